//! The cascade by attitude alone, for a craft that has lost its place: an attitude, body rates and an acceleration in; motor forces
//! out. Any heading stays as it is.

use nalgebra::Vector3;

use super::attitude::half_error;
use super::inner::Errors;
use super::memory::Seen;
use super::yield_learner::MotorYield;
use super::{Cascade, CascadeMemory, middle, parts_of, turned};
use crate::mixer::{MotorLimited, Parts};
use crate::motor_lag::MotorForces;
use crate::quaternion::{Heading, Quaternion};

impl Cascade {
    /// One step that makes an acceleration (m/s^2, beside gravity, cut to the limits) at an attitude of norm 1 and body rates:
    /// commanded forces, N, finite and within the motors' range, and the limits that cut them. Nothing where an
    /// input is not finite.
    ///
    /// The learned figures of motors, air and imbalance are flown with and stay as they are.
    #[inline(never)]
    pub fn level(
        &self,
        memory: &mut CascadeMemory,
        forces_n: &mut MotorForces,
        (attitude, body_rates_rad_s): (Quaternion, &Vector3<f32>),
        acceleration_m_s2: &Vector3<f32>,
    ) -> Option<(MotorForces, MotorLimited)> {
        let none = Vector3::new(0.0, 0.0, 0.0);
        let wanted = self.outer.limited(&none, acceleration_m_s2);
        // Upside down it has no heading.
        let has_heading = attitude.w * attitude.w + attitude.z * attitude.z > 1e-6;
        let heading = if has_heading { Heading::from_half(attitude.w, attitude.z) } else { Heading::ZERO };
        let w = body_rates_rad_s;
        let errors = Errors {
            half_rotation: half_error(&wanted, heading, attitude),
            body_rates: [w.x, w.y, w.z],
            imbalance: memory.imbalance.parts,
        };
        let axis = attitude.thrust_axis();
        let along = axis.x * wanted.x + axis.y * wanted.y + axis.z * wanted.z;
        let thrust = self.airframe().mixing.quarter_mass_kg * (along - memory.disturbance.along);
        let reference = Parts { thrust, roll: 0.0, pitch: 0.0, yaw: 0.0 };
        let MotorYield { share, inverse } = memory.motors;
        let forces = turned(&parts_of(forces_n), share);
        let asked = self.inner.commands(thrust, [&reference, &reference], &forces, &errors);
        let (commands, limited) = self.allocation.allocate(turned(&asked, inverse))?;
        let commands_n = commands.forces().map(|force| self.allocation.cut(force));
        *forces_n = self.actuation.lag.next(forces_n, &commands_n);
        // An estimate that comes back is a new one, and the observers begin where it is.
        let before = memory.seen;
        *memory = CascadeMemory {
            carried: CascadeMemory::IN_FLIGHT.carried,
            held: CascadeMemory::IN_FLIGHT.held,
            disturbance: memory.disturbance.anew(),
            seen: Seen { mean_forces: memory.coming, axis, undisturbed: false, answer: [0.0; 2], ..before },
            coming: middle(&forces, &turned(&parts_of(forces_n), share)),
            ..*memory
        };
        Some((commands_n, limited))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::airframe::Airframe;
    use crate::cascade::gains::tests::BRUSHLESS;
    use crate::cascade::{Air, CascadeLimits};
    use crate::clock::Rate;

    const CRAFT: Airframe = Airframe::CRAZYFLIE_2_1_BRUSHLESS;

    fn cascade() -> Cascade {
        let rate = Rate::from_hz(500).unwrap();
        let craft = CRAFT.with_motor_lag(0.05).unwrap();
        Cascade::new(&BRUSHLESS, &craft, rate, &CascadeLimits::STANDARD, &Air::BRUSHLESS).unwrap()
    }

    fn level(attitude: Quaternion, rates: [f32; 3], acceleration: [f32; 3]) -> Option<MotorForces> {
        let (mut memory, mut forces) = (CascadeMemory::IN_FLIGHT, [CRAFT.hover_force_n(); 4]);
        let rates = Vector3::from(rates);
        let step = cascade().level(&mut memory, &mut forces, (attitude, &rates), &Vector3::from(acceleration));
        step.map(|(forces, _)| forces)
    }

    #[test]
    fn level_and_still_it_hovers_at_any_heading() {
        for psi in [0.0_f32, 1.0, 3.0] {
            let forces = level(Heading::from_angle(psi).quaternion(), [0.0; 3], [0.0; 3]).unwrap();
            for force in forces {
                // Roundings of an error of rotation of 1e-7 times its gain.
                assert!((force - CRAFT.hover_force_n()).abs() < 1e-6, "{forces:?}");
            }
        }
    }

    #[test]
    fn a_tilt_and_a_rate_are_answered_against() {
        let [m1, m2, m3, m4] = level(Quaternion::new(0.99, 0.14, 0.0, 0.0), [0.0; 3], [0.0; 3]).unwrap();
        // Rolled to the right about x: the right side, M1 and M2, pushes more.
        assert!(m1 > m3 && m2 > m4);
        let [m1, m2, m3, m4] = level(Quaternion::IDENTITY, [0.0, 1.0, 0.0], [0.0; 3]).unwrap();
        // Nose going down about y: the front, M1 and M4, pushes more.
        assert!(m1 > m2 && m4 > m3);
    }

    #[test]
    fn a_nan_gives_nothing_and_large_inputs_stay_within_the_range() {
        let figures = CRAFT.figures();
        let upside_down = Quaternion::new(0.0, 1.0, 0.0, 0.0);
        for acceleration in [[0.0, 0.0, -100.0], [1e6, -1e6, 1e6], [0.0; 3]] {
            for rates in [[0.0; 3], [30.0, -30.0, 30.0]] {
                for force in level(upside_down, rates, acceleration).unwrap() {
                    assert!((figures.force_min_n..=figures.force_max_n).contains(&force));
                }
            }
        }
        assert_eq!(level(Quaternion::IDENTITY, [f32::NAN, 0.0, 0.0], [0.0; 3]), None);
        assert_eq!(level(Quaternion::new(f32::NAN, 0.0, 0.0, 1.0), [0.0; 3], [0.0; 3]), None);
    }
}
