//! The actuator-aware law: LQR with integral action on a rigid craft whose motors lag, from state and gyroscope straight to
//! motor forces.
//!
//! `u = f_r + tau df_r/dt - K [dr dv 2 q_err,v dw (f - f_r) int dr]`, each motor cut to its range. `q_err = q_r^-1 q`
//! of the sign with a scalar part of at least 0, dw = measured less reference body rates, f the forces that the lag
//! gives from the commands so far ([`MotorLag`]: motors are not measured). The gain is designed at heading 0: position
//! and velocity errors and their integral are turned into the reference's heading frame; rotation and body rates are
//! the body's own. The integral is kept in the world frame, used before the present error is added, and holds while any
//! motor is cut.

use nalgebra::Vector3;

use super::difference;
use super::force_range::ForceRange;
use crate::actuation::Actuation;
use crate::gain::{Gain, GainError};
use crate::mixer::{MotorLimited, Parts};
use crate::motor_lag::MotorForces;
use crate::motor_reference::MotorReference;
use crate::state::State;

/// Outputs: forces of M1 to M4, N. Errors: position (3, m), velocity (3, m/s), rotation vector (3, rad), body rates (3,
/// rad/s), motor forces (4, N), integral of position (3, m s); the first two groups and the last in the heading frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorAwareGain {
    gain: Gain<4, 19>,
    feedback: Feedback,
}

/// `-K` as a step takes it. Entries for the rotation are doubled: a step has half of it, the vector part of a quaternion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put the larger one on")]
enum Feedback {
    Decoupled(Chains),
    /// By columns, so that every error is done with once it is used.
    Dense([[f32; 4]; 19]),
}

/// The gain of a design in which the hover model of an X with equal arms decouples: thrust, roll, pitch and yaw parts
/// of the four forces answer each to their own errors. A quarter of the products of the whole matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Chains {
    /// From z, vz, thrust part of the forces, integral of z.
    thrust: [f32; 4],
    /// From y, vy, rotation about x, p, roll part, integral of y.
    roll: [f32; 6],
    /// From x, vx, rotation about y, q, pitch part, integral of x.
    pitch: [f32; 6],
    /// From rotation about z, r, yaw part.
    yaw: [f32; 3],
}

/// The law: a gain on a craft's motors. Its memory is the caller's: predicted motor forces and the
/// integral of the position error ([`crate::Memory`]).
///
/// It is flown from a table: [`crate::gains::table`] has an example.
#[derive(Clone, Copy, Debug)]
pub struct ActuatorAware<'a> {
    pub(crate) gain: &'a ActuatorAwareGain,
    pub(crate) actuation: &'a Actuation,
    range: ForceRange,
}

impl ActuatorAwareGain {
    /// Checks a matrix given by rows.
    ///
    /// # Errors
    /// [`GainError`] names the entry or column.
    pub const fn new(rows: [[f32; 19]; 4]) -> Result<Self, GainError> {
        match Gain::new(rows) {
            Ok(gain) => {
                let columns = columns_of_feedback(&gain);
                let feedback = match Chains::of(&columns) {
                    Some(chains) => Feedback::Decoupled(chains),
                    None => Feedback::Dense(columns),
                };
                Ok(Self { gain, feedback })
            }
            Err(error) => Err(error),
        }
    }

    /// For tables in the source: a bad one does not compile when it initialises a constant.
    ///
    /// # Panics
    /// At compile time, on gains that [`ActuatorAwareGain::new`] refuses.
    pub const fn table(rows: [[f32; 19]; 4]) -> Self {
        match Self::new(rows) {
            Ok(gain) => gain,
            Err(error) => error.refuse_to_compile(),
        }
    }

    /// The matrix.
    pub const fn gain(&self) -> &Gain<4, 19> {
        &self.gain
    }

    /// Whether it decouples into thrust, roll, pitch and yaw, and a step therefore takes a quarter of the products.
    pub const fn is_decoupled(&self) -> bool {
        matches!(self.feedback, Feedback::Decoupled(_))
    }
}

