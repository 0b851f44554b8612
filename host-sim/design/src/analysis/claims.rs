//! The claims of Section III, each beside the models' answer.

use serde::Serialize;

use super::{ModelAnalysis, SectionThree};

/// One statement of the paper, checked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// Its place in the paper.
    pub source: &'static str,
    /// Its text.
    pub statement: &'static str,
    /// The computed answer.
    pub computed: String,
    /// Whether the two agree.
    pub holds: bool,
}

impl SectionThree {
    /// The paper's claims in its order.
    pub fn claims(&self) -> Vec<Claim> {
        let (flat, equilibrium) = (&self.flat, &self.equilibrium);
        let stairs = &equilibrium.staircase;
        let mode = equilibrium.uncontrollable_modes.first().map_or(&[][..], |mode| &mode.combination);
        let all_zero = |model: &ModelAnalysis| model.eigenvalues.iter().all(|value| value.norm() == 0.0);
        let (largest_f, largest_e) = (flat.largest_jordan_block(), equilibrium.largest_jordan_block());
        let n = stairs.a.nrows();
        let orthogonality =
            &stairs.transformation * stairs.transformation.transpose() - nalgebra::DMatrix::identity(n, n);
        let split = stairs.uncontrollable;
        let zero_block =
            stairs.a.view((0, split), (split, stairs.a.ncols() - split)).norm() + stairs.b.rows(0, split).norm();
        vec![
            Claim {
                source: "III-A",
                statement: "all eigenvalues of A_f and A_e are 0",
                computed: format!(
                    "largest |eigenvalue| {:.1e} 1/s and {:.1e} 1/s",
                    largest(flat),
                    largest(equilibrium)
                ),
                holds: all_zero(flat) && all_zero(equilibrium),
            },
            Claim {
                source: "III-A",
                statement: "both have a Jordan block of size 10",
                computed: format!("largest block {largest_f} for A_f and {largest_e} for A_e"),
                holds: largest_f == 10 && largest_e == 10,
            },
            Claim {
                source: "III-A",
                statement: "both models are unstable",
                computed: "a block larger than 1 at an eigenvalue with real part 0 grows without bound".to_owned(),
                holds: grows(flat) && grows(equilibrium),
            },
            Claim {
                source: "III-B",
                statement: "rank(C_f) = 10 and rank(C_e) = 9",
                computed: format!("{} and {}", flat.controllability.rank, equilibrium.controllability.rank),
                holds: flat.controllability.rank == 10 && equilibrium.controllability.rank == 9,
            },
            Claim {
                source: "III-B",
                statement: "an orthogonal T_e gives the form (11)",
                computed: format!(
                    "|T_e T_e' - I| = {:.1e}, zero blocks of (11) {zero_block:.1e}",
                    orthogonality.norm()
                ),
                holds: orthogonality.norm() < stairs.tolerance && zero_block <= stairs.tolerance * stairs.a.norm(),
            },
            Claim {
                source: "III-B",
                statement: "the uncontrollable mode is exactly q0 - 1",
                computed: describe(mode),
                holds: matches!(mode, [(name, coefficient)] if name == "q0" && coefficient.abs() == 1.0),
            },
            Claim {
                source: "III-C",
                statement: "A_u = 0, stable in the sense of Lyapunov",
                computed: format!("A_u is {split} x {split}, |A_u| = {:.1e}", stairs.uncontrollable_a().norm()),
                holds: split == 1 && stairs.uncontrollable_a().norm() == 0.0,
            },
            Claim {
                source: "III-C",
                statement: "(F-LTI) is stabilisable, (E-LTI) is not",
                computed: format!("{} and {}", verdict(flat), verdict(equilibrium)),
                holds: flat.stabilisable && !equilibrium.stabilisable,
            },
            Claim {
                source: "III-D",
                statement: "with |q| = 1 the mode is determined, and the reduced pair (14) is controllable",
                computed: format!(
                    "q0 - 1 = sqrt(1 - q1^2 - q2^2 - q3^2) - 1, of second order; steps {:?} add up to {}",
                    stairs.steps,
                    stairs.steps.iter().sum::<usize>()
                ),
                holds: stairs.steps.iter().sum::<usize>() == 9,
            },
        ]
    }
}

/// A mode as a sum of states.
fn describe(combination: &[(String, f64)]) -> String {
    let terms: Vec<String> = combination.iter().map(|(name, coefficient)| format!("{coefficient:+} {name}")).collect();
    if terms.is_empty() { "none".to_owned() } else { terms.join(" ") }
}

fn largest(model: &ModelAnalysis) -> f64 {
    model.eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max)
}

fn grows(model: &ModelAnalysis) -> bool {
    model.jordan.iter().any(|structure| structure.eigenvalue[0] >= 0.0 && structure.block_sizes.iter().any(|s| *s > 1))
}

fn verdict(model: &ModelAnalysis) -> &'static str {
    if model.stabilisable { "stabilisable" } else { "not stabilisable" }
}
