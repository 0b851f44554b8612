//! Scenario files: values that are read, values that are refused and how, and that a flight repeats.

use std::path::Path;

use nalgebra::Vector3;
use quatrack_simulation::scenario::compare::Table;
use quatrack_simulation::scenario::file::{Estimator, ScenarioFile};
use quatrack_simulation::scenario::flight::Setpoints;
use quatrack_simulation::scenario::{CourseChoice, Law, Scenario};

/// Every key but a filter's, which flies only where the estimator does.
const WHOLE: &str = r#"
vehicle = "crazyflie-2.1-brushless"
course = "eight"
speed_m_s = 2.1
duration_s = 3.0
law = "lee"
setpoints = "exact"
estimator = "exact"
seed = 7
[air]
drag_per_s = [0.447, 0.435, 0.45]
moment_n_m_per_m_s = [7.0e-4, 9.1e-4]
wind_m_s = [1.0, 0.0, 0.0]
gust_rms_m_s = 0.5
[errors]
mass_factor = 1.1
inertia_factor = 0.9
lag_ms = 67.0
delay_ms = 5.0
thrust_factor = 0.97
thrust_factor_end = 0.90
torque_bias_n_m = [1e-5, 0.0]
centre_of_mass_m = [5e-4, 0.0]
gyro_bias_rad_s = [0.0, 0.01, 0.0]
accelerometer_bias_m_s2 = [0.0, 0.0, 0.1]
[told]
mass_kg = 0.045
lag_ms = 50.0
drag_per_s = 0.353
moment_n_m_per_m_s = [5.6e-4, 7.3e-4]
[noise]
gyro_rad_s = 0.02
accelerometer_m_s2 = 0.5
position_m = 0.001
velocity_m_s = 0.01
attitude_rad = 0.0035
[filter]
prediction_hz = 100
position_hz = 100
drag_per_s = 0.0
latency_ms = 0.0
phase_ms = 0.0
"#;

fn scenario(text: &str) -> Result<Scenario, String> {
    let file = ScenarioFile::parse(text, "my.toml").map_err(|error| error.to_string())?;
    Scenario::checked(&file, "my.toml", Path::new("")).map_err(|error| error.to_string())
}

#[test]
fn every_key_of_a_file_is_in_the_scenario() {
    let read = scenario(WHOLE).unwrap();
    assert_eq!((read.course, read.duration_s), (CourseChoice::Eight(2.1), Some(3.0)));
    assert_eq!(
        (read.law, read.setpoints, read.estimator, read.seed),
        (Law::Lee, Setpoints::Exact, Estimator::Exact, 7)
    );
    assert_eq!(read.environment.air.drag_per_s, [0.447, 0.435, 0.45]);
    assert_eq!(read.environment.wind.mean_m_s, Vector3::x());
    assert_eq!(read.environment.wind.turbulence.map(|turbulence| turbulence.rms_m_s.x), Some(0.5));
    let truth = &read.truth;
    // 39.3 g and 10 % more.
    assert!((truth.mass_kg - 0.04323).abs() < 1e-12 && (truth.inertia_kg_m2.m22 - 0.9 * 36e-6).abs() < 1e-18);
    assert_eq!((truth.rise_lag_s, truth.fall_lag_s, truth.delay_s), (0.067, 0.067, 0.005));
    // 2 s of hover, 3 s of ramp and 3 s that are measured.
    assert!((truth.thrust_factor_per_s * 8.0 + 0.07).abs() < 1e-12);
    assert_eq!((read.told.mass_kg, read.told.lag_s, read.told.drag_per_s), (0.045, Some(0.05), Some(0.353)));
    assert_eq!((read.noise.gyro_rad_s, read.noise.attitude_rad), (0.02, 0.0035));
}

#[test]
fn thrust_fades_to_the_end_of_any_course() {
    for course in ["course = \"hover\"\nduration_s = 1.0", "course = \"step\"\nduration_s = 2.0", "duration_s = 0.5"] {
        let text = format!("vehicle = \"crazyflie-2.1-brushless\"\n{course}\n[errors]\nthrust_factor_end = 0.8\n");
        let flown = scenario(&text).unwrap();
        let mut law = flown.law.start(&flown.vehicle, &flown.told).unwrap();
        let recording = flown.record(law.as_mut(), &flown.flown(None)).unwrap();
        assert!(recording.flight.lost.is_none(), "{course}");
        let [_, most_n] = recording.around.last().unwrap().thrust_limits_n;
        // The last row is within 10 ms of the end, 0.2 of a factor over 3 s and more away.
        let factor = most_n[0] / flown.vehicle.motors().thrust_max_n;
        assert!((factor - 0.8).abs() < 1e-3, "{course}: {factor}");
    }
}

