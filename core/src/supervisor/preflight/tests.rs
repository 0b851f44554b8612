//! The checks before arming: each refusal, and a craft that passes.

use super::*;
use crate::quaternion::Quaternion;

const COVERAGE: Coverage = Coverage { lag_s: [0.05, 0.13], mass_kg: [0.025, 0.035], rate_hz: 500 };

fn at(position: [f32; 3]) -> State {
    State::at_rest(Vector3::from(position))
}

fn limits(least: f32, most: f32) -> Limits {
    Limits::new(least, most, Vector3::new(20.0, 20.0, 10.0)).unwrap()
}

fn checked(change: impl FnOnce(&mut Preflight)) -> Result<(), ArmError> {
    let (state, limits) = (at([0.0, 0.0, 1.0]), limits(1.0, 16.0));
    let mut preflight = Preflight {
        fault: None,
        link_silence_ticks: Some(500),
        tolerated_ticks: [500, 50],
        state: Some(state),
        reference_m: Some(Vector3::new(0.6, 0.0, 1.8)),
        start_max_m: 1.0,
        law: Certified::For(COVERAGE),
        lag_s: 0.126,
        mass_kg: 0.029,
        rate_hz: 500,
        limits,
        battery_v: 3.7,
    };
    change(&mut preflight);
    preflight.check()
}

#[test]
fn a_sound_craft_is_armed() {
    assert_eq!(checked(|_| ()), Ok(()));
    assert_eq!(checked(|p| p.reference_m = None), Ok(()), "a reference may still come");
    assert_eq!(checked(|p| p.law = Certified::NoMotors), Ok(()), "commands for somebody else's motors");
    assert_eq!(checked(|p| (p.lag_s, p.mass_kg, p.battery_v) = (0.05, 0.035, 4.2)), Ok(()));
}

#[test]
fn each_thing_that_forbids_it_is_named() {
    let tilted = State { attitude: Quaternion::new(0.966, 0.259, 0.0, 0.0), ..at([0.0, 0.0, 1.0]) };
    let mad = at([f32::NAN, 0.0, 0.0]);
    let (strong, weak, none) = (limits(9.0, 20.0), limits(0.0, 10.0), limits(0.0, 0.0));
    let rows: [(Result<(), ArmError>, ArmError); 15] = [
        (checked(|p| p.fault = Some(Fault::HardFault)), ArmError::Faulted(Fault::HardFault)),
        (checked(|p| p.link_silence_ticks = None), ArmError::LinkSilent),
        (checked(|p| p.link_silence_ticks = Some(501)), ArmError::LinkSilent),
        (checked(|p| p.tolerated_ticks = [501, 50]), ArmError::Tolerance { ticks: 501 }),
        (checked(|p| p.tolerated_ticks = [500, 10_000]), ArmError::Tolerance { ticks: 10_000 }),
        (checked(|p| p.state = None), ArmError::NoState),
        (checked(|p| p.state = Some(mad)), ArmError::NoState),
        (
            checked(|p| p.reference_m = Some(Vector3::new(3.0, 0.0, 5.0))),
            ArmError::TooFar { distance_m: 5.0, most_m: 1.0 },
        ),
        (checked(|p| p.law = Certified::ForNone), ArmError::NotCertified),
        (checked(|p| p.lag_s = 0.14), ArmError::Lag { lag_s: 0.14, most_s: 0.13 }),
        (checked(|p| p.mass_kg = 0.04), ArmError::Mass { mass_kg: 0.04, covered_kg: 0.035 }),
        (checked(|p| p.rate_hz = 250), ArmError::Rate { rate_hz: 250, law_hz: 500 }),
        (checked(|p| p.limits = strong), ArmError::NoHover { thrust_m_s2: 9.0 }),
        (checked(|p| p.limits = none), ArmError::NoHover { thrust_m_s2: 0.0 }),
        (checked(|p| p.battery_v = 4.4), ArmError::Battery { volts: 4.4 }),
    ];
    for (found, expected) in rows {
        assert_eq!(found, Err(expected));
    }
    assert!(matches!(checked(|p| p.state = Some(tilted)), Err(ArmError::Tilted { .. })), "30 degrees");
    assert_eq!(checked(|p| p.limits = weak), Err(ArmError::NoHover { thrust_m_s2: 10.0 }));
    assert!(matches!(checked(|p| p.battery_v = f32::NAN), Err(ArmError::Battery { .. })));
    assert!(matches!(checked(|p| p.lag_s = f32::NAN), Err(ArmError::Lag { .. })));
    let far = Some(Vector3::new(f32::NAN, 0.0, 0.0));
    assert!(matches!(checked(|p| p.reference_m = far), Err(ArmError::TooFar { .. })));
}
