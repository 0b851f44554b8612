//! Gains in f64 in; the source of the core's `f32` tables out.

use std::fmt::Write;

use nalgebra::SMatrix;

use super::DesignError;
use super::along::GainsAlong;
use super::synthesis::{
    EquilibriumWeights, FlatWeights, PAPER_MU, lqr_equilibrium, lqr_flat, lyapunov_equilibrium, lyapunov_flat,
};

/// The smallest entry of a table but 0: that of the core, `quatrack::gains::table::ENTRY_MIN`.
pub const ENTRY_MIN: f32 = 1e-9;

/// A gain as the core flies it: every entry rounded to the nearest f32; by rows.
pub fn rounded<const M: usize, const N: usize>(gain: &SMatrix<f64, M, N>) -> [[f32; N]; M] {
    std::array::from_fn(|row| std::array::from_fn(|column| gain[(row, column)] as f32))
}

/// Gains over time as the core flies them: rounded, and entries smaller than [`ENTRY_MIN`] as zero. Entries
/// that couple the axes fade away where the trajectory rests.
pub fn rounded_along(gains: &GainsAlong) -> Vec<[[f32; 9]; 4]> {
    let kept = |entry: f32| if entry.abs() < ENTRY_MIN { 0.0 } else { entry };
    gains.gains.iter().map(|gain| rounded(gain).map(|row| row.map(kept))).collect()
}

/// The whole of `core/src/gains/paper.rs`: the four designs of the paper.
///
/// # Errors
/// [`DesignError`] where a design has no solution.
pub fn paper_tables() -> Result<String, DesignError> {
    let mut text = String::from(
        "//! The paper's four gain tables, Table I: made by `cargo gains generate` and not edited by hand.\n\n\
         use crate::law::{EquilibriumGain, FlatOutputGain};\n",
    );
    table(
        &mut text,
        "LYAP_F",
        "FlatOutputGain",
        "(LYAP-F): Lyapunov design (15) on the flat chain, every pole at real part -2 1/s.",
        &lyapunov_flat(PAPER_MU)?.gain,
    );
    table(
        &mut text,
        "LYAP_E",
        "EquilibriumGain",
        "(LYAP-E): Lyapunov design (17) at the hover equilibrium, every pole at real part -2 1/s.",
        &lyapunov_equilibrium(PAPER_MU)?.gain,
    );
    table(
        &mut text,
        "LQR_F",
        "FlatOutputGain",
        "(LQR-F): the Riccati equation (20) on the flat chain, with the paper's weights.",
        &lqr_flat(&FlatWeights::paper())?.gain,
    );
    table(
        &mut text,
        "LQR_E",
        "EquilibriumGain",
        "(LQR-E): the Riccati equation (21) at the hover equilibrium, with the paper's weights.",
        &lqr_equilibrium(&EquilibriumWeights::paper())?.gain,
    );
    Ok(text)
}

fn table<const M: usize, const N: usize>(
    text: &mut String,
    name: &str,
    kind: &str,
    doc: &str,
    gain: &SMatrix<f64, M, N>,
) {
    // Writing to a string does not fail.
    let _ = write!(text, "\n/// {doc}\npub static {name}: {kind} = {kind}::table([\n");
    for row in rounded(gain) {
        let _ = writeln!(text, "    {row:?},");
    }
    text.push_str("]);\n");
}
