//! Times and headings of a flight: least times slowed, corridors stretched, headings at its ends and at stops, in both directions.

use quatrack_plan::plan::{Budget, Extremes, FlightPlan, Overrides};
use quatrack_plan::trajectory::Trajectory as _;
use quatrack_plan::trajectory::transform::Transform;

use crate::flights::{planned, read, refusal};

#[test]
fn a_heading_stays_behind_the_last_given_one_and_turns_back_where_the_plan_is_reversed() {
    let text = "waypoints = [{ time_s = 0, position_m = [0, 0, 1] }, { time_s = 3, position_m = [2, 0, 1], yaw_deg = 90 }, \
                { time_s = 6, position_m = [2, 2, 1] }]\n";
    let curve = |reverse| {
        let over = Overrides { transform: Transform { reverse, ..Transform::default() }, ..Overrides::default() };
        let plan = FlightPlan::from_toml(text, &over, &Budget::unlimited()).unwrap();
        plan.solve(&Budget::unlimited()).unwrap().legs[0].curve.clone()
    };
    let [forth, back] = [false, true].map(curve);
    for (t_s, degrees) in [(0.0, 0.0_f64), (3.0, 90.0), (6.0, 90.0)] {
        assert!((forth.at(t_s).heading_rad - degrees.to_radians()).abs() < 1e-6, "{t_s}");
    }
    for t_s in [0.0, 1.0, 2.0, 4.0, 5.5, 6.0] {
        // The same optimum by other steps: the solver's accuracy for a curve.
        assert!((back.at(t_s).heading_rad - forth.at(6.0 - t_s).heading_rad).abs() < 1e-5, "{t_s}");
    }
}

#[test]
fn a_heading_too_slow_is_told_for_the_flight_with_all_its_stops() {
    let text = "waypoints = [{ time_s = 0, position_m = [0, 0, 1], yaw_deg = 0 }, \
                { time_s = 2, position_m = [1, 1, 1], yaw_deg = 170, stop = true }, \
                { time_s = 4, position_m = [0, 1, 1], yaw_deg = 500 }]\nduration_s = 4\nbounds.yaw_rate_max_deg_s = 120\n";
    let line = refusal(text);
    let said: Vec<&str> = line.split('(').skip(1).filter_map(|part| part.split(' ').next()).collect();
    let [rate, duration_s] = said[..] else { panic!("{line}") };
    let flight = planned(&text.replace("= 120", &format!("= {rate}")));
    let sampled = flight.legs.iter().map(|leg| leg.realised.sampled);
    let [fastest, body] = [|s: Extremes| s.heading_rate_max_rad_s, |s: Extremes| s.body_rate_max_rad_s]
        .map(|of| sampled.clone().map(of).fold(0.0, f64::max));
    // Nearly level, the heading's rate is all of the body's.
    assert!((0.99..1.1).contains(&(body / fastest)), "{body} beside {fastest}");
    // The slower turn of the two asks for less; a bound holds for the control points, some way above the curve.
    assert!(
        fastest <= rate.parse::<f64>().unwrap().to_radians() && fastest > 165_f64.to_radians(),
        "{line}: {fastest}"
    );
    let flight = planned(&text.replace("duration_s = 4", &format!("duration_s = {duration_s}")));
    assert!((flight.duration_s() - duration_s.parse::<f64>().unwrap()).abs() < 1e-9 && flight.duration_s() > 4.0);
}

#[test]
fn a_stretched_plan_keeps_its_corridors_at_its_waypoints() {
    let text = "waypoints = [{ time_s = 0, position_m = [0, 0, 1] }, { time_s = 2, position_m = [2, 0, 1] }, \
                { time_s = 4, position_m = [2, 2, 1] }]\nduration_s = 4\nbounds.tilt_max_deg = 8\n\
                [[corridors]]\nmin_m = [1.9, -0.02, 0.9]\nmax_m = [2.01, 2.02, 1.1]\nfrom_s = 2.2\n";
    let line = refusal(text);
    let enough =
        line.split("(duration_s = ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a longer duration");
    let flight = planned(&text.replace("duration_s = 4", &format!("duration_s = {enough}")));
    let ratio = flight.duration_s() / 4.0;
    assert!(ratio > 1.1 && (flight.legs[0].plan.corridors()[0].from_s - 2.2 * ratio).abs() < 1e-9);
}

#[test]
fn least_times_are_slowed_like_written_ones() {
    let text = "waypoints = [{ position_m = [0, 0, 1] }, { position_m = [2, 0, 1] }]\n\
                bounds = { speed_max_m_s = 1.5, acceleration_max_m_s2 = 3 }\n";
    let over = Overrides { transform: Transform { time_scale: 2.0, ..Transform::default() }, ..Overrides::default() };
    let slow = FlightPlan::from_toml(text, &over, &Budget::unlimited()).unwrap();
    let fast = read(text).unwrap();
    assert!((slow.legs()[0].duration_s() - 2.0 * fast.legs()[0].duration_s()).abs() < 1e-9);
    assert!(
        fast.notes()[0].starts_with("the times are the least")
            && slow.notes()[0].contains("in proportion to the least")
    );
    assert!(slow.solve(&Budget::unlimited()).is_ok());
}
