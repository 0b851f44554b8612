//! The reference: the flat output and its derivatives (world frame, SI) in; the state and input that fly it out, checked
//! once.

use nalgebra::Vector3;

use crate::command::Command;
use crate::error::{Field, ReferenceError, first_non_finite};
use crate::flatness::{AttitudeAndInput, Tilt};
use crate::quaternion::Heading;
use crate::state::State;

/// The flat output and its derivatives at one time, world frame; as a planner or a stored trajectory gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FlatSample {
    /// Position, m.
    pub position_m: Vector3<f32>,
    /// Velocity, m/s.
    pub velocity_m_s: Vector3<f32>,
    /// Acceleration without gravity, m/s^2.
    pub acceleration_m_s2: Vector3<f32>,
    /// Jerk, m/s^3.
    pub jerk_m_s3: Vector3<f32>,
    /// Heading psi of `q = q_tilt(n) q_z(psi)`, rad; within +-2000.
    pub heading_rad: f32,
    /// Its rate, rad/s.
    pub heading_rate_rad_s: f32,
}

impl FlatSample {
    /// Rest at a position and heading.
    pub const fn at_rest(position_m: Vector3<f32>, heading_rad: f32) -> Self {
        const ZERO: Vector3<f32> = Vector3::new(0.0, 0.0, 0.0);
        Self {
            position_m,
            velocity_m_s: ZERO,
            acceleration_m_s2: ZERO,
            jerk_m_s3: ZERO,
            heading_rad,
            heading_rate_rad_s: 0.0,
        }
    }

    /// Whether every number is finite; false, too, for some near the end of f32.
    #[inline(always)]
    fn is_finite(&self) -> bool {
        let Self { position_m: r, velocity_m_s: v, acceleration_m_s2: a, jerk_m_s3: j, .. } = self;
        // A sum is finite only if all of its terms are; the converse fails only for numbers near the end of f32.
        let sum = (r.x + r.y + r.z) + (v.x + v.y + v.z) + (a.x + a.y + a.z) + (j.x + j.y + j.z);
        (sum + self.heading_rad + self.heading_rate_rad_s).is_finite()
    }

    /// The first number that is not finite.
    #[cold]
    pub(crate) fn fault(&self) -> Option<ReferenceError> {
        let Self { position_m: r, velocity_m_s: v, acceleration_m_s2: a, jerk_m_s3: j, .. } = self;
        let (psi, rate) = (self.heading_rad, self.heading_rate_rad_s);
        let fields =
            [Field::Position, Field::Velocity, Field::Acceleration, Field::Jerk, Field::Heading, Field::HeadingRate];
        let values = [r.x, r.y, r.z, v.x, v.y, v.z, a.x, a.y, a.z, j.x, j.y, j.z, psi, 0.0, 0.0, rate];
        first_non_finite(&fields, &values).map(|(field, value)| ReferenceError::NonFinite { field, value })
    }
}

/// A flyable reference: finite, with thrust, upright enough for the flat map. Only this module makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    pub(crate) state: State,
    pub(crate) input: Command,
    pub(crate) acceleration_m_s2: Vector3<f32>,
    pub(crate) jerk_m_s3: Vector3<f32>,
    pub(crate) heading: Heading,
    pub(crate) heading_rate_rad_s: f32,
}

impl Reference {
    /// Hover at a position and heading.
    ///
    /// # Errors
    /// [`ReferenceError::NonFinite`].
    pub fn hover(position_m: Vector3<f32>, heading_rad: f32) -> Result<Self, ReferenceError> {
        Self::from_flat(&FlatSample::at_rest(position_m, heading_rad))
    }

    /// The state and input that fly a flat output, by the flat map (5).
    ///
    /// # Errors
    /// [`ReferenceError`] where a number is not finite and at the map's singularities.
    pub fn from_flat(sample: &FlatSample) -> Result<Self, ReferenceError> {
        if !sample.is_finite()
            && let Some(fault) = sample.fault()
        {
            return Err(fault);
        }
        Self::of_finite(sample)
    }

