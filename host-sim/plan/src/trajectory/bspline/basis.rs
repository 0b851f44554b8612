//! Basis functions of clamped uniform B-splines: degree, spans and duration in; values, and weights of derivatives,
//! out.

use super::BSplineError;

/// The basis functions of clamped uniform B-splines of one degree: a spline before it has control points, for
/// a planner that looks for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformBasis {
    degree: usize,
    spans: usize,
    duration_s: f64,
}

impl UniformBasis {
    /// The basis of `degree` over `[0, duration_s]` cut into `spans` equal spans.
    ///
    /// # Errors
    /// [`BSplineError`] names the value out of range.
    pub fn new(degree: usize, spans: usize, duration_s: f64) -> Result<Self, BSplineError> {
        if !(1..=7).contains(&degree) {
            return Err(BSplineError::Degree(degree));
        }
        if spans == 0 {
            return Err(BSplineError::TooFewControlPoints { degree, found: degree });
        }
        if !(duration_s > 0.0 && duration_s.is_finite()) {
            return Err(BSplineError::Duration(duration_s));
        }
        Ok(Self { degree, spans, duration_s })
    }

    /// Polynomial degree of the curve.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of polynomial spans.
    pub fn spans(&self) -> usize {
        self.spans
    }

    /// Length in time, s.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// How many control points the curve has.
    pub fn control_points(&self) -> usize {
        self.spans + self.degree
    }

    /// Knot `i` of the clamped uniform knot vector for control points of the curve itself.
    pub(super) fn knot(&self, i: usize) -> f64 {
        self.duration_s * i.saturating_sub(self.degree).min(self.spans) as f64 / self.spans as f64
    }

    /// Degree over knot distance, 1/s: times the difference of control points `j + 1` and `j` of derivative `k - 1`, it
    /// is control point `j` of derivative `k`.
    pub(super) fn difference_rate(&self, k: usize, j: usize) -> f64 {
        (self.degree - k + 1) as f64 / (self.knot(j + self.degree + 1) - self.knot(j + k))
    }

    /// Weights that turn control points of the curve into those of its `order`-th derivative: entry `j` holds the
    /// `order + 1` weights, in 1/s^order, of control points `j..=j + order`.
    ///
    /// # Panics
    /// If `order` exceeds the degree.
    pub fn derivative_weights(&self, order: usize) -> Vec<Vec<f64>> {
        assert!(order <= self.degree, "a spline of degree {} has no derivative {order}", self.degree);
        let mut rows = vec![vec![1.0]; self.control_points()];
        for k in 1..=order {
            rows = rows
                .windows(2)
                .enumerate()
                .map(|(j, pair)| {
                    let rate = self.difference_rate(k, j);
                    let mut row = vec![0.0; k + 1];
                    for i in 0..k {
                        row[i] -= rate * pair[0][i];
                        row[i + 1] += rate * pair[1][i];
                    }
                    row
                })
                .collect();
        }
        rows
    }

    /// Index of the span that holds `t_s`, the last one at the end.
    pub fn span_at(&self, t_s: f64) -> usize {
        let position = (t_s / self.duration_s * self.spans as f64).floor();
        (position.max(0.0) as usize).min(self.spans - 1)
    }

    /// Values of the basis functions of the `order`-th derivative's spline (degree `degree - order`) that are not zero
    /// in span `span`: entry `i` belongs to derivative control point `span + i`.
    ///
    /// # Panics
    /// If `order` exceeds the degree.
    pub fn values(&self, order: usize, span: usize, t_s: f64) -> Vec<f64> {
        // Cox-de Boor, from degree 0 upwards; knots are the curve's own with `order` taken off either end.
        let degree = self.degree - order;
        let knot = |i: usize| self.knot(i + order);
        let s = span + degree;
        let mut values = vec![1.0];
        for d in 1..=degree {
            let mut next = vec![0.0; d + 1];
            for (r, value) in values.iter().enumerate() {
                let left = knot(s + 1 + r - d);
                let right = knot(s + 1 + r);
                let share = value / (right - left);
                next[r] += share * (right - t_s);
                next[r + 1] += share * (t_s - left);
            }
            values = next;
        }
        values
    }

    /// The `order`-th derivative at `t_s` in terms of the curve's own control points: the index of the first one that
    /// matters, and the weights, 1/s^order, of it and those that follow.
    ///
    /// # Panics
    /// If `order` exceeds the degree.
    pub fn derivative_at(&self, order: usize, t_s: f64) -> (usize, Vec<f64>) {
        self.derivative_by(&self.derivative_weights(order), order, t_s)
    }

    /// The same by the rows of [`Self::derivative_weights`] for this order: for many times.
    pub(crate) fn derivative_by(&self, rows: &[Vec<f64>], order: usize, t_s: f64) -> (usize, Vec<f64>) {
        let span = self.span_at(t_s);
        let mut weights = vec![0.0; self.degree + 1];
        for (i, value) in self.values(order, span, t_s).iter().enumerate() {
            for (weight, row) in weights[i..].iter_mut().zip(&rows[span + i]) {
                *weight += value * row;
            }
        }
        (span, weights)
    }
}
