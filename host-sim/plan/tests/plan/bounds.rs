//! Plans other than the paper's: bounds hold for all t, and where they cannot, the report says which is too tight.

use quatrack_plan::plan::{Extremes, Infeasibility, Limit, Plan, PlanError, paper};
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::bspline::BSpline;

/// The mild plan with lines that start with a key replaced, all of them.
fn mild_with(edits: &[(&str, &str)]) -> String {
    let line = |line: &str| {
        let edit = edits.iter().find(|(key, _)| line.strip_prefix(key).is_some_and(|rest| rest.starts_with(" = ")));
        edit.map_or_else(|| format!("{line}\n"), |(key, value)| format!("{key} = {value}\n"))
    };
    paper::MILD_TOML.lines().map(line).collect()
}

fn solved(text: &str) -> (Plan, BSpline) {
    let plan = Plan::from_toml(text).unwrap();
    let curve = plan.solve().unwrap_or_else(|error| panic!("{error}"));
    (plan, curve)
}

fn infeasible(text: &str) -> (Infeasibility, String) {
    let error = Plan::from_toml(text).unwrap().solve().unwrap_err();
    let line = error.to_string();
    match error {
        PlanError::Infeasible(report) => (report, line),
        other => panic!("expected an infeasible plan, got: {other}"),
    }
}

/// The value that the report gives if this limit alone is relaxed, SI.
fn enough(report: &Infeasibility, limit: Limit) -> Option<f64> {
    let alone = report.ways_out.iter().filter(|way| way.len() == 1).flatten();
    alone.filter(|remedy| remedy.limit == limit).map(|remedy| remedy.enough).next()
}

#[test]
fn the_bound_reported_is_the_least_that_would_do() {
    // Key, a value far too tight, the limit, and how its SI value is written in the file.
    let si: fn(f64) -> f64 = |value| value;
    let cases = [
        ("speed_max_m_s", "0.2", Limit::Speed, si),
        ("tilt_max_deg", "1.1", Limit::Tilt, f64::to_degrees),
        ("thrust_min_m_s2", "9.8", Limit::ThrustMin, si),
        ("thrust_max_m_s2", "9.83", Limit::ThrustMax, si),
        ("body_rate_max_deg_s", "0.5", Limit::BodyRate, f64::to_degrees),
    ];
    for (key, given, limit, written) in cases {
        let (report, line) = infeasible(&mild_with(&[(key, given)]));
        let expected = format!("{key} = {given} is too tight (");
        assert!(line.contains(&expected) && !line.contains('\n'), "{line}");
        let enough = written(enough(&report, limit).unwrap_or_else(|| panic!("{line}")));
        solved(&mild_with(&[(key, &enough.to_string())]));
        // The report leaves a thousandth of room (for thrust, of its distance to hover), and the descent of a ratio ends
        // within another: 1 % tighter must fail.
        let hover = if key.starts_with("thrust") { 9.81 } else { 0.0 };
        let tighter = hover + 0.99 * (enough - hover);
        let (_, line) = infeasible(&mild_with(&[(key, &tighter.to_string())]));
        assert!(line.contains(key), "{line}");
    }
}

#[test]
fn waypoints_met_exactly_are_beyond_the_mild_bounds() {
    let (report, line) = infeasible(&mild_with(&[("tolerance_m", "0.0")]));
    let more_m = enough(&report, Limit::Waypoints).unwrap();
    assert!(line.contains("the waypoints' tolerance_m is too tight ("), "{line}");
    // The paper's plan allows 5 cm, and there every waypoint uses it up; less does too, down to this.
    assert!((0.03..0.05).contains(&more_m), "{line}");
    solved(&mild_with(&[("tolerance_m", &more_m.to_string())]));
    infeasible(&mild_with(&[("tolerance_m", &(0.99 * more_m).to_string())]));
}

#[test]
fn bounds_too_tight_together_are_reported_together() {
    let (report, line) = infeasible(&mild_with(&[("speed_max_m_s", "0.2"), ("tilt_max_deg", "0.5")]));
    assert_eq!((enough(&report, Limit::Speed), enough(&report, Limit::Tilt)), (None, None), "{line}");
    let way = report.ways_out.iter().find(|way| way.len() == 2).unwrap_or_else(|| panic!("{line}"));
    assert_eq!((way[0].limit, way[1].limit), (Limit::Speed, Limit::Tilt));
    let (speed_m_s, tilt_deg) = (way[0].enough.to_string(), way[1].enough.to_degrees().to_string());
    solved(&mild_with(&[("speed_max_m_s", &speed_m_s), ("tilt_max_deg", &tilt_deg)]));
}

