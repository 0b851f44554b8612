//! Why a design is refused or fails, in one line each: which matrix, which value, the remedy.

use num_complex::Complex64;
use thiserror::Error;

use crate::analysis::MatrixError;

/// A design problem without an answer, or one whose answer was not found to working precision.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum DesignError {
    /// A matrix that cannot be worked with.
    #[error(transparent)]
    Matrix(#[from] MatrixError),
    /// A weight is not symmetric.
    #[error(
        "{name}[{row},{column}] is {value} but {name}[{column},{row}] is {mirrored}; {name} must be symmetric: \
         use ({name} + {name}')/2"
    )]
    NotSymmetric {
        /// Name of the matrix.
        name: &'static str,
        /// Row of the entry, from 0.
        row: usize,
        /// Column of the entry, from 0.
        column: usize,
        /// The entry.
        value: f64,
        /// The entry across the diagonal.
        mirrored: f64,
    },
    /// The weight of the state has a negative eigenvalue.
    #[error("Q has the eigenvalue {eigenvalue:.3e}; the weight of the state must be positive semidefinite")]
    NotPositiveSemidefinite {
        /// Its smallest eigenvalue.
        eigenvalue: f64,
    },
    /// The weight of the input is singular or has a negative eigenvalue.
    #[error(
        "R is not positive definite: pivot {row} of its Cholesky factorisation is {pivot:.3e} of R[{row},{row}]; \
         give every input a positive weight"
    )]
    NotPositiveDefinite {
        /// Row of the pivot, from 0.
        row: usize,
        /// The pivot as a share of the diagonal entry.
        pivot: f64,
    },
    /// The input does not reach an unstable mode.
    #[error(
        "(A, B) is not stabilisable: the input does not reach the mode with eigenvalue {}; \
         remove that mode or add an actuator for it", complex(.eigenvalue)
    )]
    NotStabilisable {
        /// The eigenvalue that no feedback moves, 1/s.
        eigenvalue: Complex64,
    },
    /// The input does not reach some mode, stable or not.
    #[error(
        "(A, B) is not controllable: the input does not reach the mode with eigenvalue {}; \
         remove that mode or add an actuator for it", complex(.eigenvalue)
    )]
    NotControllable {
        /// The eigenvalue that no feedback moves, 1/s.
        eigenvalue: Complex64,
    },
    /// The weight does not see a mode on the imaginary axis.
    #[error(
        "(Q, A) is not detectable: Q does not see the mode with eigenvalue {} on the imaginary axis, so no optimal \
         feedback moves it; give its states a weight", complex(.eigenvalue)
    )]
    NotDetectable {
        /// The eigenvalue that the optimal feedback would leave where it is, 1/s.
        eigenvalue: Complex64,
    },
    /// The Hamiltonian matrix has an eigenvalue on the imaginary axis.
    #[error(
        "the Hamiltonian matrix has the eigenvalue {} on the imaginary axis to working precision, so no stabilising \
         solution can be told from its neighbours; change Q or scale the weights", complex(.eigenvalue)
    )]
    HamiltonianOnAxis {
        /// The eigenvalue, 1/s.
        eigenvalue: Complex64,
    },
    /// The required decay rate is no positive number.
    #[error("mu is {mu}; the decay rate must be a positive number")]
    DecayRate {
        /// The given rate, 1/s.
        mu: f64,
    },
    /// The plant already decays faster than asked for, so that (15) has no positive definite solution.
    #[error(
        "mu is {mu}, but A has the eigenvalue {}, which already decays faster; (15) has a positive definite solution \
         only for mu above {}", complex(.eigenvalue), -.eigenvalue.re
    )]
    AlreadyFaster {
        /// The given rate, 1/s.
        mu: f64,
        /// The fastest eigenvalue of A, 1/s.
        eigenvalue: Complex64,
    },
    /// The linear Lyapunov equation is singular.
    #[error(
        "the Lyapunov equation has no unique solution: the eigenvalues {} and {} of A add up to zero",
        complex(.first), complex(.second)
    )]
    OppositeEigenvalues {
        /// One of the two, 1/s.
        first: Complex64,
        /// The other, 1/s.
        second: Complex64,
    },
    /// The weight does not see a mode on the unit circle.
    #[error(
        "(Q, A) is not detectable: Q does not see the mode with eigenvalue {} on the unit circle, so no optimal \
         feedback moves it; give its states a weight", complex(.eigenvalue)
    )]
    NotDetectableSampled {
        /// The eigenvalue that the optimal feedback would leave where it is, per sample.
        eigenvalue: Complex64,
    },
    /// No stabilising solution of the discrete Riccati equation can be told from its neighbours.
    #[error(
        "the discrete Riccati equation leaves the closed loop the eigenvalue {} on the unit circle to working \
         precision; change Q or scale the weights", complex(.eigenvalue)
    )]
    ClosedLoopOnCircle {
        /// The eigenvalue, per sample.
        eigenvalue: Complex64,
    },
    /// The linear Stein equation is singular.
    #[error(
        "the discrete Lyapunov equation has no unique solution: the product of the eigenvalues {} and {} of A is 1",
        complex(.first), complex(.second)
    )]
    ReciprocalEigenvalues {
        /// One of the two, per sample.
        first: Complex64,
        /// The other, per sample.
        second: Complex64,
    },
    /// Cost of state and input together that can be driven below zero.
    #[error(
        "the weights Q, R and the cross weight S together are not positive semidefinite: Q - S R^-1 S' has the \
         eigenvalue {eigenvalue:.3e}; make S smaller"
    )]
    CrossWeight {
        /// Its smallest eigenvalue.
        eigenvalue: f64,
    },
    /// The sampling period is no positive number.
    #[error("the sampling period is {period_s} s; it must be a positive number")]
    Period {
        /// The given period, s.
        period_s: f64,
    },
    /// The delay is negative or not a number.
    #[error("the delay is {delay_s} s; it must be zero or a positive number")]
    Delay {
        /// The given delay, s.
        delay_s: f64,
    },
    /// A matrix so large or so small that nothing is known of the equation.
    #[error(
        "{name} has the largest entry {largest:.3e}, and no answer was found; Riccati equations are solved where the largest entries \
         of A, B, Q and R are from {least:e} to {most:e}: choose other units of time, states, inputs or cost"
    )]
    Size {
        /// Name of the matrix.
        name: &'static str,
        /// Its largest entry, without its sign.
        largest: f64,
        /// The least that is in range.
        least: f64,
        /// The most.
        most: f64,
    },
    /// The equation has an answer, but its gain is stable with more digits than it is returned with alone.
    #[error(
        "{equation} was solved, but its gain rounded to 16 digits leaves the closed loop the pole {}: A and B are too large \
         beside the closed loop; sample faster, or remove the fastest unstable modes", complex(.pole)
    )]
    RoundedGain {
        /// The equation.
        equation: &'static str,
        /// The pole farthest out, 1/s or per sample.
        pole: Complex64,
    },
    /// The answer is not good to working precision.
    #[error("{equation} was not solved to working precision; scale the states or the weights")]
    Inaccurate {
        /// The equation.
        equation: &'static str,
        /// Relative residual of the best attempt.
        residual: f64,
    },
}

/// A complex number as people write it: without an imaginary part of zero.
fn complex(value: &Complex64) -> String {
    if value.im == 0.0 {
        real(value.re)
    } else {
        format!("{} {} {}i", real(value.re), if value.im < 0.0 { '-' } else { '+' }, real(value.im.abs()))
    }
}

/// Six digits, at any size.
fn real(value: f64) -> String {
    // Adding zero makes -0 a plain 0.
    let value = value + 0.0;
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) { format!("{value:.6}") } else { format!("{value:.5e}") }
}