    /// The same for a caller that knows sine and cosine of the heading; the sample's own angle is not looked at.
    ///
    /// # Errors
    /// Those of [`Self::from_flat`].
    #[inline]
    pub fn from_flat_at(sample: &FlatSample, heading: Heading) -> Result<Self, ReferenceError> {
        let tilt = Tilt::new(sample.acceleration_m_s2, sample.jerk_m_s3);
        if !(sample.is_finite() && tilt.is_regular()) {
            return Err(fault(sample));
        }
        Ok(Self::of_map(sample, heading, &tilt.with_heading(heading, sample.heading_rate_rad_s)))
    }

    /// Overwrites a reference in place with the result of [`Self::from_flat_at`], for a sample whose numbers were
    /// looked at where they came from; where there is nothing to be given it stays as it was. A position or velocity that
    /// is not finite all the same shows as an error of the step that follows it.
    ///
    /// # Errors
    /// [`ReferenceError`] at the singularities of the flat map.
    #[inline(always)]
    pub fn move_to_finite_flat(&mut self, sample: &FlatSample, heading: Heading) -> Result<(), ReferenceError> {
        let tilt = Tilt::new(sample.acceleration_m_s2, sample.jerk_m_s3);
        if !tilt.is_regular() {
            return Err(fault(sample));
        }
        *self = Self::of_map(sample, heading, &tilt.with_heading(heading, sample.heading_rate_rad_s));
        Ok(())
    }

    /// The same for a sample that is known to be finite.
    #[inline(always)]
    pub(crate) fn of_finite(sample: &FlatSample) -> Result<Self, ReferenceError> {
        let tilt = Tilt::new(sample.acceleration_m_s2, sample.jerk_m_s3);
        if !tilt.is_regular() {
            return Err(tilt.fault());
        }
        // Most flights do not turn: heading 0 needs no sine and no products with it.
        let (heading, mapped) = if sample.heading_rad == 0.0 {
            (Heading::ZERO, tilt.straight(sample.heading_rate_rad_s))
        } else {
            let heading = Heading::from_angle(sample.heading_rad);
            (heading, tilt.with_heading(heading, sample.heading_rate_rad_s))
        };
        Ok(Self::of_map(sample, heading, &mapped))
    }

    #[inline(always)]
    fn of_map(sample: &FlatSample, heading: Heading, mapped: &AttitudeAndInput) -> Self {
        Self {
            state: State {
                position_m: sample.position_m,
                attitude: mapped.attitude,
                velocity_m_s: sample.velocity_m_s,
            },
            input: mapped.input,
            acceleration_m_s2: sample.acceleration_m_s2,
            jerk_m_s3: sample.jerk_m_s3,
            heading,
            heading_rate_rad_s: sample.heading_rate_rad_s,
        }
    }

    /// Position, attitude and velocity to be at.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Thrust and body rates that keep the craft on the reference.
    pub fn input(&self) -> &Command {
        &self.input
    }

    /// This reference with the input of one that lies ahead: a command that is held for a period moves the craft like the
    /// input of the middle of the period, so that feeding forward the input half a period ahead leaves the hold's error
    /// one order smaller. For the equilibrium laws; the flat output law's acceleration is error and input in one.
    pub fn with_input_of(self, ahead: &Self) -> Self {
        Self { input: ahead.input, ..self }
    }

    /// Acceleration without gravity, world frame, m/s^2.
    pub fn acceleration_m_s2(&self) -> Vector3<f32> {
        self.acceleration_m_s2
    }

    /// Jerk, world frame, m/s^3.
    pub fn jerk_m_s3(&self) -> Vector3<f32> {
        self.jerk_m_s3
    }

    /// Heading of the attitude.
    pub fn heading(&self) -> Heading {
        self.heading
    }
}

/// Why a sample has no reference, or none that can be told from one that is not finite.
#[cold]
#[inline(never)]
fn fault(sample: &FlatSample) -> ReferenceError {
    let tilt = Tilt::new(sample.acceleration_m_s2, sample.jerk_m_s3);
    match sample.fault() {
        Some(fault) => fault,
        None if tilt.is_regular() => ReferenceError::NonFinite { field: Field::Position, value: sample.position_m.x },
        None => tilt.fault(),
    }
}
