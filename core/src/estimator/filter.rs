//! The filter's two steps: prediction by inertial sensors, correction by a measurement.

use nalgebra::{Matrix3, Vector3};

use super::column::{Column, Group};
use super::config::EstimatorConfig;
use super::covariance::Covariance;
use super::error::{EstimatorError, EstimatorFigure, all_within, within};
use super::estimate::Estimate;
use super::motion::{Imu, Motion, corrected};
use crate::math::sqrt;
use crate::state::{NORM_SQUARED_TOLERANCE, State};

/// Largest body rate that is taken, rad/s: above the range of any gyroscope on small craft (4000 degrees per second).
pub const BODY_RATE_MAX_RAD_S: f32 = 100.0;
/// Largest specific force that is taken along an axis, m/s^2: above the range of the accelerometers (24 to 100 g).
pub const SPECIFIC_FORCE_MAX_M_S2: f32 = 1000.0;
/// Longest time that one prediction may span, s.
pub const PERIOD_MAX_S: f32 = 0.1;
/// Furthest position along an axis, m. A step of f32 is 1 mm there.
pub const POSITION_MAX_M: f32 = 10_000.0;
/// Largest velocity along an axis, m/s.
pub const VELOCITY_MAX_M_S: f32 = 300.0;
/// Largest turn within one prediction or correction, rad: as far as the series go.
pub const TURN_MAX_RAD: f32 = 1.0;

/// The share that a correction adds to the variances, as a part of those before it: more than f32 rounds in taking a large
/// variance down to a small one (nine errors, some three roundings of 6e-8 each), so that the covariance stays
/// positive. A position that was known to 10 m is then known to 14 mm by its first measurement, and better by the next.
const ROUNDING: f32 = 2e-6;

impl Imu {
    /// Every number within the range of a sensor.
    pub(super) fn check(&self) -> Result<(), EstimatorError> {
        let (rates, force) = (&self.body_rates_rad_s, &self.specific_force_m_s2);
        all_within(EstimatorFigure::BodyRates, [rates.x, rates.y, rates.z], BODY_RATE_MAX_RAD_S)?;
        all_within(EstimatorFigure::SpecificForce, [force.x, force.y, force.z], SPECIFIC_FORCE_MAX_M_S2)
    }
}

/// The innovation of a measurement of `N` numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation<const N: usize> {
    /// Measured minus predicted, in the measurement's unit; of an attitude the rotation vector from the predicted to
    /// the measured, body frame, rad.
    pub difference: [f32; N],
    /// Variance of each that the filter expects.
    pub variance: [f32; N],
    /// The normalised innovation squared, `d' S^-1 d` with the expected covariance S: of a consistent filter it has the
    /// chi-square distribution with `N` degrees of freedom, mean `N`.
    pub normalised_squared: f32,
    /// Whether it has passed the gate and been taken.
    pub is_taken: bool,
}

/// One number of a measurement: a row of its matrix that is zero but in one group of errors.
pub(super) struct Row {
    pub(super) direction: Vector3<f32>,
    /// Measured minus predicted.
    pub(super) difference: f32,
    pub(super) variance: f32,
}

/// The error-state Kalman filter: craft and sensors as configured. Its state is in an [`Estimate`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimator {
    config: EstimatorConfig,
}

impl Estimator {
    /// A filter for these figures.
    ///
    /// # Errors
    /// [`EstimatorError::OutOfRange`] names the first figure that makes no sense.
    pub const fn new(config: EstimatorConfig) -> Result<Self, EstimatorError> {
        match config.checked() {
            Ok(config) => Ok(Self { config }),
            Err(error) => Err(error),
        }
    }

    /// The figures.
    pub const fn config(&self) -> &EstimatorConfig {
        &self.config
    }

    /// An estimate to begin with, as well known as [`EstimatorConfig::at_start`] says.
    ///
    /// # Errors
    /// [`EstimatorError::OutOfRange`] for a state that is none.
    pub fn start(&self, state: &State) -> Result<Estimate, EstimatorError> {
        check_position(&state.position_m)?;
        check_velocity(&state.velocity_m_s)?;
        let norm_squared = state.attitude.dot(state.attitude);
        let (min, max) = (1.0 - NORM_SQUARED_TOLERANCE, 1.0 + NORM_SQUARED_TOLERANCE);
        within(EstimatorFigure::AttitudeNorm, norm_squared, min, max)?;
        let state = state.validated().map_err(|_| EstimatorError::Restarted)?;
        Ok(Estimate { state, covariance: self.covariance_at_start() })
    }

    fn covariance_at_start(&self) -> Covariance {
        let start = &self.config.at_start;
        let [r, v] = [start.position_m, start.velocity_m_s].map(|deviation| deviation * deviation);
        let [tilt, heading] = [start.tilt_rad, start.heading_rad].map(|deviation| deviation * deviation);
        Covariance::of_variances(&Column {
            position: Vector3::new(r, r, r),
            velocity: Vector3::new(v, v, v),
            attitude: Vector3::new(tilt, tilt, heading),
        })
    }

