//! Samples of the inertial sensors (body frame, rad/s and m/s^2) in; their mean between two predictions out.

use nalgebra::Vector3;

use super::error::EstimatorError;
use super::motion::Imu;

/// Sums samples up to the next prediction: of a gyroscope at 1 kHz, ten for a filter that predicts at 100 Hz.
///
/// A rotation needs the mean of the body rates, up to the product of two changes of direction within a period.
#[derive(Clone, Copy, Debug)]
pub struct ImuAverager {
    rates: Vector3<f32>,
    force: Vector3<f32>,
    samples: u16,
}

impl Default for ImuAverager {
    fn default() -> Self {
        Self::new()
    }
}

impl ImuAverager {
    /// Without a sample.
    pub const fn new() -> Self {
        Self { rates: Vector3::new(0.0, 0.0, 0.0), force: Vector3::new(0.0, 0.0, 0.0), samples: 0 }
    }

    /// One sample more. Of those beyond 65535 in a period none is taken.
    ///
    /// # Errors
    /// [`EstimatorError::OutOfRange`] as [`super::Estimator::predict`]; the sample is left out.
    pub fn add(&mut self, sample: &Imu) -> Result<(), EstimatorError> {
        sample.check()?;
        let Some(samples) = self.samples.checked_add(1) else { return Ok(()) };
        self.rates += sample.body_rates_rad_s;
        self.force += sample.specific_force_m_s2;
        self.samples = samples;
        Ok(())
    }

    /// The mean of the samples since the last call; nothing where there was none.
    pub fn take(&mut self) -> Option<Imu> {
        let Self { rates, force, samples } = core::mem::take(self);
        let per_sample = 1.0 / f32::from(samples);
        (samples > 0).then(|| Imu { body_rates_rad_s: rates * per_sample, specific_force_m_s2: force * per_sample })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_is_taken_once_and_of_sound_samples_alone() {
        let sample = |rate: f32| Imu {
            body_rates_rad_s: Vector3::new(rate, 0.0, -rate),
            specific_force_m_s2: Vector3::new(0.0, 0.5 * rate, 9.81),
        };
        let mut averager = ImuAverager::new();
        assert_eq!(averager.take(), None);
        averager.add(&sample(1.0)).unwrap();
        averager.add(&sample(3.0)).unwrap();
        assert!(averager.add(&sample(f32::NAN)).is_err());
        assert_eq!(averager.take(), Some(sample(2.0)));
        assert_eq!(averager.take(), None);
    }
}
