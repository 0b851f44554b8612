//! The steady Kalman filter of a linear model by structure-preserving doubling: model and noise in; gain and the innovations'
//! covariance out.
//!
//! Chu, Fan, Lin, Wang, "Structure-preserving algorithms for periodic discrete-time algebraic Riccati equations", Int. J. Control
//! 77 (2004): each round squares the closed loop, so that 30 rounds go as far as 10^9 steps of the filter.

use nalgebra::{SMatrix, SVector};

/// `x' = A x + w`, `y = H x + v`, with variances of w and v of each component.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linear<const N: usize, const M: usize> {
    pub(super) a: SMatrix<f64, N, N>,
    pub(super) h: SMatrix<f64, M, N>,
    pub(super) q: SVector<f64, N>,
    pub(super) r: SVector<f64, M>,
}

/// The steady gain of `x += K (y - H x)`, and the covariance of the innovation in the brackets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steady<const N: usize, const M: usize> {
    pub(super) gain: SMatrix<f64, N, M>,
    pub(super) covariance: SMatrix<f64, M, M>,
}

const ROUNDS: usize = 30;

impl<const N: usize, const M: usize> Linear<N, M> {
    /// None where no filter settles, or the noise is not of this world.
    pub(super) fn steady(&self) -> Option<Steady<N, M>> {
        let weighted = SMatrix::<f64, N, M>::from_fn(|i, j| self.h[(j, i)] / self.r[j]);
        let (mut a, mut g) = (self.a.transpose(), weighted * self.h);
        let mut p = SMatrix::<f64, N, N>::from_diagonal(&self.q);
        for _ in 0..ROUNDS {
            let inverse = (SMatrix::<f64, N, N>::identity() + g * p).try_inverse()?;
            let left = a * inverse;
            let more = a.transpose() * p * inverse * a;
            g += left * g * a.transpose();
            p += 0.5 * (more + more.transpose());
            a = left * a;
            if more.amax() <= 1e-12 * p.amax() {
                break;
            }
        }
        let covariance = self.h * p * self.h.transpose() + SMatrix::<f64, M, M>::from_diagonal(&self.r);
        let gain = p * self.h.transpose() * covariance.try_inverse()?;
        (gain.iter().chain(covariance.iter()).all(|value| value.is_finite())).then_some(Steady { gain, covariance })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix1, Vector1};

    use super::*;

    #[test]
    fn the_filter_of_a_random_walk_has_its_closed_form() {
        // p = q + p r / (p + r): with q = r = 1 the golden ratio, and the gain is its reciprocal.
        let walk = Linear { a: Matrix1::new(1.0), h: Matrix1::new(1.0), q: Vector1::new(1.0), r: Vector1::new(1.0) };
        let steady = walk.steady().unwrap();
        let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
        assert!((steady.covariance[0] - golden - 1.0).abs() < 1e-12, "{steady:?}");
        assert!((steady.gain[0] - 1.0 / golden).abs() < 1e-12, "{steady:?}");
    }
}
