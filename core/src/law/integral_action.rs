//! LQI: the equilibrium law with the integral of the position error, `u = u_e - K e - K_i i`.
//!
//! The integral is a sum over the control steps, `i+ = i + h (r - r_r)`, kept in the world frame, where the force of a
//! wind or a weight keeps its direction while the craft turns; the law turns it to the reference's heading frame like
//! every other error. A command is computed from the sum before the present error is added: the design's model does the
//! same.
//!
//! **Anti-windup.** The sum holds while the command that answers to it is cut to the limits: the vertical part while the
//! thrust is, both horizontal parts while the roll rate or the pitch rate is. A cut yaw rate holds nothing: no position
//! answers to it. Where a step gives no command, the whole sum holds.

use nalgebra::Vector3;

use super::{ControlLaw, Equilibrium, EquilibriumGain, ErrorForm, FeedForward, difference};
use crate::clock::Rate;
use crate::command::{Command, Limited};
use crate::gain::{Gain, GainError};
use crate::reference::Reference;
use crate::state::{NormalizedState, State};

/// Outputs `[T p q r]` from errors `[x y z q1 q2 q3 vx vy vz]` and their integrals `[ix iy iz]`, metre seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegralGain {
    equilibrium: EquilibriumGain,
    /// `-K_i`: the law adds.
    integral: [[f32; 3]; 4],
}

impl IntegralGain {
    /// Checks a matrix given by rows.
    ///
    /// # Errors
    /// [`GainError`] names the entry or column.
    pub const fn new(rows: [[f32; 12]; 4]) -> Result<Self, GainError> {
        if let Err(error) = Gain::new(rows) {
            return Err(error);
        }
        let [t, p, q, r] = rows;
        let [(t, ti), (p, pi), (q, qi), (r, ri)] = [split(t), split(p), split(q), split(r)];
        match EquilibriumGain::new([t, p, q, r]) {
            Ok(equilibrium) => Ok(Self { equilibrium, integral: [ti, pi, qi, ri] }),
            Err(error) => Err(error),
        }
    }

    /// For tables in the source: a bad one does not compile when it initialises a constant.
    ///
    /// # Panics
    /// At compile time, on gains that [`IntegralGain::new`] refuses.
    pub const fn table(rows: [[f32; 12]; 4]) -> Self {
        match Self::new(rows) {
            Ok(gain) => gain,
            Err(error) => error.refuse_to_compile(),
        }
    }

    /// The matrix by rows.
    pub const fn rows(&self) -> [[f32; 12]; 4] {
        let equilibrium = self.equilibrium.gain();
        let [t, p, q, r] = *equilibrium.rows();
        let [ti, pi, qi, ri] = self.integral;
        [joined(t, ti), joined(p, pi), joined(q, qi), joined(r, ri)]
    }

    /// The part without the integrals.
    pub const fn equilibrium(&self) -> &EquilibriumGain {
        &self.equilibrium
    }
}

/// A row's nine entries for the errors, and minus its three for the integrals.
const fn split(row: [f32; 12]) -> ([f32; 9], [f32; 3]) {
    let [x, y, z, q1, q2, q3, vx, vy, vz, ix, iy, iz] = row;
    ([x, y, z, q1, q2, q3, vx, vy, vz], [-ix, -iy, -iz])
}

const fn joined(row: [f32; 9], negated: [f32; 3]) -> [f32; 12] {
    let ([x, y, z, q1, q2, q3, vx, vy, vz], [ix, iy, iz]) = (row, negated);
    [x, y, z, q1, q2, q3, vx, vy, vz, -ix, -iy, -iz]
}

/// The LQI law. Errors are those of [`ErrorForm::HeadingFrame`].
///
/// ```
/// use quatrack::law::IntegralGain;
/// use quatrack::nalgebra::Vector3;
/// use quatrack::{Controller, FeedForward, IntegralAction, Limits, Measured, Memory, Rate, Reference, State, Target};
///
/// let mut rows = [[0.0; 12]; 4];
/// for (row, gains) in rows.iter_mut().zip(quatrack::gains::paper::LQR_E.gain().rows()) {
///     row[..9].copy_from_slice(gains);
/// }
/// (rows[0][11], rows[1][10], rows[2][9]) = (50.9, -20.7, 20.7);
/// let gain = IntegralGain::new(rows).map_err(|error| error.to_string())?;
/// let law = IntegralAction::new(&gain, Rate::from_hz(500).ok_or("no rate")?, FeedForward::With);
/// let (controller, mut memory) = (Controller::new(law, Limits::NONE), Memory::at_rest());
/// let state = State::at_rest(Vector3::new(0.0, 0.0, 0.9));
/// let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0).map_err(|error| error.to_string())?;
/// for _ in 0..500 {
///     controller.step(&mut memory, Measured::new(&state), Target::new(&reference)).map_err(|error| error.to_string())?;
/// }
/// // A second of -0.1 m.
/// assert!((memory.integral_m_s().z + 0.1).abs() < 1e-5);
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct IntegralAction<'a> {
    gain: &'a IntegralGain,
    feed_forward: FeedForward,
    /// Time between two control steps, s.
    period_s: f32,
}

impl<'a> IntegralAction<'a> {
    /// The law at the rate of control steps that the gain was designed for.
    pub fn new(gain: &'a IntegralGain, rate: Rate, feed_forward: FeedForward) -> Self {
        Self { gain, feed_forward, period_s: 1.0 / rate.hz() as f32 }
    }

    /// The command before saturation, with the sum of the steps before, world frame, metre seconds.
    #[inline]
    pub fn command(&self, sum: &Vector3<f32>, state: &NormalizedState<'_>, reference: &Reference) -> Command {
        let Self { gain: IntegralGain { equilibrium: gain, integral }, feed_forward, .. } = *self;
        let without = Equilibrium { gain, error_form: ErrorForm::HeadingFrame, feed_forward }.command(state, reference);
        let i = reference.heading.to_heading_frame(*sum);
        let [t, p, q, r] = integral.map(|[kx, ky, kz]| kx * i.x + ky * i.y + kz * i.z);
        let rates = &without.body_rates_rad_s;
        Command {
            thrust_m_s2: without.thrust_m_s2 + t,
            body_rates_rad_s: Vector3::new(rates.x + p, rates.y + q, rates.z + r),
        }
    }

    /// The sum after a step whose command was `limited`.
    #[inline]
    pub fn advanced(&self, sum: &Vector3<f32>, state: &State, reference: &Reference, limited: Limited) -> Vector3<f32> {
        let error = difference(&state.position_m, &reference.state.position_m);
        let [p, q, _] = limited.body_rates();
        let horizontal_s = if p || q { 0.0 } else { self.period_s };
        let vertical_s = if limited.thrust() { 0.0 } else { self.period_s };
        Vector3::new(sum.x + horizontal_s * error.x, sum.y + horizontal_s * error.y, sum.z + vertical_s * error.z)
    }
}
