//! Why the equations of a design have no answer, in the design's own words: the error, the model and its weights in; the states that
//! are to blame, with their weights, out.

use nalgebra::{Complex, DMatrix};
use quatrack_design::design::DesignError;

use super::model::{LinearModel, Weights};
use super::names::Signal;

/// A singular value, or a part of a vector, below this share of the largest counts as zero.
const ZERO: f64 = 1e-9;

/// The states that are to blame, and the remedy; nothing where none can be told.
pub(super) fn blamed(
    error: &DesignError,
    model: &LinearModel,
    weights: Option<&Weights>,
    period_s: f64,
) -> Option<String> {
    match error {
        DesignError::NotDetectable { eigenvalue } => unseen(model, weights?, *eigenvalue),
        // A mode per sample is one of the model held over a period.
        DesignError::NotDetectableSampled { eigenvalue } => unseen(model, weights?, eigenvalue.ln() / period_s),
        DesignError::Inaccurate { .. }
        | DesignError::HamiltonianOnAxis { .. }
        | DesignError::ClosedLoopOnCircle { .. }
        | DesignError::Size { .. }
        | DesignError::NotStabilisable { .. } => far_apart(model, weights?),
        _ => None,
    }
}

/// The states of the modes at an eigenvalue that no weight sees: the kernel of `[A - lambda I; Q]`.
fn unseen(model: &LinearModel, weights: &Weights, eigenvalue: Complex<f64>) -> Option<String> {
    let n = model.a.nrows();
    let complex = |m: &DMatrix<f64>| m.map(|value| Complex::new(value, 0.0));
    let mut stacked = DMatrix::zeros(2 * n, n);
    let shifted = complex(&model.a) - DMatrix::from_diagonal_element(n, n, eigenvalue);
    stacked.rows_mut(0, n).copy_from(&shifted);
    // The zero weights decide which modes are seen, not the sizes of the others.
    let sees = weights.q.map(|weight| if weight == 0.0 { 0.0 } else { 1.0 });
    stacked.rows_mut(n, n).copy_from(&complex(&sees));
    let svd = stacked.svd(false, true);
    let (values, rows) = (svd.singular_values, svd.v_t?);
    let most = values.max();
    let in_kernel = |state: usize| {
        let column = rows.column(state);
        let parts = values.iter().zip(&column).filter(|(value, _)| **value <= ZERO.sqrt() * most);
        parts.map(|(_, part)| part.norm()).fold(0.0, f64::max) > ZERO.sqrt()
    };
    let names: Vec<String> =
        (0..n).filter(|state| in_kernel(*state)).map(|state| of_row(model.states, state, weights)).collect();
    let remedy = "no feedback can be optimal in a state that costs nothing for ever: give it a weight";
    (!names.is_empty()).then(|| format!("unseen is {}; {remedy}", names.join(", ")))
}

/// The weights that lie farthest apart.
fn far_apart(model: &LinearModel, weights: &Weights) -> Option<String> {
    let states = weights.q.diagonal();
    let inputs = weights.r.diagonal();
    let named = states.iter().copied().zip(model.states).chain(inputs.iter().copied().zip(model.inputs));
    let mut positive: Vec<(f64, &Signal)> = named.filter(|(weight, _)| *weight > 0.0).collect();
    positive.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ((least, of_least), (most, of_most)) = (positive.first()?, positive.last()?);
    Some(format!(
        "its weights reach from {least:e} of {} to {most:e} of {}: bring them closer together",
        of_least.name, of_most.name
    ))
}

/// A state with its row in Q.
fn of_row(states: &[Signal], state: usize, weights: &Weights) -> String {
    let name = states.get(state).map_or("?", |signal| signal.name);
    format!("{name} (row {} of Q, {:e})", state + 1, weights.q[(state, state)])
}
