//! Linear matrix equations in the Schur basis of A, a column at a time: the part that the Lyapunov and the Stein
//! equation share.
//!
//! In flow the Schur form `A = U T U*`, the right-hand side, and for each column the contribution of the columns before it;
//! out flows X, symmetric.

use nalgebra::{DMatrix, DMatrixView, DVectorViewMut};
use num_complex::Complex64;

use crate::analysis::ComplexSchur;

/// The matrix of a column's equation: `adjoint T* + identity I`, lower triangular.
pub(super) struct Pencil {
    pub(super) adjoint: Complex64,
    pub(super) identity: Complex64,
}

/// Solves for `Y = U* X U` from the right-hand side `-U* C U` and turns it back.
///
/// `reduce` is given T, the columns that are known and the next one: it takes their contribution off that column and
/// tells its equation. Not finite where a pencil is singular.
pub(super) fn solve_by_columns(
    schur: &ComplexSchur,
    c: &DMatrix<f64>,
    reduce: impl Fn(&DMatrix<Complex64>, DMatrixView<'_, Complex64>, &mut DVectorViewMut<'_, Complex64>) -> Pencil,
) -> DMatrix<f64> {
    let (u, t) = (&schur.unitary, &schur.triangular);
    let n = t.nrows();
    // Real products run at many times the speed of complex ones.
    let (re, im) = (u.map(|value| value.re), u.map(|value| value.im));
    let (c_re, c_im) = (c * &re, c * &im);
    let (re_transposed, im_transposed) = (re.transpose(), im.transpose());
    let turned_re = &re_transposed * &c_re + &im_transposed * &c_im;
    let turned_im = &re_transposed * c_im - &im_transposed * c_re;
    let mut y = turned_re.zip_map(&turned_im, |re, im| -Complex64::new(re, im));
    for j in 0..n {
        let (known, mut open) = y.columns_range_pair_mut(0..j, j..n);
        let mut column = open.column_mut(0);
        let Pencil { adjoint, identity } = reduce(t, known.as_view(), &mut column);
        for i in 0..n {
            let sum: Complex64 = (0..i).map(|k| t[(k, i)].conj() * column[k]).sum();
            column[i] = (column[i] - adjoint * sum) / (adjoint * t[(i, i)].conj() + identity);
        }
    }
    // The real part of U Y U*.
    let (y_re, y_im) = (y.map(|value| value.re), y.map(|value| value.im));
    let x = (&re * &y_re - &im * &y_im) * re_transposed + (re * y_im + im * y_re) * im_transposed;
    (&x + x.transpose()) * 0.5
}
