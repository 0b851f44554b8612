//! Entries of a plan file beyond places at times: stops, velocities, headings, bounds without times, rows of waypoints;
//! and the message when it cannot be met.

use nalgebra::Vector3;
use quatrack_plan::plan::{Bounds, Budget, FlightPlan, Limit, Overrides, Plan, PlanError, PlannedFlight, paper};
use quatrack_plan::trajectory::Trajectory as _;
use quatrack_plan::trajectory::transform::Transform;

pub(crate) fn read(text: &str) -> Result<FlightPlan, PlanError> {
    FlightPlan::from_toml(text, &Overrides::default(), &Budget::unlimited())
}

pub(crate) fn planned(text: &str) -> PlannedFlight {
    read(text).and_then(|plan| plan.solve(&Budget::unlimited())).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

pub(crate) fn refusal(text: &str) -> String {
    let outcome = read(text).and_then(|plan| plan.solve(&Budget::unlimited()));
    let line = outcome.map(|_| "planned").expect_err("must be refused").to_string();
    assert!(!line.contains('\n'), "{line}");
    line
}

/// A square of 8 m.
fn square(more: &str) -> String {
    format!(
        "{more}\nwaypoints = [\n  {{ position_m = [0, 0, 1] }},\n  {{ position_m = [8, 0, 1] }},\n  \
         {{ position_m = [8, 8, 1] }},\n  {{ position_m = [0, 8, 1] }},\n  {{ position_m = [0, 0, 1] }},\n]\n"
    )
}

#[test]
fn a_curve_is_the_same_wherever_it_lies() {
    let near = paper::mild().unwrap().solve().unwrap();
    let shift = Vector3::new(1000.0, -20_000.0, 300.0);
    let over = Overrides { transform: Transform { shift_m: shift, ..Transform::default() }, ..Overrides::default() };
    let far = FlightPlan::from_toml(paper::MILD_TOML, &over, &Budget::unlimited()).unwrap();
    let far = far.solve(&Budget::unlimited()).unwrap();
    for (a, b) in near.control_points_m().iter().zip(far.legs[0].curve.control_points_m()) {
        // The solver's accuracy for a curve: its waypoints lose 4e-12 m at 20 km, and it takes other steps.
        assert!((a + shift - b).norm() < 1e-6, "{a} {b}");
    }
}

#[test]
fn a_waypoint_given_twice_is_a_pause_and_a_stop_can_be_said() {
    let text = "waypoints = [\n\
                { time_s = 0, position_m = [0, 0, 1] }, { time_s = 5, position_m = [1.5, 0, 1] },\n\
                { time_s = 9, position_m = [1.5, 0, 1] }, { time_s = 14, position_m = [1.5, 1.5, 1] }]\n";
    let plan = read(text).unwrap();
    assert_eq!(plan.notes(), ["waypoints 2 and 3 are the same place: it rests there"]);
    let flight = plan.solve(&Budget::unlimited()).unwrap();
    assert_eq!((flight.legs.len(), flight.duration_s()), (3, 14.0));
    let pieces = flight.pieces().unwrap();
    for k in 0..=400 {
        let at = pieces.at(5.0 + 0.01 * f64::from(k));
        assert!((at.position_m - Vector3::new(1.5, 0.0, 1.0)).norm() < 1e-9, "{k}");
    }
    let stopped = planned(
        &text
            .replace("{ time_s = 9, position_m = [1.5, 0, 1] },", "")
            .replace("position_m = [1.5, 0, 1]", "position_m = [1.5, 0, 1], stop = true"),
    );
    let at = stopped.pieces().unwrap().at(5.0);
    assert!(at.velocity_m_s.norm() + at.acceleration_m_s2.norm() < 1e-9);
    let both = text.replace("time_s = 5, ", "time_s = 5, stop = true, velocity_m_s = [1, 0, 0], ");
    assert!(refusal(&both).starts_with("waypoint 2 (time_s = 5): has a velocity_m_s where the flight rests"));
}

#[test]
fn a_velocity_at_a_waypoint_is_flown() {
    let flight = planned(
        "waypoints = [{ time_s = 0, position_m = [0, 0, 1] }, { time_s = 3, position_m = [1, 0, 1], velocity_m_s = [0.2, 0.5, 0] },\n\
         { time_s = 6, position_m = [2, 1, 1] }]\n[bounds]\nacceleration_max_m_s2 = 2\n",
    );
    let at = flight.legs[0].curve.at(3.0);
    // The solver's accuracy, by the derivative of a curve of 2 m.
    assert!((at.velocity_m_s - Vector3::new(0.2, 0.5, 0.0)).norm() < 1e-7, "{}", at.velocity_m_s);
    assert!(flight.legs[0].realised.sampled.acceleration_max_m_s2 < 2.0);
}

#[test]
fn the_heading_is_planned_with_its_rate() {
    let text = square("duration_s = 24\nsegment_shares = [1, 1, 1, 1]")
        .replacen("[8, 0, 1] }", "[8, 0, 1], yaw_deg = 90 }", 1)
        .replacen("[0, 8, 1] }", "[0, 8, 1], yaw_deg = -180 }", 1);
    let flight = planned(&text);
    let heading = |t_s: f64| flight.legs[0].curve.at(t_s).heading_rad.to_degrees();
    for (t_s, deg) in [(0.0, 0.0), (6.0, 90.0), (18.0, -180.0)] {
        assert!((heading(t_s) - deg).abs() < 1e-4, "{t_s}: {}", heading(t_s));
    }
    assert!(flight.legs[0].curve.at(0.0).heading_rate_rad_s.abs() < 1e-6);
    let slow = format!("{text}[bounds]\nyaw_rate_max_deg_s = 10\n");
    let line = refusal(&slow);
    assert!(line.starts_with("no heading meets the plan: yaw_rate_max_deg_s = 10 is too tight ("), "{line}");
    let enough = line.split("too tight (").nth(1).unwrap().split(' ').next().unwrap().to_owned();
    planned(&format!("{text}[bounds]\nyaw_rate_max_deg_s = {enough}\n"));
    let longer = line.split("too short (").nth(1).unwrap().split(' ').next().unwrap().to_owned();
    planned(&slow.replace("duration_s = 24", &format!("duration_s = {longer}")));
}

#[test]
fn the_least_times_are_those_of_a_fine_search() {
    // From rest to rest over 8 m at 2 m/s and 2 m/s^2, at its fastest: 1 s to gather speed, 3 s at it, 1 s to brake.
    let line = "waypoints = [{ position_m = [0, 0, 1] }, { position_m = [8, 0, 1] }]\n[bounds]\nspeed_max_m_s = 2\n\
                acceleration_max_m_s2 = 2\n";
    let flight = planned(line);
    assert!((5.0..5.0 * 1.05).contains(&flight.duration_s()), "{}", flight.duration_s());
    let flown = flight.legs[0].realised.sampled;
    assert!(flown.speed_max_m_s <= 2.0 + 1e-6 && flown.acceleration_max_m_s2 <= 2.0 + 1e-6);

    // Around a corner: of all shares in hundredths, none is faster by more than a twentieth.
    let corner = |times: &str, bounds: &str| {
        format!(
            "spans = 32\n{times}\nwaypoints = [{{ position_m = [0, 0, 1] }}, {{ position_m = [3, 0, 1] }}, {{ position_m = [3, 1, 1] \
             }}]\n[bounds]\n{bounds}\n"
        )
    };
    for bounds in ["speed_max_m_s = 1.5\nacceleration_max_m_s2 = 2", "tilt_max_deg = 15\nthrust_max_m_s2 = 12"] {
        let least_s = planned(&corner("", bounds)).duration_s();
        for share in [0.5, 0.56, 0.6, 0.64, 0.68, 0.72, 0.76, 0.8] {
            let times = format!("duration_s = {}\nsegment_shares = [{share}, {}]", 0.95 * least_s, 1.0 - share);
            let faster = Plan::from_toml(&corner(&times, bounds)).unwrap().solve();
            assert!(faster.is_err(), "{bounds}: share {share} takes less than 95 % of {least_s} s");
        }
    }
    assert!(refusal(&square("")).starts_with("no times and nothing to find them from"));
}

#[test]
fn a_tour_of_many_waypoints_keeps_its_pace() {
    // 60 places in a hall of 40 m by a linear congruential generator (Knuth's), as rows without times.
    let mut state = 1_u64;
    let mut random = |from: f64, to: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        from + (to - from) * (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let places: Vec<_> =
        (0..60).map(|_| Vector3::new(random(0.0, 40.0), random(0.0, 40.0), random(1.0, 3.0))).collect();
    let rows: String = places.iter().map(|at| format!("{},{},{}\n", at.x, at.y, at.z)).collect();
    let bounds = Bounds { speed_max_m_s: Some(2.0), acceleration_max_m_s2: Some(3.0), ..Bounds::default() };
    let over = Overrides { bounds, ..Overrides::default() };
    let plan = FlightPlan::from_toml(&format!("x,y,z\n{rows}"), &over, &Budget::unlimited()).unwrap();
    let flown_s = plan.solve(&Budget::unlimited()).unwrap().duration_s();
    let straight_s: f64 = places.windows(2).map(|pair| (pair[1] - pair[0]).norm() / 2.0).sum();
    // Between straight lines at full speed, which no curve does, and a fifth more for its bends.
    let ratio = flown_s / straight_s;
    assert!((1.0..1.2).contains(&ratio), "{flown_s} s, straight {straight_s} s");
}

#[test]
fn rows_of_waypoints_are_plans() {
    let timed = planned("t,x,y,z,yaw\n2,0,0,1,0\n4,1,0,1,0.5\n6,1,1,1,1\n");
    assert_eq!(timed.duration_s(), 4.0);
    let at = timed.legs[0].curve.at(2.0);
    assert!((at.position_m - Vector3::new(1.0, 0.0, 1.0)).norm() < 1e-9 && (at.heading_rad - 0.5).abs() < 1e-6);
    let bounds = Bounds { speed_max_m_s: Some(1.0), acceleration_max_m_s2: Some(2.0), ..Bounds::default() };
    let over = Overrides { bounds, ..Overrides::default() };
    let rows = "0.0;0,5;1,4\n0.0;0,1;1,7\n0.0;0,0;1,4\n";
    let free = FlightPlan::from_toml(rows, &over, &Budget::unlimited()).unwrap();
    assert!(free.has_free_times() && free.solve(&Budget::unlimited()).is_ok());
    assert!(refusal(rows).starts_with("no times and nothing to find them from"));
}

#[test]
fn plans_may_be_turned_slowed_and_reversed() {
    let over = |transform| Overrides { transform, ..Overrides::default() };
    let plan = |transform| {
        let plan = FlightPlan::from_toml(paper::MILD_TOML, &over(transform), &Budget::unlimited()).unwrap();
        plan.solve(&Budget::unlimited()).unwrap().legs[0].curve.clone()
    };
    let original = paper::mild().unwrap().solve().unwrap();
    let back = plan(Transform { reverse: true, ..Transform::default() });
    for t_s in [3.0, 10.0, 25.0] {
        // The same optimum by other steps: the solver's accuracy for a curve.
        assert!((back.at(t_s).position_m - original.at(30.0 - t_s).position_m).norm() < 1e-5, "{t_s}");
    }
    let slow = plan(Transform { time_scale: 2.0, ..Transform::default() });
    assert_eq!(slow.duration_s(), 60.0);
    let turned = plan(Transform { turn_rad: std::f64::consts::PI, ..Transform::default() });
    let (a, b) = (turned.at(10.0).position_m, original.at(10.0).position_m);
    assert!((a.xy() + b.xy()).norm() < 1e-5 && (a.z - b.z).abs() < 1e-5);
    assert!((turned.at(10.0).heading_rad - std::f64::consts::PI).abs() < 1e-6);
}

/// Types each way out into the plan, as printed.
fn typed(text: &str, line: &str) -> Vec<String> {
    let ways = line.trim_start_matches("no curve meets the plan: ").trim_end_matches("; the rest kept").split(", or ");
    ways.filter_map(|way| {
        let mut edited = text.to_owned();
        for part in way.split(" and ") {
            let (key, rest) = part.split_once(" = ")?;
            let enough = rest.split('(').nth(1)?.trim_start_matches("duration_s = ").split(' ').next()?;
            let at = edited.find(&format!("{key} ="))?;
            let end = at + edited[at..].find('\n')?;
            edited.replace_range(at..end, &format!("{key} = {enough}"));
        }
        Some(edited)
    })
    .collect()
}

#[test]
fn every_remedy_as_printed_plans_and_a_longer_duration_is_one() {
    let cases = [
        paper::MILD_TOML.replace("speed_max_m_s = 0.5", "speed_max_m_s = 0.4"),
        // Just inside the edge of the mild plan's bounds.
        paper::MILD_TOML.replace("body_rate_max_deg_s = 1.5", "body_rate_max_deg_s = 0.9"),
        "degree = 5\nspans = 9\nduration_s = 1.0471163705755129\nsnap_sample_period_s = 0.025846113604092953\n\
         [[waypoints]]\ntime_s = 0.0\nposition_m = [-1.801, -0.703, -1.826]\n\
         [[waypoints]]\ntime_s = 0.4\nposition_m = [-1.85, -0.722, -1.876]\n\
         [[waypoints]]\ntime_s = 1.0471163705755129\nposition_m = [-0.987, -0.385, -1.001]\n\
         [bounds]\nspeed_max_m_s = 8\ntilt_max_deg = 15.0\nthrust_max_m_s2 = 11.0\n"
            .to_owned(),
    ];
    for text in cases {
        let line = refusal(&text);
        assert!(line.contains("duration_s = ") && line.contains(" is too short (duration_s = "), "{line}");
        let ways = typed(&text, &line);
        assert!(!ways.is_empty(), "{line}");
        for way in ways {
            planned(&way);
        }
    }
}

#[test]
fn no_more_is_asked_for_than_is_needed() {
    let text = paper::MILD_TOML.replace("tilt_max_deg = 1.75", "tilt_max_deg = 1.2");
    let Err(PlanError::Infeasible(report)) = read(&text).unwrap().solve(&Budget::unlimited()) else {
        panic!("infeasible")
    };
    for way in report.ways_out.iter().filter(|way| way.len() == 1) {
        let remedy = way[0];
        let less = match remedy.limit {
            Limit::Tilt => text.replace("= 1.2", &format!("= {}", (remedy.enough * 0.995).to_degrees())),
            Limit::Duration => text.replace("duration_s = 30.0", &format!("duration_s = {}", remedy.enough * 0.995)),
            _ => continue,
        };
        assert!(read(&less).unwrap().solve(&Budget::unlimited()).is_err(), "{remedy:?}: less does too");
    }
}

#[test]
fn a_detour_names_its_waypoint() {
    // The third is reached too early: to be there, the curve swings out on either side.
    let text = "waypoints = [{ time_s = 0, position_m = [0, 0, 1] }, { time_s = 4, position_m = [1, 0, 1] }, \
                { time_s = 4.2, position_m = [2, 0, 1] }, { time_s = 9, position_m = [3, 0, 1] }]\n";
    let flight = planned(text);
    let detour = flight.legs[0].detour.expect("a curve many times as long");
    assert!(detour.times > 2.5 && [Some(2), Some(3)].contains(&detour.waypoint), "{detour:?}");
    assert_eq!(planned(&text.replace("4.2", "6.5")).legs[0].detour, None);
}

#[test]
fn the_time_is_bounded_and_progress_told() {
    let told = std::cell::RefCell::new(Vec::new());
    let tell = |stage: &str| told.borrow_mut().push(stage.to_owned());
    let budget = Budget::of_seconds(0.0, &tell);
    let plan = read(paper::MILD_TOML).unwrap();
    assert_eq!(plan.solve(&budget), Err(PlanError::TimeLimit { limit_s: 0.0 }));
    assert_eq!(told.borrow().first().map(String::as_str), Some("planning"));
}
