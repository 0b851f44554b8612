use std::path::Path;

use super::*;
use crate::scenario::Scenario;
use crate::scenario::file::ScenarioFile;

fn flown(text: &str) -> RigidFlight {
    let file = ScenarioFile::parse(&format!("vehicle = \"crazyflie-2.1-brushless\"\n{text}"), "test").unwrap();
    let scenario = Scenario::checked(&file, "test", Path::new("")).unwrap();
    let mut law = scenario.law.start(&scenario.vehicle, &scenario.told).unwrap();
    scenario.fly(law.as_mut(), &scenario.flown(None)).unwrap()
}

#[test]
fn a_craft_on_its_way_along_a_long_step_is_not_lost() {
    for text in [
        "course = \"step\"\nstep_m = 10.0\nduration_s = 9.0",
        "course = \"step\"\nstep_m = -5.0\nduration_s = 9.0",
        // 6 m from the goal as it jumps; and 6.9 m from where the course begins.
        "course = \"step\"\nstep_m = 2.0\nduration_s = 9.0\n[start]\noffset_m = [-4.0, 0.0, 0.0]",
        "course = \"hover\"\n[start]\noffset_m = [4.0, 4.0, 4.0]",
    ] {
        let flight = flown(text);
        assert_eq!(flight.lost, None, "{text}");
        // It goes there at 1.8 m/s at most: 10 m take less than 9 s with what starts and ends it.
        let end = flight.samples.last().unwrap();
        assert!(end.position_error_m().norm() < 0.05, "{text}: {}", end.position_error_m());
    }
}

#[test]
fn one_that_leaves_the_line_of_a_step_is_lost_at_5_m_from_it() {
    // Two motors of one side are dead: it falls.
    let flight = flown("course = \"step\"\nstep_m = 8.0\n[errors]\nmotor_strength = [0.0, 0.0, 1.0, 1.0]");
    let lost = flight.lost.expect("it falls");
    let position_m = flight.samples.last().unwrap().state.position_m;
    // Below the line and beside its end at the start: the nearest place is (0, 0, 1), and a step of 1 ms goes on from 5 m.
    let off_m = (position_m - Vector3::z()).norm();
    assert!((5.0..5.05).contains(&off_m) && lost.reason == "5 m from the course", "{off_m}: {}", lost.reason);
}
