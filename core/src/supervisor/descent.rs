//! Level and down without a place: the velocity, as far as it is believed, in; the acceleration to be flown by attitude
//! alone, m/s^2, out.
//!
//! Sideways motion is braked for as long as the velocity is believed. Downwards the same velocity is held to a slow
//! descent; once it is believed no more, the thrust is a little below the weight, and less with every second, so that the
//! craft comes down even where its motors give more than their command. With the drag of small craft the end of it is 1.5
//! m/s.

use nalgebra::Vector3;

use super::braking::DESCENT_M_S;
use super::monitor::Looked;
use crate::clock::Tick;
use crate::math::sqrt;

/// How a believed velocity is braked, 1/s, and at most, m/s^2: 17 degrees of tilt.
const BRAKE_PER_S: f32 = 1.5;
const BRAKE_MAX_M_S2: f32 = 3.0;
/// How the descent is held, 1/s, and at most, m/s^2.
const HOLD_PER_S: f32 = 2.0;
const HOLD_MAX_M_S2: f32 = 1.5;
/// For how long a bridged velocity is believed, s: an accelerometer that is off by 0.05 g is then off by 0.75 m/s.
const BELIEVED_S: f32 = 1.5;
/// The thrust's deficit to the weight then, m/s^2; its growth, m/s^3; and its most, m/s^2.
const LESS_M_S2: f32 = 0.12;
const LESS_PER_S: f32 = 0.06;
const LESS_MAX_M_S2: f32 = 0.6;
/// Specific force at which the craft has met the ground, m/s^2.
const IMPACT_M_S2: f32 = 20.0;

/// Acceleration to be flown, beside gravity, m/s^2.
pub fn acceleration(looked: &Looked<'_>, tick_s: f32) -> Vector3<f32> {
    let v = &looked.state.velocity_m_s;
    let bridged_s = looked.velocity_bridged_ticks.map_or(0.0, |ticks: Tick| ticks as f32 * tick_s);
    let belief = if bridged_s < BELIEVED_S { 1.0 - bridged_s / BELIEVED_S } else { 0.0 };
    let (x, y) = (-BRAKE_PER_S * v.x, -BRAKE_PER_S * v.y);
    let across = sqrt(x * x + y * y);
    let scale = if across > BRAKE_MAX_M_S2 { belief * BRAKE_MAX_M_S2 / across } else { belief };
    let held = within(-HOLD_PER_S * (v.z + DESCENT_M_S), HOLD_MAX_M_S2);
    let less = LESS_M_S2 + LESS_PER_S * bridged_s;
    let less = if less > LESS_MAX_M_S2 { LESS_MAX_M_S2 } else { less };
    let wanted = Vector3::new(scale * x, scale * y, belief * held - (1.0 - belief) * less);
    // A velocity that is NaN is none to be braked.
    if (wanted.x + wanted.y + wanted.z).is_finite() { wanted } else { Vector3::new(0.0, 0.0, -less) }
}

/// Whether a specific force (m/s^2) is that of an impact.
pub(super) fn is_impact(force: &Vector3<f32>) -> bool {
    force.dot(force) > IMPACT_M_S2 * IMPACT_M_S2
}

fn within(value: f32, most: f32) -> f32 {
    if value > most {
        most
    } else if value < -most {
        -most
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::super::monitor::Soundness;
    use super::*;
    use crate::state::State;

    fn at(velocity: [f32; 3], bridged: Option<Tick>) -> Vector3<f32> {
        let state = State { velocity_m_s: Vector3::from(velocity), ..State::at_rest(Vector3::zeros()) };
        let body_rates = Vector3::zeros();
        let looked = Looked {
            soundness: Soundness::AttitudeOnly,
            state: &state,
            body_rates_rad_s: &body_rates,
            velocity_bridged_ticks: bridged,
        };
        acceleration(&looked, 1e-3)
    }

    #[test]
    fn a_known_velocity_is_braked_and_a_descent_held() {
        assert_eq!(at([0.0, 0.0, -0.3], None), Vector3::zeros());
        assert_eq!(at([1.0, -0.4, 0.2], None), Vector3::new(-1.5, 0.6, -1.0));
        let fast = at([30.0, -40.0, -5.0], None);
        assert!((fast - Vector3::new(-1.8, 2.4, 1.5)).norm() < 1e-6, "{fast}");
    }

    #[test]
    fn an_unknown_one_is_let_be_and_the_thrust_falls_slowly_to_a_bound() {
        assert!((at([1.0, 1.0, 1.0], Some(1500)) - Vector3::new(0.0, 0.0, -0.21)).norm() < 1e-6);
        assert_eq!(at([1.0, 1.0, 1.0], Some(60_000)), Vector3::new(0.0, 0.0, -0.6));
        let half = at([1.0, 0.0, -0.3], Some(750));
        assert!((half - Vector3::new(-0.75, 0.0, -0.0825)).norm() < 1e-6, "{half}");
    }

    #[test]
    fn no_number_comes_out_that_is_none() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38] {
            for axis in 0..3 {
                let mut velocity = [0.0; 3];
                velocity[axis] = bad;
                for bridged in [None, Some(100), Some(9000)] {
                    let found = at(velocity, bridged);
                    assert!(found.norm() < 4.0, "{velocity:?}: {found}");
                }
            }
        }
    }
}
