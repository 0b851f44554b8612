//! Coordinates of the states in which the cost P of a Riccati equation is about the identity.
//!
//! In flow a P near the solution, n x n; out flow a lower triangular L with `L L'` about P, the matrices of the equation
//! for the states `z = L' x`, and what is found for z back in the states x.
//!
//! Where the states count for costs that are far apart, as in a long chain of integrators, the equation is ill-conditioned
//! in any diagonal scaling: in 16 digits the cheap combinations of states are lost beside the dear ones. In z every
//! combination costs about the same, and with `P = I` a closed loop never lengthens z, since the cost only falls. L is a
//! matrix of f64 taken as it is; the matrices for z are formed from it in 32 digits.

use nalgebra::DMatrix;

use super::double_double::DoubleMatrix;

/// A pivot of the factorisation has to be above this share of its diagonal entry: of rounding in 32 digits a thousandfold.
const LEAST_PIVOT: f64 = 1e-28;

/// The states `z = L' x`.
pub(super) struct CostCoordinates {
    lower: DMatrix<f64>,
    transposed: DoubleMatrix,
}

impl CostCoordinates {
    /// From a P; nothing if it is not positive definite.
    pub(super) fn new(p: &DoubleMatrix) -> Option<Self> {
        let lower = factor(p)?;
        Some(Self { transposed: DoubleMatrix::new(lower.transpose()), lower })
    }

    /// `L' A L^-T`: the map A of the states.
    pub(super) fn map(&self, a: &DoubleMatrix) -> DoubleMatrix {
        a.transposed().times(&DoubleMatrix::new(self.lower.clone())).over_lower(&self.lower).transposed()
    }

    /// `L' F`: columns F that act on the states.
    pub(super) fn input(&self, factor: &DoubleMatrix) -> DoubleMatrix {
        self.transposed.times(factor)
    }

    /// `L^-1 S`: columns S of weights of the states.
    pub(super) fn weight(&self, s: &DoubleMatrix) -> DoubleMatrix {
        s.over_lower(&self.lower)
    }

    /// `L^-1 Q L^-T`: the form `x' Q x`.
    pub(super) fn form(&self, q: &DoubleMatrix) -> DoubleMatrix {
        self.weight(&self.weight(q).transposed()).symmetrised()
    }

    /// `L P L'`: the form `z' P z` of the states x.
    pub(super) fn form_of_states(&self, p: &DoubleMatrix) -> DoubleMatrix {
        DoubleMatrix::new(self.lower.clone()).times(&p.times(&self.transposed)).symmetrised()
    }

    /// `K L'`: the feedback `K z` of the states x.
    pub(super) fn feedback_of_states(&self, k: &DoubleMatrix) -> DoubleMatrix {
        k.times(&self.transposed)
    }
}

/// Cholesky's factor in 32 digits, rounded.
fn factor(p: &DoubleMatrix) -> Option<DMatrix<f64>> {
    let n = p.hi.nrows();
    let mut lower = p.clone();
    for k in 0..n {
        for j in 0..k {
            let factor = lower.get(k, j);
            for i in k..n {
                lower.set(i, k, lower.get(i, k).minus(lower.get(i, j).times(factor)));
            }
        }
        let pivot = lower.get(k, k);
        if pivot.hi.is_nan() || pivot.hi <= LEAST_PIVOT * p.hi[(k, k)] {
            return None;
        }
        let root = pivot.sqrt();
        for i in k..n {
            lower.set(i, k, lower.get(i, k).over(root));
        }
    }
    Some(lower.hi.lower_triangle())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::double_double::Double;

    #[test]
    fn a_cost_is_about_the_identity_in_its_own_coordinates() {
        // Hilbert's matrix of 14, condition 6e17: in 16 digits it has no Cholesky factor.
        let n = 14;
        let p = DoubleMatrix::from_fn(n, n, |i, j| Double::new(1.0).over(Double::new((i + j + 1) as f64)));
        assert!(p.hi.clone().cholesky().is_none());
        let coordinates = CostCoordinates::new(&p).expect("positive definite");
        let own = coordinates.form(&p);
        // L is rounded: eps times its condition, the root of 6e17.
        assert!((&own.hi - DMatrix::identity(n, n)).amax() < 1e-6);
        // There and back, in 32 digits.
        assert!(coordinates.form_of_states(&own).minus(&p).hi.amax() < 1e-30);
        let negative = DoubleMatrix::new(DMatrix::from_diagonal_element(2, 2, -1.0));
        assert!(CostCoordinates::new(&negative).is_none());
    }
}
