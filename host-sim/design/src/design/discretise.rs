//! A continuous pair under inputs that are held between samples: `x' = A x + B u` in, `x+ = A_d x + B_d u` out, exactly.
//!
//! `A_d = e^(A h)` and `B_d = int_0^h e^(A s) ds B` are blocks of one exponential, `e^([A B; 0 0] h)` (Van Loan 1978).
//! An input that arrives `delay` late, `delay = k h + phi` with `0 <= phi < h`, splits the hold in two:
//! `x+ = A_d x + B_0 u(-k) + B_1 u(-k-1)`, `B_0 = int_0^(h-phi) e^(A s) ds B`, `B_1 = e^(A (h-phi)) int_0^phi e^(A s) ds B`.
//! Nothing is approximated: the exponential is summed in 32 digits and rounded once.

use nalgebra::DMatrix;

use super::DesignError;
use super::double_double::{Double, DoubleMatrix};
use crate::analysis::{MatrixError, require_finite, require_square};

/// The series is summed for a matrix whose row sums are at most this, a power of two.
const SERIES_NORM: f64 = 0.0625;
/// Terms at most: `0.0625^22 / 22!` is below 1e-47.
const MAX_TERMS: u32 = 22;
/// Squarings at most: a norm of 1e300 needs 1,001.
const MAX_SQUARINGS: i32 = 1_100;

/// `x+ = A_d x + B_d u` with u held over a period.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// `A_d`, n x n.
    pub a: DMatrix<f64>,
    /// `B_d`, n x m.
    pub b: DMatrix<f64>,
    /// The period h, s.
    pub period_s: f64,
}

/// `x+ = A_d x + B_0 u(-k) + B_1 u(-k-1)`: held inputs that arrive late.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldLate {
    /// `A_d`, n x n.
    pub a: DMatrix<f64>,
    /// `B_0`, n x m, of the input k samples ago.
    pub b_recent: DMatrix<f64>,
    /// `B_1`, n x m, of the input k + 1 samples ago.
    pub b_previous: DMatrix<f64>,
    /// k.
    pub whole_samples: usize,
    /// The period h, s.
    pub period_s: f64,
}

/// `e^M` of a square matrix, rounded once.
///
/// # Errors
/// [`MatrixError`] for a matrix that is not square, empty or not finite, or whose exponential is too large for an f64.
pub fn exponential(m: &DMatrix<f64>) -> Result<DMatrix<f64>, MatrixError> {
    require_square("M", m)?;
    Ok(precise_exponential(m, 1.0)?.hi)
}

/// The pair under inputs held over `period_s`: A n x n, 1/s; B n x m.
///
/// # Errors
/// [`DesignError::Matrix`] for matrices that do not fit, are empty, not finite, or grow beyond an f64 in a period;
/// [`DesignError::Period`].
pub fn zero_order_hold(a: &DMatrix<f64>, b: &DMatrix<f64>, period_s: f64) -> Result<Held, DesignError> {
    require_period(period_s)?;
    let (a, b) = integrated(a, b, period_s)?;
    Ok(Held { a: a.hi, b: b.hi, period_s })
}

/// The pair under inputs held over `period_s` that arrive `delay_s` late.
///
/// # Errors
/// As [`zero_order_hold`], and [`DesignError::Delay`].
pub fn zero_order_hold_late(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    period_s: f64,
    delay_s: f64,
) -> Result<HeldLate, DesignError> {
    require_period(period_s)?;
    if !(delay_s.is_finite() && delay_s >= 0.0) {
        return Err(DesignError::Delay { delay_s });
    }
    let whole = (delay_s / period_s).floor();
    // The remainder of an f64 division is exact, and below the period.
    let late_s = delay_s % period_s;
    let (before, recent) = integrated(a, b, period_s - late_s)?;
    let (after, previous) = integrated(a, b, late_s)?;
    Ok(HeldLate {
        a: before.times(&after).hi,
        b_previous: before.times(&previous).hi,
        b_recent: recent.hi,
        whole_samples: whole as usize,
        period_s,
    })
}

