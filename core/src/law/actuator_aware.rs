//! The actuator-aware law: LQR with integral action on a rigid craft whose motors lag, from state and gyroscope straight to
//! motor forces.
//!
//! `u = f_r + tau df_r/dt - K [dr dv 2 q_err,v dw (f - f_r) int dr]`, each motor cut to its range. `q_err = q_r^-1 q` of the
//! sign with a scalar part of at least 0, dw = measured less reference body rates, f the forces that the lag gives from the
//! commands so far ([`MotorLag`]: motors are not measured). The gain is designed at heading 0: position and velocity errors and
//! their integral are turned into the reference's heading frame; rotation and body rates are the body's own. The integral
//! is kept in the world frame, used before the present error is added, and holds while any motor is cut.

use nalgebra::Vector3;

use super::difference;
use crate::airframe::Airframe;
use crate::gain::{Gain, GainError};
use crate::mixer::{MotorLimited, Parts, saturate_each};
use crate::motor_lag::{MotorForces, MotorLag};
use crate::motor_reference::MotorReference;
use crate::state::Measured;

/// Outputs: forces of M1 to M4, N. Errors: position (3, m), velocity (3, m/s), rotation vector (3, rad), body rates (3, rad/s),
/// motor forces (4, N), integral of position (3, m s); the first two groups and the last in the heading frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorAwareGain {
    /// `-K`: the law adds.
    feedback: Gain<4, 19>,
    chains: Option<Chains>,
}

/// The gain of a design in which the hover model of an X with equal arms falls apart: thrust, roll, pitch and yaw parts of the
/// four forces answer each to their own errors. A quarter of the products of the whole matrix. Entries are those of `-K` in
/// parts of forces.
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

/// The law: a gain for a craft's motors. What it remembers is apart, in [`ActuatorMemory`].
#[derive(Clone, Copy, Debug)]
pub struct ActuatorAware<'a> {
    /// The gain.
    pub gain: &'a ActuatorAwareGain,
    lag: MotorLag,
    force_min_n: f32,
    force_max_n: f32,
}

/// What the law remembers from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ActuatorMemory {
    /// Forces that the motors should have, N.
    pub(crate) forces_n: MotorForces,
    /// Integral of the position error in the world frame, m s.
    pub(crate) integral_m_s: Vector3<f32>,
}

impl ActuatorMemory {
    /// Motors at some forces (N), and nothing integrated: zeros on the ground, the forces of hover when taking over in
    /// flight. Nothing where a force is not finite.
    pub fn new(forces_n: MotorForces) -> Option<Self> {
        let finite = forces_n.iter().all(|force| force.is_finite());
        finite.then_some(Self { forces_n, integral_m_s: Vector3::new(0.0, 0.0, 0.0) })
    }

    /// Motors that stand still.
    pub const fn at_rest() -> Self {
        Self { forces_n: [0.0; 4], integral_m_s: Vector3::new(0.0, 0.0, 0.0) }
    }

    /// A craft that hovers.
    pub const fn hovering(airframe: &Airframe) -> Self {
        Self { forces_n: [airframe.hover_force_n(); 4], integral_m_s: Vector3::new(0.0, 0.0, 0.0) }
    }

    /// Forces that the motors should have, N.
    pub const fn forces_n(&self) -> MotorForces {
        self.forces_n
    }

    /// Integral of the position error in the world frame, m s.
    pub const fn integral_m_s(&self) -> Vector3<f32> {
        self.integral_m_s
    }

    /// Forgets the integral: before another trajectory that begins elsewhere.
    pub const fn clear_integral(&mut self) {
        self.integral_m_s = Vector3::new(0.0, 0.0, 0.0);
    }
}

