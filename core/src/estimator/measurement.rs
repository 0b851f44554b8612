//! Measurements that a filter takes: position, velocity, attitude, both halves of a pose, height, distance from a point.
//!
//! The numbers of a measurement have independent noise with one standard deviation.

use nalgebra::Vector3;

use super::column::Group;
use super::error::{EstimatorError, EstimatorFigure, within};
use super::estimate::Estimate;
use super::filter::{Estimator, Innovation, POSITION_MAX_M, Row, check_position, check_velocity};
use crate::math::sqrt;
use crate::quaternion::Quaternion;
use crate::state::{NORM_SQUARED_TOLERANCE, State};

/// Largest standard deviation of a measurement, in its unit.
const DEVIATION_MAX: f32 = 1e3;
/// Least: its square is a normal number with digits left beside the variances of a state.
const DEVIATION_MIN: f32 = 1e-6;
/// Nearest to a point that the direction from it is known, m.
const DISTANCE_MIN_M: f32 = 1e-3;

fn variance(deviation: f32) -> Result<f32, EstimatorError> {
    within(EstimatorFigure::MeasurementDeviation, deviation, DEVIATION_MIN, DEVIATION_MAX)?;
    Ok(deviation * deviation)
}

/// One row for each axis.
fn rows(difference: &Vector3<f32>, variance: f32) -> [Row; 3] {
    [
        Row { direction: Vector3::new(1.0, 0.0, 0.0), difference: difference.x, variance },
        Row { direction: Vector3::new(0.0, 1.0, 0.0), difference: difference.y, variance },
        Row { direction: Vector3::new(0.0, 0.0, 1.0), difference: difference.z, variance },
    ]
}

/// The rotation vector of a unit quaternion's shorter way, rad: `2 v (1 + |v|^2 / 6 + 3 |v|^4 / 40)`, the arcsine's
/// series; 8 % short at a right angle, exact to `|v|^7 / 11` near 0.
fn rotation_vector(q: Quaternion) -> Vector3<f32> {
    let v = if q.w < 0.0 { -q.vector() } else { q.vector() };
    let v2 = v.dot(&v);
    v * (2.0 + v2 * (1.0 / 3.0 + v2 * (3.0 / 20.0)))
}

impl Estimator {
    /// Takes a measured position, world frame, m.
    ///
    /// # Errors
    /// [`EstimatorError::OutOfRange`] for a position or a standard deviation out of range: nothing changes.
    /// [`EstimatorError::Restarted`].
    pub fn update_position(
        &self,
        estimate: &mut Estimate,
        position_m: &Vector3<f32>,
        deviation_m: f32,
    ) -> Result<Innovation<3>, EstimatorError> {
        check_position(position_m)?;
        let rows = rows(&(position_m - estimate.state.position_m), variance(deviation_m)?);
        self.correct(estimate, Group::Position, &rows)
    }

    /// Takes a measured velocity, world frame, m/s.
    ///
    /// # Errors
    /// As [`Self::update_position`].
    pub fn update_velocity(
        &self,
        estimate: &mut Estimate,
        velocity_m_s: &Vector3<f32>,
        deviation_m_s: f32,
    ) -> Result<Innovation<3>, EstimatorError> {
        check_velocity(velocity_m_s)?;
        let rows = rows(&(velocity_m_s - estimate.state.velocity_m_s), variance(deviation_m_s)?);
        self.correct(estimate, Group::Velocity, &rows)
    }

    /// Takes a measured attitude; the standard deviation is that about each body axis, rad.
    ///
    /// # Errors
    /// As [`Self::update_position`]; the quaternion's norm may be off as far as [`State::validated`] takes it.
    pub fn update_attitude(
        &self,
        estimate: &mut Estimate,
        attitude: Quaternion,
        deviation_rad: f32,
    ) -> Result<Innovation<3>, EstimatorError> {
        let norm_squared = attitude.dot(attitude);
        let (min, max) = (1.0 - NORM_SQUARED_TOLERANCE, 1.0 + NORM_SQUARED_TOLERANCE);
        within(EstimatorFigure::AttitudeNorm, norm_squared, min, max)?;
        let measured = State { attitude, ..estimate.state }.validated().map_err(|_| EstimatorError::Restarted)?;
        let from_estimate = estimate.state.attitude.conjugate() * measured.attitude;
        let rows = rows(&rotation_vector(from_estimate), variance(deviation_rad)?);
        self.correct(estimate, Group::Attitude, &rows)
    }

