//! Clamped uniform B-splines: control points in, position and any derivative at a time out.
//!
//! The control points of a derivative are scaled differences of the curve's own ("virtual control points", reference
//! [10] of the paper); since a B-spline lies in the convex hull of its control points, a bound on them holds for all t.

use nalgebra::Vector3;

use super::{FlatSample, Trajectory};

/// A clamped uniform B-spline of position; heading 0.
#[derive(Clone, Debug, PartialEq)]
pub struct BSpline {
    degree: usize,
    duration_s: f64,
    control_points_m: Vec<Vector3<f64>>,
}

/// Why control points do not make a spline.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BSplineError {
    /// Degree outside 1..=7; 7 is what the on-board pieces carry.
    #[error("degree = {0}: must be from 1 to 7")]
    Degree(usize),
    /// Not enough control points for one span.
    #[error("{found} control points: a spline of degree {degree} needs at least {}", degree + 1)]
    TooFewControlPoints {
        /// The spline's degree.
        degree: usize,
        /// How many there are.
        found: usize,
    },
    /// Zero, negative or not a number.
    #[error("duration_s = {0}: must be a positive number of seconds")]
    Duration(f64),
    /// A control point that is not finite.
    #[error("control point {index} (from 0) has the coordinate {value}: must be a finite number of metres")]
    ControlPoint {
        /// Which one, from 0.
        index: usize,
        /// The first coordinate that is not finite.
        value: f64,
    },
}

impl BSpline {
    /// A spline of `degree` over `[0, duration_s]` with `control_points_m.len() - degree` spans of equal length.
    ///
    /// # Errors
    /// [`BSplineError`] names what is out of range.
    pub fn new(degree: usize, duration_s: f64, control_points_m: Vec<Vector3<f64>>) -> Result<Self, BSplineError> {
        if !(1..=7).contains(&degree) {
            return Err(BSplineError::Degree(degree));
        }
        if control_points_m.len() <= degree {
            return Err(BSplineError::TooFewControlPoints { degree, found: control_points_m.len() });
        }
        if !(duration_s > 0.0 && duration_s.is_finite()) {
            return Err(BSplineError::Duration(duration_s));
        }
        for (index, point) in control_points_m.iter().enumerate() {
            if let Some(&value) = point.iter().find(|v| !v.is_finite()) {
                return Err(BSplineError::ControlPoint { index, value });
            }
        }
        Ok(Self { degree, duration_s, control_points_m })
    }

    /// Polynomial degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Control points of position, m.
    pub fn control_points_m(&self) -> &[Vector3<f64>] {
        &self.control_points_m
    }

    /// Number of polynomial spans.
    pub fn spans(&self) -> usize {
        self.control_points_m.len() - self.degree
    }

    /// Knot `i` of the clamped uniform knot vector for control points of the curve itself.
    fn knot(&self, i: usize) -> f64 {
        let spans = self.spans();
        self.duration_s * i.saturating_sub(self.degree).min(spans) as f64 / spans as f64
    }

    /// Control points of the `order`-th derivative, m/s^order: `len() - order` of them.
    ///
    /// # Panics
    /// If `order` exceeds the degree.
    pub fn derivative_control_points(&self, order: usize) -> Vec<Vector3<f64>> {
        assert!(order <= self.degree, "a spline of degree {} has no derivative {order}", self.degree);
        let mut points = self.control_points_m.clone();
        for k in 1..=order {
            let degree = (self.degree - k + 1) as f64;
            points = (0..points.len() - 1)
                .map(|j| {
                    let width = self.knot(j + self.degree + 1) - self.knot(j + k);
                    (points[j + 1] - points[j]) * (degree / width)
                })
                .collect();
        }
        points
    }

    /// Index of the span that holds `t_s`, the last one at the end.
    pub fn span_at(&self, t_s: f64) -> usize {
        let spans = self.spans();
        let position = (t_s / self.duration_s * spans as f64).floor();
        (position.max(0.0) as usize).min(spans - 1)
    }

    /// Values of the basis functions of the `order`-th derivative's spline (degree `degree - order`) that are not zero
    /// in span `span`: entry `i` belongs to derivative control point `span + i`.
    pub fn basis(&self, order: usize, span: usize, t_s: f64) -> Vec<f64> {
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

    /// The `order`-th derivative at `t_s`, clamped to the duration; m/s^order.
    pub fn derivative(&self, order: usize, t_s: f64) -> Vector3<f64> {
        if order > self.degree {
            return Vector3::zeros();
        }
        self.evaluate(&self.derivative_control_points(order), order, t_s)
    }

    fn evaluate(&self, points: &[Vector3<f64>], order: usize, t_s: f64) -> Vector3<f64> {
        let t_s = t_s.clamp(0.0, self.duration_s);
        let span = self.span_at(t_s);
        self.basis(order, span, t_s).iter().enumerate().map(|(i, value)| points[span + i] * *value).sum()
    }
}

impl Trajectory for BSpline {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, t_s: f64) -> FlatSample {
        let at_rest = !(0.0..=self.duration_s).contains(&t_s);
        let derivative = |order| if at_rest { Vector3::zeros() } else { self.derivative(order, t_s) };
        FlatSample {
            position_m: self.derivative(0, t_s),
            velocity_m_s: derivative(1),
            acceleration_m_s2: derivative(2),
            jerk_m_s3: derivative(3),
            heading_rad: 0.0,
            heading_rate_rad_s: 0.0,
        }
    }
}
