//! Clamped uniform B-splines: control points in, position and any derivative at a time out.
//!
//! The control points of a derivative are scaled differences of the curve's own ("virtual control points", reference
//! \[10\] of the paper); since a B-spline lies in the convex hull of its control points, a bound on them holds for all t.

mod basis;

use nalgebra::Vector3;
use quatrack_design::model::flat::FlatSample;

use super::Trajectory;
pub use basis::UniformBasis;

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
        let t_s = t_s.clamp(0.0, self.basis.duration_s());
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
        self.basis.degree()
    }

    /// Control points of position, m.
    pub fn control_points_m(&self) -> &[Vector3<f64>] {
        &self.derivatives[0]
    }

    /// Number of polynomial spans.
    pub fn spans(&self) -> usize {
        self.basis.spans()
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
        let t_s = t_s.clamp(0.0, self.basis.duration_s());
        let span = self.span_at(t_s);
        self.basis(order, span, t_s).iter().enumerate().map(|(i, value)| points[span + i] * *value).sum()
    }
}

impl Trajectory for BSpline {
    fn duration_s(&self) -> f64 {
        self.basis.duration_s()
    }

    fn at(&self, t_s: f64) -> FlatSample {
        let at_rest = !(0.0..=self.basis.duration_s()).contains(&t_s);
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
mod tests;
