//! (LYAP-F) and (LQR-F): linear feedback on the flat state, through the flat map (7).
//!
//! The flat state is `z = [r v a q3]`, with the acceleration that the reference's thrust gives in the measured
//! attitude. The law is computed in the reference's heading frame: the model is symmetric about the vertical, so the
//! paper's law at heading 0, where `q3` of the reference is 0, serves every heading.

use nalgebra::Vector3;

use super::{ControlLaw, FeedForward, difference};
use crate::command::Command;
use crate::flatness::{GRAVITY_M_S2, Tilt};
use crate::gain::{Gain, GainError};
use crate::math::sqrt;
use crate::reference::Reference;
use crate::state::NormalizedState;

/// Outputs `[a(3) j(3) q3']` from errors `[r(3) v(3) a(3) q3]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatOutputGain {
    gain: Gain<7, 10>,
    chains: Option<Chains>,
}

/// The gain of a design in which the flat chain decouples, as the paper's do: acceleration answers to position and
/// velocity of its axis, jerk to acceleration, the rate of `q3` to `q3`. A seventh of the products of the whole matrix.
/// Entries are those of `-K`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Chains {
    position: [f32; 3],
    velocity: [f32; 3],
    acceleration: [f32; 3],
    q3: f32,
}

impl FlatOutputGain {
    /// Checks a matrix given by rows.
    ///
    /// # Errors
    /// [`GainError`] names the entry or column.
    pub const fn new(rows: [[f32; 10]; 7]) -> Result<Self, GainError> {
        match Gain::new(rows) {
            Ok(gain) => Ok(Self { chains: Chains::of(&gain), gain }),
            Err(error) => Err(error),
        }
    }

    /// For tables in the source: a bad one does not compile when it initialises a constant.
    ///
    /// # Panics
    /// At compile time, on gains that [`FlatOutputGain::new`] refuses.
    pub const fn table(rows: [[f32; 10]; 7]) -> Self {
        match Self::new(rows) {
            Ok(gain) => gain,
            Err(error) => error.refuse_to_compile(),
        }
    }

    /// The matrix.
    pub const fn gain(&self) -> Gain<7, 10> {
        self.gain
    }

    /// `-K e`. The same sums in the same order either way: leaving out a product with zero changes no bit of them, and
    /// neither does the sign.
    #[inline]
    fn feedback(&self, error: &[f32; 10]) -> [f32; 7] {
        let [x, y, z, vx, vy, vz, ax, ay, az, q3] = *error;
        match &self.chains {
            Some(Chains { position: kr, velocity: kv, acceleration: ka, q3: kq }) => [
                kr[0] * x + kv[0] * vx,
                kr[1] * y + kv[1] * vy,
                kr[2] * z + kv[2] * vz,
                ka[0] * ax,
                ka[1] * ay,
                ka[2] * az,
                kq * q3,
            ],
            // An array of its own: the chains' errors then never need to be in memory.
            None => self.gain.times(&[x, y, z, vx, vy, vz, ax, ay, az, q3]).map(|sum| -sum),
        }
    }
}

impl Chains {
    const fn of(gain: &Gain<7, 10>) -> Option<Self> {
        let listed = [(0, 0), (0, 3), (1, 1), (1, 4), (2, 2), (2, 5), (3, 6), (4, 7), (5, 8), (6, 9)];
        if !gain.is_zero_outside(&listed) {
            return None;
        }
        let [a0, a1, a2, j0, j1, j2, q] = gain.rows();
        Some(Self {
            position: [-a0[0], -a1[1], -a2[2]],
            velocity: [-a0[3], -a1[4], -a2[5]],
            acceleration: [-j0[6], -j1[7], -j2[8]],
            q3: -q[9],
        })
    }
}

/// The flat output law.
///
/// ```
/// use quatrack::nalgebra::Vector3;
/// use quatrack::{Controller, FlatOutput, Limits, Measured, Memory, Reference, State, Target, gains::paper};
///
/// // 10 cm too low: 44.7 1/s^2 times 0.1 m on top of gravity. Sideways it asks for no attitude: F has no outer loop.
/// let controller = Controller::new(FlatOutput::new(&paper::LQR_F), Limits::NONE);
/// let state = State::at_rest(Vector3::new(0.0, 0.0, 0.9));
/// let reference = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0)?;
/// let output = controller.step(&mut Memory::at_rest(), Measured::new(&state), Target::new(&reference))?;
/// let command = output.command().ok_or("no command")?.command;
/// assert!((command.thrust_m_s2 - (9.81 + 4.472136)).abs() < 1e-5);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct FlatOutput<'a> {
    /// The gain, designed at heading 0.
    pub gain: &'a FlatOutputGain,
    /// Whether the reference's acceleration, jerk and heading rate are added.
    pub feed_forward: FeedForward,
}

impl<'a> FlatOutput<'a> {
    /// The paper's law: no feed-forward.
    pub const fn new(gain: &'a FlatOutputGain) -> Self {
        Self { gain, feed_forward: FeedForward::Without }
    }
}

impl ControlLaw for FlatOutput<'_> {
    #[inline]
    fn command(&self, state: &NormalizedState<'_>, reference: &Reference) -> Command {
        let heading = reference.heading;
        let target = &reference.state;
        let r = heading.to_heading_frame(difference(state.position_m(), &target.position_m));
        let v = heading.to_heading_frame(difference(state.velocity_m_s(), &target.velocity_m_s));
        // The chart's own hemisphere is q0 >= 0.
        let attitude = state.attitude_from_heading(heading);

        let target_acceleration = heading.to_heading_frame(reference.acceleration_m_s2);
        let axis = attitude.thrust_axis();
        let thrust = reference.input.thrust_m_s2;
        let (ax, ay) = (thrust * axis.x - target_acceleration.x, thrust * axis.y - target_acceleration.y);
        let az = thrust * axis.z - GRAVITY_M_S2 - target_acceleration.z;

        let [v0, v1, v2, v3, v4, v5, v6] = self.gain.feedback(&[r.x, r.y, r.z, v.x, v.y, v.z, ax, ay, az, attitude.z]);
        let (acceleration, jerk, q3_rate) = match self.feed_forward {
            FeedForward::Without => (Vector3::new(v0, v1, v2), Vector3::new(v3, v4, v5), v6),
            FeedForward::With => {
                let (a, j) = (target_acceleration, heading.to_heading_frame(reference.jerk_m_s3));
                // q3 = cos(tilt/2) sin(psi/2) in the frame that the heading passes through: psi = 0 there, psi' is not.
                let q = &target.attitude;
                let q3_rate = 0.5 * sqrt(q.w * q.w + q.z * q.z) * reference.heading_rate_rad_s;
                (Vector3::new(a.x + v0, a.y + v1, a.z + v2), Vector3::new(j.x + v3, j.y + v4, j.z + v5), q3_rate + v6)
            }
        };
        Tilt::new(acceleration, jerk).with_q3(attitude.z, q3_rate).input
    }
}