impl Feedback {
    /// `u - K e`.
    #[inline(always)]
    fn added_to(&self, u: MotorForces, e: &Errors) -> MotorForces {
        let (r, v, rotation, rates, i) = (&e.position, &e.velocity, &e.half_rotation, &e.body_rates, &e.integral);
        match self {
            Self::Decoupled(Chains { thrust, roll, pitch, yaw }) => {
                let f = Parts::four_times_of(e.forces);
                let [k1, k2, k3, k4] = Parts {
                    thrust: thrust[0] * r.z + thrust[1] * v.z + thrust[2] * f.thrust + thrust[3] * i.z,
                    roll: roll[0] * r.y
                        + roll[1] * v.y
                        + roll[2] * rotation.x
                        + roll[3] * rates.x
                        + roll[4] * f.roll
                        + roll[5] * i.y,
                    pitch: pitch[0] * r.x
                        + pitch[1] * v.x
                        + pitch[2] * rotation.y
                        + pitch[3] * rates.y
                        + pitch[4] * f.pitch
                        + pitch[5] * i.x,
                    yaw: yaw[0] * rotation.z + yaw[1] * rates.z + yaw[2] * f.yaw,
                }
                .forces();
                let [u1, u2, u3, u4] = u;
                [u1 + k1, u2 + k2, u3 + k3, u4 + k4]
            }
            Self::Dense(columns) => {
                let add = |[u1, u2, u3, u4]: MotorForces, [k1, k2, k3, k4]: &[f32; 4], e: f32| {
                    [u1 + k1 * e, u2 + k2 * e, u3 + k3 * e, u4 + k4 * e]
                };
                let [rx, ry, rz, vx, vy, vz, ax, ay, az, p, q, s, f1, f2, f3, f4, ix, iy, iz] = columns;
                let [e1, e2, e3, e4] = e.forces;
                let u = add(add(add(u, rx, r.x), ry, r.y), rz, r.z);
                let u = add(add(add(u, vx, v.x), vy, v.y), vz, v.z);
                let u = add(add(add(u, ax, rotation.x), ay, rotation.y), az, rotation.z);
                let u = add(add(add(u, p, rates.x), q, rates.y), s, rates.z);
                let u = add(add(add(add(u, f1, e1), f2, e2), f3, e3), f4, e4);
                add(add(add(u, ix, i.x), iy, i.y), iz, i.z)
            }
        }
    }
}

/// `-K` by columns, with those of the rotation twice.
const fn columns_of_feedback(gain: &Gain<4, 19>) -> [[f32; 4]; 19] {
    let rows = gain.rows();
    let mut columns = [[0.0; 4]; 19];
    let mut column = 0;
    while column < 19 {
        let scale = if column >= 6 && column < 9 { -2.0 } else { -1.0 };
        let mut row = 0;
        while row < 4 {
            columns[column][row] = scale * rows[row][column];
            row += 1;
        }
        column += 1;
    }
    columns
}

impl Chains {
    /// Nothing unless every column drives one part alone, by the pattern of its signs and with entries of the same size.
    const fn of(columns: &[[f32; 4]; 19]) -> Option<Self> {
        // Signs with which M1 to M4 have each part: the rows of the table of [`mod@crate::airframe`].
        const THRUST: [f32; 4] = [1.0, 1.0, 1.0, 1.0];
        const ROLL: [f32; 4] = [-1.0, -1.0, 1.0, 1.0];
        const PITCH: [f32; 4] = [-1.0, 1.0, 1.0, -1.0];
        const YAW: [f32; 4] = [-1.0, 1.0, -1.0, 1.0];
        let [x, y, z, vx, vy, vz, rotation_x, rotation_y, rotation_z, p, q, r, f1, f2, f3, f4, ix, iy, iz] = columns;
        let thrust = [size(z, &THRUST), size(vz, &THRUST), size(iz, &THRUST), Some(0.0), Some(0.0)];
        let roll = [size(y, &ROLL), size(vy, &ROLL), size(rotation_x, &ROLL), size(p, &ROLL), size(iy, &ROLL)];
        let pitch = [size(x, &PITCH), size(vx, &PITCH), size(rotation_y, &PITCH), size(q, &PITCH), size(ix, &PITCH)];
        let yaw = [size(rotation_z, &YAW), size(r, &YAW), Some(0.0), Some(0.0), Some(0.0)];
        // The share of one motor in the command of another depends only on how the two lie to each other:
        // the same, on one side, across, at one end.
        let [same, side, across, end] = *f1;
        let circulates =
            is(f2, [side, same, end, across]) && is(f3, [across, end, same, side]) && is(f4, [end, across, side, same]);
        match (thrust, roll, pitch, yaw, circulates) {
            (
                [Some(z), Some(vz), Some(iz), ..],
                [Some(y), Some(vy), Some(rotation_x), Some(p), Some(iy)],
                [Some(x), Some(vx), Some(rotation_y), Some(q), Some(ix)],
                [Some(rotation_z), Some(r), ..],
                true,
            ) => Some(Self {
                // A quarter: the forces come as four times their parts.
                thrust: [z, vz, 0.25 * ((same + side) + (across + end)), iz],
                roll: [y, vy, rotation_x, p, 0.25 * ((same + side) - (across + end)), iy],
                pitch: [x, vx, rotation_y, q, 0.25 * ((same - side) - (across - end)), ix],
                yaw: [rotation_z, r, 0.25 * ((same - side) + (across - end))],
            }),
            _ => None,
        }
    }
}

