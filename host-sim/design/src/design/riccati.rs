//! The continuous algebraic Riccati equation `A' P + P A + Q - P B R^-1 B' P = 0` and its stabilising solution.
//!
//! In flow A (n x n), B (n x m), Q (n x n), R (m x m); out flow P, `K = R^-1 B' P`, the poles of `A - B K` and bounds on
//! their accuracy.
//!
//! **Method.**
//! 1. R is factorised in 32 digits and only `F = B R^-1/2` is kept, so that an R that is nearly singular costs none.
//! 2. The Hamiltonian matrix is balanced by powers of two.
//! 3. The staircase forms of (A, F), with PBH tests beside them, and of (A', Q) decide whether an unstable mode is out
//!    of reach, or a mode on the imaginary axis out of sight.
//! 4. The matrix sign function of the Hamiltonian gives a first P. Where too little of it is left by rounding, doubling in
//!    32 digits does for up to 100 states; where that fails too, the ordered Schur form, or the sign function in 32 digits.
//! 5. Newton-Kleinman steps with residuals in 32 digits refine P until the corrections are below the rounding of an f64;
//!    after doubling in 32 digits in coordinates in which P is about the identity, where few digits are lost.
//! 6. The result counts only if the corrections have vanished and every pole of the closed loop is stable, with the gain in
//!    32 digits and with the one that is returned, in 16.
//!
//! **Conditions.** A stabilising solution exists and is unique if (A, B) is stabilisable and the Hamiltonian has no
//! eigenvalue on the imaginary axis; for Q >= 0 the latter says that Q sees every mode of A there. [`lqr`] demands
//! Q >= 0, and then P >= 0. [`care`] takes any symmetric Q, as H-infinity problems need. [`strong_care`] also accepts
//! closed-loop poles on the axis, the limit of stabilising solutions; there Newton steps only halve the error, and how far
//! they get is in `last_correction`.
//!
//! References: Laub 1979; Byers 1987; Kleinman 1968; Benner 2001 (balancing); Guo and Lancaster 1998 (strong solutions);
//! Kenney and Hewer 1990 (condition).

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::attempts::ACCURATE;
use super::closed_loop;
use super::equation::Equation;
use super::existence::{
    EQUATION, marginal_pole, no_solution, require_detectable, require_positive_semidefinite, require_stabilisable,
};
use super::input_weight::InputWeight;
use super::lyapunov_operator::LyapunovOperator;
use super::newton::Refined;
use super::riccati_attempts::{Solution, solution};
use super::sizes::or_size;
use super::{DesignError, require_symmetric};
use crate::analysis::{MatrixError, require_finite, require_square};

/// The same where poles on the axis make the equation singular and each step only halves the error.
const ACCURATE_ON_AXIS: f64 = 1e-7;
/// A pole within this of the axis, relative to the closed loop, may be on it but for rounding.
const NEAR_AXIS: f64 = 1e-5;

/// Solution of the Riccati equation.
#[derive(Debug, Clone)]
pub struct RiccatiSolution {
    /// P, n x n, symmetric.
    pub p: DMatrix<f64>,
    /// `K = R^-1 B' P`, m x n, for u = -K x.
    pub gain: DMatrix<f64>,
    /// Eigenvalues of `A - B K` with K as it is here, rounded to 16 digits, 1/s, sorted by real part.
    pub poles: Vec<Complex64>,
    /// Frobenius norm of the residual of P over the sum of the norms of the four terms, evaluated in 32 digits.
    pub relative_residual: f64,
    /// Last Newton correction over P, before P was rounded to f64.
    pub last_correction: f64,
    /// Relative change of P for a relative change of A, Q and `B R^-1 B'`, in the balanced coordinates: an upper
    /// estimate (Kenney and Hewer 1990).
    pub condition: f64,
}

/// Which closed loops are accepted.
#[derive(Clone, Copy, PartialEq)]
enum Poles {
    Stable,
    StableOrMarginal,
}

