//! Rows of a matrix in; an orthogonal transformation that leaves nothing below as many of them as its rank, and the
//! rank, out.

use nalgebra::DMatrix;

/// Householder QR with column pivoting of `m`: applies the orthogonal factor to the rows of `basis` too and returns how
/// many pivots exceed `threshold`.
pub(super) fn compress_rows(mut m: DMatrix<f64>, threshold: f64, basis: &mut DMatrix<f64>) -> usize {
    let (rows, columns) = m.shape();
    for k in 0..rows.min(columns) {
        let tail = |j: usize| m.view((k, j), (rows - k, 1)).norm();
        // The first of the largest: keeps ties, and so the paper's permutation, in the order of the columns.
        let (mut pivot, mut largest) = (k, tail(k));
        for j in k + 1..columns {
            let norm = tail(j);
            if norm > largest {
                (pivot, largest) = (j, norm);
            }
        }
        if largest <= threshold {
            return k;
        }
        m.swap_columns(k, pivot);
        let column: Vec<f64> = (k..rows).map(|i| m[(i, k)]).collect();
        let reflection = Reflection::onto_first_axis(&column);
        reflection.apply_to_rows(&mut m, k);
        reflection.apply_to_rows(basis, k);
    }
    rows.min(columns)
}

/// Another orthonormal basis, as rows, of the same space: row echelon form with positive leading entries.
pub(super) fn echelon(mut rows: DMatrix<f64>) -> DMatrix<f64> {
    let mut step = 0;
    for j in 0..rows.ncols() {
        if step == rows.nrows() {
            break;
        }
        let column: Vec<f64> = (step..rows.nrows()).map(|i| rows[(i, j)]).collect();
        // Unit rows: a smaller entry is either rounding or no good to lead a row.
        if column.iter().map(|value| value * value).sum::<f64>() > 1e-12 {
            Reflection::onto_first_axis(&column).apply_to_rows(&mut rows, step);
            if rows[(step, j)] < 0.0 {
                rows.row_mut(step).neg_mut();
            }
            step += 1;
        }
    }
    rows
}

/// `I - beta v v'`.
struct Reflection {
    v: Vec<f64>,
    beta: f64,
}

impl Reflection {
    fn onto_first_axis(x: &[f64]) -> Self {
        let mut v = x.to_vec();
        // Already on the axis: nothing to do, and no sign to flip.
        if x[1..].iter().all(|value| *value == 0.0) {
            return Self { v, beta: 0.0 };
        }
        let norm = x.iter().map(|value| value * value).sum::<f64>().sqrt();
        v[0] += norm.copysign(x[0]);
        let beta = 2.0 / v.iter().map(|value| value * value).sum::<f64>();
        Self { v, beta }
    }

    /// Applies it to rows `first..` of `m`.
    fn apply_to_rows(&self, m: &mut DMatrix<f64>, first: usize) {
        for mut column in m.column_iter_mut() {
            let sum = self.beta * self.v.iter().enumerate().map(|(i, v)| v * column[first + i]).sum::<f64>();
            for (i, v) in self.v.iter().enumerate() {
                column[first + i] -= sum * v;
            }
        }
    }
}
