//! `quatrack analyze`: Section III in numbers, as tables and as JSON.

mod text;

use nalgebra::DMatrix;
use quatrack_design::analysis::{
    Claim, JordanStructure, ModelAnalysis, NumericalRank, PbhTest, SectionThree, UncontrollableMode,
};
use serde::Serialize;

use super::{Failure, output};
use text::text;

/// Poles, Jordan blocks, controllability and stabilisability of the paper's two linear models (Section III).
///
/// For (F-LTI) and (E-LTI): A and B, eigenvalues, Jordan blocks, the rank of the controllability matrix (10), the
/// orthogonal staircase (11), the uncontrollable mode as a combination of the states, the PBH test at each eigenvalue,
/// and the reduced pair (14); then each claim of the paper beside the computed answer.
#[derive(clap::Args)]
#[command(after_help = "Example: quatrack analyze --json section3.json")]
pub(crate) struct Args {
    /// Also write everything to this file as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let section = SectionThree::new().map_err(Failure::input)?;
    output::print(&text(&section))?;
    if let Some(path) = &args.json {
        output::write_json(path, &output::Named::new("analyze", &Document::new(&section)))?;
        output::print(&format!("\nwrote {}\n", path.display()))?;
    }
    Ok(())
}

/// The JSON document: matrices by rows.
#[derive(Serialize)]
struct Document<'a> {
    models: [Model<'a>; 2],
    claims: Vec<Claim>,
}

#[derive(Serialize)]
struct Model<'a> {
    label: &'a str,
    states: &'a [&'static str],
    inputs: &'a [&'static str],
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
    eigenvalues_per_s: Vec<[f64; 2]>,
    jordan: &'a [JordanStructure],
    controllability_matrix: &'a NumericalRank,
    staircase: StaircaseRecord<'a>,
    pbh: &'a [PbhTest],
    uncontrollable_modes: &'a [UncontrollableMode],
    controllable: bool,
    stabilisable: bool,
}

#[derive(Serialize)]
struct StaircaseRecord<'a> {
    transformation: Vec<Vec<f64>>,
    uncontrollable: usize,
    steps: &'a [usize],
    a_u: Vec<Vec<f64>>,
    a_cu: Vec<Vec<f64>>,
    a_c: Vec<Vec<f64>>,
    b_c: Vec<Vec<f64>>,
    tolerance: f64,
}

impl<'a> Document<'a> {
    fn new(section: &'a SectionThree) -> Self {
        Self { models: [Model::new(&section.flat), Model::new(&section.equilibrium)], claims: section.claims() }
    }
}

impl<'a> Model<'a> {
    fn new(model: &'a ModelAnalysis) -> Self {
        let stairs = &model.staircase;
        let (a_c, b_c) = stairs.controllable_pair();
        Self {
            label: model.label,
            states: &model.states,
            inputs: &model.inputs,
            a: rows(&model.a),
            b: rows(&model.b),
            eigenvalues_per_s: model.eigenvalues.iter().map(|value| [value.re, value.im]).collect(),
            jordan: &model.jordan,
            controllability_matrix: &model.controllability,
            staircase: StaircaseRecord {
                transformation: rows(&stairs.transformation),
                uncontrollable: stairs.uncontrollable,
                steps: &stairs.steps,
                a_u: rows(&stairs.uncontrollable_a()),
                a_cu: rows(&stairs.coupling()),
                a_c: rows(&a_c),
                b_c: rows(&b_c),
                tolerance: stairs.tolerance,
            },
            pbh: &model.pbh,
            uncontrollable_modes: &model.uncontrollable_modes,
            controllable: model.controllable(),
            stabilisable: model.stabilisable,
        }
    }
}

fn rows(m: &DMatrix<f64>) -> Vec<Vec<f64>> {
    m.row_iter().map(|row| row.iter().copied().collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_document_holds_the_reduced_pair_by_rows() {
        let section = SectionThree::new().expect("the paper's models are finite");
        let document = Document::new(&section);
        let hover = &document.models[1].staircase;
        assert_eq!((hover.a_c.len(), hover.a_c[0].len(), hover.b_c[0].len()), (9, 9, 4));
        // vx' = 2 g q2: row 3 of the reduced pair, column 6.
        assert!((hover.a_c[3][6] - 19.62).abs() < 1e-13);
    }
}