#[test]
fn motors_at_their_limits_count_where_a_craft_is_lost_before_it_is_measured() {
    let flown =
        scenario("vehicle = \"crazyflie-2.1\"\nlaw = \"lee\"\n[errors]\nthrust_factor = 0.5\nmass_factor = 1.9\n")
            .unwrap();
    let mut law = flown.law.start(&flown.vehicle, &flown.told).unwrap();
    let recording = flown.record(law.as_mut(), &flown.flown(None)).unwrap();
    let lost_s = recording.flight.lost.unwrap().time_s;
    // It asks for more than there is from its first steps on, at 500 Hz.
    let [steps, all] = [recording.flight.saturated_steps as f64, 500.0 * lost_s];
    assert!(lost_s < 5.0 && steps > 0.5 * all && steps <= all + 1.0, "{steps} of {all}");
}

#[test]
fn all_but_the_vehicle_may_be_left_out() {
    let read = scenario("vehicle = \"crazyflie-2.1\"").unwrap();
    assert_eq!((&read.course, read.duration_s), (&CourseChoice::Eight(2.1), Some(12.0)));
    assert_eq!((read.law, read.setpoints), (Law::Quatrack, Setpoints::At100Hz));
    assert!((read.told.mass_kg, read.told.lag_s) == (0.029, None) && read.truth.rise_lag_s == 0.126);
    for (course, duration_s) in [("hover", Some(10.0)), ("step", Some(5.0)), ("mild", None)] {
        let read = scenario(&format!("vehicle = \"crazyflie-2.1\"\ncourse = \"{course}\"")).unwrap();
        assert_eq!(read.duration_s, duration_s, "{course}");
    }
}

#[test]
fn the_vehicles_own_air_is_that_of_its_file() {
    let read = scenario("vehicle = \"crazyflie-2.1-brushless\"\nair = \"vehicle\"").unwrap();
    // arXiv 2512.14450, at 45 g; on the 39.3 g of the vehicle's file the same force is more a kilogram.
    let air = &read.environment.air;
    assert!((air.drag_per_s[0] - 0.447 * 0.045 / read.vehicle.mass_kg()).abs() < 1e-12, "{:?}", air.drag_per_s);
    assert_eq!(air.moment_n_m_per_m_s, [7.0e-4, 9.1e-4]);
}

