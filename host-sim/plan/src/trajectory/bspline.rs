//! Clamped uniform B-splines: control points in, position and any derivative at a time out.
//!
//! The control points of a derivative are scaled differences of the curve's own ("virtual control points", reference
//! \[10\] of the paper); since a B-spline lies in the convex hull of its control points, a bound on them holds for all t.

use nalgebra::Vector3;
use quatrack_design::model::flat::FlatSample;

use super::Trajectory;

/// Why control points do not make a spline.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BSplineError {
    /// Degree outside 1..=7; 7 is the degree of the on-board pieces.
    #[error("degree = {0}: must be from 1 to 7")]
    Degree(usize),
    /// Not enough control points for one span.
    #[error("{found} control points: a spline of degree {degree} needs at least {}", degree + 1)]
    TooFewControlPoints {
        /// The spline's degree.
        degree: usize,
        /// The number found.
        found: usize,
    },
    /// Zero, negative or not a number.
    #[error("duration_s = {0}: must be a positive number of seconds")]
    Duration(f64),
    /// A control point that is not finite.
    #[error("control point {index} (from 0) has the coordinate {value}: must be a finite number of metres")]
    ControlPoint {
        /// Its number, from 0.
        index: usize,
        /// The first coordinate that is not finite.
        value: f64,
    },
    /// Another number of control points of the heading than of the position, or one that is not finite.
    #[error("heading_control_points_rad: must be {expected} finite numbers, one for each control point")]
    Heading {
        /// The number required.
        expected: usize,
    },
}

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
    fn knot(&self, i: usize) -> f64 {
        self.duration_s * i.saturating_sub(self.degree).min(self.spans) as f64 / self.spans as f64
    }

    /// Degree over knot distance, 1/s: times the difference of control points `j + 1` and `j` of derivative `k - 1`, it
    /// is control point `j` of derivative `k`.
    fn difference_rate(&self, k: usize, j: usize) -> f64 {
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

/// A clamped uniform B-spline of position, and of the heading, which is 0 unless it is given.
#[derive(Clone, Debug, PartialEq)]
pub struct BSpline {
    basis: UniformBasis,
    /// Control points of every derivative: entry `k` in m/s^k, from 0 to the degree.
    derivatives: Vec<Vec<Vector3<f64>>>,
    /// The same of the heading, rad/s^k; empty where it is 0.
    heading: Vec<Vec<f64>>,
}

impl BSpline {
    /// A spline of `degree` over `[0, duration_s]` with `control_points_m.len() - degree` spans of equal length.
    ///
    /// # Errors
    /// [`BSplineError`] names the value out of range.
    pub fn new(degree: usize, duration_s: f64, control_points_m: Vec<Vector3<f64>>) -> Result<Self, BSplineError> {
        if (1..=7).contains(&degree) && control_points_m.len() <= degree {
            return Err(BSplineError::TooFewControlPoints { degree, found: control_points_m.len() });
        }
        let basis = UniformBasis::new(degree, control_points_m.len().saturating_sub(degree), duration_s)?;
        for (index, point) in control_points_m.iter().enumerate() {
            if let Some(&value) = point.iter().find(|v| !v.is_finite()) {
                return Err(BSplineError::ControlPoint { index, value });
            }
        }
        let mut derivatives = vec![control_points_m];
        for k in 1..=degree {
            let differences = derivatives[k - 1].windows(2).enumerate();
            let next = differences.map(|(j, pair)| (pair[1] - pair[0]) * basis.difference_rate(k, j)).collect();
            derivatives.push(next);
        }
        Ok(Self { basis, derivatives, heading: Vec::new() })
    }

    /// The same curve with a heading of as many control points, rad.
    ///
    /// # Errors
    /// [`BSplineError::Heading`] for another number of them, or one that is not finite.
    pub fn with_heading(mut self, control_points_rad: Vec<f64>) -> Result<Self, BSplineError> {
        let expected = self.basis.control_points();
        if control_points_rad.len() != expected || !control_points_rad.iter().all(|value| value.is_finite()) {
            return Err(BSplineError::Heading { expected });
        }
        self.heading = vec![control_points_rad];
        for k in 1..=self.degree() {
            let differences = self.heading[k - 1].windows(2).enumerate();
            let next = differences.map(|(j, pair)| (pair[1] - pair[0]) * self.basis.difference_rate(k, j)).collect();
            self.heading.push(next);
        }
        Ok(self)
    }

    /// Control points of the heading, rad; none where it is 0.
    pub fn heading_control_points_rad(&self) -> Option<&[f64]> {
        self.heading.first().map(Vec::as_slice)
    }

    /// The `order`-th derivative of the heading at `t_s`, clamped to the duration; rad/s^order.
    pub fn heading_derivative(&self, order: usize, t_s: f64) -> f64 {
        let Some(points) = self.heading.get(order) else { return 0.0 };
        let t_s = t_s.clamp(0.0, self.basis.duration_s);
        let span = self.span_at(t_s);
        self.basis(order, span, t_s).iter().zip(&points[span..]).map(|(value, point)| value * point).sum()
    }

    /// The same of the polynomial of a span, at its start too.
    pub(super) fn heading_derivative_in(&self, order: usize, span: usize, t_s: f64) -> f64 {
        let Some(points) = self.heading.get(order) else { return 0.0 };
        self.basis(order, span, t_s).iter().zip(&points[span..]).map(|(value, point)| value * point).sum()
    }

    /// Polynomial degree.
    pub fn degree(&self) -> usize {
        self.basis.degree
    }

    /// Control points of position, m.
    pub fn control_points_m(&self) -> &[Vector3<f64>] {
        &self.derivatives[0]
    }

    /// Number of polynomial spans.
    pub fn spans(&self) -> usize {
        self.basis.spans
    }

    /// Control points of the `order`-th derivative, m/s^order: `len() - order` of them.
    ///
    /// # Panics
    /// If `order` exceeds the degree.
    pub fn derivative_control_points(&self, order: usize) -> Vec<Vector3<f64>> {
        assert!(order <= self.degree(), "a spline of degree {} has no derivative {order}", self.degree());
        self.derivatives[order].clone()
    }

    /// Index of the span that holds `t_s`, the last one at the end.
    pub fn span_at(&self, t_s: f64) -> usize {
        self.basis.span_at(t_s)
    }

    /// Values of the basis functions of the `order`-th derivative's spline (degree `degree - order`) that are not zero
    /// in span `span`: entry `i` belongs to derivative control point `span + i`.
    pub fn basis(&self, order: usize, span: usize, t_s: f64) -> Vec<f64> {
        self.basis.values(order, span, t_s)
    }

    /// The `order`-th derivative at `t_s`, clamped to the duration; m/s^order.
    pub fn derivative(&self, order: usize, t_s: f64) -> Vector3<f64> {
        let Some(points) = self.derivatives.get(order) else {
            return Vector3::zeros();
        };
        let t_s = t_s.clamp(0.0, self.basis.duration_s);
        let span = self.span_at(t_s);
        self.basis(order, span, t_s).iter().enumerate().map(|(i, value)| points[span + i] * *value).sum()
    }
}

impl Trajectory for BSpline {
    fn duration_s(&self) -> f64 {
        self.basis.duration_s
    }

    fn at(&self, t_s: f64) -> FlatSample {
        let at_rest = !(0.0..=self.basis.duration_s).contains(&t_s);
        let derivative = |order| if at_rest { Vector3::zeros() } else { self.derivative(order, t_s) };
        FlatSample {
            position_m: self.derivative(0, t_s),
            velocity_m_s: derivative(1),
            acceleration_m_s2: derivative(2),
            jerk_m_s3: derivative(3),
            heading_rad: self.heading_derivative(0, t_s),
            heading_rate_rad_s: if at_rest { 0.0 } else { self.heading_derivative(1, t_s) },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve without symmetry, in metres over 3 s, of every degree that is allowed.
    fn curve(degree: usize) -> BSpline {
        let point = |i: usize| {
            let x = i as f64;
            Vector3::new((1.3 * x).sin(), 0.4 * x - 1.0, (0.7 * x * x).cos())
        };
        BSpline::new(degree, 3.0, (0..degree + 6).map(point).collect()).unwrap()
    }

    #[test]
    fn basis_functions_are_a_partition_of_unity() {
        for degree in 1..=7 {
            let curve = curve(degree);
            for order in 0..=degree {
                for step in 0..=60 {
                    let t_s = 0.05 * f64::from(step);
                    let values = curve.basis(order, curve.span_at(t_s), t_s);
                    assert_eq!(values.len(), degree - order + 1);
                    // Weights that are not negative and of sum 1 make the curve a mean of its control points; each value
                    // comes from at most 7 roundings of factors below 1.
                    assert!(values.iter().all(|v| *v >= -1e-15), "degree {degree}, order {order}, t {t_s}: {values:?}");
                    assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn derivatives_agree_with_central_differences() {
        for degree in 2..=7 {
            let curve = curve(degree);
            for order in 1..degree {
                // Away from knots (multiples of 0.5 s) the error of a central difference is h^2/6 times the derivative two
                // orders up, which is at most (2 * 7 / 0.5 s)^2 times this one's control points: 1.3e-8 of them.
                let (t_s, h_s) = (1.13, 1e-5);
                let slope =
                    (curve.derivative(order - 1, t_s + h_s) - curve.derivative(order - 1, t_s - h_s)) / (2.0 * h_s);
                let exact = curve.derivative(order, t_s);
                assert!((slope - exact).norm() < 1e-6 * (1.0 + exact.norm()), "degree {degree}, order {order}");
            }
        }
    }

    #[test]
    fn the_derivative_beyond_the_degree_is_zero() {
        assert_eq!(curve(3).derivative(4, 1.0), Vector3::zeros());
        assert_ne!(curve(3).derivative(3, 1.0), Vector3::zeros());
    }

    #[test]
    fn ends_are_the_first_and_last_control_points() {
        for degree in 1..=7 {
            let curve = curve(degree);
            for order in 0..=degree {
                let points = curve.derivative_control_points(order);
                let scale = 1e-14 * points[0].norm().max(points[points.len() - 1].norm());
                assert!((curve.derivative(order, 0.0) - points[0]).norm() <= scale);
                assert!((curve.derivative(order, 3.0) - points[points.len() - 1]).norm() <= scale);
            }
            let (before, after) = (curve.at(-1.0), curve.at(4.0));
            assert_eq!(before.position_m, curve.at(0.0).position_m);
            assert_eq!(after.position_m, curve.at(3.0).position_m);
            assert_eq!((before.velocity_m_s, after.jerk_m_s3), (Vector3::zeros(), Vector3::zeros()));
        }
    }

    #[test]
    fn every_derivative_stays_in_the_hull_of_its_spans_control_points() {
        let curve = curve(5);
        for order in 0..=4 {
            let points = curve.derivative_control_points(order);
            for step in 0..=300 {
                let t_s = 0.01 * f64::from(step);
                let span = curve.span_at(t_s);
                let hull = &points[span..=span + curve.degree() - order];
                let value = curve.derivative(order, t_s);
                // Support function of the hull in a handful of directions; the slack is rounding of the largest point.
                for direction in [Vector3::x(), -Vector3::y(), Vector3::z(), Vector3::new(1.0, -2.0, 0.5)] {
                    let support = hull.iter().map(|p| p.dot(&direction)).fold(f64::NEG_INFINITY, f64::max);
                    assert!(value.dot(&direction) <= support + 1e-13 * (1.0 + support.abs()));
                }
            }
        }
    }

    #[test]
    fn weights_give_the_derivative_from_the_control_points() {
        let curve = curve(5);
        for order in 0..=5 {
            for t_s in [0.0, 0.21, 1.5, 2.99, 3.0] {
                let (first, weights) = curve.basis.derivative_at(order, t_s);
                let points = &curve.control_points_m()[first..first + weights.len()];
                let sum: Vector3<f64> = points.iter().zip(&weights).map(|(p, w)| p * *w).sum();
                let exact = curve.derivative(order, t_s);
                // Differences of order k over spans of 0.5 s lose k digits at the most.
                assert!((sum - exact).norm() <= 1e-12 * (1.0 + exact.norm()), "order {order}, t {t_s}");
            }
        }
    }

    #[test]
    fn a_polynomial_is_reproduced() {
        // Control points at the Greville abscissae (means of `degree` knots) make the identity: x(t) = t, for any degree.
        let basis = UniformBasis::new(5, 4, 2.0).unwrap();
        let greville = |j: usize| (1..=5).map(|i| basis.knot(j + i)).sum::<f64>() / 5.0;
        let points = (0..basis.control_points()).map(|j| Vector3::new(greville(j), 0.0, 0.0)).collect();
        let line = BSpline::new(5, 2.0, points).unwrap();
        for t_s in [0.0, 0.3, 0.5, 1.7, 2.0] {
            assert!((line.derivative(0, t_s).x - t_s).abs() < 1e-14);
            assert!((line.derivative(1, t_s).x - 1.0).abs() < 1e-13);
            assert!(line.derivative(2, t_s).x.abs() < 1e-11);
        }
    }

    #[test]
    fn numbers_that_make_no_spline_are_named() {
        let points = vec![Vector3::zeros(); 6];
        assert_eq!(BSpline::new(0, 1.0, points.clone()), Err(BSplineError::Degree(0)));
        assert_eq!(BSpline::new(8, 1.0, points.clone()), Err(BSplineError::Degree(8)));
        assert_eq!(
            BSpline::new(6, 1.0, points.clone()),
            Err(BSplineError::TooFewControlPoints { degree: 6, found: 6 })
        );
        assert_eq!(BSpline::new(5, 0.0, points.clone()), Err(BSplineError::Duration(0.0)));
        assert_eq!(BSpline::new(5, f64::INFINITY, points.clone()), Err(BSplineError::Duration(f64::INFINITY)));
        let mut broken = points;
        broken[2].y = f64::NEG_INFINITY;
        let error = BSplineError::ControlPoint { index: 2, value: f64::NEG_INFINITY };
        assert_eq!(BSpline::new(5, 1.0, broken), Err(error));
    }
}
