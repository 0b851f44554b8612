//! The estimate as the loop takes it: carried on to each step, and its velocity held to its position.
//!
//! The firmware's filter predicts a hundred times a second. Between two of its estimates position goes on by the velocity,
//! velocity by the acceleration that the force observer expects, and attitude by the gyroscope, which is read at each step.
//! A velocity that stayed as it was would be off by up to 0.1 m/s at 10 m/s^2, and pull the thrust back and forth a
//! hundred times a second.
//!
//! A filter that knows of no drag estimates a velocity that is off while its position is right. An observer of the position
//! that is fed the velocity finds the difference b: `p^' = v - b + 2 w (p - p^)`, `b' = -w^2 (p - p^)`, both poles at w. The loop
//! flies on `v - b`: where position and velocity agree it changes nothing.

use nalgebra::Vector3;

use super::bounds::{is_beyond, within};
use crate::math::sqrt;
use crate::quaternion::Quaternion;
use crate::state::State;

/// Longest time that an estimate is carried on, s.
const CARRIED_MAX_S: f32 = 0.012;

/// Poles of the velocity's observer, rad/s.
const HELD_RAD_S: f32 = 10.0;

/// Largest difference of velocity from the slope of the position, m/s.
const BIAS_MAX_M_S: f32 = 1.0;

/// Difference of positions along an axis beyond which the estimate has jumped, m.
const JUMP_M: f32 = 0.2;

/// Squared norms between which a quaternion is taken for an attitude: no filter's is farther off than by half.
const NORM_SQUARED: [f32; 2] = [0.25, 4.0];

/// State of the craft at a step, carried on from the newest estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Now {
    pub(super) position: Vector3<f32>,
    pub(super) velocity: Vector3<f32>,
    /// The attitude, of norm 1.
    pub(super) attitude: Quaternion,
    pub(super) body_rates: Vector3<f32>,
}

/// The newest estimate, carried on to the present step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Carried {
    /// The newest estimate as it was given.
    position: Vector3<f32>,
    given: Quaternion,
    /// Its attitude carried on, and for how long.
    attitude: Quaternion,
    age_s: f32,
    /// By how much its velocity has changed since, m/s.
    gained: Vector3<f32>,
}

impl Carried {
    /// No estimate yet.
    pub(super) const NONE: Self = Self {
        position: Vector3::new(0.0, 0.0, 0.0),
        // No attitude is zero: the first estimate is a new one.
        given: Quaternion::new(0.0, 0.0, 0.0, 0.0),
        attitude: Quaternion::IDENTITY,
        age_s: 0.0,
        gained: Vector3::new(0.0, 0.0, 0.0),
    };

    /// The estimate at this step, a period after the last one, of a craft with body rates `w` and acceleration `a`; nothing
    /// where its quaternion is no attitude.
    #[inline(always)]
    pub(super) fn at_step(
        &mut self,
        estimate: &State,
        w: &Vector3<f32>,
        a: &Vector3<f32>,
        period_s: f32,
    ) -> Option<Now> {
        let (p, v) = (&estimate.position_m, &estimate.velocity_m_s);
        if *p == self.position && estimate.attitude == self.given {
            if self.age_s < CARRIED_MAX_S {
                self.age_s += period_s;
                let g = self.gained;
                self.gained = Vector3::new(g.x + period_s * a.x, g.y + period_s * a.y, g.z + period_s * a.z);
                let half = 0.5 * period_s;
                let turn = Quaternion::new(1.0, half * w.x, half * w.y, half * w.z);
                self.attitude = normalised(self.attitude * turn)?;
            }
        } else {
            let attitude = normalised(estimate.attitude)?;
            *self = Self { position: *p, given: estimate.attitude, attitude, ..Self::NONE };
        }
        let t = self.age_s;
        Some(Now {
            position: Vector3::new(p.x + t * v.x, p.y + t * v.y, p.z + t * v.z),
            velocity: Vector3::new(v.x + self.gained.x, v.y + self.gained.y, v.z + self.gained.z),
            attitude: self.attitude,
            body_rates: *w,
        })
    }
}

/// The same attitude of norm 1; nothing where its norm is far off or not a number.
#[inline(always)]
fn normalised(q: Quaternion) -> Option<Quaternion> {
    let squared = q.dot(q);
    let [least, most] = NORM_SQUARED;
    (squared >= least && squared <= most).then(|| q.scaled(1.0 / sqrt(squared)))
}

/// The observer that holds the velocity to the position.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct HeldVelocity {
    position: Vector3<f32>,
    bias: Vector3<f32>,
    last: Vector3<f32>,
}

impl HeldVelocity {
    /// Nothing known: the first position is taken as it is.
    pub(super) const NONE: Self = Self {
        position: Vector3::new(f32::INFINITY, f32::INFINITY, f32::INFINITY),
        bias: Vector3::new(0.0, 0.0, 0.0),
        last: Vector3::new(0.0, 0.0, 0.0),
    };

