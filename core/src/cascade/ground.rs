//! Standing or flying: whether the observers may believe what they see.
//!
//! On the ground, or held by a wall or a hand, a craft does not move as its forces say. After a start with motors off it stands until
//! it has climbed or moves; a disturbance on its bound at rest means that it is held, one along the thrust that only the ground can
//! give that it stands again.

use super::estimate::Now;

/// Climb after which the craft flies, m.
const CLIMB_M: f32 = 0.03;
/// Speed from which on it does, and below which it is at rest, m/s.
const MOVING_M_S: f32 = 0.25;
/// Time at rest with a disturbance on its bound after which it is held, s.
const HELD_S: f32 = 0.1;
/// Push along the thrust, at rest, that only the ground gives, m/s^2.
pub(super) const GROUND_PUSH_M_S2: f32 = 3.0;

/// Whether the craft stands, and since when it does not move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Ground {
    /// While it stands: the lowest height seen, m.
    lowest_m: Option<f32>,
    /// How long a disturbance was on its bound at rest, s.
    held_s: f32,
}

impl Ground {
    /// Standing, at a height not seen yet.
    pub(super) const STANDING: Self = Self { lowest_m: Some(f32::INFINITY), held_s: 0.0 };

    /// In flight.
    pub(super) const FLYING: Self = Self { lowest_m: None, held_s: 0.0 };

    pub(super) fn is_standing(&self) -> bool {
        self.lowest_m.is_some()
    }

    /// Looks at a step, at which a disturbance was on its bound or pushed along the thrust.
    #[inline(always)]
    pub(super) fn step(&mut self, now: &Now, on_bound: bool, push_m_s2: f32, period_s: f32) {
        let (v, z) = (&now.velocity, now.position.z);
        let at_rest = v.x * v.x + v.y * v.y + v.z * v.z < MOVING_M_S * MOVING_M_S;
        match &mut self.lowest_m {
            Some(lowest) => {
                if z < *lowest {
                    *lowest = z;
                }
                if !at_rest || z > *lowest + CLIMB_M {
                    *self = Self::FLYING;
                }
            }
            None if at_rest && push_m_s2 > GROUND_PUSH_M_S2 => *self = Self::STANDING,
            None if at_rest && on_bound => {
                self.held_s += period_s;
                if self.held_s > HELD_S {
                    *self = Self::STANDING;
                }
            }
            None => self.held_s = 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::quaternion::Quaternion;

    fn at(z: f32, speed: f32) -> Now {
        Now {
            position: Vector3::new(0.0, 0.0, z),
            velocity: Vector3::new(speed, 0.0, 0.0),
            attitude: Quaternion::IDENTITY,
            body_rates: Vector3::zeros(),
        }
    }

    #[test]
    fn it_flies_once_it_has_climbed_or_moves() {
        for (now, flies) in [(at(0.029, 0.1), false), (at(0.031, 0.1), true), (at(0.0, 0.26), true)] {
            let mut ground = Ground::STANDING;
            ground.step(&at(0.0, 0.0), false, 0.0, 0.002);
            ground.step(&now, false, 0.0, 0.002);
            assert_eq!(!ground.is_standing(), flies);
        }
    }

    #[test]
    fn a_wall_holds_it_after_a_tenth_of_a_second_and_the_ground_at_once() {
        let mut ground = Ground::FLYING;
        for step in 0..60 {
            assert!(!ground.is_standing() || step > 50, "{step}");
            ground.step(&at(1.0, 0.0), true, 0.0, 0.002);
        }
        assert!(ground.is_standing());
        let mut ground = Ground::FLYING;
        ground.step(&at(1.0, 0.3), true, 3.5, 0.002);
        assert!(!ground.is_standing());
        ground.step(&at(1.0, 0.0), false, 3.5, 0.002);
        assert!(ground.is_standing());
    }
}
