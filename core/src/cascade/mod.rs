//! The cascade: the equilibrium LQR of a craft whose motors lag, factored so that it has limits, told of the air, with
//! observers in place of an integral. Estimate, gyroscope and a reference to its fifth derivative in; four motor forces
//! out.
//!
//! In the order in which data flows, with `n = R z` and forces in parts of thrust, roll, pitch and yaw:
//!
//! ```text
//! estimate        p, v, q carried on to the step, v by the force observer; v held to p
//! outer           approach: the velocity towards p_r that the craft should have beside the reference's
//! reference       a' = a + d v - d^, ...; flat map -> q_r, w_r, f_r, u_r; answer to the air's moment at v_r and some of the approach
//! outer           A = -k_v sat[(v - v_r) + sat(k_p / k_v (p - p_r))];  h = a' + A + g z, within its limits
//! attitude        e = vector part of q_d^-1 q, q_d along h at the reference's heading
//! inner           u = u_r - (k_th 2 e + k_w (w - w_r) + k_f (f^ + t^ - f_r)) - t^;   t = m / 4 (h . n - d^_z)
//! allocation      within the motors' range, attitude first;  f^ by the motors' lag
//! - - - - - - - - after the motors have their forces - - - - - - - -
//! force_observer  d^ across and its slope, d^_z along the thrust
//! torque_observer t^ about each axis
//! air_learner     d, c_x, c_y; the wind's moment
//! yield_learner   the motors' force as a share of the commanded one
//! ground          whether the craft is on the ground, and the observers off with it
//! ```
//!
//! [`Cascade::command`] is the upper half, [`Cascade::observe`] the lower one: a caller with little time at the step
//! may call it before the next one. Where nothing is limited and the observers see nothing, the command is the LQR's.

mod air;
mod air_learner;
mod allocation;
mod attitude;
mod bounds;
mod estimate;
mod force_observer;
mod gains;
mod ground;
mod inner;
mod jerk_fit;
mod level;
mod limits;
mod memory;
mod outer;
mod reference;
mod torque_observer;
mod yield_learner;

use nalgebra::Vector3;

pub use self::air::{Air, AirError};
use self::air_learner::{AirLearner, Felt};
use self::allocation::Allocation;
use self::bounds::smaller;
use self::force_observer::{ForceObserver, Pushed};
pub use self::gains::{CascadeGainError, CascadeGains, HeightGains, TiltGains, YawGains};
use self::ground::HELD_M_S;
use self::inner::{Errors, InnerLoop};
pub use self::jerk_fit::JerkFit;
pub use self::limits::{CascadeLimits, CascadeLimitsError};
pub use self::memory::CascadeMemory;
use self::memory::{Before, Seen};
use self::outer::OuterLoop;
use self::reference::{InAir, Surroundings};
use self::torque_observer::TorqueObserver;
use self::yield_learner::MotorYield;
use crate::actuation::Actuation;
use crate::airframe::Airframe;
use crate::clock::Rate;
use crate::error::{StateError, StepError};
use crate::flatness::GRAVITY_M_S2;
use crate::law::difference;
use crate::mixer::{MotorLimited, Parts};
use crate::motor_lag::{MotorForces, MotorLagError};
use crate::motor_reference::FifthOrderSample;
use crate::quaternion::Heading;
use crate::state::State;

/// The cascade for a craft at a control rate. Its memory is apart, in [`CascadeMemory`].
#[derive(Clone, Copy, Debug)]
pub struct Cascade {
    actuation: Actuation,
    drag_along_share: f32,
    outer: OuterLoop,
    inner: InnerLoop,
    allocation: Allocation,
    force_observer: ForceObserver,
    torque_observer: TorqueObserver,
    air_learner: AirLearner,
}

/// The inputs of a step.
#[derive(Clone, Copy, Debug)]
pub struct CascadeInput<'a> {
    /// The estimate.
    pub state: &'a State,
    /// The gyroscope's body rates, rad/s.
    pub body_rates_rad_s: &'a Vector3<f32>,
    /// The reference; its own angle of heading is not looked at.
    pub sample: &'a FifthOrderSample,
    /// The reference's heading.
    pub heading: Heading,
    /// Which directions of it are followed.
    pub followed: Followed,
}

/// Which directions of a reference are followed. Where one is not, a pilot flies the craft: there is no error, no known air and no
/// observer that answers, and the reference's acceleration is that of the tilt or thrust asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Followed {
    /// Over the ground.
    pub across: bool,
    /// Up and down.
    pub height: bool,
}

impl Followed {
    /// All of them.
    pub const ALL: Self = Self { across: true, height: true };
}

impl Cascade {
    /// For gains that were designed for the airframe's motor lag and the rate.
    ///
    /// # Errors
    /// [`MotorLagError`] for a lag shorter than two control periods.
    pub const fn new(
        gains: &CascadeGains,
        airframe: &Airframe,
        rate: Rate,
        limits: &CascadeLimits,
        air: &Air,
    ) -> Result<Self, MotorLagError> {
        let actuation = match Actuation::new(&airframe.commanded_at(rate), rate) {
            Ok(actuation) => actuation,
            Err(error) => return Err(error),
        };
        let period_s = actuation.lag.period_s();
        Ok(Self {
            actuation,
            drag_along_share: air.drag_along_share,
            outer: OuterLoop::new(gains, airframe, limits),
            inner: InnerLoop::new(gains),
            allocation: Allocation::of(airframe),
            force_observer: ForceObserver::new(period_s),
            torque_observer: TorqueObserver::new(airframe, period_s),
            air_learner: AirLearner::new(air, airframe, period_s),
        })
    }