/// The factor by which a column is the signs, if there is one.
const fn size(column: &[f32; 4], signs: &[f32; 4]) -> Option<f32> {
    let size = column[0] * signs[0];
    if is(column, [size * signs[0], size * signs[1], size * signs[2], size * signs[3]]) { Some(size) } else { None }
}

const fn is(column: &[f32; 4], other: [f32; 4]) -> bool {
    column[0] == other[0] && column[1] == other[1] && column[2] == other[2] && column[3] == other[3]
}

/// The error that the gain is applied to.
struct Errors {
    position: Vector3<f32>,
    velocity: Vector3<f32>,
    half_rotation: Vector3<f32>,
    body_rates: Vector3<f32>,
    forces: MotorForces,
    integral: Vector3<f32>,
}

impl<'a> ActuatorAware<'a> {
    /// The law on a craft at a control rate, those of the gain's design. References are to be made for the actuation's
    /// airframe, [`crate::Airframe::commanded_at`] that rate: they too depend on its motor lag.
    pub const fn new(gain: &'a ActuatorAwareGain, actuation: &'a Actuation) -> Self {
        Self { gain, actuation, range: ForceRange::of(actuation.airframe()) }
    }

    /// Commanded forces (N) within the motors' range and whether any was cut; nothing, and the memory as it was, where
    /// one of them is not finite. The quaternion's norm is known to be near 1, and is not made 1: it scales the
    /// attitude error, by one part in a hundred at most.
    #[inline(always)]
    pub(crate) fn step(
        &self,
        (forces_n, integral_m_s): (&mut MotorForces, &mut Vector3<f32>),
        state: &State,
        body_rates_rad_s: &Vector3<f32>,
        reference: &MotorReference,
    ) -> Option<(MotorForces, MotorLimited)> {
        let (target, actuation) = (&reference.reference, self.actuation);
        let heading = target.heading;
        let error = difference(&state.position_m, &target.state.position_m);
        let velocity = difference(&state.velocity_m_s, &target.state.velocity_m_s);
        let attitude = target.state.attitude.conjugate() * state.attitude;
        let hemisphere = if attitude.w < 0.0 { -1.0 } else { 1.0 };
        let ([f1, f2, f3, f4], [r1, r2, r3, r4]) = (*forces_n, reference.forces_n);
        let errors = Errors {
            position: heading.to_heading_frame(error),
            velocity: heading.to_heading_frame(velocity),
            half_rotation: Vector3::new(hemisphere * attitude.x, hemisphere * attitude.y, hemisphere * attitude.z),
            body_rates: difference(body_rates_rad_s, &target.input.body_rates_rad_s),
            forces: [f1 - r1, f2 - r2, f3 - r3, f4 - r4],
            integral: heading.to_heading_frame(*integral_m_s),
        };
        let asked = self.gain.feedback.added_to(reference.commands_n, &errors);
        let (commands, limited) = self.range.saturate(&asked)?;
        *forces_n = actuation.lag.next(forces_n, &commands);
        if !limited.any() {
            let (h, i) = (actuation.lag.period_s(), *integral_m_s);
            *integral_m_s = Vector3::new(i.x + h * error.x, i.y + h * error.y, i.z + h * error.z);
        }
        Some((commands, limited))
    }
}
