//! A standstill from any course: position and velocity in; the reference that brakes to a standstill, and goes down from
//! there, out.

use nalgebra::Vector3;

use super::monitor::Looked;
use crate::clock::Tick;
use crate::math::sqrt;
use crate::motor_reference::FifthOrderSample;
use crate::quaternion::{Heading, Quaternion};
use crate::state::State;

/// How hard it brakes over ground, m/s^2: from 3 m/s within 0.75 m, and the way that the attitude's change takes.
const BRAKE_M_S2: f32 = 6.0;
/// The same up and down, m/s^2.
const BRAKE_UP_M_S2: f32 = 4.0;
/// How fast it goes down, m/s, and how it comes to do so, m/s^2.
pub(super) const DESCENT_M_S: f32 = 0.3;
const DESCENT_BEGIN_M_S2: f32 = 0.6;
/// Farthest that its reference may be below the craft, m.
const BELOW_MAX_M: f32 = 0.3;

/// The way from a course to a standstill, at the heading that the craft had.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Braking {
    position_m: Vector3<f32>,
    velocity_m_s: Vector3<f32>,
    heading: Heading,
    begun: Tick,
    /// Since when it goes down.
    descending: Option<Tick>,
    /// The reference; here, so that no caller's stack has to hold it.
    sample: FifthOrderSample,
}

impl Braking {
    /// From where a craft is.
    pub fn begin(looked: &Looked<'_>, now: Tick) -> Self {
        let State { position_m, attitude, velocity_m_s } = *looked.state;
        let sample = FifthOrderSample::at_rest(position_m, 0.0);
        Self { position_m, velocity_m_s, heading: heading_of(attitude), begun: now, descending: None, sample }
    }

    /// Goes down from here on.
    pub fn descend(&mut self, now: Tick) {
        self.descending.get_or_insert(now);
    }

    /// The reference at a tick of a length (s), by a craft at a height (m): it is never far ahead of one that has come to
    /// the ground.
    pub fn at(&mut self, now: Tick, tick_s: f32, height_m: f32) -> &FifthOrderSample {
        let t = now.wrapping_sub(self.begun) as f32 * tick_s;
        let (p, v) = (self.position_m, self.velocity_m_s);
        let over_ground = Vector3::new(v.x, v.y, 0.0);
        let across = braked(sqrt(v.x * v.x + v.y * v.y), BRAKE_M_S2, t);
        let up = braked(v.z, BRAKE_UP_M_S2, t);
        let flat = &mut self.sample.flat;
        flat.position_m = p + over_ground * across.way + Vector3::new(0.0, 0.0, v.z * up.way);
        flat.velocity_m_s = over_ground * across.speed + Vector3::new(0.0, 0.0, v.z * up.speed);
        flat.acceleration_m_s2 = over_ground * across.change + Vector3::new(0.0, 0.0, v.z * up.change);
        if let Some(descending) = self.descending {
            let t = now.wrapping_sub(descending) as f32 * tick_s;
            let begin_s = DESCENT_M_S / DESCENT_BEGIN_M_S2;
            if t < begin_s {
                flat.position_m.z -= 0.5 * DESCENT_BEGIN_M_S2 * t * t;
                flat.velocity_m_s.z -= DESCENT_BEGIN_M_S2 * t;
                flat.acceleration_m_s2.z -= DESCENT_BEGIN_M_S2;
            } else {
                flat.position_m.z -= DESCENT_M_S * (t - 0.5 * begin_s);
                flat.velocity_m_s.z -= DESCENT_M_S;
            }
            let least_m = height_m - BELOW_MAX_M;
            if flat.position_m.z < least_m {
                flat.position_m.z = least_m;
            }
        }
        &self.sample
    }

    /// For how long it has been going down, ticks, if it does.
    pub(super) fn is_descending_since(&self, now: Tick) -> Option<Tick> {
        self.descending.map(|since| now.wrapping_sub(since))
    }