    /// Moves on by a period to a position, and takes the bias off the velocity.
    #[inline(always)]
    pub(super) fn step(&mut self, now: &mut Now, period_s: f32) {
        let (p, v) = (&now.position, &now.velocity);
        let axis = |p: f32, v: f32, held: f32, bias: f32, last: f32| {
            let moved = held + period_s * (0.5 * (v + last) - bias);
            let e = p - moved;
            if is_beyond(e, JUMP_M) {
                return (p, bias);
            }
            let bias = bias - period_s * HELD_RAD_S * HELD_RAD_S * e;
            (moved + period_s * 2.0 * HELD_RAD_S * e, within(bias, BIAS_MAX_M_S))
        };
        let (x, bx) = axis(p.x, v.x, self.position.x, self.bias.x, self.last.x);
        let (y, by) = axis(p.y, v.y, self.position.y, self.bias.y, self.last.y);
        let (z, bz) = axis(p.z, v.z, self.position.z, self.bias.z, self.last.z);
        *self = Self { position: Vector3::new(x, y, z), bias: Vector3::new(bx, by, bz), last: *v };
        now.velocity = Vector3::new(v.x - bx, v.y - by, v.z - bz);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f32 = 0.002;

    const TURNING: Vector3<f32> = Vector3::new(0.0, 0.0, 1.0);
    const STEADY: Vector3<f32> = Vector3::new(0.0, 0.0, 0.0);

    fn moving(position_m: Vector3<f32>, velocity_m_s: Vector3<f32>) -> State {
        State { velocity_m_s, ..State::at_rest(position_m) }
    }

    #[test]
    fn an_estimate_is_carried_on_by_velocity_and_gyro_and_not_for_ever() {
        let (state, mut carried) = (moving(Vector3::zeros(), Vector3::new(1.0, 0.0, 0.0)), Carried::NONE);
        let fresh = carried.at_step(&state, &TURNING, &STEADY, H).unwrap();
        assert_eq!((fresh.position.x, fresh.attitude), (0.0, Quaternion::IDENTITY));
        let later = (0..4).filter_map(|_| carried.at_step(&state, &TURNING, &STEADY, H)).last().unwrap();
        // 8 ms at 1 m/s and 1 rad/s; small angles.
        assert!((later.position.x - 0.008).abs() < 1e-7 && (later.attitude.z - 0.004).abs() < 1e-7);
        let last = (0..100).filter_map(|_| carried.at_step(&state, &TURNING, &STEADY, H)).last().unwrap();
        assert!((last.position.x - 0.012).abs() < 1e-6);
    }

    #[test]
    fn a_velocity_gains_what_the_forces_give_until_there_is_a_new_one() {
        let (state, mut carried) = (moving(Vector3::zeros(), Vector3::new(1.0, 0.0, 0.0)), Carried::NONE);
        let a = Vector3::new(5.0, 0.0, -2.0);
        let steps = [(); 8].map(|()| carried.at_step(&state, &TURNING, &a, H).unwrap());
        assert_eq!(steps[0].velocity, state.velocity_m_s);
        // After 8 ms, and no longer than 12 ms.
        assert!((steps[4].velocity - Vector3::new(1.04, 0.0, -0.016)).norm() < 1e-6);
        assert!((steps[7].velocity - Vector3::new(1.06, 0.0, -0.024)).norm() < 1e-6);
        let newer = moving(Vector3::new(0.01, 0.0, 0.0), Vector3::new(1.02, 0.0, 0.0));
        assert_eq!(carried.at_step(&newer, &TURNING, &a, H).unwrap().velocity, newer.velocity_m_s);
    }

    #[test]
    fn a_quaternion_is_scaled_to_norm_1_or_refused() {
        for (norm, sound) in [(0.98, true), (1.05, true), (0.4, false), (2.1, false), (f32::NAN, false)] {
            let mut state = moving(Vector3::zeros(), Vector3::zeros());
            state.attitude = Quaternion::new(0.6 * norm, 0.0, 0.8 * norm, 0.0);
            let now = { Carried::NONE }.at_step(&state, &TURNING, &STEADY, H);
            assert_eq!(now.is_some(), sound, "{norm}");
            if let Some(now) = now {
                assert!((now.attitude.dot(now.attitude) - 1.0).abs() < 3e-7);
            }
        }
    }

    #[test]
    fn a_velocity_that_is_off_is_held_to_the_position() {
        let mut held = HeldVelocity::NONE;
        let (mut found, mut x) = (0.0, 0.0);
        for _ in 0..1000 {
            x += H;
            let state = moving(Vector3::new(x, 0.0, 0.0), Vector3::new(1.3, 0.0, 0.0));
            let mut now = { Carried::NONE }.at_step(&state, &TURNING, &STEADY, H).unwrap();
            held.step(&mut now, H);
            found = now.velocity.x;
        }
        // 20 time constants; rounding of positions of 2 m times the observer's gain of 50 1/s.
        assert!((found - 1.0).abs() < 1e-4, "{found}");
    }

    #[test]
    fn an_agreeing_velocity_stays_as_it_is_even_where_the_estimate_jumps() {
        let mut held = HeldVelocity::NONE;
        for step in 0..500_u16 {
            let x = 0.5 * H * f32::from(step) + if step > 250 { 5.0 } else { 0.0 };
            let mut now = { Carried::NONE }
                .at_step(&moving(Vector3::new(x, 0.0, 0.0), Vector3::new(0.5, 0.0, 0.0)), &TURNING, &STEADY, H)
                .unwrap();
            held.step(&mut now, H);
            // Half the spacing of positions of 5 m, 2.4e-7 m, in each step of 2 ms.
            assert!((now.velocity.x - 0.5).abs() < 1.2e-4, "{step}");
        }
    }
}
