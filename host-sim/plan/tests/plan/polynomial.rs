//! Polynomial pieces: the same curve as the spline they come from, and only curves that can be flown.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::bspline::BSpline;
use quatrack_plan::trajectory::polynomial::{Coordinate, Piece, PiecewisePolynomial, PolynomialError};

/// Control points of the size of the paper's: a metre or two.
fn wavy(degree: usize, spans: usize) -> BSpline {
    let point = |i: usize| {
        let phase = i as f64;
        Vector3::new((1.3 * phase).sin(), (0.7 * phase).cos(), 0.5 + 0.4 * (2.1 * phase).sin())
    };
    BSpline::new(degree, 12.0, (0..spans + degree).map(point).collect()).expect("valid control points")
}

fn line(duration_s: f64, from: f64, slope: f64) -> Piece {
    let mut coefficients = [[0.0; 8]; 4];
    coefficients[0][0] = from;
    coefficients[0][1] = slope;
    Piece { duration_s, coefficients }
}

#[test]
fn pieces_are_the_spline_of_any_degree() {
    for degree in 1..=7 {
        let spline = wavy(degree, 38);
        let pieces = PiecewisePolynomial::from_bspline(&spline).expect("a spline of a few metres");
        assert_eq!(pieces.pieces().len(), 38);
        for k in 0..=1200 {
            // Off the joints, so that both sides look at the same span; derivatives of low degrees jump there.
            let t = 12.0 * (f64::from(k) + 0.37) / 1201.0;
            let (a, b) = (pieces.at(t), spline.at(t));
            let off = [
                a.position_m - b.position_m,
                a.velocity_m_s - b.velocity_m_s,
                a.acceleration_m_s2 - b.acceleration_m_s2,
                a.jerk_m_s3 - b.jerk_m_s3,
            ];
            for (order, off) in off.into_iter().enumerate() {
                // Where the knots coincide, the terms c_k w^k of a span of w = 12/38 s are up to C(d, k) 2^k |P|; they
                // sum to 3^d |P|, each rounded, with |P| < 2 m; times up to 12 s are rounded where the curve rises by up
                // to 2d/w |P|. Each derivative brings 2d/w. At degree 7: 1.2e-12 m in position.
                let steepness = 2.0 * degree as f64 * 38.0 / 12.0;
                let rounding = (3_f64.powi(degree as i32) + 12.0 * steepness) * 2.0 * f64::EPSILON;
                let tolerance = rounding * steepness.powi(order as i32);
                assert!(off.norm() <= tolerance, "degree {degree}, t = {t}, derivative {order}: {off}");
            }
            assert_eq!(a.heading_rad, 0.0);
        }
        assert_eq!(pieces.duration_s(), 12.0);
    }
}

#[test]
fn pieces_take_as_long_as_the_spline_to_the_bit() {
    // 38 times 30/38 s adds up to 29.999999999999986 s; 3 * 0.1 / 3 is not 0.1 either.
    for (duration_s, spans) in [(30.0, 38), (0.1, 3), (12.0, 38), (1.0 / 3.0, 49), (7.7, 1)] {
        let points = (0..spans + 5).map(|i| Vector3::new(f64::from(i).sin(), 0.0, 1.0)).collect();
        let spline = BSpline::new(5, duration_s, points).expect("valid control points");
        let pieces = PiecewisePolynomial::from_bspline(&spline).expect("a spline of a metre");
        assert_eq!(pieces.duration_s(), duration_s, "{spans} spans");
        // The end is flown, and the time after it is at rest.
        assert!(pieces.at(duration_s).velocity_m_s.x != 0.0);
        assert_eq!(pieces.at(duration_s.next_up()).velocity_m_s.x, 0.0);
    }
}

#[test]
fn derivatives_are_those_of_the_monomials() {
    // x = t^7 alone: at t = 2, 2^7, 7 * 2^6, 42 * 2^5, 210 * 2^4; integers, so exact.
    let mut piece = line(3.0, 0.0, 0.0);
    piece.coefficients[0][7] = 1.0;
    let at = |order| piece.derivative(Coordinate::X, order, 2.0);
    assert_eq!([at(0), at(1), at(2), at(3)], [128.0, 448.0, 1344.0, 3360.0]);
}

#[test]
fn joints_belong_to_the_later_piece_and_the_ends_rest() {
    let pieces = PiecewisePolynomial::new(vec![line(1.0, 0.0, 1.0), line(0.5, 1.0, -2.0)]).expect("continuous");
    assert_eq!(pieces.duration_s(), 1.5);
    let x = |t: f64| (pieces.at(t).position_m.x, pieces.at(t).velocity_m_s.x);
    assert_eq!(x(-1.0), (0.0, 0.0), "rests at the start");
    assert_eq!(x(0.75), (0.75, 1.0));
    assert_eq!(x(1.0), (1.0, -2.0), "the later piece");
    assert_eq!(x(1.5), (0.0, -2.0), "the end itself still flies");
    assert_eq!(x(2.0), (0.0, 0.0), "rests at the end");
}

