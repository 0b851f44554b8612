//! Plan files that cannot be used: each is refused with a line that names the fault, its value and its range.

use quatrack_plan::plan::{Plan, PlanError};

const HEAD: &str = "degree = 5\nspans = 10\nduration_s = 4.0\nsnap_sample_period_s = 0.1\n";
const START: &str = "[[waypoints]]\ntime_s = 0.0\nposition_m = [0, 0, 0]\n";
const MIDDLE: &str = "[[waypoints]]\ntime_s = 2.0\nposition_m = [0, 1, 0]\ntolerance_m = 0.1\n";
const END: &str = "[[waypoints]]\ntime_s = 4.0\nposition_m = [1, 0, 0]\n";

fn good() -> String {
    [HEAD, START, MIDDLE, END].concat()
}

/// The good plan with one text for another.
fn edited(from: &str, to: &str) -> String {
    assert!(good().contains(from), "nothing to edit: {from}");
    good().replacen(from, to, 1)
}

fn refusal(text: &str) -> String {
    let error = Plan::from_toml(text).map(|_| "accepted").unwrap_err();
    assert!(!error.is_infeasible());
    let line = error.to_string();
    assert!(!line.contains('\n'), "{line:?}");
    line
}

#[test]
fn the_good_plan_is_good() {
    let plan = Plan::from_toml(&good()).unwrap();
    assert_eq!(plan.waypoints().len(), 3);
    assert_eq!(plan.waypoints()[1].tolerance_m, 0.1);
    assert!(plan.solve().is_ok());
}

#[test]
fn values_out_of_range_are_named_with_their_range() {
    let cases = [
        ("degree = 5", "degree = 3", "degree = 3: must be from 4"),
        ("degree = 5", "degree = 8", "degree = 8: must be from 4"),
        ("spans = 10", "spans = 0", "spans = 0: must be from 3"),
        ("spans = 10", "spans = 2", "(four control points at rest at each end)"),
        ("spans = 10", "spans = 100000", "to 500"),
        ("duration_s = 4.0", "duration_s = 0.0", "duration_s = 0: must be from 0.01"),
        ("duration_s = 4.0", "duration_s = nan", "duration_s = NaN"),
        ("duration_s = 4.0", "duration_s = inf", "duration_s = inf"),
        ("duration_s = 4.0", "duration_s = -4.0", "duration_s = -4"),
        ("period_s = 0.1", "period_s = 0.0", "snap_sample_period_s = 0: must be above 0"),
        ("period_s = 0.1", "period_s = 0.3", "at most 0.200000 s"),
        ("period_s = 0.1", "period_s = nan", "snap_sample_period_s = NaN"),
        ("period_s = 0.1", "period_s = 1e-12", "at least a millionth"),
        ("period_s = 0.1", "period_s = 0.1\nbody_rate_slack_reward = -1", "body_rate_slack_reward = -1"),
        ("time_s = 2.0", "time_s = -2.0", "waypoint 2: time_s = -2: must be from 0 to that of the last waypoint, 4 s"),
        ("time_s = 2.0", "time_s = 4.5", "waypoint 2: time_s = 4.5"),
        ("time_s = 2.0", "time_s = nan", "waypoint 2: time_s = NaN"),
        ("[0, 1, 0]", "[0, inf, 0]", "waypoint 2: position_m = inf: must be a finite number"),
        ("[0, 1, 0]", "[0, 1e7, 0]", "waypoint 2: position_m = 10000000"),
        ("tolerance_m = 0.1", "tolerance_m = -0.1", "waypoint 2: tolerance_m = -0.1: must be from 0 (met exactly)"),
        ("tolerance_m = 0.1", "tolerance_m = nan", "waypoint 2: tolerance_m = NaN"),
        ("[1, 0, 0]", "[1, 0, 0]\ntolerance_m = 0.1", "waypoint 3: tolerance_m = 0.1: must be 0 or left out"),
    ];
    for (from, to, expected) in cases {
        let line = refusal(&edited(from, to));
        assert!(line.contains(expected), "{to}: {line}");
    }
}

