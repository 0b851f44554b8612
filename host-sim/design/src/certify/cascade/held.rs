//! A chain of the plant under commands that are held over a control period and act late by whole periods: its exact
//! discrete matrices.

use nalgebra::{DMatrix, DVector};

/// A chain in discrete time with one input.
#[derive(Debug, Clone)]
pub(super) struct HeldChain {
    a: DMatrix<f64>,
    b: DVector<f64>,
    /// How many periods commands are late.
    pub(super) late: usize,
}

impl HeldChain {
    /// From `x' = a x + b u`.
    pub(super) fn new(a: &DMatrix<f64>, b: &DVector<f64>, period_s: f64, late: usize) -> Self {
        let n = a.nrows();
        let mut both = DMatrix::zeros(n + 1, n + 1);
        both.view_mut((0, 0), (n, n)).copy_from(a);
        both.view_mut((0, n), (n, 1)).copy_from(b);
        let held = (both * period_s).exp();
        Self { a: held.view((0, 0), (n, n)).into_owned(), b: held.view((0, n), (n, 1)).column(0).into_owned(), late }
    }

    /// Number of states, waiting commands among them.
    pub(super) fn states(&self) -> usize {
        self.a.nrows() + self.late
    }

    /// Moves `x`, the chain's states and the commands that wait, oldest first, on by a period with a new command.
    pub(super) fn advance(&self, x: &mut [f64], command: f64) {
        let n = self.a.nrows();
        let (states, waiting) = x.split_at_mut(n);
        let acting = waiting.first().copied().unwrap_or(command);
        let next = &self.a * DVector::from_column_slice(states) + &self.b * acting;
        states.copy_from_slice(next.as_slice());
        if self.late > 0 {
            waiting.rotate_left(1);
            waiting[self.late - 1] = command;
        }
    }
}
