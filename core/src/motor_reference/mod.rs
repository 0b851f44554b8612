//! The reference carried on to the motors: the flat output to its fifth derivative, and any heading to its third, in;
//! state, angular acceleration, motor forces and the commands that give them out, checked once.
//!
//! The paper's flat map ends at body rates, which take the jerk. Torque takes the angular acceleration and so the snap;
//! its rate, which a motor that lags has to be ahead by, takes the fifth derivative.

mod angular;

use nalgebra::Vector3;

pub(crate) use self::angular::{Motion, Turn, Turning};
use crate::airframe::Airframe;
use crate::command::Command;
use crate::error::{Field, ReferenceError, first_non_finite};
use crate::mixer::Parts;
use crate::motor_lag::MotorForces;
use crate::quaternion::Heading;
use crate::reference::{FlatSample, Reference};
use crate::state::State;

/// The flat output and its derivatives at one time, as far as the motor forces and their rates depend on it; world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FifthOrderSample {
    /// Position to jerk, heading and its rate.
    pub flat: FlatSample,
    /// Snap, fourth derivative of the position, m/s^4.
    pub snap_m_s4: Vector3<f32>,
    /// Crackle, fifth derivative of the position, m/s^5.
    pub crackle_m_s5: Vector3<f32>,
    /// Second derivative of the heading, rad/s^2.
    pub heading_acceleration_rad_s2: f32,
    /// Third derivative of the heading, rad/s^3.
    pub heading_jerk_rad_s3: f32,
}

impl FifthOrderSample {
    /// Rest at a position and heading.
    pub const fn at_rest(position_m: Vector3<f32>, heading_rad: f32) -> Self {
        Self::of_jerk(FlatSample::at_rest(position_m, heading_rad))
    }

    /// A sample of which no more than the jerk is known: the rest is taken for zero.
    pub const fn of_jerk(flat: FlatSample) -> Self {
        const ZERO: Vector3<f32> = Vector3::new(0.0, 0.0, 0.0);
        Self { flat, snap_m_s4: ZERO, crackle_m_s5: ZERO, heading_acceleration_rad_s2: 0.0, heading_jerk_rad_s3: 0.0 }
    }

    /// The first number that is not finite.
    #[cold]
    fn fault(&self) -> Option<ReferenceError> {
        let (s, c) = (&self.snap_m_s4, &self.crackle_m_s5);
        let fields = [Field::SnapAndCrackle, Field::SnapAndCrackle, Field::HeadingDerivatives];
        let values = [s.x, s.y, s.z, c.x, c.y, c.z, self.heading_acceleration_rad_s2, self.heading_jerk_rad_s3];
        self.flat.fault().or_else(|| {
            first_non_finite(&fields, &values).map(|(field, value)| ReferenceError::NonFinite { field, value })
        })
    }
}

/// A flyable reference with the motor forces that fly it: finite, with thrust, upright enough for the flat map. Only this
/// module makes one. The forces may be beyond the range of the motors.
///
/// ```
/// use quatrack::nalgebra::Vector3;
/// use quatrack::{Airframe, MotorReference};
///
/// let airframe = Airframe::CRAZYFLIE_2_1;
/// let hover = MotorReference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0, &airframe)?;
/// // A quarter of the weight of 29 g each.
/// assert!(hover.forces_n().iter().all(|force| (force - 0.25 * 0.029 * 9.81).abs() < 1e-6));
/// # Ok::<(), quatrack::ReferenceError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorReference {
    pub(crate) reference: Reference,
    pub(crate) angular_acceleration_rad_s2: Vector3<f32>,
    pub(crate) forces_n: MotorForces,
    /// The commands that give these forces behind the airframe's motor lag.
    pub(crate) commands_n: MotorForces,
}

impl MotorReference {
    /// Hover at a position and heading.
    ///
    /// # Errors
    /// [`ReferenceError::NonFinite`].
    pub fn hover(position_m: Vector3<f32>, heading_rad: f32, airframe: &Airframe) -> Result<Self, ReferenceError> {
        Self::from_flat(&FifthOrderSample::at_rest(position_m, heading_rad), airframe)
    }

    /// The reference that flies a flat output with a craft.
    ///
    /// # Errors
    /// [`ReferenceError`] where a number is not finite and at the flat map's singularities.
    pub fn from_flat(sample: &FifthOrderSample, airframe: &Airframe) -> Result<Self, ReferenceError> {
        let FlatSample { position_m: r, velocity_m_s: v, .. } = &sample.flat;
        // Every number that the motor forces depend on shows in them; position and velocity do not.
        if ((r.x + r.y + r.z) + (v.x + v.y + v.z)).is_finite() {
            let mapped = Self::of_finite(sample, airframe);
            if mapped.is_ok() {
                return mapped;
            }
        }
        match sample.fault() {
            Some(fault) => Err(fault),
            None => Self::of_finite(sample, airframe),
        }
    }

    /// The same for a caller that knows sine and cosine of the heading; the sample's own angle is not looked at.
    ///
    /// # Errors
    /// Those of [`Self::from_flat`].
    #[inline]
    pub fn from_flat_at(
        sample: &FifthOrderSample,
        heading: Heading,
        airframe: &Airframe,
    ) -> Result<Self, ReferenceError> {
        let FlatSample { position_m: r, velocity_m_s: v, .. } = &sample.flat;
        if ((r.x + r.y + r.z) + (v.x + v.y + v.z)).is_finite() {
            return Self::of_sample(sample, heading, airframe);
        }
        // Not finite, or near the end of f32.
        Err(sample.fault().unwrap_or(ReferenceError::NonFinite { field: Field::Position, value: f32::INFINITY }))
    }

