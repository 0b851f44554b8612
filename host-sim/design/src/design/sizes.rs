//! Sizes of the matrices of a Riccati equation: a refusal and the matrices in, the refusal that names a size out of range out.
//!
//! The solvers square norms and compare what is left with the rounding of the largest. Far from 1 squares leave the range of an f64,
//! or A, B, Q and R leave each other's digits: then a mode looks as if it were out of reach or out of sight.

use nalgebra::DMatrix;

use super::DesignError;
use crate::analysis::MatrixError;

/// Largest entries for which a refusal is what it says; equations beyond may still be solved.
const LARGEST: [f64; 2] = [1e-20, 1e20];

/// A refusal of an equation, of the size of one of its matrices where that is out of range.
pub(super) fn or_size(error: DesignError, problem: [(&'static str, &DMatrix<f64>); 4]) -> DesignError {
    let hangs_on_sizes = matches!(
        error,
        DesignError::NotStabilisable { .. }
            | DesignError::NotDetectable { .. }
            | DesignError::NotDetectableSampled { .. }
            | DesignError::HamiltonianOnAxis { .. }
            | DesignError::ClosedLoopOnCircle { .. }
            | DesignError::Inaccurate { .. }
            | DesignError::Matrix(MatrixError::EigenvaluesNotFound { .. } | MatrixError::NotFinite { .. })
    );
    let is_finite = problem.iter().all(|(_, matrix)| matrix.iter().all(|entry| entry.is_finite()));
    let [least, most] = LARGEST;
    let outside = |largest: f64| largest != 0.0 && !(least..=most).contains(&largest);
    let sizes = problem.map(|(name, matrix)| (name, matrix.amax()));
    match sizes.into_iter().find(|(_, largest)| outside(*largest)) {
        Some((name, largest)) if hangs_on_sizes && is_finite => DesignError::Size { name, largest, least, most },
        _ => error,
    }
}
