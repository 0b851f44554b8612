//! Refits: the same curve where it can be, joints without jumps everywhere, and errors as they are stated.

use std::num::NonZeroUsize;

use nalgebra::Vector3;
use quatrack_plan::plan;
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::bspline::BSpline;
use quatrack_plan::trajectory::poly4d::{PIECES_MAX, StoredTrajectory};
use quatrack_plan::trajectory::polynomial::{Coordinate, Piece, PiecewisePolynomial};
use quatrack_plan::trajectory::refit;
use quatrack_simulation::flight::deviation::Deviation;
use quatrack_simulation::flight::reference::Exact;

fn pieces_of(curve: &BSpline) -> PiecewisePolynomial {
    PiecewisePolynomial::from_bspline(curve).expect("a spline of a few metres")
}

/// A curve of a few metres without symmetry, a third of a second a span, that turns as it goes along x.
pub(super) fn wavy(degree: usize, spans: usize) -> PiecewisePolynomial {
    let point = |i: usize| {
        let phase = i as f64;
        Vector3::new((1.3 * phase).sin(), (0.7 * phase).cos(), 0.5 + 0.4 * (2.1 * phase).sin())
    };
    let curve = BSpline::new(degree, spans as f64 / 3.0, (0..spans + degree).map(point).collect());
    let mut pieces = pieces_of(&curve.expect("valid control points")).pieces().to_vec();
    for piece in &mut pieces {
        piece.coefficients[3] = piece.coefficients[0];
    }
    PiecewisePolynomial::new(pieces).expect("a spline has no jumps")
}

fn fitted(source: &PiecewisePolynomial, pieces: usize) -> PiecewisePolynomial {
    refit::refit(source, NonZeroUsize::new(pieces).expect("at least one")).expect("a curve of a few metres")
}

fn off(source: &PiecewisePolynomial, fit: &dyn Trajectory) -> Deviation {
    Deviation::between(&Exact(source), &Exact(fit))
}

#[test]
fn pieces_that_are_few_enough_are_kept() {
    let source = wavy(7, 31);
    assert_eq!(fitted(&source, 31), source);
    assert_eq!(fitted(&source, 40), source);
}

#[test]
fn pieces_that_were_cut_in_two_are_joined_again() {
    let source = wavy(7, 6);
    let halves = source.pieces().iter().flat_map(|piece| {
        let duration_s = 0.5 * piece.duration_s;
        let mut second = *piece;
        for coordinate in Coordinate::ALL {
            let mut factorial = 1.0;
            for (order, coefficient) in second.coefficients[coordinate as usize].iter_mut().enumerate() {
                factorial *= order.max(1) as f64;
                *coefficient = piece.derivative(coordinate, order, duration_s) / factorial;
            }
        }
        [Piece { duration_s, ..*piece }, Piece { duration_s, ..second }]
    });
    let cut = PiecewisePolynomial::new(halves.collect()).expect("no jumps");
    let joined = fitted(&cut, 6);
    assert_eq!(joined.pieces().len(), 6);
    // Hermite's formula has sums of 84 |r|, with |r| of a metre; as a septic every rounding of 1e-16 stays of that size in
    // position, and durations in f32 shift a curve of up to 5 m/s by up to 1e-8 s.
    let off = off(&source, &joined);
    assert!(off.position_m < 1e-7 && off.heading_rad < 1e-7, "{off:?}");
    assert!(off.velocity_m_s < 1e-6 && off.acceleration_m_s2 < 1e-5, "{off:?}");
}

/// The error that rounding may leave in a condition on a derivative at the end of a fitted piece. Hermite's formula
/// multiplies the error of the values by up to 35 + 84 + 70 + 20 in all, each product rounded by a share of the largest
/// term; degree 7 makes each derivative at most 7 / duration times as large.
fn rounding(piece: &Piece, coordinate: Coordinate, order: usize) -> f64 {
    let coefficients = &piece.coefficients[coordinate as usize];
    let terms = coefficients.iter().rev().fold(0.0, |sum, c| sum * piece.duration_s + c.abs());
    209.0 * f64::EPSILON * terms * (7.0 / piece.duration_s).powi(order as i32)
}

#[test]
fn joints_are_continuous_up_to_jerk_and_ends_are_kept() {
    // Degree 3 jumps in jerk at every breakpoint, degree 5 not at all; 700 pieces are more than are looked at one by one.
    for (source, pieces) in [(wavy(3, 20), 7), (wavy(5, 38), 31), (wavy(5, 38), 1), (wavy(4, 700), 31)] {
        let fit = fitted(&source, pieces);
        assert!(fit.pieces().len() <= pieces);
        let ends = |pieces: &[Piece]| (pieces[0], pieces[pieces.len() - 1]);
        let ((first, last), (source_first, source_last)) = (ends(fit.pieces()), ends(source.pieces()));
        for coordinate in Coordinate::ALL {
            for order in 0..4 {
                for pair in fit.pieces().windows(2) {
                    let end = pair[0].derivative(coordinate, order, pair[0].duration_s);
                    let start = pair[1].derivative(coordinate, order, 0.0);
                    let tolerance = rounding(&pair[0], coordinate, order);
                    assert!((end - start).abs() <= tolerance, "{coordinate}, derivative {order}: {end} to {start}");
                }
                let start = source_first.derivative(coordinate, order, 0.0);
                // Divided by the duration's power and its factorial, and multiplied back.
                let off = (first.derivative(coordinate, order, 0.0) - start).abs();
                assert!(off <= 10.0 * f64::EPSILON * start.abs(), "{coordinate}, derivative {order}: {off}");
                let end = source_last.derivative(coordinate, order, source_last.duration_s);
                let off = (last.derivative(coordinate, order, last.duration_s) - end).abs();
                assert!(off <= rounding(&last, coordinate, order), "{coordinate}, derivative {order}: {off}");
            }
        }
    }
}