    /// The same for a sample whose position and velocity are known to be finite.
    #[inline(never)]
    pub(crate) fn of_finite(sample: &FifthOrderSample, airframe: &Airframe) -> Result<Self, ReferenceError> {
        Self::of_sample(sample, Heading::from_angle_inlined(sample.flat.heading_rad), airframe)
    }

    #[inline(always)]
    fn of_sample(sample: &FifthOrderSample, heading: Heading, airframe: &Airframe) -> Result<Self, ReferenceError> {
        let flat = &sample.flat;
        let motion = Motion {
            acceleration: flat.acceleration_m_s2,
            jerk: flat.jerk_m_s3,
            snap: sample.snap_m_s4,
            crackle: sample.crackle_m_s5,
        };
        let (second, third) = (sample.heading_acceleration_rad_s2, sample.heading_jerk_rad_s3);
        let turn = Turn::at(heading, [flat.heading_rate_rad_s, second, third]);
        Self::of_motion(&flat.position_m, &flat.velocity_m_s, &motion, Some(&turn), airframe)
    }

    /// The same from its parts. Inlined, so that none of them has to be in memory.
    #[inline(always)]
    pub(crate) fn of_motion(
        position_m: &Vector3<f32>,
        velocity_m_s: &Vector3<f32>,
        motion: &Motion,
        turn: Option<&Turn>,
        airframe: &Airframe,
    ) -> Result<Self, ReferenceError> {
        let turning = Turning::of(motion, turn)?;
        let ([p, q, r], [p1, q1, r1]) = (turning.rates, turning.acceleration);
        let (forces, rates) = turning.force_parts(airframe);
        let lead_s = airframe.lead_s;
        let commands = Parts {
            thrust: forces.thrust + lead_s * rates.thrust,
            roll: forces.roll + lead_s * rates.roll,
            pitch: forces.pitch + lead_s * rates.pitch,
            yaw: forces.yaw + lead_s * rates.yaw,
        };
        // Every derivative is in one of the commands; a number that is not finite stays so in their sum.
        let sum = (commands.thrust + commands.roll) + (commands.pitch + commands.yaw);
        if sum.to_bits() << 1 >= f32::INFINITY.to_bits() << 1 {
            return Err(beyond_range(sum));
        }
        Ok(Self {
            reference: Reference {
                state: State { position_m: *position_m, attitude: turning.attitude, velocity_m_s: *velocity_m_s },
                input: Command { thrust_m_s2: turning.thrust, body_rates_rad_s: Vector3::new(p, q, r) },
                acceleration_m_s2: motion.acceleration,
                jerk_m_s3: motion.jerk,
                heading: turning.heading,
                heading_rate_rad_s: turn.map_or(0.0, Turn::rate_rad_s),
            },
            angular_acceleration_rad_s2: Vector3::new(p1, q1, r1),
            forces_n: forces.forces(),
            commands_n: commands.forces(),
        })
    }

    /// As the paper's laws take it: state, thrust and body rates.
    pub fn reference(&self) -> &Reference {
        &self.reference
    }

    /// Position, attitude and velocity to be at.
    pub fn state(&self) -> &State {
        &self.reference.state
    }

    /// Body rates, rad/s.
    pub fn body_rates_rad_s(&self) -> Vector3<f32> {
        self.reference.input.body_rates_rad_s
    }

    /// Their rate in the body frame, rad/s^2.
    pub fn angular_acceleration_rad_s2(&self) -> Vector3<f32> {
        self.angular_acceleration_rad_s2
    }

    /// Motor forces M1 to M4, N.
    pub fn forces_n(&self) -> MotorForces {
        self.forces_n
    }

    /// Commands that give these forces behind the motor lag of the airframe that the reference was made for, `f + tau
    /// df/dt`, N; with half a control period beside tau where that is [`Airframe::commanded_at`] a rate.
    pub fn commands_n(&self) -> MotorForces {
        self.commands_n
    }
}

impl Turning {
    /// The motor forces of the turning and their rates, in parts, N and N/s.
    #[inline(always)]
    pub(crate) fn force_parts(&self, airframe: &Airframe) -> (Parts, Parts) {
        let ([p, q, r], [p1, q1, r1], [p2, q2, r2]) = (self.rates, self.acceleration, self.jerk);
        // Euler's equations and their derivative, with inertia over four levers.
        let mixing = &airframe.mixing;
        let ([ix, iy, iz], [gx, gy, gz]) = (mixing.inertia, mixing.gyroscopic);
        let forces = Parts {
            thrust: mixing.quarter_mass_kg * self.thrust,
            roll: ix * p1 + gx * (q * r),
            pitch: iy * q1 + gy * (p * r),
            yaw: iz * r1 + gz * (p * q),
        };
        let rates = Parts {
            thrust: mixing.quarter_mass_kg * self.thrust_rate,
            roll: ix * p2 + gx * (q1 * r + q * r1),
            pitch: iy * q2 + gy * (p1 * r + p * r1),
            yaw: iz * r2 + gz * (p1 * q + p * q1),
        };
        (forces, rates)
    }
}

/// The rates of the motor forces left the range of f32.
#[cold]
fn beyond_range(value: f32) -> ReferenceError {
    ReferenceError::NonFinite { field: Field::SnapAndCrackle, value }
}
