//! Curves of every degree against their control points, against differences, and against a line that is known.

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
            let slope = (curve.derivative(order - 1, t_s + h_s) - curve.derivative(order - 1, t_s - h_s)) / (2.0 * h_s);
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
    assert_eq!(BSpline::new(6, 1.0, points.clone()), Err(BSplineError::TooFewControlPoints { degree: 6, found: 6 }));
    assert_eq!(BSpline::new(5, 0.0, points.clone()), Err(BSplineError::Duration(0.0)));
    assert_eq!(BSpline::new(5, f64::INFINITY, points.clone()), Err(BSplineError::Duration(f64::INFINITY)));
    let mut broken = points;
    broken[2].y = f64::NEG_INFINITY;
    let error = BSplineError::ControlPoint { index: 2, value: f64::NEG_INFINITY };
    assert_eq!(BSpline::new(5, 1.0, broken), Err(error));
}
