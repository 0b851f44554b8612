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
mod command;
mod estimate;
mod force_observer;
mod gains;
mod ground;
mod inner;
mod jerk_fit;
mod level;
mod limits;
mod memory;
mod observe;
mod outer;
mod reference;
mod torque_observer;
mod yield_learner;

use nalgebra::Vector3;

pub use self::air::{Air, AirError};
use self::air_learner::AirLearner;
use self::allocation::Allocation;
use self::force_observer::ForceObserver;
pub use self::gains::{CascadeGainError, CascadeGains, HeightGains, TiltGains, YawGains};
use self::inner::InnerLoop;
pub use self::jerk_fit::JerkFit;
pub use self::limits::{CascadeLimits, CascadeLimitsError};
pub use self::memory::CascadeMemory;
use self::outer::OuterLoop;
use self::torque_observer::TorqueObserver;
use crate::actuation::Actuation;
use crate::airframe::Airframe;
use crate::clock::Rate;
use crate::error::StepError;
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
