//! One control step: an estimated state and a reference in, a command within the limits out, or the reason for none.

use nalgebra::Vector3;

use crate::command::{Command, Limited, Limits};
use crate::error::StepError;
use crate::law::{AnyLaw, ControlLaw, Equilibrium, FlatOutput};
use crate::quaternion::Quaternion;
use crate::reference::Reference;
use crate::state::State;

/// A law and the limits of the vehicle that it flies. To be called at a fixed rate.
#[derive(Clone, Copy, Debug)]
pub struct Tracker<'a> {
    flown: Flown<'a>,
}

/// Which law is flown, each beside the limits: a step then takes one pointer to both.
#[derive(Clone, Copy, Debug)]
enum Flown<'a> {
    Equilibrium(Limiting<Equilibrium<'a>>),
    FlatOutput(Limiting<FlatOutput<'a>>),
}

#[derive(Clone, Copy, Debug)]
struct Limiting<L> {
    law: L,
    limits: Limits,
}

/// What one step gives.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Step {
    /// The command, finite and within the limits.
    pub command: Command,
    /// What was cut to stay there.
    pub limited: Limited,
}

impl<'a> Tracker<'a> {
    /// A tracker that flies `law` within `limits`.
    pub fn new(law: impl Into<AnyLaw<'a>>, limits: Limits) -> Self {
        let flown = match law.into() {
            AnyLaw::Equilibrium(law) => Flown::Equilibrium(Limiting { law, limits }),
            AnyLaw::FlatOutput(law) => Flown::FlatOutput(Limiting { law, limits }),
        };
        Self { flown }
    }

    /// The command for this step. The measured quaternion may have either sign.
    ///
    /// # Errors
    /// [`StepError`] where the state is no state or the law has no answer. There is then no command: the caller stops
    /// or levels, and never holds the last one.
    #[inline(never)]
    pub fn step(&self, state: &State, reference: &Reference) -> Result<Step, StepError> {
        match &self.flown {
            Flown::Equilibrium(limiting) => limiting.step(state, reference),
            Flown::FlatOutput(limiting) => limiting.step(state, reference),
        }
    }
}

impl<L: ControlLaw> Limiting<L> {
    /// Hands the numbers over in registers. Each group stands together in memory and comes in with one instruction, where
    /// reading them one by one as they are needed takes sixteen.
    #[inline]
    fn step(&self, state: &State, reference: &Reference) -> Result<Step, StepError> {
        let State { position_m: r, attitude: q, velocity_m_s: v } = state;
        let State { position_m: rr, velocity_m_s: vr, .. } = &reference.state;
        #[rustfmt::skip]
        return self.on(
            state, reference,
            q.w, q.x, q.y, q.z, r.x, r.y, r.z, v.x, v.y, v.z,
            rr.x, rr.y, rr.z, vr.x, vr.y, vr.z,
        );
    }

    /// One step on the state and on the reference's position and velocity as numbers; the rest is read where it stands.
    /// Out of line, so that no law pays for the registers of another.
    #[inline(never)]
    #[allow(clippy::too_many_arguments, reason = "as many as are handed over in registers")]
    #[rustfmt::skip]
    fn on(
        &self, state: &State, reference: &Reference,
        w: f32, q1: f32, q2: f32, q3: f32, x: f32, y: f32, z: f32, vx: f32, vy: f32, vz: f32,
        xr: f32, yr: f32, zr: f32, vxr: f32, vyr: f32, vzr: f32,
    ) -> Result<Step, StepError> {
        let (position_m, velocity_m_s) = (Vector3::new(x, y, z), Vector3::new(vx, vy, vz));
        let read = State { position_m, attitude: Quaternion::new(w, q1, q2, q3), velocity_m_s };
        let (position_m, velocity_m_s) = (Vector3::new(xr, yr, zr), Vector3::new(vxr, vyr, vzr));
        let target = Reference { state: State { position_m, velocity_m_s, ..reference.state }, ..*reference };
        let Some(measured) = read.measured() else { return refuse(state) };
        match self.limits.saturate(&self.law.command(&measured, &target)) {
            Some((command, limited)) => Ok(Step { command, limited }),
            None => refuse(state),
        }
    }
}

/// Why there is no command. The reference has been checked when it was made.
#[cold]
#[inline(never)]
pub(crate) fn refuse(state: &State) -> Result<Step, StepError> {
    Err(state.fault().map_or(StepError::Singular, StepError::State))
}