/// The optimal feedback of (LQR) for weights Q >= 0 and R > 0: (20), (21).
///
/// # Errors
/// As [`care`], and [`DesignError::NotPositiveSemidefinite`].
pub fn lqr(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<RiccatiSolution, DesignError> {
    require_square("A", a)?;
    require_positive_semidefinite(&require_symmetric("Q", q, a.nrows())?)?;
    care(a, b, q, r)
}

/// The stabilising solution for any symmetric Q and R > 0.
///
/// # Errors
/// [`DesignError::Matrix`] for matrices that do not fit, are empty or not finite; [`DesignError::NotSymmetric`];
/// [`DesignError::NotPositiveDefinite`] for R; [`DesignError::NotStabilisable`], [`DesignError::NotDetectable`] and
/// [`DesignError::HamiltonianOnAxis`] where no stabilising solution exists; [`DesignError::Inaccurate`] where none was
/// found to working precision; [`DesignError::RoundedGain`] where its gain in 16 digits does not stabilise;
/// [`DesignError::Size`] where one of the latter is met and a matrix is far from 1.
pub fn care(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<RiccatiSolution, DesignError> {
    solve(a, b, q, r, Poles::Stable).map_err(|error| or_size(error, [("A", a), ("B", b), ("Q", q), ("R", r)]))
}

/// The strong solution: as [`care`], but closed-loop poles on the imaginary axis are accepted.
///
/// # Errors
/// As [`care`] but for the eigenvalues on the axis.
pub fn strong_care(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<RiccatiSolution, DesignError> {
    solve(a, b, q, r, Poles::StableOrMarginal).map_err(|error| or_size(error, [("A", a), ("B", b), ("Q", q), ("R", r)]))
}

fn solve(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
    accepted: Poles,
) -> Result<RiccatiSolution, DesignError> {
    require_square("A", a)?;
    require_finite("B", b)?;
    let (rows, m) = b.shape();
    let n = a.nrows();
    if rows != n {
        let error =
            MatrixError::Dimension { name: "B", rows, columns: m, expected_rows: n, expected_columns: m, fits: "A" };
        return Err(error.into());
    }
    let q = require_symmetric("Q", q, n)?;
    let weight = InputWeight::new(&require_symmetric("R", r, m)?)?;
    let given = Equation::new(a.clone(), weight.factor(b), q);
    let balanced = given.clone().balanced();
    if let Err(error) = require_stabilisable(&balanced) {
        // Balancing moves a mode that Q does not see so far off that the input seems not to reach it.
        require_stabilisable(&given)?;
        if accepted == Poles::Stable {
            require_detectable(&given)?;
        }
        return Err(error);
    }
    if accepted == Poles::Stable {
        require_detectable(&balanced)?;
    }
    // A second scaling for the rare matrix that balancing makes worse.
    let scalings = [balanced, given.clone().uniformly_scaled()];
    let Some(found) = solution(&scalings) else { return Err(no_solution(&scalings[0], f64::INFINITY)) };
    let abscissa = found.abscissa();
    let Solution { equation, refined, poles } = found;
    let p = equation.unscaled(&refined.x);
    let relative_residual = given.relative_residual(&p.hi);
    let stable = refined.last_correction <= ACCURATE && abscissa < 0.0;
    let good = match accepted {
        Poles::Stable => {
            let near_axis = abscissa.abs() <= NEAR_AXIS * refined.closed_loop.norm();
            // For Q >= 0 the test of detectability has already settled that the axis is free.
            if near_axis
                && let Some(nearest) = poles.last()
                && (!stable || require_positive_semidefinite(&given.q.hi).is_err())
                && let Some(eigenvalue) = marginal_pole(equation, &refined, *nearest)
            {
                require_detectable(&given)?;
                return Err(DesignError::HamiltonianOnAxis { eigenvalue });
            }
            stable
        }
        Poles::StableOrMarginal => {
            let marginal = abscissa <= ACCURATE_ON_AXIS * refined.closed_loop.norm();
            stable || (marginal && refined.last_correction <= ACCURATE_ON_AXIS)
        }
    };
    if !good || !relative_residual.is_finite() {
        // Balancing may lift entries that are zero up to rounding: ask once more as given, to name the mode.
        require_stabilisable(&given)?;
        if accepted == Poles::Stable {
            require_detectable(&given)?;
        }
        return Err(no_solution(equation, relative_residual));
    }
    let gain = weight.gain(&given.factor, &p);
    let [poles, in_16_digits] = closed_loop::poles(a, b, &gain)?;
    match poles.iter().chain(&in_16_digits).max_by(|x, y| x.re.total_cmp(&y.re)) {
        Some(pole) if accepted == Poles::Stable && pole.re >= 0.0 => {
            return Err(DesignError::RoundedGain { equation: EQUATION, pole: *pole });
        }
        _ => {}
    }
    Ok(RiccatiSolution {
        gain,
        relative_residual,
        last_correction: refined.last_correction,
        condition: condition(equation, &refined)?,
        poles,
        p: p.hi,
    })
}

/// Kenney and Hewer's upper estimate of the condition number.
///
/// With `H_k` the solution of `(A - G X)' H + H (A - G X) = -X^k`, the norms of the three perturbation maps are `|H_0|`
/// for Q, at most `2 sqrt(|H_0| |H_2|)` for A, and `|H_2|` for G.
fn condition(equation: &Equation, refined: &Refined) -> Result<f64, DesignError> {
    let n = equation.states();
    let operator = LyapunovOperator::new(&refined.closed_loop)?;
    let x = &refined.x.hi;
    let norm_x = x.norm();
    if norm_x == 0.0 {
        return Ok(0.0);
    }
    let h0 = operator.solve(&DMatrix::identity(n, n)).norm();
    let h2 = operator.solve(&(x * x)).norm();
    let norm_g = (&equation.factor.hi * equation.factor.hi.transpose()).norm();
    Ok((h0 * equation.q.hi.norm() + 2.0 * (h0 * h2).sqrt() * equation.a.hi.norm() + h2 * norm_g) / norm_x)
}
