//! Exchange with other tools: a design in; every matrix with the names and units of its rows and columns out.
//!
//! It has everything that K is computed from: A, B, Q and R for the continuous designs; A_d, B_d and the cost
//! between the samples, Q_d, S_d, R_d, for those at a control rate.

use std::fmt::Write as _;

use nalgebra::DMatrix;
use quatrack_design::analysis::staircase;
use quatrack_design::model::linear::linearise;
use quatrack_design::model::{hover_input, hover_state};
use serde_json::{Map, Value, json};

use super::GainsError;
use super::artifacts::by_rows;
use super::design::{Design, Problem};
use super::designed::{Designed, Poles};
use super::kinds::Gains;
use super::model::SampledProblem;
use super::names::{MODEL_STATES, Signal};

/// A matrix with the meaning of its rows and columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// Its name: `A`, `B`, `Q`, `R`, `K`, `P`, `T_e`, `A_d`...
    pub name: String,
    /// The signals of the rows.
    pub rows: Vec<Signal>,
    /// The signals of the columns.
    pub columns: Vec<Signal>,
    /// The entries.
    pub entries: DMatrix<f64>,
}

/// Everything about a design that another tool needs to compute its gain again.
#[derive(Debug, Clone)]
pub struct Export {
    /// Name of the design.
    pub name: String,
    /// How the gain was computed: `lyapunov`, `lqr`, `sampled-lqr`, `lqi`.
    pub method: &'static str,
    /// mu of a Lyapunov design, 1/s.
    pub mu_1_s: Option<f64>,
    /// Period of a design at a control rate, s.
    pub period_s: Option<f64>,
    /// The matrices.
    pub matrices: Vec<Matrix>,
    /// Poles of the closed loop.
    pub poles: Poles,
}

impl Export {
    /// Computes a design and collects its matrices.
    ///
    /// # Errors
    /// [`GainsError::Design`] where the equations have no solution; [`GainsError::Value`] for gains over time.
    pub fn of(design: &Design) -> Result<Self, GainsError> {
        if let Problem::Along { .. } = design.problem {
            return Err(GainsError::Value {
                key: "method".into(),
                value: "\"along\"".into(),
                must: "one with one gain to be exported; the gains over time are in the design's JSON".into(),
            });
        }
        let designed = Designed::of(design)?;
        let (states, inputs) = (designed.model.states, designed.model.inputs);
        let matrix = |name: &str, rows: &[Signal], columns: &[Signal], entries: DMatrix<f64>| Matrix {
            name: name.to_owned(),
            rows: rows.to_vec(),
            columns: columns.to_vec(),
            entries,
        };
        let (a, b) = (&designed.model.a, &designed.model.b);
        let mut matrices = vec![matrix("A", states, states, a.clone()), matrix("B", states, inputs, b.clone())];
        let mut period_s = None;
        if let Some(weights) = &designed.weights {
            matrices.push(matrix("Q", states, states, weights.q.clone()));
            matrices.push(matrix("R", inputs, inputs, weights.r.clone()));
        }
        if let Some(SampledProblem { held, cost }) = designed.sampled {
            period_s = Some(held.period_s);
            matrices.push(matrix("A_d", states, states, held.a));
            matrices.push(matrix("B_d", states, inputs, held.b));
            matrices.push(matrix("Q_d", states, states, cost.q));
            matrices.push(matrix("S_d", states, inputs, cost.s));
            matrices.push(matrix("R_d", inputs, inputs, cost.r));
        }
        let gain = match (&designed.gains, designed.gain_in_parts) {
            (Gains::Cascade(_), Some(in_parts)) => in_parts,
            (gains, _) => gains.dense(),
        };
        matrices.push(matrix("K", inputs, states, gain));
        for (number, past) in (1..).zip(&designed.past_command_gains) {
            matrices.push(matrix(&format!("K_past_{number}"), inputs, inputs, past.clone()));
        }
        matrices.push(matrix("P", states, states, designed.p.clone()));
        if matches!(designed.gains, Gains::Equilibrium(_) | Gains::Integral(_)) {
            matrices.extend(hover_staircase(inputs)?);
        }
        Ok(Self {
            name: design.name.to_string(),
            method: design.problem.named().1,
            mu_1_s: design.problem.mu_1_s(),
            period_s,
            matrices,
            poles: designed.poles,
        })
    }

    /// As JSON: for each matrix its rows, and the names and units of its rows and columns.
    pub fn to_json(&self) -> Value {
        let matrices: Map<String, Value> = self
            .matrices
            .iter()
            .map(|matrix| {
                let Matrix { name, rows, columns, entries } = matrix;
                (name.clone(), json!({ "rows": rows, "columns": columns, "entries": by_rows(entries) }))
            })
            .collect();
        let (unit, poles) = match &self.poles {
            Poles::Continuous(poles) => ("1/s", poles),
            Poles::Sampled(poles) => ("per sample", poles),
        };
        let poles: Vec<[f64; 2]> = poles.iter().map(|pole| [pole.re, pole.im]).collect();
        json!({
            "schema": "quatrack/export/1",
            "name": self.name,
            "method": self.method,
            "mu_1_s": self.mu_1_s,
            "period_s": self.period_s,
            "matrices": matrices,
            "poles": { "unit": unit, "re_im": poles },
        })
    }

    /// As CSV: an entry a line, with its place and the signals of that. Poles are a matrix of two columns.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("matrix,row,column,value,row_name,row_unit,column_name,column_unit\n");
        // Writing to a string does not fail.
        for Matrix { name, rows, columns, entries } in &self.matrices {
            for (i, row) in rows.iter().enumerate() {
                for (j, column) in columns.iter().enumerate() {
                    let _ = writeln!(
                        text,
                        "{name},{i},{j},{:?},{},{},{},{}",
                        entries[(i, j)],
                        row.name,
                        row.unit,
                        column.name,
                        column.unit
                    );
                }
            }
        }
        let (unit, poles) = match &self.poles {
            Poles::Continuous(poles) => ("1/s", poles),
            Poles::Sampled(poles) => ("1", poles),
        };
        for (i, pole) in poles.iter().enumerate() {
            let _ = writeln!(text, "poles,{i},0,{:?},pole {i},{unit},real part,{unit}", pole.re);
            let _ = writeln!(text, "poles,{i},1,{:?},pole {i},{unit},imaginary part,{unit}", pole.im);
        }
        text
    }
}

/// The hover model with all ten states and the staircase that separates q0, which no input moves: `T_e A_10 T_e'` has
/// it first.
fn hover_staircase(inputs: &[Signal]) -> Result<Vec<Matrix>, GainsError> {
    let (a, b) = linearise(&hover_state(), &hover_input());
    let a = DMatrix::from_column_slice(10, 10, a.as_slice());
    let b = DMatrix::from_column_slice(10, 4, b.as_slice());
    let stairs = staircase(&a, &b).map_err(quatrack_design::design::DesignError::from)?;
    const STAIRS: [&str; 10] = ["s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "s9", "s10"];
    let steps = STAIRS.map(|name| Signal { name, unit: "mixed" }).to_vec();
    let states = MODEL_STATES.to_vec();
    Ok(vec![
        Matrix { name: "A_10".into(), rows: states.clone(), columns: states.clone(), entries: a },
        Matrix { name: "B_10".into(), rows: states.clone(), columns: inputs.to_vec(), entries: b },
        Matrix { name: "T_e".into(), rows: steps, columns: states, entries: stairs.transformation },
    ])
}
