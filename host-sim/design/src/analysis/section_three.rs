//! Section III for the paper's two models, (F-LTI) and (E-LTI), in numbers and with the names of the states.

use nalgebra::DMatrix;
use num_complex::Complex64;
use serde::Serialize;

use super::controllability::controllability_rank;
use super::{
    JordanStructure, MatrixError, NumericalRank, PbhTest, Staircase, distinct_eigenvalues, eigenvalues, jordan_blocks,
    pbh_test, staircase,
};
use crate::model::linear::{flat_chain, linearise};
use crate::model::{INPUT_NAMES, STATE_NAMES, hover_input, hover_state};

/// Names of the flat state (6a) in order, with their units.
const FLAT_STATE_NAMES: [&str; 10] =
    ["x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s", "ax_m_s2", "ay_m_s2", "az_m_s2", "q3"];
/// Names of the flat input (6b) in order, with their units.
const FLAT_INPUT_NAMES: [&str; 7] = ["ax_m_s2", "ay_m_s2", "az_m_s2", "jx_m_s3", "jy_m_s3", "jz_m_s3", "q3_rate_per_s"];

/// One uncontrollable mode of a model: a combination of its states that the input does not reach.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UncontrollableMode {
    /// Name of a state and its coefficient, entries below 1e-12 left out.
    pub combination: Vec<(String, f64)>,
}

/// The questions of Section III about one linear model.
#[derive(Debug, Clone)]
pub struct ModelAnalysis {
    /// Label of the model in the paper.
    pub label: &'static str,
    /// Names of the states in the order of A.
    pub states: Vec<&'static str>,
    /// Names of the inputs in the order of the columns of B.
    pub inputs: Vec<&'static str>,
    /// A, n x n.
    pub a: DMatrix<f64>,
    /// B, n x m.
    pub b: DMatrix<f64>,
    /// Eigenvalues of A, 1/s.
    pub eigenvalues: Vec<Complex64>,
    /// Jordan blocks at each distinct eigenvalue.
    pub jordan: Vec<JordanStructure>,
    /// Rank of the controllability matrix (10).
    pub controllability: NumericalRank,
    /// The staircase (11).
    pub staircase: Staircase,
    /// One PBH test for each distinct eigenvalue.
    pub pbh: Vec<PbhTest>,
    /// The modes that the input does not reach, in the order of the staircase.
    pub uncontrollable_modes: Vec<UncontrollableMode>,
    /// Every unstable or marginal eigenvalue is controllable.
    pub stabilisable: bool,
}

impl ModelAnalysis {
    /// Analyses one pair.
    ///
    /// # Errors
    /// [`MatrixError`] for matrices that do not fit or are not finite.
    pub fn new(
        label: &'static str,
        states: &[&'static str],
        inputs: &[&'static str],
        a: DMatrix<f64>,
        b: DMatrix<f64>,
    ) -> Result<Self, MatrixError> {
        let eigenvalues = eigenvalues(&a)?;
        // A Jordan block of size 2 scatters its eigenvalue by the square root of the rounding.
        let distinct = distinct_eigenvalues(&eigenvalues, f64::EPSILON.sqrt() * a.norm());
        let jordan = distinct.iter().map(|(value, _)| jordan_blocks(&a, *value)).collect::<Result<Vec<_>, _>>()?;
        let pbh = distinct.iter().map(|(value, _)| pbh_test(&a, &b, *value)).collect::<Result<Vec<_>, _>>()?;
        let staircase = staircase(&a, &b)?;
        let uncontrollable_modes = (0..staircase.uncontrollable)
            .map(|row| UncontrollableMode {
                combination: states
                    .iter()
                    .zip(staircase.transformation.row(row).iter())
                    .filter(|(_, coefficient)| coefficient.abs() >= 1e-12)
                    .map(|(name, coefficient)| ((*name).to_owned(), *coefficient))
                    .collect(),
            })
            .collect();
        Ok(Self {
            label,
            states: states.to_vec(),
            inputs: inputs.to_vec(),
            controllability: controllability_rank(&a, &b)?,
            stabilisable: pbh.iter().all(|test| test.controllable || !test.unstable),
            a,
            b,
            eigenvalues,
            jordan,
            staircase,
            pbh,
            uncontrollable_modes,
        })
    }

    /// Whether the input reaches every state.
    pub fn controllable(&self) -> bool {
        self.staircase.uncontrollable == 0
    }

    /// The largest Jordan block.
    pub fn largest_jordan_block(&self) -> usize {
        self.jordan.iter().flat_map(|structure| &structure.block_sizes).copied().max().unwrap_or(0)
    }
}

/// Both models of the paper.
#[derive(Debug, Clone)]
pub struct SectionThree {
    /// The flat chain (F-LTI).
    pub flat: ModelAnalysis,
    /// The hover linearisation (E-LTI), all ten states.
    pub equilibrium: ModelAnalysis,
}

impl SectionThree {
    /// Analyses both models.
    ///
    /// # Errors
    /// [`MatrixError`]; not for the paper's models.
    pub fn new() -> Result<Self, MatrixError> {
        let (a, b) = flat_chain();
        let flat = ModelAnalysis::new("F-LTI", &FLAT_STATE_NAMES, &FLAT_INPUT_NAMES, dense(&a), dense(&b))?;
        let (a, b) = linearise(&hover_state(), &hover_input());
        let equilibrium = ModelAnalysis::new("E-LTI", &STATE_NAMES, &INPUT_NAMES, dense(&a), dense(&b))?;
        Ok(Self { flat, equilibrium })
    }
}

fn dense<const R: usize, const C: usize>(m: &nalgebra::SMatrix<f64, R, C>) -> DMatrix<f64> {
    DMatrix::from_column_slice(R, C, m.as_slice())
}
