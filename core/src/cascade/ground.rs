//! Standing, held or flying: whether the observers may believe the measurements.
//!
//! On the ground, or held by a wall or a hand, a craft does not move as its forces say: the observers would learn a false disturbance.
//!
//! - **Standing.** After a start with motors off it stands until it has climbed or moves, and corrects no position over ground. A
//!   disturbance along the thrust that only the ground can give means that it stands again.
//! - **Held.** A disturbance on its bound at rest means that it is held, and so does a stop that no air makes. Near that place it
//!   goes towards its goal slowly, by the error alone: a craft that leans against a wall on its lower edge is turned over by it.
//! - **Flying** otherwise.

use nalgebra::Vector3;

use super::estimate::Now;

/// Climb after which a craft that stood flies, m.
const WAY_M: f32 = 0.03;
/// Distance after which one that was held does, m: more than it is thrown back.
const HELD_WAY_M: f32 = 0.15;
/// How fast it makes a position error good until then, m/s: 4.5 degrees of lean at rest, where a wall without friction turns a craft
/// over from 9 on.
pub(super) const HELD_M_S: f32 = 0.15;
/// Speed from which on it does, and below which it is at rest, m/s.
const MOVING_M_S: f32 = 0.25;
/// Time at rest with a disturbance on its bound after which it is held, s: less than a craft takes to lean against the disturbance that it has
/// learned.
const HELD_S: f32 = 0.03;
/// Push along the thrust, at rest, that only the ground gives, m/s^2.
const GROUND_PUSH_M_S2: f32 = 3.0;

/// Whether the craft stands, is held or flies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Ground {
    /// On the ground; the lowest height seen, m.
    Standing { lowest_m: f32 },
    /// Held by something, at a place, world frame, m.
    Held { at_m: Vector3<f32> },
    /// How long a disturbance has been on its bound at rest, s.
    Flying { stuck_s: f32 },
}

impl Ground {
    /// Standing, at a height not seen yet.
    pub(super) const STANDING: Self = Self::Standing { lowest_m: f32::INFINITY };

    /// In flight.
    pub(super) const FLYING: Self = Self::Flying { stuck_s: 0.0 };

    pub(super) fn is_standing(&self) -> bool {
        matches!(self, Self::Standing { .. })
    }

    #[inline(always)]
    pub(super) fn is_held(&self) -> bool {
        matches!(self, Self::Held { .. })
    }

    /// Something has stopped it.
    #[cold]
    pub(super) fn stop(&mut self, at_m: &Vector3<f32>) {
        *self = Self::Held { at_m: *at_m };
    }

    pub(super) fn is_flying(&self) -> bool {
        matches!(self, Self::Flying { .. })
    }

    /// Looks at a step, at which a disturbance was on its bound or pushed along the thrust.
    #[inline(always)]
    pub(super) fn step(&mut self, now: &Now, on_bound: bool, push_m_s2: f32, period_s: f32) {
        let (v, p) = (&now.velocity, &now.position);
        let at_rest = v.x * v.x + v.y * v.y + v.z * v.z < MOVING_M_S * MOVING_M_S;
        *self = match *self {
            Self::Flying { .. } if at_rest && push_m_s2 > GROUND_PUSH_M_S2 => Self::STANDING,
            Self::Flying { stuck_s } if at_rest && on_bound => {
                let stuck_s = stuck_s + period_s;
                if stuck_s > HELD_S { Self::Held { at_m: *p } } else { Self::Flying { stuck_s } }
            }
            Self::Flying { .. } => Self::FLYING,
            Self::Standing { lowest_m } => {
                let lowest_m = if p.z < lowest_m { p.z } else { lowest_m };
                if at_rest && p.z <= lowest_m + WAY_M { Self::Standing { lowest_m } } else { Self::FLYING }
            }
            Self::Held { at_m } => {
                let (x, y, z) = (p.x - at_m.x, p.y - at_m.y, p.z - at_m.z);
                if x * x + y * y + z * z <= HELD_WAY_M * HELD_WAY_M { Self::Held { at_m } } else { Self::FLYING }
            }
        };
    }
}

#[cfg(test)]
mod tests {
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
    fn a_wall_holds_it_after_a_moment_and_the_ground_at_once() {
        let mut ground = Ground::FLYING;
        for step in 0..25 {
            assert!(ground.is_flying() || step >= 15, "{step}");
            ground.step(&at(1.0, 0.0), true, 0.0, 0.002);
        }
        assert!(!ground.is_flying() && !ground.is_standing());
        ground.step(&at(1.14, 0.4), true, 0.0, 0.002);
        assert!(!ground.is_flying());
        ground.step(&at(1.16, 0.4), true, 0.0, 0.002);
        assert!(ground.is_flying());
        let mut ground = Ground::FLYING;
        ground.step(&at(1.0, 0.3), true, 3.5, 0.002);
        assert!(!ground.is_standing());
        ground.step(&at(1.0, 0.0), false, 3.5, 0.002);
        assert!(ground.is_standing());
    }
}
