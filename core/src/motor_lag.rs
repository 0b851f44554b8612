//! How a motor answers: the time constant and the control rate in; the force at the next step out.
//!
//! `f' = (u - f) / tau` with the command u held over a period h has the exact solution `f+ = u + (f - u) e^(-h / tau)`. The
//! motors are not measured: this prediction is taken for their forces.

use core::fmt;

use crate::clock::Rate;

/// The forces of the four motors M1 to M4 of [`mod@crate::airframe`], N.
pub type MotorForces = [f32; 4];

/// A first-order lag at a control rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorLag {
    lag_s: f32,
    period_s: f32,
    /// `e^(-h / tau)`.
    decay: f32,
}

/// A lag that cannot be followed at the control rate: not a number, or shorter than two periods.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MotorLagError {
    /// The time constant, s.
    pub lag_s: f32,
    /// The least that the rate allows, s.
    pub min_s: f32,
}

impl fmt::Display for MotorLagError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "motor lag of {} s; must be at least two control periods, {} s", self.lag_s, self.min_s)
    }
}

impl core::error::Error for MotorLagError {}

impl MotorLag {
    /// A lag of `lag_s` seconds, stepped at `rate`.
    ///
    /// # Errors
    /// [`MotorLagError`] for a lag that is not finite or shorter than two periods.
    pub const fn new(lag_s: f32, rate: Rate) -> Result<Self, MotorLagError> {
        let period_s = 1.0 / rate.hz() as f32;
        let min_s = 2.0 * period_s;
        if !(lag_s >= min_s && lag_s <= f32::MAX) {
            return Err(MotorLagError { lag_s, min_s });
        }
        Ok(Self { lag_s, period_s, decay: exp_minus(period_s / lag_s) })
    }

    /// Time constant, s.
    pub const fn lag_s(&self) -> f32 {
        self.lag_s
    }

    /// The control period h, s.
    pub const fn period_s(&self) -> f32 {
        self.period_s
    }

    /// The share of a difference between force and command that is left after a period: `e^(-h / tau)`.
    pub const fn decay(&self) -> f32 {
        self.decay
    }

    /// Forces after a period under held commands.
    #[inline]
    pub fn next(&self, forces_n: &MotorForces, commands_n: &MotorForces) -> MotorForces {
        let ([f1, f2, f3, f4], [u1, u2, u3, u4], k) = (*forces_n, *commands_n, self.decay);
        [u1 + (f1 - u1) * k, u2 + (f2 - u2) * k, u3 + (f3 - u3) * k, u4 + (f4 - u4) * k]
    }
}

/// `e^(-x)` for `0 <= x <= 1/2`: the series to its tenth term, whose successor is below 1e-11. For when a lag is set, not
/// for a step.
const fn exp_minus(x: f32) -> f32 {
    let mut sum = 1.0;
    let mut power = 10;
    while power > 0 {
        sum = 1.0 - sum * x / power as f32;
        power -= 1;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_decay_is_the_exponential() {
        for (lag_s, hz) in [(0.126_f32, 500), (0.0635, 500), (0.05, 100), (0.02, 100), (0.004, 500), (30.0, 10_000)] {
            let lag = MotorLag::new(lag_s, Rate::from_hz(hz).unwrap()).unwrap();
            let exact = (-1.0 / (f64::from(hz) * f64::from(lag_s))).exp();
            // Two roundings in x, at most 1/2, and the last one of the sum.
            assert!((f64::from(lag.decay()) - exact).abs() < 1.2e-7, "{lag_s} s at {hz} Hz: {} {exact}", lag.decay());
        }
    }

    #[test]
    fn a_lag_shorter_than_two_periods_is_refused() {
        let rate = Rate::from_hz(500).unwrap();
        for lag_s in [0.0039, 0.0, -1.0, f32::INFINITY, f32::NAN] {
            assert_eq!(MotorLag::new(lag_s, rate).unwrap_err().min_s, 0.004);
        }
    }

    #[test]
    fn a_step_answer_is_the_lags() {
        let lag = MotorLag::new(0.1, Rate::from_hz(500).unwrap()).unwrap();
        let mut forces = [0.0, 0.05, 0.1, 0.12];
        for _ in 0..50 {
            forces = lag.next(&forces, &[0.1; 4]);
        }
        // After one time constant 1/e of each difference is left; 50 roundings of numbers near 0.1.
        for (found, start) in forces.iter().zip([0.0, 0.05, 0.1, 0.12]) {
            assert!((found - (0.1 + (start - 0.1) * (-1.0_f32).exp())).abs() < 2e-7, "{found}");
        }
    }
}