    /// Takes a measured pose: its position, then its attitude.
    ///
    /// # Errors
    /// As [`Self::update_position`] and [`Self::update_attitude`]; where the attitude is refused, so is the position.
    pub fn update_pose(
        &self,
        estimate: &mut Estimate,
        position_m: &Vector3<f32>,
        attitude: Quaternion,
        deviation_m: f32,
        deviation_rad: f32,
    ) -> Result<(Innovation<3>, Innovation<3>), EstimatorError> {
        let mut next = *estimate;
        let position = self.update_position(&mut next, position_m, deviation_m)?;
        let attitude = self.update_attitude(&mut next, attitude, deviation_rad)?;
        *estimate = next;
        Ok((position, attitude))
    }

    /// Takes a measured height above the world's origin, m.
    ///
    /// # Errors
    /// As [`Self::update_position`].
    pub fn update_height(
        &self,
        estimate: &mut Estimate,
        height_m: f32,
        deviation_m: f32,
    ) -> Result<Innovation<1>, EstimatorError> {
        within(EstimatorFigure::Position, height_m, -POSITION_MAX_M, POSITION_MAX_M)?;
        let variance = variance(deviation_m)?;
        let direction = Vector3::new(0.0, 0.0, 1.0);
        let row = Row { direction, difference: height_m - estimate.state.position_m.z, variance };
        self.correct(estimate, Group::Position, &[row])
    }

    /// Takes a measured distance from a known point, m, as ultra-wideband radio gives it.
    ///
    /// # Errors
    /// As [`Self::update_position`]; also where the estimate is nearer to the point than 1 mm, which has no direction.
    pub fn update_distance(
        &self,
        estimate: &mut Estimate,
        point_m: &Vector3<f32>,
        distance_m: f32,
        deviation_m: f32,
    ) -> Result<Innovation<1>, EstimatorError> {
        check_position(point_m)?;
        within(EstimatorFigure::Position, distance_m, 0.0, POSITION_MAX_M)?;
        let variance = variance(deviation_m)?;
        let from_point = estimate.state.position_m - point_m;
        let predicted = sqrt(from_point.dot(&from_point));
        within(EstimatorFigure::Position, predicted, DISTANCE_MIN_M, f32::MAX)?;
        let row = Row { direction: from_point / predicted, difference: distance_m - predicted, variance };
        self.correct(estimate, Group::Position, &[row])
    }
}

#[cfg(test)]
mod tests {
    use super::super::{EstimatorConfig, Imu};
    use super::*;

    const ESTIMATOR: Result<Estimator, EstimatorError> =
        Estimator::new(EstimatorConfig { deviation_min: 1e-5, ..EstimatorConfig::CRAZYFLIE });

    fn at_home() -> (Estimator, Estimate) {
        let estimator = ESTIMATOR.unwrap();
        let estimate = estimator.start(&State::at_rest(Vector3::new(3.0, 4.0, 0.0))).unwrap();
        (estimator, estimate)
    }

    /// Two numbers with variances P and R weigh each other: mean `R x + P z` over `P + R`, variance `P R` over it.
    #[test]
    fn a_measurement_weighs_by_its_variance() {
        let (estimator, mut estimate) = at_home();
        let found = estimator.update_velocity(&mut estimate, &Vector3::new(0.03, 0.0, 0.0), 0.02).unwrap();
        let (p, r) = (1e-4_f32, 4e-4);
        assert!((found.variance[0] / (p + r) - 1.0).abs() < 1e-6);
        assert!((found.normalised_squared - 9e-4 / (p + r)).abs() < 1e-5);
        assert!((estimate.state().velocity_m_s.x - 0.03 * p / (p + r)).abs() < 1e-8);
        // The filter adds 2e-6 of P for its roundings.
        assert!((estimate.covariance().velocity.m11 / (p * r / (p + r)) - 1.0).abs() < 4e-6);
    }