#[test]
fn a_jump_in_position_is_refused_by_name() {
    let jump = |size: f64| PiecewisePolynomial::new(vec![line(1.0, 0.0, 1.0), line(1.0, 1.0 + size, 0.0)]);
    // 1.1e-6 m is the largest gap in the public figure8.csv: 6 decimals.
    assert!(jump(1.1e-6).is_ok());
    // 9.9e-4 m and 1.01e-3 m are on either side of the tolerance of 1 mm.
    assert!(jump(9.9e-4).is_ok());
    let error = jump(-1.01e-3).expect_err("more than a millimetre");
    assert!(matches!(error, PolynomialError::Jump { piece: 1, coordinate: Coordinate::X, .. }));
    assert_eq!(
        error.to_string(),
        "x jumps by 0.001010 m from the end of piece 1 (1.000000) to the start of piece 2 (0.998990); less than 0.001 m \
         can be flown: correct x^0 of piece 2 or the duration of piece 1"
    );
}

#[test]
fn whole_turns_of_heading_are_taken_off() {
    let with_yaw = |from: f64, slope: f64| {
        let mut piece = line(1.0, 0.0, 0.0);
        piece.coefficients[3][0] = from;
        piece.coefficients[3][1] = slope;
        piece
    };
    // Turns past pi; the file wraps there by one turn, then by two the other way.
    let wrapped = vec![with_yaw(3.0, 0.5), with_yaw(3.5 - TAU, 0.5), with_yaw(4.0 + 2.0 * TAU, 0.0)];
    let pieces = PiecewisePolynomial::new(wrapped).expect("the same attitude on both sides");
    for (t, heading) in [(0.5, 3.25), (1.5, 3.75), (2.5, 4.0)] {
        // Turns taken off and put on again: a few roundings of numbers below 20.
        assert!((pieces.at(t).heading_rad - heading).abs() < 1e-14, "t = {t}");
    }
    let error = PiecewisePolynomial::new(vec![with_yaw(0.0, 0.0), with_yaw(0.5 * TAU, 0.0)]).expect_err("half a turn");
    assert!(matches!(error, PolynomialError::Jump { coordinate: Coordinate::Yaw, .. }));
    assert!(error.to_string().starts_with("yaw jumps by 3.141593 rad"), "{error}");
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    assert_eq!(PiecewisePolynomial::new(vec![]), Err(PolynomialError::Empty));
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = PiecewisePolynomial::new(vec![line(1.0, 0.0, 0.0), line(value, 0.0, 0.0)]).expect_err("no time");
        assert!(matches!(error, PolynomialError::Duration { piece: 2, .. }), "{value}");
    }
    let error = PiecewisePolynomial::new(vec![line(1.0, 0.0, f64::NAN)]).expect_err("not a number");
    assert!(matches!(error, PolynomialError::Coefficient { piece: 1, coordinate: Coordinate::X, power: 1, .. }));
    let long = vec![line(1e308, 0.0, 0.0), line(1e308, 0.0, 0.0)];
    assert_eq!(PiecewisePolynomial::new(long), Err(PolynomialError::TotalDuration));
    // Finite coefficients whose end is not: 1e200 * 1e200.
    let error = PiecewisePolynomial::new(vec![line(1e200, 0.0, 1e200), line(1.0, 0.0, 0.0)]).expect_err("overflow");
    assert!(matches!(error, PolynomialError::Jump { piece: 1, .. }));
    let huge = BSpline::new(1, 1e-300, vec![Vector3::zeros(), Vector3::new(1e300, 0.0, 0.0)]).expect("finite points");
    assert!(matches!(PiecewisePolynomial::from_bspline(&huge), Err(PolynomialError::Coefficient { .. })));
}

#[test]
fn what_is_taken_apart_is_put_together_to_the_bit() {
    // 12 / 38 s added up 38 times is not 12 s.
    let whole = PiecewisePolynomial::from_bspline(&wavy(7, 38)).expect("a spline of a few metres");
    let (pieces, boundaries_s) = (whole.pieces().to_vec(), whole.boundaries_s().to_vec());
    assert_ne!(PiecewisePolynomial::new(pieces.clone()).expect("continuous").boundaries_s(), boundaries_s);
    assert_eq!(PiecewisePolynomial::put_together(pieces.clone(), &boundaries_s), Ok(whole));
    for (place, value, piece) in
        [(0, 0.1, 1), (3, boundaries_s[3] + 1e-3, 3), (38, f64::NAN, 38), (38, f64::INFINITY, 38)]
    {
        let mut moved = boundaries_s.clone();
        moved[place] = value;
        let refused = PiecewisePolynomial::put_together(pieces.clone(), &moved);
        assert!(matches!(refused, Err(PolynomialError::Boundaries { piece: of, .. }) if of == piece), "{refused:?}");
    }
    let short = PiecewisePolynomial::put_together(pieces, &boundaries_s[..38]);
    assert!(matches!(short, Err(PolynomialError::Boundaries { piece: 38, .. })), "{short:?}");
}
