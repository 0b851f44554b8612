//! The configuration of an estimator: craft and sensors, checked once.

use super::error::{EstimatorError, EstimatorFigure, within};
use crate::math::sqrt;

/// The prediction's model of the force on the craft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Force {
    /// Along body z the accelerometer's reading; along body x and y linear drag alone. A rotor craft's
    /// accelerometer measures little else on those axes, and that little is often hidden under vibration and bias.
    ThrustAxis,
    /// All three axes of the accelerometer. Every force but gravity is measured, so that no drag is modelled; a
    /// bias of the accelerometer goes straight into the velocity.
    AllAxes,
}

/// How state and covariance are carried over a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Integration {
    /// Body rates and force held over the period: of second order and more.
    SecondOrder,
    /// As the Crazyflie's firmware does it (`kalman_core.c`, commit 2a18fc29): Euler's rule on the velocity in the body
    /// frame, and the covariance of the attitude turned by half of the body's rotation. For comparison with that
    /// firmware.
    Crazyflie,
}

/// Which measurements are taken for outliers: those whose normalised innovation squared is above a quantile of the
/// chi-square distribution with as many degrees of freedom as the measurement has numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Gate {
    /// None.
    Open,
    /// One sound measurement of a hundred is lost.
    Percent99,
    /// One of a thousand.
    PerMille999,
    /// One of ten thousand.
    PerMyriad9999,
}

impl Gate {
    /// The most that the normalised innovation squared may be: of one number, and of three.
    const fn limits(self) -> [f32; 2] {
        match self {
            Self::Open => [f32::INFINITY; 2],
            Self::Percent99 => [6.635, 11.345],
            Self::PerMille999 => [10.828, 16.266],
            Self::PerMyriad9999 => [15.137, 21.108],
        }
    }

    /// Whether a measurement of one number, or of three, may pass.
    pub(super) const fn admits(self, numbers: usize, normalised_squared: f32) -> bool {
        let [one, three] = self.limits();
        normalised_squared <= if numbers == 1 { one } else { three }
    }
}

/// Standard deviations of an estimate at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeviationsAtStart {
    /// Deviation of each coordinate, m.
    pub position_m: f32,
    /// Deviation of each component, m/s.
    pub velocity_m_s: f32,
    /// About body x and body y, rad.
    pub tilt_rad: f32,
    /// About body z, rad.
    pub heading_rad: f32,
}

/// Craft and sensors as an [`super::Estimator`] reckons with them.
///
/// Noise is given as a density, so that it does not depend on the rate of prediction: the standard deviation of a
/// sample over the root of the sampling rate, [`noise_density`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EstimatorConfig {
    /// Source of the force.
    pub force: Force,
    /// The method of integration.
    pub integration: Integration,
    /// Linear drag over mass along body x and body y, 1/s, for [`Force::ThrustAxis`]; 0 where it is unknown. There is
    /// none for body z: along it the accelerometer measures the drag together with the thrust.
    pub drag_per_s: [f32; 2],
    /// White noise of the acceleration along body x, y, z, m/s^2 per root hertz: gusts and all other forces that are
    /// not modelled; the accelerometer's along each axis that is taken from it.
    pub acceleration_noise: [f32; 3],
    /// White noise of the gyroscope about body x, y, z, rad/s per root hertz.
    pub gyro_noise: [f32; 3],
    /// Deviations of a start.
    pub at_start: DeviationsAtStart,
    /// Least standard deviation of any of the nine states in its SI unit (m, m/s, rad): keeps the estimate from taking
    /// no measurement any more.
    pub deviation_min: f32,
    /// Most of the same.
    pub deviation_max: f32,
    /// Figures that are no measurement.
    pub gate: Gate,
}

/// Density of white noise, unit per root hertz: of samples with this standard deviation, taken at this rate and held.
pub fn noise_density(sample_deviation: f32, sample_hz: f32) -> f32 {
    sample_deviation / sqrt(sample_hz)
}

impl EstimatorConfig {
    /// The Crazyflie's firmware as shipped (parameters `kalman.*`, commit 2a18fc29): no drag, and deviations of 1 mm,
    /// 1 mm/s and 1 mrad at least. Its noises, 0.5 and 1 m/s^2 and 0.1 rad/s, are added every millisecond: times the
    /// root of 1 ms they are densities.
    pub const CRAZYFLIE: Self = Self {
        force: Force::ThrustAxis,
        integration: Integration::Crazyflie,
        drag_per_s: [0.0; 2],
        acceleration_noise: [0.015_811_388, 0.015_811_388, 0.031_622_78],
        gyro_noise: [0.003_162_277_7; 3],
        at_start: DeviationsAtStart { position_m: 10.0, velocity_m_s: 0.01, tilt_rad: 0.01, heading_rad: 0.01 },
        deviation_min: 1e-3,
        deviation_max: 10.0,
        gate: Gate::Open,
    };

