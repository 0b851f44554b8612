//! Every generated file of a checkout: its folder of designs in; the right contents of each file, and where the committed
//! one differs, out.
//!
//! | file | from |
//! |---|---|
//! | `gains/generated/*` | `gains/*.toml` |
//! | `core/src/gains/paper.rs` | the paper's weights |
//! | `core/src/gains/cascade.rs` | `gains/cascade-*.toml` |
//! | `crazyflie/src/builtin/paper_limits.rs` | `gains/lyap-*.toml`, `gains/lqr-*.toml` |
//! | `plans/*.rs` | `plans/*.toml` |

use std::path::{Path, PathBuf};

use quatrack_design::design::{DesignError, codegen};
use quatrack_plan::plan::{Plan, PlanError, paper, stored};
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::{PiecewisePolynomial, PolynomialError};
use thiserror::Error;

use crate::crazyflie::{CodegenError, paper_limits};
use crate::gains::{BuiltInError, Checked, Comparison, Failed, built_in_source, check_folder};

/// A solver's last digits differ between machines, and with them those of the coefficients: by at most this share of a
/// coefficient, or of 1 where it is smaller.
const SAME_COEFFICIENT: f64 = 1e-6;

/// Why there is nothing to compare with.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// A design gives no table, or the folder cannot be read.
    #[error("{}: {}", .0.path.display(), .0.error)]
    Table(Failed),
    /// A source of the core has no contents.
    #[error("core/src/gains/paper.rs: {0}")]
    Core(#[from] DesignError),
    /// A built-in table of the cascade has no design.
    #[error("core/src/gains/cascade.rs: {0}")]
    Cascade(#[from] BuiltInError),
    /// A source of the Crazyflie controller has none.
    #[error("crazyflie/src/builtin: {0}")]
    Crazyflie(#[from] CodegenError),
    /// A plan has no solution.
    #[error("plans: {0}")]
    Plan(#[from] PlanError),
    /// Its curve cannot be stored.
    #[error("plans: {0}")]
    Pieces(#[from] PolynomialError),
}

/// Compares everything that belongs to a folder of designs: its tables, and the generated sources of the checkout that it
/// is in. Only the tables where it is in none.
///
/// # Errors
/// [`GenerateError`] for the first file that cannot be made.
pub fn check(folder: &Path) -> Result<Vec<Checked>, GenerateError> {
    let mut checked = check_folder(folder).map_err(GenerateError::Table)?;
    let root = folder.join("..");
    let root = root.canonicalize().unwrap_or(root);
    if ["core/src/gains", "crazyflie/src/builtin", "plans"].iter().all(|inner| root.join(inner).is_dir()) {
        checked.extend(sources(&root)?);
    }
    Ok(checked)
}

/// The generated sources of a checkout.
fn sources(root: &Path) -> Result<Vec<Checked>, GenerateError> {
    let at = |path: &str| -> PathBuf { root.join(path) };
    let exact = |path: &str, contents: String| Checked::against(at(path), contents.into_bytes(), Comparison::Bytes);
    let planned = |path: &str, name: &str, plan: Plan| -> Result<Checked, GenerateError> {
        let pieces = on_board::pieces(&PiecewisePolynomial::from_bspline(&plan.solve()?)?);
        let contents = stored::rust_source(name, &pieces);
        Ok(Checked::against(at(path), contents.into_bytes(), Comparison::Numbers(SAME_COEFFICIENT)))
    };
    Ok(vec![
        exact("core/src/gains/paper.rs", codegen::paper_tables()?),
        exact("core/src/gains/cascade.rs", built_in_source(&at("gains"))?),
        exact("crazyflie/src/builtin/paper_limits.rs", paper_limits()?),
        planned("plans/mild.rs", "MILD", paper::mild()?)?,
        planned("plans/aggressive.rs", "AGGRESSIVE", paper::aggressive()?)?,
    ])
}
