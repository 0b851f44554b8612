//! The solver's edge: a [`Program`] in, values of its variables or the reason why there are none out.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT, SolverStatus, SupportedConeT,
    ZeroConeT,
};

use super::budget::Budget;
use super::program::{Affine, Constraint, Program};

/// The largest entry of `P` and `q` is scaled to this. The gap is absolute for small objectives, so that less loses
/// digits of the curve (at 1, 4e-5 m of the mild flight's); more only makes rounding end the progress earlier.
const LARGEST_OBJECTIVE_ENTRY: f64 = 1e4;

/// Residuals and gap asked of the solver.
#[derive(Clone, Copy)]
pub(super) struct Accuracy {
    /// Tolerance at which it stops.
    asked: f64,
    /// Still taken for a solution where rounding ends the progress before that.
    accepted: f64,
}

impl Accuracy {
    /// For a curve: the mild flight's control points are within 2e-7 m of where tighter ones put them.
    pub(super) const CURVE: Self = Self { asked: 1e-10, accepted: 1e-7 };
    /// For a curve at the edge of its bounds, where rounding can end the progress before any better one.
    pub(super) const EDGE: Self = Self { asked: 1e-8, accepted: 1e-6 };
    /// For a bound of which three digits are told.
    pub(super) const THREE_DIGITS: Self = Self { asked: 1e-7, accepted: 1e-5 };
}

/// The solver's result.
pub(super) enum Outcome {
    /// The optimum.
    Solved(Vec<f64>),
    /// A certificate that no values meet the constraints.
    Infeasible,
    /// Neither; the solver's word for it.
    Failed(String),
    /// The time was up before.
    OutOfTime,
}

/// Solves a cone program by an interior-point method; the same input gives the same output on every run.
pub(super) fn solve(program: &Program, accuracy: Accuracy, budget: &Budget<'_>) -> Outcome {
    if budget.is_over() {
        return Outcome::OutOfTime;
    }
    // Entries of P grow with the eighth power of spans over duration; in a slow flight those of q are the largest.
    let entries = program.quadratic.iter().map(|entry| entry.2).chain(program.linear.iter().copied());
    let largest = entries.map(f64::abs).fold(0.0, f64::max);
    let scale = if program.quadratic.is_empty() || largest == 0.0 { 1.0 } else { LARGEST_OBJECTIVE_ENTRY / largest };
    let quadratic: Vec<_> = program.quadratic.iter().map(|&(i, j, value)| (i, j, scale * value)).collect();
    let linear: Vec<f64> = program.linear.iter().map(|value| scale * value).collect();
    let p = matrix(program.variables, program.variables, &quadratic);
    let mut rows = Rows::default();
    // Equalities first, then inequalities, then cones: clarabel then sees one block of each of the first two.
    for constraint in &program.constraints {
        if let Constraint::Zero(expression) = constraint {
            rows.push(expression);
        }
    }
    let equalities = rows.b.len();
    for constraint in &program.constraints {
        if let Constraint::NonNegative(expression) = constraint {
            rows.push(expression);
        }
    }
    let mut cones: Vec<SupportedConeT<f64>> = vec![ZeroConeT(equalities), NonnegativeConeT(rows.b.len() - equalities)];
    for constraint in &program.constraints {
        if let Constraint::Cone(head, tail) = constraint {
            rows.push(head);
            tail.iter().for_each(|expression| rows.push(expression));
            cones.push(SecondOrderConeT(1 + tail.len()));
        }
    }
    let a = matrix(rows.b.len(), program.variables, &rows.entries);
    let settings = DefaultSettings {
        verbose: false,
        time_limit: budget.left_s().unwrap_or(f64::INFINITY),
        tol_gap_abs: accuracy.asked,
        tol_gap_rel: accuracy.asked,
        tol_feas: accuracy.asked,
        reduced_tol_gap_abs: accuracy.accepted,
        reduced_tol_gap_rel: accuracy.accepted,
        reduced_tol_feas: accuracy.accepted,
        ..DefaultSettings::default()
    };
    let mut solver = match DefaultSolver::new(&p, &linear, &a, &rows.b, &cones, settings) {
        Ok(solver) => solver,
        Err(error) => return Outcome::Failed(error.to_string()),
    };
    solver.solve();
    match solver.solution.status {
        SolverStatus::Solved | SolverStatus::AlmostSolved => Outcome::Solved(solver.solution.x),
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => Outcome::Infeasible,
        SolverStatus::MaxTime => Outcome::OutOfTime,
        status => Outcome::Failed(status.to_string()),
    }
}

/// Rows of `A x + s = b` for slacks `s` that are the affine expressions themselves.
#[derive(Default)]
struct Rows {
    entries: Vec<(usize, usize, f64)>,
    b: Vec<f64>,
}

impl Rows {
    fn push(&mut self, expression: &Affine) {
        let row = self.b.len();
        self.entries.extend(expression.terms.iter().map(|(variable, coefficient)| (row, *variable, -coefficient)));
        self.b.push(expression.constant);
    }
}

fn matrix(rows: usize, columns: usize, entries: &[(usize, usize, f64)]) -> CscMatrix<f64> {
    let at = |pick: fn(&(usize, usize, f64)) -> usize| entries.iter().map(pick).collect();
    CscMatrix::new_from_triplets(rows, columns, at(|e| e.0), at(|e| e.1), entries.iter().map(|e| e.2).collect())
}