/// As [`zero_order_hold_late`], in the digits of an f64.
///
/// # Errors
/// As [`zero_order_hold_late`].
pub fn zero_order_hold_late_in_f64(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    period_s: f64,
    delay_s: f64,
) -> Result<HeldLate, DesignError> {
    require_period(period_s)?;
    require_fitting(a, b)?;
    if !(delay_s.is_finite() && delay_s >= 0.0) {
        return Err(DesignError::Delay { delay_s });
    }
    let (n, m) = b.shape();
    let integrated = |duration_s: f64| {
        let mut augmented = DMatrix::zeros(n + m, n + m);
        augmented.view_mut((0, 0), (n, n)).copy_from(&(a * duration_s));
        augmented.view_mut((0, n), (n, m)).copy_from(&(b * duration_s));
        let whole = augmented.exp();
        (whole.view((0, 0), (n, n)).into_owned(), whole.view((0, n), (n, m)).into_owned())
    };
    let late_s = delay_s % period_s;
    let (before, b_recent) = integrated(period_s - late_s);
    let (a, b_previous) = if late_s > 0.0 {
        let (after, previous) = integrated(late_s);
        (&before * after, &before * previous)
    } else {
        (before, DMatrix::zeros(n, m))
    };
    require_finite("exp(A t)", &a)?;
    Ok(HeldLate { a, b_recent, b_previous, whole_samples: (delay_s / period_s).floor() as usize, period_s })
}

/// `e^(A t)` and `int_0^t e^(A s) ds B`.
fn integrated(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    duration_s: f64,
) -> Result<(DoubleMatrix, DoubleMatrix), MatrixError> {
    require_fitting(a, b)?;
    let (n, m) = b.shape();
    let mut augmented = DMatrix::zeros(n + m, n + m);
    augmented.view_mut((0, 0), (n, n)).copy_from(a);
    augmented.view_mut((0, n), (n, m)).copy_from(b);
    let whole = precise_exponential(&augmented, duration_s)?;
    let block = |first: usize, columns: usize| DoubleMatrix {
        hi: whole.hi.view((0, first), (n, columns)).into_owned(),
        lo: whole.lo.view((0, first), (n, columns)).into_owned(),
    };
    Ok((block(0, n), block(n, m)))
}

/// `e^(M t)` in 32 digits: scaled by a power of two, Taylor's series, squared back.
///
/// The squarings lose digits in proportion to the growth on the way; there are 16 to spare.
pub(super) fn precise_exponential(m: &DMatrix<f64>, duration_s: f64) -> Result<DoubleMatrix, MatrixError> {
    let n = m.nrows();
    let norm = duration_s * m.row_iter().map(|row| row.iter().map(|value| value.abs()).sum()).fold(0.0, f64::max);
    let squarings = if norm > SERIES_NORM { (norm / SERIES_NORM).log2().ceil() as i32 } else { 0 };
    let squarings = squarings.min(MAX_SQUARINGS);
    let time = Double::new(duration_s);
    let scaled = DoubleMatrix::from_fn(n, n, |i, j| time.times(Double::new(m[(i, j)])))
        .scaled(f64::from(-squarings / 2).exp2())
        .scaled(f64::from(squarings / 2 - squarings).exp2());
    let mut sum = DoubleMatrix::new(DMatrix::identity(n, n));
    let mut term = sum.clone();
    for k in 1..=MAX_TERMS {
        let product = term.times(&scaled);
        let divisor = Double::new(f64::from(k));
        term = DoubleMatrix::from_fn(n, n, |i, j| product.get(i, j).over(divisor));
        // Models of chains are nilpotent: their series ends.
        if term.hi.iter().all(|value| *value == 0.0) {
            break;
        }
        sum = sum.plus(&term);
    }
    for _ in 0..squarings {
        sum = sum.times(&sum);
    }
    require_finite("exp(A t)", &sum.hi)?;
    Ok(sum)
}

/// Refuses a period that is not a positive number.
pub(super) fn require_period(period_s: f64) -> Result<(), DesignError> {
    if period_s.is_finite() && period_s > 0.0 { Ok(()) } else { Err(DesignError::Period { period_s }) }
}

/// Refuses a B whose rows are not those of a square A.
pub(super) fn require_fitting(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Result<(), MatrixError> {
    require_square("A", a)?;
    require_finite("B", b)?;
    let (rows, columns) = b.shape();
    if rows == a.nrows() {
        return Ok(());
    }
    Err(MatrixError::Dimension {
        name: "B",
        rows,
        columns,
        expected_rows: a.nrows(),
        expected_columns: columns,
        fits: "A",
    })
}
