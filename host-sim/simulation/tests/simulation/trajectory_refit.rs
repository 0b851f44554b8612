//! Refits: the same curve where it can be, joints without jumps everywhere, and errors as they are stated; and the
//! Crazyflie's storage, to the bit.

use std::num::NonZeroUsize;

use nalgebra::Vector3;
use quatrack_plan::plan;
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::bspline::BSpline;
use quatrack_plan::trajectory::poly4d::{PIECE_BYTES, PIECES_MAX, StoreError, StoredTrajectory};
use quatrack_plan::trajectory::polynomial::{Coordinate, Piece, PiecewisePolynomial};
use quatrack_plan::trajectory::refit;
use quatrack_simulation::flight::deviation::Deviation;
use quatrack_simulation::flight::reference::Exact;

fn pieces_of(curve: &BSpline) -> PiecewisePolynomial {
    PiecewisePolynomial::from_bspline(curve).expect("a spline of a few metres")
}

/// A curve of a few metres without symmetry, a third of a second a span, that turns as it goes along x.
fn wavy(degree: usize, spans: usize) -> PiecewisePolynomial {
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
fn the_stored_form_evaluates_to_the_bits_of_the_firmware() {
    let pieces = [
        (
            0.83,
            [
                [0.1, -0.2, 0.3, 0.05, -0.7, 0.11, 0.013, -0.017],
                [0.3, 0.7, -0.9, 0.21, 0.4, -0.33, 0.07, 0.019],
                [1.1, 0.0, 0.6, -0.45, 0.17, 0.09, -0.04, 0.003],
                [-0.6, 0.8, -0.1, 0.37, -0.29, 0.06, 0.021, -0.005],
            ],
        ),
        (
            1.37,
            [
                [-0.12, 0.9, 0.2, -0.6, 0.3, 0.15, -0.07, 0.011],
                [0.469, -0.4, 0.5, 0.25, -0.35, 0.08, 0.06, -0.02],
                [1.3599, 0.33, -0.2, 0.7, -0.1, -0.23, 0.05, 0.014],
                [0.0982, -0.7, 0.44, 0.13, -0.3, 0.19, -0.03, 0.002],
            ],
        ),
    ];
    let pieces = pieces.map(|(duration_s, coefficients)| Piece { duration_s, coefficients });
    let stored = StoredTrajectory::new(&PiecewisePolynomial::new(pieces.to_vec()).unwrap()).unwrap();
    // From piecewise_eval of crazyflie-firmware (2a18fc29, pptraj.c), built for x86-64 by GCC with -ffp-contract=off.
    // Position, velocity, acceleration, jerk, heading.
    let expected: [(f64, [u32; 13]); 6] = [
        (
            0.0,
            [
                0x3dcc_cccd,
                0x3e99_999a,
                0x3f8c_cccd,
                0xbe4c_cccd,
                0x3f33_3333,
                0x0000_0000,
                0x3f19_999a,
                0xbfe6_6666,
                0x3f99_999a,
                0x3e99_999a,
                0x3fa1_47ae,
                0xc02c_cccc,
                0xbf19_999a,
            ],
        ),
        (
            0.4,
            [
                0x3d5e_f3e0,
                0x3ee9_c9ec,
                0x3f96_0e69,
                0xbdce_74cb,
                0x3e15_4e10,
                0x3ea2_225f,
                0xbef6_07ac,
                0xbf63_72ac,
                0x3f08_3c51,
                0xc0ab_60ad,
                0x4024_9774,
                0xbefd_7a08,
                0xbe8e_dfe1,
            ],
        ),
        (
            0.83,
            [
                0xbdf5_b947,
                0x3ef0_1a76,
                0x3fae_114c,
                0xbf72_6364,
                0xbc9d_e320,
                0x3f14_a832,
                0xc071_a9ca,
                0x3db7_ad40,
                0x3f5f_ab20,
                0xc11e_647d,
                0x4012_333e,
                0x3ffa_fdcc,
                0x3dc9_1558,
            ],
        ),
        (
            0.9,
            [
                0xbd66_4538,
                0x3ee3_1609,
                0x3fb0_edcf,
                0x3f6b_6b7d,
                0xbea7_51ad,
                0x3e9f_cef1,
                0x3e2a_9e45,
                0x3f8a_e1a1,
                0xbde8_4930,
                0xc043_80a1,
                0x3f70_197c,
                0x407d_db46,
                0x3d52_8236,
            ],
        ),
        (
            1.5,
            [
                0x3eef_4a14,
                0x3ee3_e7d8,
                0x3fd3_f53d,
                0x3f52_8188,
                0x3e9a_b39d,
                0x3f33_b74a,
                0x3e15_0624,
                0x3f59_a376,
                0x3f5f_9b5c,
                0x404d_00ed,
                0xbf27_7548,
                0xbf9a_57a8,
                0xbe2f_b23c,
            ],
        ),
        (
            2.5,
            [
                0x3fae_7b12,
                0x3f5e_f78c,
                0x400e_d3d9,
                0x0000_0000,
                0x0000_0000,
                0x0000_0000,
                0x0000_0000,
                0x0000_0000,
                0x0000_0000,
                0x0000_0000,
                0x0000_0000,
                0x0000_0000,
                0xbcaa_3c2c,
            ],
        ),
    ];
    for (t_s, bits) in expected {
        let sample = stored.at(t_s);
        let vectors = [sample.position_m, sample.velocity_m_s, sample.acceleration_m_s2, sample.jerk_m_s3];
        let found = vectors.iter().flat_map(|v| v.iter().copied()).chain([sample.heading_rad]);
        // Exactly f32 numbers, so that the conversion loses nothing; plus 0.0 makes one zero of both.
        let found: Vec<u32> = found.map(|value| (value as f32 + 0.0).to_bits()).collect();
        assert_eq!(found, bits, "at {t_s} s");
    }
    let before = stored.at(-1.0);
    assert_eq!((before.position_m, before.velocity_m_s), (stored.at(0.0).position_m, Vector3::zeros()));
}

#[test]
fn a_piece_is_132_little_endian_bytes() {
    let mut coefficients = [[0.0; 8]; 4];
    (coefficients[0][0], coefficients[1][1], coefficients[3][7]) = (1.0, -2.0, 0.5);
    let trajectory = PiecewisePolynomial::new(vec![Piece { duration_s: 0.25, coefficients }]).unwrap();
    let bytes = StoredTrajectory::new(&trajectory).unwrap().pieces()[0].to_bytes();
    assert_eq!((PIECE_BYTES, PIECES_MAX), (132, 31));
    // IEEE 754: 1 is 0x3f800000, -2 is 0xc0000000, 0.5 is 0x3f000000, 0.25 is 0x3e800000.
    let mut expected = [0; 132];
    for (number, [third, fourth]) in [(0, [0x80, 0x3f]), (9, [0, 0xc0]), (31, [0, 0x3f]), (32, [0x80, 0x3e])] {
        expected[4 * number + 2] = third;
        expected[4 * number + 3] = fourth;
    }
    assert_eq!(bytes, expected);
}

#[test]
fn a_trajectory_that_cannot_be_stored_is_refused_by_reason() {
    let many = StoredTrajectory::new(&wavy(5, 32)).unwrap_err();
    assert_eq!(many, StoreError::TooManyPieces(32));
    assert_eq!(many.to_string(), "32 pieces of 132 bytes: the Crazyflie's memory holds 31; fit them with fewer");
    let piece = |duration_s, x| {
        let mut coefficients = [[0.0; 8]; 4];
        coefficients[0][0] = x;
        StoredTrajectory::new(&PiecewisePolynomial::new(vec![Piece { duration_s, coefficients }]).unwrap())
    };
    assert_eq!(
        piece(1.0, 1e39).unwrap_err().to_string(),
        "as 32-bit numbers: piece 1: x^0 = inf; must be a finite number"
    );
    assert!(piece(1e-50, 0.0).unwrap_err().to_string().starts_with("as 32-bit numbers: piece 1: duration = 0 s"));
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
