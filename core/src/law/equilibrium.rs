//! (LYAP-E) and (LQR-E): `u = u_e - K (x - x_r)`, the gain designed on the model linearised at hover.

use core::hint::cold_path;

use nalgebra::Vector3;

use super::{ControlLaw, FeedForward, difference};
use crate::command::Command;
use crate::flatness::GRAVITY_M_S2;
use crate::gain::{Gain, GainError};
use crate::reference::Reference;
use crate::state::NormalizedState;

/// Outputs `[T p q r]` from errors `[x y z q1 q2 q3 vx vy vz]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquilibriumGain {
    /// `-K`: the law adds.
    feedback: Gain<4, 9>,
    chains: Option<Chains>,
}

/// The gain of a design in which the hover model decouples, as the paper's do: thrust answers to height, roll rate to
/// y, pitch rate to x, yaw rate to heading. A quarter of the products of the whole matrix. Entries are those of `-K`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Chains {
    /// From z and vz.
    thrust: [f32; 2],
    /// From y, q1 and vy.
    roll: [f32; 3],
    /// From x, q2 and vx.
    pitch: [f32; 3],
    /// From q3.
    yaw: f32,
}

impl EquilibriumGain {
    /// Checks a matrix given by rows.
    ///
    /// # Errors
    /// [`GainError`] names the entry or column.
    pub const fn new(rows: [[f32; 9]; 4]) -> Result<Self, GainError> {
        match Gain::new(rows) {
            Ok(gain) => {
                let feedback = gain.negated();
                Ok(Self { chains: Chains::of(&feedback), feedback })
            }
            Err(error) => Err(error),
        }
    }

    /// For tables in the source: a bad one does not compile when it initialises a constant.
    ///
    /// # Panics
    /// At compile time, on gains that [`EquilibriumGain::new`] refuses.
    pub const fn table(rows: [[f32; 9]; 4]) -> Self {
        match Self::new(rows) {
            Ok(gain) => gain,
            Err(error) => error.refuse_to_compile(),
        }
    }

    /// The matrix.
    pub const fn gain(&self) -> Gain<4, 9> {
        self.feedback.negated()
    }

    /// `-K e`. The same sums in the same order either way: leaving out a product with zero changes no bit of them, and
    /// neither does the sign.
    #[inline(always)]
    fn feedback(&self, error: &[f32; 9]) -> [f32; 4] {
        let [x, y, z, q1, q2, q3, vx, vy, vz] = *error;
        match &self.chains {
            Some(Chains { thrust, roll, pitch, yaw }) => [
                thrust[0] * z + thrust[1] * vz,
                roll[0] * y + roll[1] * q1 + roll[2] * vy,
                pitch[0] * x + pitch[1] * q2 + pitch[2] * vx,
                yaw * q3,
            ],
            None => {
                // Written out, or the compiler loops over memory.
                let row = |[k0, k1, k2, k3, k4, k5, k6, k7, k8]: &[f32; 9]| {
                    k0 * x + k1 * y + k2 * z + k3 * q1 + k4 * q2 + k5 * q3 + k6 * vx + k7 * vy + k8 * vz
                };
                let [thrust, p, q, r] = self.feedback.rows();
                [row(thrust), row(p), row(q), row(r)]
            }
        }
    }
}

impl Chains {
    const fn of(feedback: &Gain<4, 9>) -> Option<Self> {
        if !feedback.is_zero_outside(&[(0, 2), (0, 8), (1, 1), (1, 3), (1, 7), (2, 0), (2, 4), (2, 6), (3, 5)]) {
            return None;
        }
        let [t, p, q, r] = feedback.rows();
        Some(Self { thrust: [t[2], t[8]], roll: [p[1], p[3], p[7]], pitch: [q[0], q[4], q[6]], yaw: r[5] })
    }
}

