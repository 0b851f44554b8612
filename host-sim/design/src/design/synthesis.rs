//! The paper's four designs: (LYAP-F), (LYAP-E), (LQR-F), (LQR-E).
//!
//! In flows a decay rate or weights; out flows a gain with its P, poles and residual. The F designs work on the flat
//! chain as it is. The E designs work on the reduced pair (14) that the controllability staircase cuts out of the hover
//! linearisation, and are then mapped back to one order of the errors, which drops q0:
//!
//! - F: `z = [x y z vx vy vz ax ay az q3]`, `v = [a j q3']`, gain 7 x 10.
//! - E: `e = [x y z q1 q2 q3 vx vy vz]`, `u = [T p q r]`, gain 4 x 9.
//!
//! Both models decouple into chains, so most entries of a gain are zero by structure. The rest that rounding leaves there
//! is below 1e-12 of the largest entry and is set to exactly zero, so that the flown table has no noise in it; the poles
//! are those of the gain after that.

use nalgebra::{DMatrix, SMatrix};
use num_complex::Complex64;
use serde::Serialize;

use super::{DesignError, decay_rate_design, lqr};
use crate::analysis::{Staircase, eigenvalues, staircase};
use crate::model::linear::{flat_chain, linearise};
use crate::model::{hover_input, hover_state};

/// The paper's mu, 1/s.
pub const PAPER_MU: f64 = 2.0;

/// Names of the E error in the order of the columns of its gain, with their units.
pub const EQUILIBRIUM_ERROR_NAMES: [&str; 9] = ["x_m", "y_m", "z_m", "q1", "q2", "q3", "vx_m_s", "vy_m_s", "vz_m_s"];

/// Where the E error is in the state `[r q v]` of (2a): everything but q0.
pub(super) const ERROR_STATES: [usize; 9] = [0, 1, 2, 4, 5, 6, 7, 8, 9];

/// Share of the largest entry below which an entry of a gain is zero by structure.
const STRUCTURAL_ZERO: f64 = 1e-12;

/// A gain on the hover error `[x y z q1 q2 q3 vx vy vz]`.
#[derive(Debug, Clone)]
pub struct EquilibriumDesign {
    /// K, 4 x 9, for `u = u_e - K e`; rows T (m/s^2), p, q, r (rad/s).
    pub gain: SMatrix<f64, 4, 9>,
    /// P of (17) or (21), 9 x 9.
    pub p: SMatrix<f64, 9, 9>,
    /// Eigenvalues of the reduced closed loop, 1/s.
    pub poles: Vec<Complex64>,
    /// Relative residual of P in its equation.
    pub relative_residual: f64,
}

/// A gain on the flat state `[r v a q3]`.
#[derive(Debug, Clone)]
pub struct FlatDesign {
    /// K, 7 x 10, for `v = -K (z - z_r)`; rows acceleration (m/s^2), jerk (m/s^3), dq3/dt (1/s).
    pub gain: SMatrix<f64, 7, 10>,
    /// P of (15) or (20), 10 x 10.
    pub p: SMatrix<f64, 10, 10>,
    /// Eigenvalues of the closed loop, 1/s.
    pub poles: Vec<Complex64>,
    /// Relative residual of P in its equation.
    pub relative_residual: f64,
}

/// Diagonal weights of (LQR-E).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EquilibriumWeights {
    /// Weights of the errors `[x y z q1 q2 q3 vx vy vz]`.
    pub state: [f64; 9],
    /// Weights of the inputs `[T p q r]`.
    pub input: [f64; 4],
}

impl EquilibriumWeights {
    /// The paper's weights.
    ///
    /// It prints `Q_e = diag(100, 100, 100, 50, 50, 10, 10, 10, 50)` in the order of its staircase,
    /// x, y, z, vx, vy, q1, q2, q3, vz.
    pub fn paper() -> Self {
        Self { state: [100.0, 100.0, 100.0, 10.0, 10.0, 10.0, 50.0, 50.0, 50.0], input: [0.01, 0.1, 0.1, 0.1] }
    }
}

/// Diagonal weights of (LQR-F).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FlatWeights {
    /// Weights of the flat state `[r v a q3]`.
    pub state: [f64; 10],
    /// Weights of the flat input `[a j q3']`.
    pub input: [f64; 7],
}

impl FlatWeights {
    /// The paper's weights `Q_f`, `R_f`.
    pub fn paper() -> Self {
        Self {
            state: [200.0, 200.0, 200.0, 50.0, 50.0, 50.0, 10.0, 10.0, 10.0, 20.0],
            input: [0.1, 0.1, 0.1, 0.01, 0.01, 0.01, 0.05],
        }
    }
}

