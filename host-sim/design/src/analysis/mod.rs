//! Section III of the paper: poles, Jordan blocks, controllability, stabilisability.
//!
//! In flow a pair (A, B), dense and of any size; out flow numbers and orthogonal transformations, each rank with the
//! tolerance it was decided by. Nothing here can hang: every iteration is bounded and ends in a [`MatrixError`].
//!
//! - [`eigenvalues`]: balanced, bounded Francis QR.
//! - [`jordan_blocks`]: from the ranks of the powers of `A - lambda I`.
//! - [`controllability_matrix`] (10), [`Staircase`] (11), [`pbh_test`]: the states that the input reaches, three ways.
//! - [`SectionThree`]: all of it for (F-LTI) and (E-LTI), with the names of the states.

mod balance;
mod claims;
mod controllability;
mod error;
mod jordan;
mod schur;
mod section_three;
mod singular;

pub(crate) use balance::balance;
pub use claims::Claim;
pub(crate) use controllability::moves;
pub use controllability::{PbhTest, Staircase, controllability_matrix, pbh_test, staircase};
pub use error::MatrixError;
pub(crate) use error::{require_finite, require_square};
pub use jordan::{JordanStructure, distinct_eigenvalues, jordan_blocks};
pub(crate) use schur::{ComplexSchur, complex_schur};
pub use schur::{eigenvalues, spectral_abscissa};
pub use section_three::{ModelAnalysis, SectionThree, UncontrollableMode};
pub use singular::{NumericalRank, numerical_rank, singular_values};
