//! The upper half of a step: estimate, gyroscope and reference in; motor forces within the motors' range out.

use nalgebra::Vector3;

use super::attitude;
use super::ground::HELD_M_S;
use super::inner::Errors;
use super::memory::Seen;
use super::outer::OuterLoop;
use super::reference::{InAir, Surroundings};
use super::yield_learner::MotorYield;
use super::{Cascade, CascadeInput, CascadeMemory, Followed, middle, parts_of, turned};
use crate::error::{StateError, StepError};
use crate::flatness::GRAVITY_M_S2;
use crate::law::difference;
use crate::mixer::MotorLimited;
use crate::motor_lag::MotorForces;

/// Distance from the reference beyond which nothing is learned, m.
const FAR_M: f32 = 0.4;

impl Cascade {
    /// The commanded forces for this step, N, finite and within the motors' range, and the limits that cut them.
    ///
    /// # Errors
    /// [`StepError`] where the estimate is not to be flown on or the reference has no attitude. There are then no
    /// forces and the memory is as it was: the caller stops or levels, and never holds the last ones.
    pub fn command(
        &self,
        memory: &mut CascadeMemory,
        forces_n: &mut MotorForces,
        input: &CascadeInput<'_>,
    ) -> Result<(MotorForces, MotorLimited), StepError> {
        self.stepped(memory, forces_n, input).ok_or_else(|| refusal(input))
    }

    #[inline(always)]
    fn stepped(
        &self,
        memory: &mut CascadeMemory,
        forces_n: &mut MotorForces,
        input: &CascadeInput<'_>,
    ) -> Option<(MotorForces, MotorLimited)> {
        let (mut carried, mut held, period_s) = (memory.carried, memory.held, self.actuation.lag.period_s());
        let flat = &input.sample.flat;
        let mut now =
            carried.at_step(input.state, input.body_rates_rad_s, &memory.disturbance.acceleration, period_s)?;
        held.step(&mut now, period_s);

        let position = difference(&now.position, &flat.position_m);
        let velocity = difference(&now.velocity, &flat.velocity_m_s);
        let speed_m_s = if memory.ground.is_held() { HELD_M_S } else { self.outer.speed_m_s() };
        let approach = self.outer.approach(&memory.approach, &position, (speed_m_s, period_s));

        let (standing, disturbance, air) =
            (memory.ground.is_standing(), &memory.disturbance, self.air_learner.now(&memory.air));
        let Followed { across, height } = input.followed;
        let around = if across {
            Surroundings {
                air: if standing { air.without_moment() } else { air },
                disturbance: disturbance.across,
                slope: disturbance.slope,
                wind: memory.air.wind,
                approach,
            }
        } else {
            Surroundings::STILL
        };
        let reference = InAir::of(input.sample, input.heading, &around, now.attitude, self.airframe()).ok()?;

        let wanted = if height {
            let sideways_m_s = (across && !standing).then_some(speed_m_s);
            let correction = self.outer.correction(&position, &velocity, sideways_m_s);
            self.outer.limited(&reference.acceleration, &correction)
        } else {
            let a = &reference.acceleration;
            Vector3::new(a.x, a.y, a.z + GRAVITY_M_S2)
        };

        let axis = now.attitude.thrust_axis();
        let [p, q, r] = reference.body_rates;
        let w = &now.body_rates;
        let errors = Errors {
            half_rotation: attitude::half_error(&wanted, reference.heading, now.attitude),
            body_rates: [w.x - p, w.y - q, w.z - r],
            imbalance: memory.imbalance.parts,
        };
        let mut along = axis.x * wanted.x + axis.y * wanted.y + axis.z * wanted.z;
        if height {
            along = OuterLoop::lifting(along, wanted.z, axis.z);
            let drag_apart = air.drag * (self.drag_along_share - 1.0);
            let v = &now.velocity;
            along = along - disturbance.along + drag_apart * (axis.x * v.x + axis.y * v.y + axis.z * v.z);
        }
        let thrust = self.airframe().mixing.quarter_mass_kg * along;
        let MotorYield { share, inverse } = memory.motors;
        let forces = turned(&parts_of(forces_n), share);
        let asked = self.inner.commands(thrust, [&reference.forces, &reference.commands], &forces, &errors);
        let (commands, limited) = self.allocation.allocate(turned(&asked, inverse))?;

        // Nothing has been remembered so far; from here on nothing fails.
        let commands_n = commands.forces().map(|force| self.allocation.cut(force));
        *forces_n = self.actuation.lag.next(forces_n, &commands_n);
        let far = position.x * position.x + position.y * position.y + position.z * position.z > FAR_M * FAR_M;
        memory.seen = Seen {
            now,
            axis,
            mean_forces: memory.coming,
            answer: reference.answer,
            wanted: flat.velocity_m_s,
            body_velocity: reference.body_velocity,
            undisturbed: across && !(far || limited.any()),
            half_rotation: errors.half_rotation,
        };
        memory.coming = middle(&forces, &turned(&parts_of(forces_n), share));
        (memory.carried, memory.held, memory.approach) = (carried, held, approach);
        Some((commands_n, limited))
    }
}

/// Why there are no forces.
#[cold]
#[inline(never)]
fn refusal(input: &CascadeInput<'_>) -> StepError {
    let rates = || StateError::of_body_rates(input.body_rates_rad_s);
    input.state.fault().or_else(rates).map_or(StepError::Singular, StepError::State)
}
