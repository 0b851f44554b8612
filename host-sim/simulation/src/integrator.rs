//! One-step integrators of `x' = f(t, x)`: state and step in, state after the step out.

use nalgebra::SVector;

/// An integrator of fixed step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Bogacki and Shampine 1989, third order: MATLAB's `ode3`, with which the paper's figures were made.
    BogackiShampine3,
    /// The classical fourth order method of Runge and Kutta.
    RungeKutta4,
}

impl Method {
    /// One step of length `h` from `(t, x)`.
    pub fn step<const N: usize>(
        self,
        f: &mut impl FnMut(f64, &SVector<f64, N>) -> SVector<f64, N>,
        t: f64,
        x: &SVector<f64, N>,
        h: f64,
    ) -> SVector<f64, N> {
        match self {
            Self::BogackiShampine3 => {
                let k1 = f(t, x);
                let k2 = f(t + h / 2.0, &(x + k1 * (h / 2.0)));
                let k3 = f(t + h * 0.75, &(x + k2 * (h * 0.75)));
                x + (k1 * 2.0 + k2 * 3.0 + k3 * 4.0) * (h / 9.0)
            }
            Self::RungeKutta4 => {
                let k1 = f(t, x);
                let k2 = f(t + h / 2.0, &(x + k1 * (h / 2.0)));
                let k3 = f(t + h / 2.0, &(x + k2 * (h / 2.0)));
                let k4 = f(t + h, &(x + k3 * h));
                x + (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0)
            }
        }
    }
}

/// Dormand and Prince 1980, order 5 with an error estimate of order 4: the truth to hold the others against.
#[derive(Clone, Copy, Debug)]
pub struct DormandPrince {
    /// Bound on the estimated error of a step, largest component, absolute.
    pub tolerance: f64,
    /// Steps are refused below this length, s: the integration then fails instead of hanging.
    pub step_min_s: f64,
}

/// The step became shorter than allowed: the right-hand side is not smooth there, or not finite.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("integration stopped at t = {time_s} s: no step above the minimum meets the tolerance")]
pub struct StepTooSmall {
    /// The time, s.
    pub time_s: f64,
}

impl DormandPrince {
    /// From `(t0, x)` to `t1`, with steps chosen from the error estimate.
    ///
    /// # Errors
    /// [`StepTooSmall`].
    pub fn integrate<const N: usize>(
        &self,
        f: &mut impl FnMut(f64, &SVector<f64, N>) -> SVector<f64, N>,
        t0: f64,
        t1: f64,
        x: &SVector<f64, N>,
    ) -> Result<SVector<f64, N>, StepTooSmall> {
        let (mut t, mut x, mut h) = (t0, *x, t1 - t0);
        while t < t1 {
            let last = t + h >= t1;
            if last {
                h = t1 - t;
            }
            let (next, error) = Self::step(f, t, &x, h);
            if error <= self.tolerance {
                t = if last { t1 } else { t + h };
                x = next;
            } else if h <= self.step_min_s || !h.is_finite() {
                return Err(StepTooSmall { time_s: t });
            }
            // The usual controller: safety 0.9, growth between 0.2 and 5; a NaN error shrinks the step.
            let growth = 0.9 * (self.tolerance / error).powf(0.2);
            h *= if growth.is_nan() { 0.2 } else { growth.clamp(0.2, 5.0) };
        }
        Ok(x)
    }

    fn step<const N: usize>(
        f: &mut impl FnMut(f64, &SVector<f64, N>) -> SVector<f64, N>,
        t: f64,
        x: &SVector<f64, N>,
        h: f64,
    ) -> (SVector<f64, N>, f64) {
        const NODES: [f64; 6] = [0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
        const WEIGHTS: [[f64; 6]; 6] = [
            [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
            [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
            [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
            [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
            [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
            [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
        ];
        // Difference of the weights of order 5 and 4.
        const ERROR: [f64; 7] =
            [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];
        let mut slopes = [SVector::<f64, N>::zeros(); 7];
        slopes[0] = f(t, x);
        let mut next = *x;
        for stage in 0..6 {
            next = *x;
            for (weight, slope) in WEIGHTS[stage].iter().zip(&slopes) {
                next += slope * (weight * h);
            }
            slopes[stage + 1] = f(t + NODES[stage] * h, &next);
        }
        let mut error = SVector::<f64, N>::zeros();
        for (weight, slope) in ERROR.iter().zip(&slopes) {
            error += slope * (weight * h);
        }
        // amax() drops NaN; this keeps it.
        let worst = error.iter().fold(0.0, |worst: f64, e| if e.is_nan() { f64::NAN } else { worst.max(e.abs()) });
        (next, worst)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    /// A harmonic oscillator driven in time: `x = (sin t, cos t)` exactly.
    fn oscillator(_t: f64, x: &Vector2<f64>) -> Vector2<f64> {
        Vector2::new(x[1], -x[0])
    }

    fn error_after_one_second(method: Method, steps: u32) -> f64 {
        let h = 1.0 / f64::from(steps);
        let mut x = Vector2::new(0.0, 1.0);
        for k in 0..steps {
            x = method.step(&mut oscillator, f64::from(k) * h, &x, h);
        }
        (x - Vector2::new(1.0_f64.sin(), 1.0_f64.cos())).norm()
    }

    #[test]
    fn halving_the_step_shows_the_order() {
        for (method, order) in [(Method::BogackiShampine3, 3.0), (Method::RungeKutta4, 4.0)] {
            let ratio = error_after_one_second(method, 50) / error_after_one_second(method, 100);
            // The next term of the error is h = 1/50 times the first: a few per cent of the ratio.
            assert!((ratio.log2() - order).abs() < 0.05, "{method:?}: observed order {}", ratio.log2());
        }
    }

    #[test]
    fn the_adaptive_one_keeps_its_tolerance() {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let truth = DormandPrince { tolerance, step_min_s: 1e-9 };
            let x = truth.integrate(&mut oscillator, 0.0, 10.0, &Vector2::new(0.0, 1.0)).unwrap();
            let error = (x - Vector2::new(10.0_f64.sin(), 10.0_f64.cos())).norm();
            // Errors of at most some hundred steps add up on an oscillator, which neither damps nor grows them.
            assert!(error < 300.0 * tolerance + 1e-13, "tolerance {tolerance}: error {error}");
        }
    }

    #[test]
    fn a_singular_right_hand_side_ends_in_an_error() {
        let truth = DormandPrince { tolerance: 1e-9, step_min_s: 1e-9 };
        let mut blow_up = |_t: f64, x: &Vector2<f64>| Vector2::new(x[0] * x[0], f64::NAN);
        assert!(truth.integrate(&mut blow_up, 0.0, 1.0, &Vector2::new(1.0, 0.0)).is_err());
    }
}
