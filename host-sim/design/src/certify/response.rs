//! The response of a certified loop, by frequency and over time.
//!
//! In flow a plant, its controller and the timing; out flow the sensitivity of each channel with the others closed, and the
//! states after a start away from rest. The margins of a certificate are the peaks of these curves.

use nalgebra::DVector;
use num_complex::Complex64;

use super::CertifyError;
use super::linear_loop::LinearLoop;
use super::plant::{Controller, Plant, Timing};
use super::sampled_loop::SampledLoop;

/// A loop at its rate.
#[derive(Debug, Clone)]
pub struct LoopResponse {
    sampled: SampledLoop,
    states: usize,
    period_s: f64,
}

impl LoopResponse {
    /// The loop that [`certify`](super::certify) judges, before its gains are rounded.
    ///
    /// # Errors
    /// [`CertifyError::Matrix`] for a gain that does not fit the plant or is not finite; [`CertifyError::Design`] where the
    /// plant under hold is not found.
    pub fn new(plant: &Plant, controller: &Controller, timing: &Timing) -> Result<Self, CertifyError> {
        plant.require_fitting(controller)?;
        let sampled = SampledLoop::new(&LinearLoop::new(plant, controller), timing, &[])?;
        Ok(Self { sampled, states: plant.a.nrows(), period_s: timing.period_s })
    }

    /// The sensitivity S of each channel at a frequency, rad/s: from a disturbance added to its command to the sum of both,
    /// the other channels closed. The open loop's gain is `1 / S - 1`. Nothing on a pole.
    pub fn sensitivities(&self, frequency_rad_s: f64) -> Option<Vec<Complex64>> {
        Some(self.sampled.sensitivity(frequency_rad_s * self.period_s)?.diagonal().iter().copied().collect())
    }

    /// The plant's state `shown` at each of `steps` samples, from the state `start` on with nothing remembered.
    ///
    /// `start`: of the plant, states behind its end are zero.
    pub fn from_state(&self, start: &[f64], shown: usize, steps: usize) -> Vec<f64> {
        let closed = self.sampled.closed_loop();
        let mut x = DVector::zeros(closed.nrows());
        for (held, value) in x.iter_mut().take(self.states).zip(start) {
            *held = *value;
        }
        (0..steps)
            .map(|_| {
                let value = x[shown];
                x = &closed * &x;
                value
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use super::*;

    /// An integrator `x' = u` at 10 Hz under `u = -2 x`: the pole is 1 - 0.2, the open loop 0.2 / (z - 1).
    #[test]
    fn an_integrator_responds_as_its_formulas_say() {
        let plant = Plant::new(dmatrix![0.0], dmatrix![1.0]).unwrap();
        let controller = Controller::memoryless(dmatrix![2.0]);
        let response = LoopResponse::new(&plant, &controller, &Timing::at_rate(10)).unwrap();
        for frequency_rad_s in [0.1, 1.0, 10.0, 31.0] {
            let z = Complex64::from_polar(1.0, 0.1 * frequency_rad_s);
            let expected = (z - 1.0) / (z - 0.8);
            let found = response.sensitivities(frequency_rad_s).unwrap();
            // Rounding of one solve of size 1.
            assert!((found[0] - expected).norm() < 1e-14, "{frequency_rad_s}: {found:?}, not {expected}");
        }
        for (k, x) in response.from_state(&[-1.0], 0, 20).iter().enumerate() {
            assert!((x + 0.8_f64.powi(k as i32)).abs() < 1e-14, "{k}: {x}");
        }
    }

    #[test]
    fn a_gain_of_another_shape_is_refused() {
        let plant = Plant::new(dmatrix![0.0], dmatrix![1.0]).unwrap();
        let controller = Controller::memoryless(dmatrix![2.0, 1.0]);
        assert!(matches!(LoopResponse::new(&plant, &controller, &Timing::at_rate(10)), Err(CertifyError::Matrix(_))));
    }
}
