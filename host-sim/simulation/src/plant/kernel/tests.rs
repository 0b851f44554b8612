//! The kernel's steps against the craft's own equations, to the bit.

use nalgebra::{Matrix3, UnitQuaternion, Vector3, Vector4};
use proptest::prelude::*;

use super::*;
use crate::plant::{Airflow, RigidBody, Shove};
use crate::vehicles;

fn craft(scale: f64, air: bool, crooked: bool) -> Craft {
    let vehicle = vehicles::by_name("crazyflie-2.1-brushless").unwrap();
    let mut craft = Craft::new(&vehicle);
    craft.body = craft.body.scaled(scale, 2.0 - scale);
    if crooked {
        let beside = Matrix3::new(0.0, 1.0, -2.0, 1.0, 0.0, 0.5, -2.0, 0.5, 0.0) * 1e-6;
        craft.body = RigidBody::new(craft.body.mass_kg(), craft.body.inertia_kg_m2() + beside).unwrap();
    }
    craft.motors = craft.motors.with_lag(0.03 * scale, 0.047).around(&Vector3::new(1e-3, -5e-4, 0.0));
    craft.motors.torque_bias_n_m = Vector3::new(1e-5, -2e-5, 0.0);
    if air {
        craft.air = Some(Airflow {
            drag_n_s_m: Vector3::new(0.011, 0.012, 0.013) * scale,
            moment_n_s: [7e-4, 9e-4],
            lift_n_s2_m2: 1e-3,
            rotors: None,
        });
    }
    craft
}

/// The equations as they are written for a reader, which a load keeps: one that never pushes.
fn by_equations(craft: Craft, state: &RigidState, step: &Step) -> RigidState {
    let idle = Shove { from_s: -2.0, to_s: -1.0, force_n: Vector3::zeros() };
    craft.with_load(idle).step_in_wind(state, &step.goals_n, &step.wind, step.from_s, step.step_s)
}

fn bits(state: &RigidState) -> Vec<u64> {
    // Zero has two signs and one meaning.
    state.to_vector().iter().map(|value| (value + 0.0).to_bits()).collect()
}

prop_compose! {
    fn flight()(v in prop::array::uniform20(-3.0_f64..3.0), h in 1e-4_f64..2e-3) -> (RigidState, Step) {
        let vector = |k: usize| Vector3::new(v[k], v[k + 1], v[k + 2]);
        let forces = |k: usize| Vector4::new(v[k], v[k + 1], v[k + 2], v[k + 3]).map(|value| 0.1 + 0.03 * value);
        let state = RigidState {
            position_m: vector(0),
            velocity_m_s: vector(3),
            attitude: UnitQuaternion::from_scaled_axis(vector(6) * 0.5),
            body_rates_rad_s: vector(9) * 3.0,
            thrusts_n: forces(12),
        };
        let wind = LinearWind { from_s: 1.5, from_m_s: vector(1), slope_m_s2: vector(5) * 10.0 };
        (state, Step { goals_n: forces(16), wind, from_s: 1.5, step_s: h })
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn lanes_have_the_bits_of_the_equations(flights in prop::array::uniform4(flight()), air: bool, crooked in 0_usize..5, left_out in 0_usize..5) {
        let scales = [0.8, 1.0, 1.1, 1.3];
        // One of them with axes of inertia that are not the body's, or none.
        let craft = |lane: usize| craft(scales[lane], air, lane == crooked);
        let plants: [_; LANES] = std::array::from_fn(|lane| figures(&craft(lane)).filter(|_| lane != left_out));
        let mut lanes = SideBySide::new(&plants);
        for (lane, (state, step)) in flights.iter().enumerate().filter(|(lane, _)| *lane != left_out) {
            lanes.put_state(lane, state);
            lanes.put_step(lane, step);
        }
        lanes.advance();
        for (lane, (state, step)) in flights.iter().enumerate().filter(|(lane, _)| *lane != left_out) {
            let expected = bits(&by_equations(craft(lane), state, step));
            let mut flown = *state;
            lanes.take(lane, &mut flown);
            prop_assert!(lanes.is_finite(lane));
            prop_assert_eq!(bits(&flown), expected.clone(), "lane {}", lane);
            let (figures, has_air) = plants[lane].unwrap();
            let craft = craft(lane);
            let calm = LinearWind { slope_m_s2: Vector3::zeros(), ..step.wind };
            let felt = craft.motion(state, &step.goals_n, &calm, step.from_s).specific_force_m_s2;
            prop_assert_eq!(felt_m_s2(&figures, has_air, state, &calm.from_m_s).map(|x| x + 0.0), felt.map(|x| x + 0.0));
            prop_assert_eq!(bits(&alone(&figures, has_air, state, step)), expected, "alone {}", lane);
        }
    }
}

#[test]
fn only_plain_craft_have_figures() {
    assert!(figures(&craft(1.0, true, false)).is_some());
    let pushed = craft(1.0, true, false).with_load(Shove { from_s: 0.0, to_s: 1.0, force_n: Vector3::x() });
    assert!(figures(&pushed).is_none());
    let mut uneven = craft(1.0, false, false);
    uneven.motors.motors[2].rise_lag_s = 0.1;
    assert!(figures(&uneven).is_none());
}