#[test]
fn impossible_bounds_are_named_with_their_range() {
    let cases = [
        ("[bounds]\nspeed_max_m_s = 0", "bounds.speed_max_m_s = 0: must be above 0"),
        ("[bounds]\nspeed_max_m_s = nan", "bounds.speed_max_m_s = NaN"),
        ("[bounds]\ntilt_max_deg = 90", "bounds.tilt_max_deg = 90: must be above 0 and below 90"),
        ("[bounds]\ntilt_max_deg = -1", "bounds.tilt_max_deg = -1"),
        ("[bounds]\nthrust_max_m_s2 = 9.81", "bounds.thrust_max_m_s2 = 9.81: must be above g = 9.81"),
        ("[bounds]\nthrust_min_m_s2 = 9.81", "bounds.thrust_min_m_s2 = 9.81: must be at least 0 and below g = 9.81"),
        ("[bounds]\nthrust_min_m_s2 = -1", "bounds.thrust_min_m_s2 = -1"),
        ("[bounds]\nbody_rate_max_deg_s = inf", "bounds.body_rate_max_deg_s = inf"),
        (
            "[[corridors]]\nmin_m = [0, 0, 1]\nmax_m = [1, 1, 1]",
            "corridor 1, z: lower 1, upper 1; the lower one must be below",
        ),
        ("[[corridors]]\nmin_m = [0, nan, 0]\nmax_m = [1, 1, 1]", "corridor 1: min_m = NaN"),
        (
            "[[corridors]]\nfrom_s = 5\nmin_m = [0, 0, 0]\nmax_m = [1, 1, 1]",
            "corridor 1: from_s = 5: must be from 0 to duration_s = 4",
        ),
        (
            "[[corridors]]\nfrom_s = 3\nto_s = 2\nmin_m = [0, 0, 0]\nmax_m = [1, 1, 1]",
            "corridor 1, time: lower 3, upper 2",
        ),
    ];
    for (more, expected) in cases {
        let line = refusal(&(good() + more));
        assert!(line.contains(expected), "{more}: {line}");
    }
}

#[test]
fn waypoints_out_of_order_or_number_are_named() {
    assert_eq!(Plan::from_toml(HEAD), Err(PlanError::TooFewWaypoints(0)));
    assert_eq!(Plan::from_toml(&[HEAD, START].concat()), Err(PlanError::TooFewWaypoints(1)));
    let cases = [
        (edited("time_s = 2.0", "time_s = 0.0"), "waypoint 2 (time_s = 0): not after the one before it, at 0 s"),
        ([HEAD, START, MIDDLE, MIDDLE, END].concat(), "waypoint 3 (time_s = 2): not after the one before it, at 2 s"),
        (edited("time_s = 0.0", "time_s = 0.5"), "waypoint 1 (time_s = 0.5): must be at 0 s"),
        (edited("time_s = 2.0\n", ""), "waypoint 2: has no time_s"),
        (edited("spans", "segment_shares = [1, 1]\nspans"), "waypoint 1 (time_s = 0): has time_s, and segment_shares"),
        (edited("spans", "rest_to_rest = false\nspans"), "3 given with rest_to_rest = false"),
    ];
    for (text, expected) in cases {
        let line = refusal(&text);
        assert!(line.contains(expected), "{line}");
    }
}

#[test]
fn another_duration_stretches_the_times() {
    let plan = Plan::from_toml(&edited("duration_s = 4.0", "duration_s = 6.0")).unwrap();
    let times: Vec<f64> = plan.waypoints().iter().map(|waypoint| waypoint.time_s).collect();
    assert_eq!((times, plan.duration_s()), (vec![0.0, 3.0, 6.0], 6.0));
    let own = Plan::from_toml(&edited("duration_s = 4.0\n", "")).unwrap();
    assert_eq!(own.duration_s(), 4.0);
}

