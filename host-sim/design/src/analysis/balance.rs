//! Diagonal similarity by powers of two that evens out row and column norms (Parlett and Reinsch 1969).

use nalgebra::{DMatrix, DVector};

/// `(D^-1 m D, diag D)` with `D` powers of two, so that no digit changes.
///
/// A step is taken where it lowers the sum of the row's and the column's 2-norm by 5 %, at most 20 sweeps. The 2-norm
/// (James, Langou and Lowery 2014) does not ruin matrices that are nearly in Hessenberg form.
pub(crate) fn balance(m: &DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let n = m.nrows();
    let mut balanced = m.clone();
    let mut scale = DVector::from_element(n, 1.0);
    for _ in 0..20 {
        let mut changed = false;
        for i in 0..n {
            let (column, row) = (balanced.column(i).norm(), balanced.row(i).norm());
            if column == 0.0 || row == 0.0 || !column.is_finite() || !row.is_finite() {
                continue;
            }
            let exponent = (0.5 * (row / column).log2()).round().clamp(-500.0, 500.0);
            let factor = exponent.exp2();
            let diagonal = balanced[(i, i)].abs();
            let after = (column * factor).max(diagonal) + (row / factor).max(diagonal);
            let applied = scale[i] * factor;
            if after < 0.95 * (column + row) && (1e-150..1e150).contains(&applied) {
                balanced.column_mut(i).scale_mut(factor);
                balanced.row_mut(i).scale_mut(1.0 / factor);
                scale[i] = applied;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    (balanced, scale)
}