/// (LYAP-E): every pole of the reduced hover model at real part -mu (17).
///
/// # Errors
/// [`DesignError::DecayRate`] unless mu is positive and finite; [`DesignError::Inaccurate`] for a mu so far from 1/s
/// that P cannot be represented.
pub fn lyapunov_equilibrium(mu: f64) -> Result<EquilibriumDesign, DesignError> {
    let reduced = ReducedPair::hover()?;
    let design = decay_rate_design(&reduced.a, &reduced.b, mu)?;
    reduced.design(&design.p, &design.gain, design.relative_residual)
}

/// (LYAP-F): every pole of the flat chain at real part -mu (15).
///
/// # Errors
/// As [`lyapunov_equilibrium`].
pub fn lyapunov_flat(mu: f64) -> Result<FlatDesign, DesignError> {
    let (a, b) = dense_flat_chain();
    let design = decay_rate_design(&a, &b, mu)?;
    flat_design(&a, &b, &design.p, &design.gain, design.relative_residual)
}

/// (LQR-E): the optimal feedback on the reduced hover model (21).
///
/// # Errors
/// The errors of [`lqr`] about the weights.
pub fn lqr_equilibrium(weights: &EquilibriumWeights) -> Result<EquilibriumDesign, DesignError> {
    let reduced = ReducedPair::hover()?;
    let q = &reduced.errors * diagonal(&weights.state) * reduced.errors.transpose();
    let design = lqr(&reduced.a, &reduced.b, &q, &diagonal(&weights.input))?;
    reduced.design(&design.p, &design.gain, design.relative_residual)
}

/// (LQR-F): the optimal feedback on the flat chain (20).
///
/// # Errors
/// The errors of [`lqr`] about the weights.
pub fn lqr_flat(weights: &FlatWeights) -> Result<FlatDesign, DesignError> {
    let (a, b) = dense_flat_chain();
    let design = lqr(&a, &b, &diagonal(&weights.state), &diagonal(&weights.input))?;
    flat_design(&a, &b, &design.p, &design.gain, design.relative_residual)
}

/// The controllable pair (14) of the hover model and its states as combinations of the errors.
struct ReducedPair {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    /// `S_c T_e` without the column of q0: 9 x 9, orthogonal.
    errors: DMatrix<f64>,
}

impl ReducedPair {
    fn hover() -> Result<Self, DesignError> {
        let (a, b) = linearise(&hover_state(), &hover_input());
        let stairs: Staircase = staircase(
            &DMatrix::from_column_slice(10, 10, a.as_slice()),
            &DMatrix::from_column_slice(10, 4, b.as_slice()),
        )?;
        let (a, b) = stairs.controllable_pair();
        Ok(Self { a, b, errors: stairs.controllable_rows().select_columns(&ERROR_STATES) })
    }

    /// Maps a design back to the order of the errors.
    fn design(
        &self,
        p: &DMatrix<f64>,
        gain: &DMatrix<f64>,
        relative_residual: f64,
    ) -> Result<EquilibriumDesign, DesignError> {
        let gain = without_noise(gain);
        Ok(EquilibriumDesign {
            poles: eigenvalues(&(&self.a - &self.b * &gain))?,
            gain: SMatrix::from_iterator((gain * &self.errors).iter().copied()),
            p: SMatrix::from_iterator((self.errors.transpose() * p * &self.errors).iter().copied()),
            relative_residual,
        })
    }
}

fn flat_design(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    p: &DMatrix<f64>,
    gain: &DMatrix<f64>,
    relative_residual: f64,
) -> Result<FlatDesign, DesignError> {
    let gain = without_noise(gain);
    Ok(FlatDesign {
        poles: eigenvalues(&(a - b * &gain))?,
        gain: SMatrix::from_iterator(gain.iter().copied()),
        p: SMatrix::from_iterator(p.iter().copied()),
        relative_residual,
    })
}

/// The flat chain as matrices of any size: A is 10 x 10, B is 10 x 7.
pub fn dense_flat_chain() -> (DMatrix<f64>, DMatrix<f64>) {
    let (a, b) = flat_chain();
    (DMatrix::from_column_slice(10, 10, a.as_slice()), DMatrix::from_column_slice(10, 7, b.as_slice()))
}

/// A square matrix with these numbers on its diagonal.
pub fn diagonal(weights: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(weights.len(), weights.len(), |i, j| if i == j { weights[i] } else { 0.0 })
}

/// The gain with its structural zeros made exact.
pub(super) fn without_noise(gain: &DMatrix<f64>) -> DMatrix<f64> {
    let threshold = STRUCTURAL_ZERO * gain.amax();
    gain.map(|entry| if entry.abs() < threshold { 0.0 } else { entry })
}