#[test]
fn segment_shares_cut_the_duration() {
    let untimed: String = good().lines().filter(|line| !line.starts_with("time_s")).map(|l| format!("{l}\n")).collect();
    let with = |shares: &str| untimed.replace("spans", &format!("segment_shares = {shares}\nspans"));
    let plan = Plan::from_toml(&with("[1, 3]")).unwrap();
    let times: Vec<f64> = plan.waypoints().iter().map(|waypoint| waypoint.time_s).collect();
    assert_eq!(times, [0.0, 1.0, 4.0]);
    for (shares, expected) in [
        ("[1, 2, 3]", "segment_shares: 3 given for 3 waypoints; there must be 2"),
        ("[1, 0]", "segment_shares, entry 2 = 0: must be above 0"),
        ("[nan, 1]", "segment_shares, entry 1 = NaN"),
    ] {
        let line = refusal(&with(shares));
        assert!(line.contains(expected), "{line}");
    }
}

#[test]
fn more_exact_waypoints_than_spans_can_meet_are_named() {
    // No two at the same place, which would be a pause.
    let at = |time_s: f64| format!("[[waypoints]]\ntime_s = {time_s:?}\nposition_m = [{time_s:?}, 1, 0]\n");
    // Seven exact waypoints fit the seven control points that 10 spans of degree 5 leave between rest and rest, an
    // eighth does not.
    let evenly = |count: u32| (1..=count).map(|k| at(4.0 * f64::from(k) / f64::from(count + 1))).collect::<String>();
    let seven = [HEAD, START, &evenly(7), END].concat();
    assert!(Plan::from_toml(&seven).unwrap().solve().is_ok());
    let line = refusal(&[HEAD, START, &evenly(8), END].concat());
    assert!(line.contains("spans = 10 leave no control point for it; raise spans, or give tolerance_m"), "{line}");
    // Few, but crowded into the first span, where only two basis functions are free.
    let crowded = [at(0.1), at(0.2), at(0.3)].concat();
    let line = refusal(&[HEAD, START, &crowded, END].concat());
    assert!(line.contains("waypoint 4 (time_s = 0.3): cannot be met exactly"), "{line}");
    // After a stop the clock of its leg is not the file's.
    let stop = "[[waypoints]]\ntime_s = 1.0\nposition_m = [1, 1, 0]\nstop = true\n";
    let line = refusal(&[HEAD, START, stop, &[at(1.1), at(1.2), at(1.3)].concat(), END].concat());
    assert!(line.contains("waypoint 5: cannot be met exactly"), "{line}");
}

#[test]
fn a_text_that_is_no_plan_is_refused_with_its_line() {
    for empty in ["", "\n\n", "# only a comment\n"] {
        assert_eq!(Plan::from_toml(empty), Err(PlanError::Empty));
    }
    let cases = [
        (edited("spans = 10", "spans = 10\nspeed = 3"), "line 3: unknown field `speed`"),
        (good() + "[bounds]\nspeed_max = 3", "unknown field `speed_max`"),
        (edited("spans = 10", "spans = -10"), "line 2: "),
        (edited("spans = 10", "spans = \"ten\""), "line 2: invalid type: string \"ten\""),
        (edited("[0, 1, 0]", "[0, 1]"), "invalid length 2"),
        (edited("spans = 10", "spans = = 10"), "line 2: "),
        ("\u{0}\u{1}".to_owned(), "line 1: "),
        ("t,x_mm,y_mm,z_mm\n0,0,0,1000\n".to_owned(), "(s, m, rad); has t,x_mm,y_mm,z_mm"),
    ];
    for (text, expected) in cases {
        let line = refusal(&text);
        assert!(line.contains(expected), "{line}");
    }
}