    /// The heading that is kept.
    pub const fn heading(&self) -> Heading {
        self.heading
    }
}

/// A speed of 1 that is braked: the rest of it, the way so far over it (s), and its rate of change (1/s).
struct Braked {
    speed: f32,
    way: f32,
    change: f32,
}

fn braked(speed_m_s: f32, brake_m_s2: f32, t: f32) -> Braked {
    let stop_s = speed_m_s.abs() / brake_m_s2;
    if t < stop_s {
        Braked { speed: 1.0 - t / stop_s, way: t - 0.5 * t * t / stop_s, change: -1.0 / stop_s }
    } else {
        Braked { speed: 0.0, way: 0.5 * stop_s, change: 0.0 }
    }
}

/// The heading of an attitude; that of the world where it is upside down and has none.
pub(super) fn heading_of(q: Quaternion) -> Heading {
    if q.w * q.w + q.z * q.z > 1e-6 { Heading::from_half(q.w, q.z) } else { Heading::ZERO }
}

#[cfg(test)]
mod tests {
    use super::super::monitor::Soundness;
    use super::*;

    fn braking(velocity_m_s: Vector3<f32>) -> Braking {
        let state = State { velocity_m_s, ..State::at_rest(Vector3::new(1.0, 2.0, 3.0)) };
        let body_rates = Vector3::zeros();
        let looked = Looked {
            soundness: Soundness::Sound,
            state: &state,
            body_rates_rad_s: &body_rates,
            velocity_bridged_ticks: None,
        };
        Braking::begin(&looked, 100)
    }

    #[test]
    fn a_course_ends_at_half_its_squared_speed_over_the_brakes() {
        let mut braking = braking(Vector3::new(1.8, -2.4, 0.8));
        let start = braking.at(100, 1e-3, 3.0).flat;
        assert_eq!((start.position_m, start.velocity_m_s), (Vector3::new(1.0, 2.0, 3.0), Vector3::new(1.8, -2.4, 0.8)));
        let end = braking.at(2000, 1e-3, 3.0).flat;
        // 3 m/s at 6 m/s^2: 0.75 m along the course; 0.8 m/s at 4: 0.08 m up.
        assert!((end.position_m - Vector3::new(1.45, 1.4, 3.08)).norm() < 1e-5, "{}", end.position_m);
        assert_eq!(end.velocity_m_s, Vector3::zeros());
    }

    #[test]
    fn position_velocity_and_acceleration_belong_together() {
        let mut braking = braking(Vector3::new(1.8, -2.4, -0.8));
        for now in [150, 250, 450, 700, 1100, 1400, 2000] {
            if now > 1000 {
                braking.descend(1000);
            }
            // A height that the reference is never far below.
            let mut at = |now: Tick| braking.at(now, 1e-3, 0.0).flat;
            let (before, here, after) = (at(now - 1), at(now), at(now + 1));
            let slope = (after.position_m - before.position_m) / 2e-3;
            // Positions of 3 m have a spacing of 2.4e-7 m; a few of them over 2 ms.
            assert!((slope - here.velocity_m_s).norm() < 2e-3, "{now}: {slope} {}", here.velocity_m_s);
            let slope = (after.velocity_m_s - before.velocity_m_s) / 2e-3;
            assert!((slope - here.acceleration_m_s2).norm() < 2e-3, "{now}: {slope}");
        }
    }

    #[test]
    fn it_goes_down_but_never_far_below_the_craft() {
        let mut braking = braking(Vector3::zeros());
        braking.descend(100);
        assert!((braking.at(1100, 1e-3, 2.775).flat.position_m.z - 2.775).abs() < 1e-6);
        assert_eq!(braking.at(1100, 1e-3, 2.775).flat.velocity_m_s.z, -0.3);
        assert!((braking.at(9000, 1e-3, 2.0).flat.position_m.z - 1.7).abs() < 1e-6);
    }
}