    /// Everything within its range, the first that is not named.
    pub(super) const fn checked(self) -> Result<Self, EstimatorError> {
        const MAX: f32 = 1e3;
        // Below it squares of deviations are no longer normal numbers, and variances have no digits left.
        const MIN: f32 = 1e-6;
        let ([dx, dy], [ax, ay, az], [gx, gy, gz]) = (self.drag_per_s, self.acceleration_noise, self.gyro_noise);
        let (min, max, start) = (self.deviation_min, self.deviation_max, self.at_start);
        // Linear drag of small craft is below 1 per second; beyond 10 the units are wrong.
        let mut rest: &[(EstimatorFigure, f32, f32, f32)] = &[
            (EstimatorFigure::Drag, dx, 0.0, 10.0),
            (EstimatorFigure::Drag, dy, 0.0, 10.0),
            (EstimatorFigure::AccelerationNoise, ax, MIN, MAX),
            (EstimatorFigure::AccelerationNoise, ay, MIN, MAX),
            (EstimatorFigure::AccelerationNoise, az, MIN, MAX),
            (EstimatorFigure::GyroNoise, gx, MIN, MAX),
            (EstimatorFigure::GyroNoise, gy, MIN, MAX),
            (EstimatorFigure::GyroNoise, gz, MIN, MAX),
            (EstimatorFigure::DeviationLimit, min, MIN, 1.0),
            (EstimatorFigure::DeviationLimit, max, min, MAX),
            (EstimatorFigure::DeviationAtStart, start.position_m, min, max),
            (EstimatorFigure::DeviationAtStart, start.velocity_m_s, min, max),
            (EstimatorFigure::DeviationAtStart, start.tilt_rad, min, max),
            (EstimatorFigure::DeviationAtStart, start.heading_rad, min, max),
        ];
        while let Some(((figure, value, least, most), after)) = rest.split_first() {
            if let Err(error) = within(*figure, *value, *least, *most) {
                return Err(error);
            }
            rest = after;
        }
        Ok(self)
    }

    /// Drag along body x, y, z that the prediction takes off, 1/s.
    pub(super) const fn drag(&self) -> [f32; 3] {
        match self.force {
            Force::ThrustAxis => [self.drag_per_s[0], self.drag_per_s[1], 0.0],
            Force::AllAxes => [0.0; 3],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crazyflies_figures_are_the_firmwares_times_the_root_of_a_millisecond() {
        let config = EstimatorConfig::CRAZYFLIE.checked().unwrap();
        for (found, sample) in config.acceleration_noise.into_iter().zip([0.5, 0.5, 1.0]) {
            assert!((found - noise_density(sample, 1000.0)).abs() < 4e-9);
        }
        assert!((config.gyro_noise[0] - noise_density(0.1, 1000.0)).abs() < 4e-10);
    }

    #[test]
    fn a_figure_without_sense_is_named() {
        let sound = EstimatorConfig::CRAZYFLIE;
        let start = sound.at_start;
        for (config, figure) in [
            (EstimatorConfig { drag_per_s: [0.4, -0.1], ..sound }, EstimatorFigure::Drag),
            (EstimatorConfig { drag_per_s: [f32::NAN, 0.4], ..sound }, EstimatorFigure::Drag),
            (EstimatorConfig { acceleration_noise: [0.1, 0.1, 0.0], ..sound }, EstimatorFigure::AccelerationNoise),
            (EstimatorConfig { gyro_noise: [0.1, f32::INFINITY, 0.1], ..sound }, EstimatorFigure::GyroNoise),
            (EstimatorConfig { deviation_min: 0.0, ..sound }, EstimatorFigure::DeviationLimit),
            (EstimatorConfig { deviation_max: 1e-4, ..sound }, EstimatorFigure::DeviationLimit),
            (
                EstimatorConfig { at_start: DeviationsAtStart { tilt_rad: 0.0, ..start }, ..sound },
                EstimatorFigure::DeviationAtStart,
            ),
        ] {
            let Err(EstimatorError::OutOfRange { figure: named, .. }) = config.checked() else {
                panic!("{figure:?} was taken");
            };
            assert_eq!(named, figure);
        }
        let error = EstimatorConfig { drag_per_s: [44.0, 0.0], ..sound }.checked().unwrap_err();
        assert_eq!(std::format!("{error}"), "estimator: drag per mass, 1/s is 44; give 0 to 10");
    }

    #[test]
    fn gates_are_quantiles_of_the_chi_square_distribution() {
        // For one degree of freedom P(x^2 > c) = 1 - erf(sqrt(c / 2)); for three its table in any handbook.
        assert!(Gate::Percent99.admits(1, 6.63) && !Gate::Percent99.admits(1, 6.64));
        assert!(Gate::PerMille999.admits(3, 16.26) && !Gate::PerMille999.admits(3, 16.27));
        assert!(Gate::Open.admits(3, f32::MAX) && !Gate::Open.admits(3, f32::NAN));
    }
}