impl ActuatorAwareGain {
    /// Checks a matrix given by rows.
    ///
    /// # Errors
    /// [`GainError`] names the entry or column.
    pub const fn new(rows: [[f32; 19]; 4]) -> Result<Self, GainError> {
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
    /// At compile time, on what [`ActuatorAwareGain::new`] refuses.
    pub const fn table(rows: [[f32; 19]; 4]) -> Self {
        match Self::new(rows) {
            Ok(gain) => gain,
            Err(error) => error.refuse_to_compile(),
        }
    }

    /// The matrix.
    pub const fn gain(&self) -> Gain<4, 19> {
        self.feedback.negated()
    }

    /// Whether it falls apart into thrust, roll, pitch and yaw, and a step therefore takes a quarter of the products.
    pub const fn is_decoupled(&self) -> bool {
        self.chains.is_some()
    }

    /// `-K e`.
    #[inline(always)]
    fn feedback(&self, e: &Errors) -> MotorForces {
        let (r, v, rotation, rates, i) = (&e.position, &e.velocity, &e.rotation, &e.body_rates, &e.integral);
        match &self.chains {
            Some(Chains { thrust, roll, pitch, yaw }) => {
                let f = Parts::four_times_of(e.forces);
                Parts {
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
                .forces()
            }
            None => {
                let [f1, f2, f3, f4] = e.forces;
                self.feedback.rows().map(
                    |[k0, k1, k2, k3, k4, k5, k6, k7, k8, k9, ka, kb, kc, kd, ke, kf, kg, kh, ki]| {
                        let linear = k0 * r.x + k1 * r.y + k2 * r.z + k3 * v.x + k4 * v.y + k5 * v.z;
                        let angular = k6 * rotation.x
                            + k7 * rotation.y
                            + k8 * rotation.z
                            + k9 * rates.x
                            + ka * rates.y
                            + kb * rates.z;
                        let motors = kc * f1 + kd * f2 + ke * f3 + kf * f4;
                        linear + angular + motors + (kg * i.x + kh * i.y + ki * i.z)
                    },
                )
            }
        }
    }
}

impl Chains {
    /// Signs of the thrust, roll, pitch and yaw part in the forces of M1 to M4.
    const SIGNS: [[f32; 4]; 4] =
        [[1.0, 1.0, 1.0, 1.0], [-1.0, -1.0, 1.0, 1.0], [-1.0, 1.0, 1.0, -1.0], [-1.0, 1.0, -1.0, 1.0]];

    /// The part that a column drives alone, by the pattern of its signs; every entry must have the same size.
    const fn of(feedback: &Gain<4, 19>) -> Option<Self> {
        const THRUST: usize = 0;
        const ROLL: usize = 1;
        const PITCH: usize = 2;
        const YAW: usize = 3;
        let rows = feedback.rows();
        let parts = [
            (0, PITCH),
            (1, ROLL),
            (2, THRUST),
            (3, PITCH),
            (4, ROLL),
            (5, THRUST),
            (6, ROLL),
            (7, PITCH),
            (8, YAW),
            (9, ROLL),
            (10, PITCH),
            (11, YAW),
            (16, PITCH),
            (17, ROLL),
            (18, THRUST),
        ];
        let mut rest: &[(usize, usize)] = &parts;
        while let Some(((column, part), after)) = rest.split_first() {
            if !has_signs(rows, *column, &Self::SIGNS[*part]) {
                return None;
            }
            rest = after;
        }
        // The block of the motors: what M_j adds to M_i depends only on how the two lie to each other.
        let [same, side, opposite, end] = [rows[0][12], rows[0][13], rows[0][14], rows[0][15]];
        let lying = [
            [same, side, opposite, end],
            [side, same, end, opposite],
            [opposite, end, same, side],
            [end, opposite, side, same],
        ];
        let mut i = 0;
        while i < 16 {
            if rows[i / 4][12 + i % 4] != lying[i / 4][i % 4] {
                return None;
            }
            i += 1;
        }
        // M2 shares a side (roll) with M1, M3 the yaw, M4 the end (pitch). Forces come as four times their parts.
        let of_forces = [
            0.25 * (same + side + opposite + end),
            0.25 * (same + side - opposite - end),
            0.25 * (same - side - opposite + end),
            0.25 * (same - side + opposite - end),
        ];
        // M3 has + in roll and pitch, M2 in yaw.
        let (m3, m2) = (rows[2], rows[1]);
        Some(Self {
            thrust: [m3[2], m3[5], of_forces[0], m3[18]],
            roll: [m3[1], m3[4], m3[6], m3[9], of_forces[1], m3[17]],
            pitch: [m3[0], m3[3], m3[7], m3[10], of_forces[2], m3[16]],
            yaw: [m2[8], m2[11], of_forces[3]],
        })
    }
}

/// Whether a column is one number times these signs.
const fn has_signs(rows: &[[f32; 19]; 4], column: usize, signs: &[f32; 4]) -> bool {
    let size = rows[0][column] * signs[0];
    size == rows[1][column] * signs[1] && size == rows[2][column] * signs[2] && size == rows[3][column] * signs[3]
}

/// What the gain is applied to.
struct Errors {
    position: Vector3<f32>,
    velocity: Vector3<f32>,
    rotation: Vector3<f32>,
    body_rates: Vector3<f32>,
    forces: MotorForces,
    integral: Vector3<f32>,
}

impl<'a> ActuatorAware<'a> {
    /// The law for a craft whose motors answer with `lag`: that of the design.
    pub const fn new(gain: &'a ActuatorAwareGain, airframe: &Airframe, lag: MotorLag) -> Self {
        let figures = airframe.figures();
        Self { gain, lag, force_min_n: figures.force_min_n, force_max_n: figures.force_max_n }
    }

    /// The lag that it reckons with.
    pub const fn lag(&self) -> &MotorLag {
        &self.lag
    }

    /// Commanded forces (N) within the motors' range and which of them were cut; nothing, and the memory as it was, where one
    /// of them is not finite.
    #[inline(always)]
    pub(crate) fn step(
        &self,
        memory: &mut ActuatorMemory,
        state: &Measured<'_>,
        body_rates_rad_s: &Vector3<f32>,
        reference: &MotorReference,
    ) -> Option<(MotorForces, MotorLimited)> {
        let target = &reference.reference;
        let heading = target.heading;
        let error = difference(state.position_m(), &target.state.position_m);
        let velocity = difference(state.velocity_m_s(), &target.state.velocity_m_s);
        let attitude = state.attitude_from(target.state.attitude);
        let ([f1, f2, f3, f4], [r1, r2, r3, r4]) = (memory.forces_n, reference.forces_n);
        let [k1, k2, k3, k4] = self.gain.feedback(&Errors {
            position: heading.to_heading_frame(error),
            velocity: heading.to_heading_frame(velocity),
            rotation: Vector3::new(2.0 * attitude.x, 2.0 * attitude.y, 2.0 * attitude.z),
            body_rates: difference(body_rates_rad_s, &target.input.body_rates_rad_s),
            forces: [f1 - r1, f2 - r2, f3 - r3, f4 - r4],
            integral: heading.to_heading_frame(memory.integral_m_s),
        });
        let [u1, u2, u3, u4] = reference.commands_n(self.lag.lag_s());
        let asked = [u1 + k1, u2 + k2, u3 + k3, u4 + k4];
        let (commands, limited) = saturate_each(&asked, self.force_min_n, self.force_max_n)?;
        memory.forces_n = self.lag.next(&memory.forces_n, &commands);
        if !limited.any() {
            let (h, i) = (self.lag.period_s(), &memory.integral_m_s);
            memory.integral_m_s = Vector3::new(i.x + h * error.x, i.y + h * error.y, i.z + h * error.z);
        }
        Some((commands, limited))
    }
}