/// The meaning of `x - x_r` for a craft at a heading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ErrorForm {
    /// Position and velocity errors in the reference's heading frame, vector part of `q_r^-1 q`: the same closed loop
    /// at every heading.
    #[default]
    HeadingFrame,
    /// The paper's own form: errors in the world frame, vector part of `q - q_r`. The same to first order near heading
    /// 0, unstable at 90 degrees.
    Paper,
}

/// The equilibrium law.
///
/// ```
/// use quatrack::nalgebra::Vector3;
/// use quatrack::{Controller, Equilibrium, Limits, Measured, Memory, Reference, State, Target, gains::paper};
///
/// // 10 cm behind its place, LQR-E asks for a pitch rate of 31.6 1/(m s) times 0.1 m, nose down.
/// let controller = Controller::new(Equilibrium::new(&paper::LQR_E), Limits::NONE);
/// let state = State::at_rest(Vector3::new(-0.1, 0.0, 1.0));
/// let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0)?;
/// let output = controller.step(&mut Memory::at_rest(), Measured::new(&state), Target::new(&reference))?;
/// let command = output.command().ok_or("no command")?.command;
/// assert!((command.body_rates_rad_s.y - 3.1622776).abs() < 1e-6);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Equilibrium<'a> {
    /// The gain, designed at heading 0.
    pub gain: &'a EquilibriumGain,
    /// The error's form.
    pub error_form: ErrorForm,
    /// Whether the reference's input replaces the hover input `u_e`.
    pub feed_forward: FeedForward,
}

impl<'a> Equilibrium<'a> {
    /// The law as one flies it: errors in the heading frame, no feed-forward.
    pub const fn new(gain: &'a EquilibriumGain) -> Self {
        Self { gain, error_form: ErrorForm::HeadingFrame, feed_forward: FeedForward::Without }
    }

    #[inline(always)]
    fn error(&self, state: &NormalizedState<'_>, reference: &Reference) -> [f32; 9] {
        match self.error_form {
            ErrorForm::HeadingFrame => heading_frame_error(state, reference),
            ErrorForm::Paper => {
                cold_path();
                let target = &reference.state;
                let r = difference(state.position_m(), &target.position_m);
                let v = difference(state.velocity_m_s(), &target.velocity_m_s);
                let q = state.attitude().in_hemisphere_of(target.attitude);
                let (dx, dy, dz) = (q.x - target.attitude.x, q.y - target.attitude.y, q.z - target.attitude.z);
                [r.x, r.y, r.z, dx, dy, dz, v.x, v.y, v.z]
            }
        }
    }
}

/// The error `[x y z q1 q2 q3 vx vy vz]` of [`ErrorForm::HeadingFrame`].
#[inline(always)]
pub(super) fn heading_frame_error(state: &NormalizedState<'_>, reference: &Reference) -> [f32; 9] {
    let target = &reference.state;
    let r = reference.heading.to_heading_frame(difference(state.position_m(), &target.position_m));
    let v = reference.heading.to_heading_frame(difference(state.velocity_m_s(), &target.velocity_m_s));
    let q = state.attitude_from(target.attitude);
    [r.x, r.y, r.z, q.x, q.y, q.z, v.x, v.y, v.z]
}

impl ControlLaw for Equilibrium<'_> {
    // All of it into each of its callers: a function that they shared would take 70 instructions more.
    #[inline(always)]
    fn command(&self, state: &NormalizedState<'_>, reference: &Reference) -> Command {
        let [thrust, p, q, r] = self.gain.feedback(&self.error(state, reference));
        match self.feed_forward {
            FeedForward::Without => {
                Command { thrust_m_s2: GRAVITY_M_S2 + thrust, body_rates_rad_s: Vector3::new(p, q, r) }
            }
            FeedForward::With => {
                let input = &reference.input;
                let rates = &input.body_rates_rad_s;
                Command {
                    thrust_m_s2: input.thrust_m_s2 + thrust,
                    body_rates_rad_s: Vector3::new(rates.x + p, rates.y + q, rates.z + r),
                }
            }
        }
    }
}