#[test]
fn values_without_sense_are_refused_in_one_line_with_key_value_and_range() {
    let with = |line: &str| format!("vehicle = \"crazyflie-2.1\"\n{line}\n");
    for (text, parts) in [
        (with("speed = 2.0"), &["my.toml, line 2", "`speed = 2.0`", "unknown field `speed`", "`speed_m_s`"][..]),
        (with("[air]\ndrag = [0.4, 0.4, 0.4]"), &["line 3", "unknown field `drag`", "`drag_per_s`"]),
        (with("[errors]\nmass_factor = \"a\""), &["line 3", "mass_factor", "expected f64"]),
        (with("law = \"mpc\""), &["line 2", "unknown variant `mpc`", "`quatrack`", "`pid`"]),
        (with("setpoints = \"50hz\""), &["line 2", "unknown variant `50hz`", "`100hz`", "`exact`"]),
        ("course = \"hover\"".to_owned(), &["missing field `vehicle`"]),
        (with("[told]\nmass_kg = 29.0"), &["my.toml: told.mass_kg = 29: must be from 0.0145 to 0.058", "kg"]),
        (with("[errors]\nlag_ms = 0.067"), &["errors.lag_ms = 0.067: must be from 1 to 1000", "ms"]),
        (with("[errors]\nlag_ms = 60\nlag_rise_ms = 50"), &["errors.lag_ms = 60: must be left out"]),
        (with("[errors]\nlag_rise_ms = 50"), &["errors.lag_rise_ms = 50: must be given with"]),
        (with("[errors]\ninertia_factor = 100"), &["errors.inertia_factor = 100: must be from 0.2 to 5"]),
        (with("[errors]\nmass_factor = nan"), &["my.toml, line 3, `mass_factor = nan`: must be a finite number"]),
        (with("[noise]\n\nposition_m = -inf"), &["my.toml, line 4, `position_m = -inf`: must be a finite number"]),
        (
            with("[start]\noffset_m = [0.0, 1e999, 0.0]"),
            &["my.toml, line 3, `offset_m = [0.0, 1e999, 0.0]`: must be a finite"],
        ),
        (
            with("[air]\nwind_m_s = [1.0, 0.0, 0.0]"),
            &["my.toml: air.wind_m_s = [1.0, 0.0, 0.0]: must be 0", "of = \"vehicle\""],
        ),
        (
            with("[air]\ngust_rms_m_s = 2.0"),
            &["my.toml: air.gust_rms_m_s = 2: must be 0", "air.drag_per_s", "--air vehicle"],
        ),
        (with("[told]\nlag_ms = 3.0"), &["my.toml: told.lag_ms = 3: must be from 4 to 126", "leave it out"]),
        (with("[told]\nlag_ms = 300.0"), &["my.toml: told.lag_ms = 300: must be from 4 to 126", "leave it out"]),
        (with("[told]\ndrag_per_s = 1.5"), &["my.toml: told.drag_per_s = 1.5: must be from 0 to 1", "leave it out"]),
        (
            with("[told]\nmoment_n_m_per_m_s = [0.0, 0.01]"),
            &["my.toml: told.moment_n_m_per_m_s = 0.01: must be from 0 to 0.002", "leave it out"],
        ),
        (with("[errors]\ndelay_ms = -1"), &["my.toml: errors.delay_ms = -1: must be from 0"]),
        (with("[air]\nwind_m_s = [4.0, 4.0, 0.0]"), &["my.toml: air.wind_m_s = 5.65", "from 0 to 5"]),
        (with("[air]\ngust_rms_m_s = 4.0"), &["air.gust_rms_m_s = 4: must be from 0 to 2.5"]),
        (with("[air]\ndrag_per_s = [0.4, -0.4, 0.4]"), &["air.drag_per_s = -0.4: must be from 0"]),
        (with("air = \"none\""), &["line 2", "invalid value", "\"vehicle\" or a table"]),
        (with("[noise]\nposition_m = 5.0"), &["noise.position_m = 5: must be from 0 to 1"]),
        (with("[filter]\nprediction_hz = 300"), &["filter.prediction_hz = 300: must be a divisor of 1000 Hz"]),
        (with("step_m = 1.0"), &["step_m = 1: must be left out: it belongs to course = \"step\""]),
        (with("duration_s = 0"), &["duration_s = 0: must be from 0.1 to 600"]),
        ("vehicle = \"crazyflie\"".to_owned(), &["my.toml: vehicle:", "crazyflie-2.1"]),
    ] {
        let said = scenario(&text).unwrap_err();
        for part in parts {
            assert!(said.contains(part), "{text}\n{said}\nlacks {part}");
        }
        assert!(!said.contains('\n') && !said.contains("Some("), "{said}");
    }
}

#[test]
fn a_flight_is_the_same_to_the_bit_for_the_same_seed_and_another_for_another() {
    let seeded = |seed: u64| Scenario { seed, ..scenario(WHOLE).unwrap() };
    let fly = |scenario: Scenario| {
        let mut law = scenario.law.start(&scenario.vehicle, &scenario.told).unwrap();
        scenario.fly(law.as_mut(), &scenario.flown(None)).unwrap()
    };
    let [first, again, other] = [7, 7, 8].map(|seed| fly(seeded(seed)));
    let last = |flight: &quatrack_simulation::flight::rigid_loop::RigidFlight| flight.samples.last().unwrap().state;
    assert_eq!(last(&first), last(&again));
    assert_ne!(last(&first), last(&other));
    // Every 10 ms of the measured part, both ends.
    assert_eq!((first.samples.len(), first.samples[0].time_s), (301, 5.0));
}

#[test]
fn a_table_is_written_as_its_schema_says() {
    let scenario = scenario("vehicle = \"crazyflie-2.1\"\ncourse = \"hover\"\nduration_s = 0.5").unwrap();
    let flown = scenario.flown(None);
    let mut lee = Law::Lee.start(&scenario.vehicle, &scenario.told).unwrap();
    let mut flights = vec![("lee".to_owned(), scenario.fly(lee.as_mut(), &flown).unwrap())];
    // Told a mass that makes it fall: lost, with no IAE.
    let told = quatrack_simulation::scenario::ToldFigures { mass_kg: 0.0, ..scenario.told };
    let mut falling = Law::Lee.start(&scenario.vehicle, &told).unwrap();
    flights.push(("falling".to_owned(), scenario.fly(falling.as_mut(), &flown).unwrap()));
    let written = serde_json::to_value(Table::of(&flights)).unwrap();
    assert_eq!(written["schema"], "quatrack/compare/1");
    assert_eq!((&written["rows"][0]["law"], &written["rows"][0]["lost"]), (&"lee".into(), &false.into()));
    assert!(written["rows"][0]["iae_m_s"].as_f64().unwrap() < 1e-9, "a hover in vacuum");
    assert_eq!((&written["rows"][1]["iae_m_s"], &written["rows"][1]["lost"]), (&serde_json::Value::Null, &true.into()));
}
