//! The two laws of the paper, written for the registers of a Cortex-M4F. Nothing here computes anything of its own.
//!
//! The measured state and the reference's position and velocity, sixteen numbers, are handed over in the sixteen floating
//! point registers that a call may use. Each group of them comes in from memory with one instruction; read one by one as
//! they are needed, they take one each. A step of the equilibrium law takes 194 instructions like this and 225 written
//! plainly. Each law is out of line, so that neither pays for the registers that the other saves.

use nalgebra::Vector3;

use super::controller::Controller;
use super::law::Law;
use super::output::{Output, Step};
use crate::error::StepError;
use crate::law::ControlLaw;
use crate::quaternion::Quaternion;
use crate::reference::Reference;
use crate::state::State;

/// Calls one of the two functions below with the numbers of its state and reference.
macro_rules! in_registers {
    ($step:ident, $controller:expr, $state:expr, $reference:expr) => {{
        let State { position_m: r, attitude: q, velocity_m_s: v } = $state;
        let State { position_m: rr, velocity_m_s: vr, .. } = &$reference.state;
        $step(
            $controller,
            $state,
            $reference,
            q.w,
            q.x,
            q.y,
            q.z,
            r.x,
            r.y,
            r.z,
            v.x,
            v.y,
            v.z,
            rr.x,
            rr.y,
            rr.z,
            vr.x,
            vr.y,
            vr.z,
        )
    }};
}

/// A step of the equilibrium law.
#[inline(always)]
pub(super) fn equilibrium(
    controller: &Controller<'_>,
    state: &State,
    reference: &Reference,
) -> Result<Output, StepError> {
    in_registers!(equilibrium_on, controller, state, reference)
}

/// A step of the flat output law.
#[inline(always)]
pub(super) fn flat_output(
    controller: &Controller<'_>,
    state: &State,
    reference: &Reference,
) -> Result<Output, StepError> {
    in_registers!(flat_output_on, controller, state, reference)
}

/// Defines a step on numbers; the rest is read where it is.
macro_rules! step_on {
    ($name:ident, $law:path) => {
        #[inline(never)]
        #[allow(clippy::too_many_arguments, reason = "as many as are handed over in registers")]
        #[rustfmt::skip]
        fn $name(
            controller: &Controller<'_>, state: &State, reference: &Reference,
            w: f32, q1: f32, q2: f32, q3: f32, x: f32, y: f32, z: f32, vx: f32, vy: f32, vz: f32,
            xr: f32, yr: f32, zr: f32, vxr: f32, vyr: f32, vzr: f32,
        ) -> Result<Output, StepError> {
            let $law(law) = &controller.law else { return refuse(state) };
            let (position_m, velocity_m_s) = (Vector3::new(x, y, z), Vector3::new(vx, vy, vz));
            let read = State { position_m, attitude: Quaternion::new(w, q1, q2, q3), velocity_m_s };
            let (position_m, velocity_m_s) = (Vector3::new(xr, yr, zr), Vector3::new(vxr, vyr, vzr));
            let target = Reference { state: State { position_m, velocity_m_s, ..reference.state }, ..*reference };
            let Some(normalized) = read.normalized() else { return refuse(state) };
            match controller.limits.saturate(&law.command(&normalized, &target)) {
                Some((command, limited)) => Ok(Output::Command(Step { command, limited })),
                None => refuse(state),
            }
        }
    };
}

step_on!(equilibrium_on, Law::Equilibrium);
step_on!(flat_output_on, Law::FlatOutput);

/// Why there is no command. The reference has been checked when it was made.
#[cold]
#[inline(never)]
fn refuse(state: &State) -> Result<Output, StepError> {
    Err(state.fault().map_or(StepError::Singular, StepError::State))
}
