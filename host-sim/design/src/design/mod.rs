//! Section IV of the paper: Lyapunov and Riccati equations, and the four gains.
//!
//! In flow a pair (A, B) and a decay rate or weights; out flow gains with P, poles and residuals.
//! All solvers are dense, bounded and end in an answer that has been checked or in a [`DesignError`]:
//!
//! - [`lyapunov()`]: `A' X + X A + Q = 0`; [`decay_rate_design`]: (15) and (17).
//! - [`lqr`], [`care`], [`strong_care`]: the continuous algebraic Riccati equation, (20) and (21).
//! - [`stein()`]: `A' X A - X + Q = 0`; [`dlqr`], [`dare()`]: the discrete algebraic Riccati equation.
//! - [`discretise`]: a pair under held inputs, with or without a delay; [`sampled`]: gains for a control rate.
//! - [`along`]: gains over time along a trajectory.
//! - [`mod@actuator_aware`]: gains from 19 errors, motors' lag and integral among them, to four motor forces.
//! - [`mod@cascade`]: the gains of the cascade, without the integral.
//! - [`synthesis`]: (LYAP-F), (LYAP-E), (LQR-F), (LQR-E) with the paper's numbers; [`integral`]: E with the integral of
//!   the position error.

pub mod actuator_aware;
pub mod along;
mod attempts;
pub mod cascade;
mod closed_loop;
pub mod codegen;
mod cost_coordinates;
mod dare;
mod dare_equation;
mod dare_existence;
pub mod discretise;
mod double_double;
mod double_elimination;
mod double_products;
mod doubling;
mod equation;
mod error;
mod existence;
mod hamiltonian;
mod input_weight;
pub mod integral;
mod lyapunov;
mod lyapunov_operator;
mod newton;
mod riccati;
mod riccati_attempts;
pub mod sampled;
mod sizes;
mod stein;
pub mod synthesis;
mod triangular;

pub use dare::{DareSolution, dare, dlqr, dlqr_with_cross};
pub use error::DesignError;
pub use lyapunov::{DecayRateDesign, LyapunovSolution, decay_rate_design, lyapunov};
pub use riccati::{RiccatiSolution, care, lqr, strong_care};
pub use stein::{SteinSolution, stein};

use nalgebra::DMatrix;

use crate::analysis::{MatrixError, require_square};

/// The symmetric part of a weight that is n x n, finite and symmetric up to rounding.
fn require_symmetric(name: &'static str, m: &DMatrix<f64>, n: usize) -> Result<DMatrix<f64>, DesignError> {
    require_square(name, m)?;
    if m.nrows() != n {
        let fits = if name == "R" { "the columns of B" } else { "A" };
        let (rows, columns) = m.shape();
        return Err(MatrixError::Dimension { name, rows, columns, expected_rows: n, expected_columns: n, fits }.into());
    }
    for column in 0..n {
        for row in 0..column {
            let (value, mirrored) = (m[(row, column)], m[(column, row)]);
            // A product like C' C is symmetric up to the rounding of its diagonal.
            let diagonal = (m[(row, row)].abs() * m[(column, column)].abs()).sqrt();
            let size = value.abs().max(mirrored.abs()).max(diagonal);
            if (value - mirrored).abs() > 10.0 * n as f64 * f64::EPSILON * size {
                return Err(DesignError::NotSymmetric { name, row, column, value, mirrored });
            }
        }
    }
    Ok((m + m.transpose()) * 0.5)
}