#[test]
fn the_heading_is_fitted_as_a_coordinate_is() {
    // Heading and x are the same polynomials here, so are their fits.
    let fit = fitted(&wavy(5, 38), 20);
    for piece in fit.pieces() {
        assert_eq!(piece.coefficients[3], piece.coefficients[0]);
    }
}

#[test]
fn more_pieces_fit_no_worse() {
    let source = wavy(5, 38);
    let errors: Vec<f64> = [5, 10, 15, 20, 25, 30, 36]
        .map(|pieces| {
            let off = off(&source, &fitted(&source, pieces));
            off.position_m.hypot(off.heading_rad)
        })
        .to_vec();
    // The largest error is least at the probes, four in an eighth of a piece; between them it may be a little larger. The
    // measure is their joint norm, of which this sum of two maxima is at most the square root of two.
    assert!(errors.windows(2).all(|pair| pair[1] < 1.1 * 2_f64.sqrt() * pair[0]), "{errors:?}");
    // One more piece for each three lets the error, of order five or more in the length, fall much faster than that.
    assert!(errors[6] < 1e-3 * errors[0], "{errors:?}");
}

#[test]
fn knots_that_are_searched_for_beat_even_ones() {
    let source = pieces_of(&plan::paper::aggressive().unwrap().solve().unwrap());
    // 32.8 um is the largest error of Hermite pieces with 31 even knots, computed with SciPy's BPoly.from_derivatives.
    assert!(off(&source, &fitted(&source, 31)).position_m < 0.25 * 32.8e-6);
}

#[test]
fn the_papers_trajectories_fit_the_memory_within_micrometres() {
    for (plan, position_m, velocity_m_s, acceleration_m_s2, body_rates_rad_s) in
        [(plan::paper::mild(), 2e-6, 1e-5, 1e-4, 1e-4), (plan::paper::aggressive(), 1e-5, 1e-4, 3e-3, 1e-2)]
    {
        let source = pieces_of(&plan.unwrap().solve().unwrap());
        let fit = fitted(&source, PIECES_MAX);
        let stored = StoredTrajectory::new(&fit).unwrap();
        assert!(stored.pieces().len() <= 31 && stored.bytes() <= 4096);
        // Bounds are the measured figures rounded up: mild 1.5 um, 4.7 um/s, 51 um/s^2, 54 urad/s; W 7.8 um, 66 um/s,
        // 1.7 mm/s^2, 4.6 mrad/s. Of the W's, f32 and its time account for 2.6 um.
        let off = off(&source, &stored);
        assert!(off.position_m < position_m && off.velocity_m_s < velocity_m_s, "{off:?}");
        assert!(off.acceleration_m_s2 < acceleration_m_s2 && off.body_rates_rad_s < body_rates_rad_s, "{off:?}");
        assert_eq!((off.heading_rad, off.heading_rate_rad_s), (0.0, 0.0));
        // Knots do not move when they are stored.
        for (piece, exact) in stored.pieces().iter().zip(fit.pieces()) {
            assert_eq!(f64::from(piece.duration_s), exact.duration_s);
        }
    }
}

#[test]
fn deviations_are_the_ones_put_in() {
    let hover = |x: f64, slope: f64, heading: f64| {
        let mut coefficients = [[0.0; 8]; 4];
        (coefficients[0][0], coefficients[1][1], coefficients[3][0]) = (x, slope, heading);
        PiecewisePolynomial::new(vec![Piece { duration_s: 2.0, coefficients }]).unwrap()
    };
    let off = off(&hover(0.0, 0.0, 0.0), &hover(0.25, 0.5, 0.5));
    // 0.25 m along x and, at the end, 0.5 m/s for 2 s along y, less a 40,000th at most.
    assert!((off.position_m - 1.0625_f64.sqrt()).abs() < 1.0 / 40_000.0);
    assert_eq!((off.velocity_m_s, off.heading_rad, off.thrust_m_s2), (0.5, 0.5, 0.0));
    // A turn about the vertical by half a radian; an arcsine of a rounded chord.
    assert!((off.attitude_rad - 0.5).abs() < 1e-14, "{off:?}");
    assert_eq!((off.acceleration_m_s2, off.jerk_m_s3, off.body_rates_rad_s), (0.0, 0.0, 0.0));
}