    #[test]
    fn a_distance_and_a_height_are_taken_along_their_direction() {
        let (estimator, mut estimate) = at_home();
        let origin = Vector3::new(0.0, 0.0, 0.0);
        let distance = estimator.update_distance(&mut estimate, &origin, 5.5, 0.1).unwrap();
        // Half a metre away from the point, along (0.6, 0.8); a variance of 100 m^2 leaves it to the measurement.
        assert!((distance.difference[0] - 0.5).abs() < 1e-6 && (distance.variance[0] - 100.01).abs() < 1e-4);
        assert!((estimate.state().position_m - Vector3::new(3.3, 4.4, 0.0)).norm() < 1e-3);
        estimator.update_height(&mut estimate, 1.5, 0.1).unwrap();
        assert!((estimate.state().position_m - Vector3::new(3.3, 4.4, 1.5)).norm() < 1e-3);
        let nowhere = estimate.state().position_m;
        let refused = estimator.update_distance(&mut estimate, &nowhere, 1.0, 0.1);
        assert!(matches!(refused, Err(EstimatorError::OutOfRange { figure: EstimatorFigure::Position, .. })));
    }

    #[test]
    fn an_attitude_of_either_sign_turns_the_estimate_towards_it() {
        for sign in [1.0, -1.0] {
            let (estimator, mut estimate) = at_home();
            // 0.1 rad about body y.
            let measured = Quaternion::new(0.998_750_3 * sign, 0.0, 0.049_979_17 * sign, 0.0);
            let position = Vector3::new(3.0, 4.0, 0.0);
            let (_, turned) = estimator.update_pose(&mut estimate, &position, measured, 1e-3, 0.01).unwrap();
            assert!((turned.difference[1] - 0.1).abs() < 1e-5, "{:?}", turned.difference);
            // Deviations of 0.01 rad on both sides: half of it.
            let q = estimate.state().attitude;
            assert!((2.0 * q.y - 0.05).abs() < 1e-4 && (q.dot(q) - 1.0).abs() < 3e-7);
        }
    }

    /// A tilt that is not known of shows in positions, by the velocity that the thrust gives.
    #[test]
    fn positions_tell_the_tilt() {
        let (estimator, mut estimate) = at_home();
        let tilt = 0.05_f32;
        let level = Vector3::new(0.0, 0.0, 9.81);
        let imu = Imu { body_rates_rad_s: Vector3::zeros(), specific_force_m_s2: level };
        for step in 1..=300_u16 {
            let time = 0.01 * f32::from(step);
            let position = Vector3::new(3.0 + 0.5 * 9.81 * tilt * time * time, 4.0, 0.0);
            estimator.predict(&mut estimate, &imu, 0.01).unwrap();
            estimator.update_position(&mut estimate, &position, 1e-3).unwrap();
        }
        let found = 2.0 * estimate.state().attitude.y;
        assert!((found - tilt).abs() < 2e-3, "{found}");
        assert!((estimate.state().velocity_m_s.x - 9.81 * tilt * 3.0).abs() < 0.02);
    }

    #[test]
    fn a_nan_is_named_and_changes_nothing() {
        let (estimator, mut estimate) = at_home();
        let before = estimate;
        let position = Vector3::new(0.0, f32::NAN, 0.0);
        let Err(EstimatorError::OutOfRange { figure, value, .. }) =
            estimator.update_position(&mut estimate, &position, 1e-3)
        else {
            panic!("taken");
        };
        assert!(figure == EstimatorFigure::Position && value.is_nan() && estimate == before);
        for deviation in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(estimator.update_height(&mut estimate, 1.0, deviation).is_err() && estimate == before);
        }
        let half = Quaternion::new(0.5, 0.0, 0.0, 0.0);
        let pose = estimator.update_pose(&mut estimate, &Vector3::zeros(), half, 1e-3, 1e-2);
        assert!(pose.is_err() && estimate == before);
    }
}