    /// Carries an estimate on over `period_s` by the mean of the inertial measurements in it.
    ///
    /// # Errors
    /// [`EstimatorError::OutOfRange`] where a number is none or beyond a sensor's range, the period is not within
    /// [`PERIOD_MAX_S`], or the craft turns by more than [`TURN_MAX_RAD`] in it; [`EstimatorError::Restarted`].
    pub fn predict(&self, estimate: &mut Estimate, imu: &Imu, period_s: f32) -> Result<(), EstimatorError> {
        imu.check()?;
        within(EstimatorFigure::Period, period_s, f32::MIN_POSITIVE, PERIOD_MAX_S)?;
        let turn = sqrt(imu.body_rates_rad_s.dot(&imu.body_rates_rad_s)) * period_s;
        within(EstimatorFigure::Turn, turn, 0.0, TURN_MAX_RAD)?;
        let motion = Motion::over(&self.config, &estimate.state, imu, period_s);
        // White noise over the period: half of it before and half of it after, which integrates it by the trapezoidal
        // rule.
        let half = 0.5 * period_s;
        let [ax, ay, az] = self.config.acceleration_noise;
        let [gx, gy, gz] = self.config.gyro_noise;
        let rotation = &motion.rotation;
        let body = Vector3::new(ax * ax * half, ay * ay * half, az * az * half);
        let velocity = rotation * Matrix3::from_diagonal(&body) * rotation.transpose();
        let attitude = Vector3::new(gx * gx * half, gy * gy * half, gz * gz * half);
        let mut covariance = estimate.covariance;
        covariance.add_noise(&velocity, &attitude);
        covariance.carry(&motion.transition);
        covariance.add_noise(&velocity, &attitude);
        self.commit(estimate, &motion.state, &mut covariance)
    }

    /// Takes the rows of a measurement one after the other, which for independent numbers is the same as together.
    pub(super) fn correct<const N: usize>(
        &self,
        estimate: &mut Estimate,
        group: Group,
        rows: &[Row; N],
    ) -> Result<Innovation<N>, EstimatorError> {
        let before = estimate.covariance.block(group);
        let difference = rows.each_ref().map(|row| row.difference);
        let variance = rows.each_ref().map(|row| row.direction.dot(&(before * row.direction)) + row.variance);
        let mut covariance = estimate.covariance;
        let mut error = Column::ZERO;
        let mut normalised_squared = 0.0;
        for row in rows {
            let column = covariance.column(group, &row.direction);
            let own = column.of(group).dot(&row.direction);
            // Roundings may leave a variance a little below zero.
            let own = if own > 0.0 { own } else { 0.0 };
            let inverse = 1.0 / (own + row.variance);
            let gain = Column::ZERO.plus(&column, inverse);
            // The part that the rows before have already explained.
            let left = row.difference - row.direction.dot(error.of(group));
            normalised_squared += left * left * inverse;
            error = error.plus(&gain, left);
            covariance.subtract(&gain, &column);
        }
        let is_taken = self.config.gate.admits(N, normalised_squared);
        if is_taken {
            let turn = sqrt(error.attitude.dot(&error.attitude));
            let shorter = if turn > TURN_MAX_RAD { TURN_MAX_RAD / turn } else { 1.0 };
            let (attitude, back) = corrected(estimate.state.attitude, &(error.attitude * shorter));
            let state = State {
                position_m: estimate.state.position_m + error.position,
                attitude,
                velocity_m_s: estimate.state.velocity_m_s + error.velocity,
            };
            covariance.turn(&back);
            covariance.widen(&estimate.covariance, ROUNDING);
            self.commit(estimate, &state, &mut covariance)?;
        }
        Ok(Innovation { difference, variance, normalised_squared, is_taken })
    }

    /// Makes a step's outcome the estimate, if it is one.
    fn commit(
        &self,
        estimate: &mut Estimate,
        state: &State,
        covariance: &mut Covariance,
    ) -> Result<(), EstimatorError> {
        let (min, max) = (self.config.deviation_min, self.config.deviation_max);
        covariance.bound(min * min, max * max);
        let is_state = check_position(&state.position_m).is_ok()
            && check_velocity(&state.velocity_m_s).is_ok()
            && state.attitude.dot(state.attitude).is_finite();
        if is_state && covariance.is_finite() {
            *estimate = Estimate { state: *state, covariance: *covariance };
            Ok(())
        } else {
            estimate.covariance = self.covariance_at_start();
            Err(EstimatorError::Restarted)
        }
    }
}

pub(super) fn check_position(position_m: &Vector3<f32>) -> Result<(), EstimatorError> {
    all_within(EstimatorFigure::Position, [position_m.x, position_m.y, position_m.z], POSITION_MAX_M)
}

pub(super) fn check_velocity(velocity_m_s: &Vector3<f32>) -> Result<(), EstimatorError> {
    all_within(EstimatorFigure::Velocity, [velocity_m_s.x, velocity_m_s.y, velocity_m_s.z], VELOCITY_MAX_M_S)
}