#[test]
fn a_corridor_holds_for_all_of_its_time() {
    // The free flight leaves both.
    let corridors = "\n[[corridors]]\nmin_m = [-1.0, -1.0, -0.05]\nmax_m = [1.0, 0.7, 1.0]\n\
                     \n[[corridors]]\nfrom_s = 10.0\nto_s = 15.0\nmin_m = [-1.0, -1.0, 0.1]\nmax_m = [1.0, 1.0, 0.479]\n";
    let (plan, curve) = solved(&(paper::MILD_TOML.to_owned() + corridors));
    let free = paper::mild().unwrap().solve().unwrap();
    let highest = |curve: &BSpline, axis: usize, from: u32, to: u32| {
        (from..=to).map(|k| curve.at(0.01 * f64::from(k)).position_m[axis]).fold(f64::NEG_INFINITY, f64::max)
    };
    assert!(highest(&free, 1, 0, 3000) > 0.7 && highest(&free, 2, 1000, 1500) > 0.479);
    assert_eq!(plan.corridors().len(), 2);
    for k in 0..=3000 {
        let t_s = 0.01 * f64::from(k);
        let p = curve.at(t_s).position_m;
        // 1e-7 is the solver's accuracy.
        assert!(p.y <= 0.7 + 1e-7 && p.z >= -0.05 - 1e-7, "{t_s}: {p}");
        assert!(!(10.0..=15.0).contains(&t_s) || (0.1 - 1e-7..=0.479 + 1e-7).contains(&p.z), "{t_s}: {p}");
    }

    let narrow = "\n[[corridors]]\nmin_m = [-1.0, -1.0, -0.05]\nmax_m = [1.0, 0.5, 1.0]\n";
    let (report, line) = infeasible(&(paper::MILD_TOML.to_owned() + narrow));
    let wider_m = enough(&report, Limit::Corridor(0)).unwrap();
    assert!(line.contains("corridor 1 is too tight (every side "), "{line}");
    let wide = narrow.replace("0.5, 1.0]", &format!("{}, 1.0]", 0.5 + wider_m));
    solved(&(paper::MILD_TOML.to_owned() + &wide));
}

#[test]
fn bounds_hold_at_every_sample_of_every_degree() {
    for degree in 4..=7 {
        // Degree 4 has jumps in the snap only and so in nothing that is bounded.
        let text =
            mild_with(&[("degree", &degree.to_string()), ("speed_max_m_s", "0.55"), ("body_rate_max_deg_s", "2.5")]);
        let (plan, curve) = solved(&text);
        assert_eq!((curve.degree(), curve.spans()), (degree, plan.spans()));
        let flown = Extremes::of(&curve);
        assert!(flown.speed_max_m_s < 0.55 && flown.tilt_max_rad < 1.75_f64.to_radians(), "{degree}: {flown:?}");
        assert!(flown.thrust_min_m_s2 > 9.7 && flown.thrust_max_m_s2 < 9.9, "{degree}: {flown:?}");
        assert!(flown.turn_rate_max_rad_s < 2.5_f64.to_radians(), "{degree}: {flown:?}");
        let end = curve.at(plan.duration_s());
        let moving = end.velocity_m_s.norm() + end.acceleration_m_s2.norm() + end.jerk_m_s3.norm();
        assert_eq!(moving, 0.0);
    }
}

#[test]
fn without_rest_a_cubic_is_planned_as_it_is() {
    // Snap of a cubic is 0: four points on one are met by it and nothing better.
    let cubic = |t: f64| [t, t * t, 0.5 * t * t * t - t];
    let waypoints =
        [0.0, 0.5, 1.25, 2.0].map(|t| format!("[[waypoints]]\ntime_s = {t:?}\nposition_m = {:?}\n", cubic(t)));
    let head = "degree = 5\nspans = 6\nduration_s = 2\nrest_to_rest = false\nsnap_sample_period_s = 0.1\n";
    let (_, curve) = solved(&(head.to_owned() + &waypoints.concat()));
    for k in 0..=200 {
        let t_s = 0.01 * f64::from(k);
        let [x, y, z] = cubic(t_s);
        // The snap is found to be 0 within the solver's accuracy, 1e-10, integrated four times over 2 s.
        assert!((curve.at(t_s).position_m - nalgebra::Vector3::new(x, y, z)).norm() < 1e-8, "{t_s}");
    }
    assert!((curve.at(0.0).velocity_m_s - nalgebra::Vector3::new(1.0, 0.0, -1.0)).norm() < 1e-7);
}

#[test]
fn two_waypoints_make_a_flight() {
    // From rest to rest over 4 s, far from any bound: half way at half time, by symmetry.
    let text = "degree = 7\nspans = 8\nduration_s = 4.0\nsnap_sample_period_s = 0.1\n\
                waypoints = [{ time_s = 0, position_m = [0, 0, 0] }, { time_s = 4, position_m = [1, -2, 3] }]";
    let (_, curve) = solved(text);
    assert!((curve.at(2.0).position_m - nalgebra::Vector3::new(0.5, -1.0, 1.5)).norm() < 1e-9);
    assert_eq!(curve.at(4.0).position_m, nalgebra::Vector3::new(1.0, -2.0, 3.0));
}

#[test]
fn slow_and_small_flights_are_planned_too() {
    // Snap goes with length over time to the fourth: from one of these to the other its square spans 20 decades.
    for (duration_s, spans, size_m, period_s) in [(1000.0, 20, 1.0, 10.0), (5.0, 60, 0.01, 0.04)] {
        let text = format!(
            "degree = 5\nspans = {spans}\nduration_s = {duration_s:?}\nsnap_sample_period_s = {period_s}\n\
             [bounds]\nspeed_max_m_s = 1\nbody_rate_max_deg_s = 20\ntilt_max_deg = 5\n\
             [[waypoints]]\ntime_s = 0\nposition_m = [0, 0, 0]\n\
             [[waypoints]]\ntime_s = {}\nposition_m = [{size_m}, 0, {size_m}]\n\
             [[waypoints]]\ntime_s = {duration_s:?}\nposition_m = [0, {size_m}, 0]\n",
            0.4 * duration_s
        );
        let (plan, curve) = solved(&text);
        // Twice the straight path would be a curve with loops in it.
        let straight_m = (2.0_f64.sqrt() + 3.0_f64.sqrt()) * size_m;
        let flown = Extremes::of(&curve);
        assert!((straight_m..2.0 * straight_m).contains(&flown.length_m), "{straight_m} {flown:?}");
        assert!(plan.realised(&curve).misses_m.iter().all(|miss_m| *miss_m < 1e-8 * size_m));
    }
}
