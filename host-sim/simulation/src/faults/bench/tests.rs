//! Every kind of fault on every craft: the flights that may not be lost, and when the motors are off.

use super::super::kinds;
use super::*;

fn flown(name: &str, vehicle: &str) -> Row {
    let fault = kinds().into_iter().find(|fault| fault.name == name).unwrap();
    fly(&fault, &Crafts::by_name(vehicle).unwrap()).unwrap()
}

#[test]
fn there_are_at_least_65_kinds_each_of_its_own_name() {
    let mut names: Vec<&str> = kinds().iter().map(|fault| fault.name).collect();
    names.sort_unstable();
    names.dedup();
    assert!(names.len() >= 65 && names.len() == kinds().len(), "{} of {}", names.len(), kinds().len());
}

#[test]
fn nothing_recoverable_is_lost_and_the_rest_ends_with_motors_off() {
    for vehicle in super::super::VEHICLES {
        let craft = Crafts::by_name(vehicle).unwrap();
        for fault in kinds() {
            let row = fly(&fault, &craft).unwrap();
            assert!(row.is_as_promised(), "{row:?}");
        }
    }
}

#[test]
fn half_a_second_of_no_state_is_flown_through() {
    for vehicle in super::super::VEHICLES {
        let row = flown("state: NaN for 500 ms", vehicle);
        assert!(!row.crashed && row.end_state == EndState(Mode::Flying), "{row:?}");
        assert_eq!(row.detected_ms, Some(0));
    }
}

#[test]
fn a_bad_setpoint_at_3_m_s_stops_it_within_a_metre_and_a_half() {
    for vehicle in super::super::VEHICLES {
        let row = flown("setpoint: NaN position at 3 m/s", vehicle);
        assert!(!row.crashed && row.farthest_m < 1.5, "{row:?}");
    }
}

#[test]
fn a_dead_motor_ends_with_motors_off() {
    for vehicle in super::super::VEHICLES {
        let row = flown("motor: one dead", vehicle);
        assert!(row.motors_off_ms.is_some_and(|ms| ms < 8000), "{row:?}");
    }
}
