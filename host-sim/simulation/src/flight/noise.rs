//! Measurement noise that is the same on every run: a seed in, normally distributed numbers out.

use nalgebra::Vector3;

use crate::plant::RigidState;

/// Standard deviations of white noise on each component of a measurement, at every control step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Deviation of the position, m.
    pub position_m: f64,
    /// Deviation of the velocity, m/s.
    pub velocity_m_s: f64,
    /// Deviation of the body rates, rad/s.
    pub body_rates_rad_s: f64,
    /// The seed.
    pub seed: u64,
}

/// A source of normally distributed numbers.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    state: u64,
}

impl Source {
    pub(crate) fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Steele, Lea and Flood 2014 (SplitMix64): above 0, up to 1.
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        ((z >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    /// Box and Muller 1958, the cosine half: mean 0, deviation 1.
    pub(crate) fn normal(&mut self) -> f64 {
        let (radius, turn) = ((-2.0 * self.uniform().ln()).sqrt(), self.uniform());
        radius * (std::f64::consts::TAU * turn).cos()
    }

    fn vector(&mut self, deviation: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| deviation * self.normal())
    }

    /// The measurement of a state.
    pub(crate) fn measured(&mut self, state: &RigidState, noise: &Noise) -> RigidState {
        RigidState {
            position_m: state.position_m + self.vector(noise.position_m),
            velocity_m_s: state.velocity_m_s + self.vector(noise.velocity_m_s),
            body_rates_rad_s: state.body_rates_rad_s + self.vector(noise.body_rates_rad_s),
            ..*state
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_mean_zero_deviation_one_and_the_tails_of_a_normal_distribution() {
        let mut source = Source::new(1);
        let numbers: Vec<f64> = (0..40_000).map(|_| source.normal()).collect();
        let mean = numbers.iter().sum::<f64>() / 40_000.0;
        let variance = numbers.iter().map(|x| x * x).sum::<f64>() / 40_000.0;
        let beyond_two = numbers.iter().filter(|x| x.abs() > 2.0).count() as f64 / 40_000.0;
        // Four deviations of each estimate from 40,000 numbers.
        assert!(mean.abs() < 0.02, "{mean}");
        assert!((variance - 1.0).abs() < 0.03, "{variance}");
        assert!((beyond_two - 0.0455).abs() < 0.0042, "{beyond_two}");
    }
}