    /// The same, stiffer or softer in position by a factor: its square times the position gains, itself times the
    /// velocity gains.
    pub const fn with_stiffness(self, factor: f32) -> Self {
        Self { outer: self.outer.scaled(factor), ..self }
    }

    /// The craft, with the lead of its commands.
    pub const fn airframe(&self) -> &Airframe {
        self.actuation.airframe()
    }

    /// The actuation for commands of other laws, with the cascade's motor lag.
    pub const fn actuation(&self) -> &Actuation {
        &self.actuation
    }

    /// Drag (1/s) and moment (N s) that are flown with, told or learned.
    pub const fn air(&self, memory: &CascadeMemory) -> (f32, [f32; 2]) {
        let now = self.air_learner.now(&memory.air);
        (now.drag, self.air_learner.moment_n_s(&now))
    }

    /// One step with all that follows it, with the specific force in the body frame (m/s^2) where an accelerometer
    /// gives one;
    /// `forces_n` are those that the motors should have, and move on.
    ///
    /// # Errors
    /// Those of [`Self::command`].
    pub fn step(
        &self,
        memory: &mut CascadeMemory,
        forces_n: &mut MotorForces,
        input: &CascadeInput<'_>,
        accelerometer: Option<&Vector3<f32>>,
    ) -> Result<(MotorForces, MotorLimited), StepError> {
        let stepped = self.command(memory, forces_n, input)?;
        self.observe(memory, accelerometer);
        Ok(stepped)
    }

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

    /// The updates after a step: the observers, the air, the ground.
    pub fn observe(&self, memory: &mut CascadeMemory, accelerometer: Option<&Vector3<f32>>) {
        let (seen, before) = (memory.seen, memory.before);
        let (flew, period_s) = (memory.ground.is_flying(), self.actuation.lag.period_s());
        memory.before = Before { velocity: seen.now.velocity, axis: seen.axis, answer: seen.answer };
        let push = memory.disturbance.along;
        memory.ground.step(&seen.now, memory.disturbance.is_on_bound(), push, period_s);
        if !(flew && memory.ground.is_flying()) {
            return memory.rest();
        }
        let thrust = seen.mean_forces.thrust / self.airframe().mixing.quarter_mass_kg;
        let (known, mut mean_velocity) =
            (self.air_learner.now(&memory.air).drag, mean(&before.velocity, &seen.now.velocity));
        let drag = smaller(known, BELIEVED_DRAG_MAX_PER_S);
        if known > drag {
            // Drag known beyond that is taken of the reference's velocity, as the reference has it: it is no part of the
            // loop.
            let (rest, v) = ((known - drag) / drag, &seen.wanted);
            mean_velocity += Vector3::new(rest * v.x, rest * v.y, rest * v.z);
        }
        let pushed =
            Pushed { velocity: seen.now.velocity, mean_velocity, axis: mean(&before.axis, &seen.axis), thrust, drag };
        if self.force_observer.step(&mut memory.disturbance, &pushed) {
            memory.ground.stop(&seen.now.position);
            return memory.rest();
        }
        if seen.undisturbed {
            memory.motors.step(thrust, memory.disturbance.along, period_s);
        }
        let ([rx, ry], [sx, sy]) = (before.answer, seen.answer);
        let (rates, answer) = (&seen.now.body_rates, [0.5 * (rx + sx), 0.5 * (ry + sy)]);
        self.torque_observer.step(&mut memory.imbalance, rates, &seen.mean_forces, answer);
        let felt = Felt {
            accelerometer,
            body_velocity: seen.body_velocity,
            body_rates: rates,
            forces: &seen.mean_forces,
            undisturbed: seen.undisturbed,
        };
        self.air_learner.step(&mut memory.air, &felt);
    }
}

/// Most of the drag that the force observer takes of the measured velocity, 1/s. Certificates go as far.
const BELIEVED_DRAG_MAX_PER_S: f32 = 0.6;

/// Distance from the reference beyond which nothing is learned, m.
const FAR_M: f32 = 0.4;

#[inline(always)]
fn mean(a: &Vector3<f32>, b: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z))
}

/// The parts of motor forces.
#[inline(always)]
fn parts_of(forces_n: &MotorForces) -> Parts {
    let Parts { thrust, roll, pitch, yaw } = Parts::four_times_of(*forces_n);
    Parts { thrust: 0.25 * thrust, roll: 0.25 * roll, pitch: 0.25 * pitch, yaw: 0.25 * yaw }
}

/// The same with the torques' parts times a factor.
#[inline(always)]
fn turned(parts: &Parts, factor: f32) -> Parts {
    let Parts { thrust, roll, pitch, yaw } = *parts;
    Parts { thrust, roll: factor * roll, pitch: factor * pitch, yaw: factor * yaw }
}

#[inline(always)]
fn middle(a: &Parts, b: &Parts) -> Parts {
    Parts {
        thrust: 0.5 * (a.thrust + b.thrust),
        roll: 0.5 * (a.roll + b.roll),
        pitch: 0.5 * (a.pitch + b.pitch),
        yaw: 0.5 * (a.yaw + b.yaw),
    }
}

/// Why there are no forces.
#[cold]
#[inline(never)]
fn refusal(input: &CascadeInput<'_>) -> StepError {
    let rates = || StateError::of_body_rates(input.body_rates_rad_s);
    input.state.fault().or_else(rates).map_or(StepError::Singular, StepError::State)
}
