//! Curves to bytes and back: Bitcraze's own example, a curve of every degree, and numbers that the form cannot hold.

use super::*;
use crate::trajectory::Trajectory;

/// Bitcraze's own example: 2000 ms, x and y cubic, z and yaw constant.
#[test]
fn the_documented_header_reads() {
    let mut bytes = vec![0; START_BYTES];
    bytes[4..6].copy_from_slice(&1000_i16.to_le_bytes());
    bytes.extend([0x0a, 0xd0, 0x07]);
    for point in [0_i16, 500, 500, 0, -500, -500] {
        bytes.extend(point.to_le_bytes());
    }
    bytes.extend([0; 3]);
    let read = from_bytes(&bytes).unwrap();
    let middle = read.at(1.0).position_m;
    // Half way, a cubic is (0 + 3 * 0 + 3 * 0.5 + 0.5) / 8.
    assert!((middle.x - 0.25).abs() < 1e-15 && (middle.y + 0.25).abs() < 1e-15 && middle.z == 1.0);
    assert_eq!(to_bytes(&read).unwrap(), bytes);
}

#[test]
fn a_curve_is_within_half_a_millimetre_and_reads_back_the_same() {
    let mut piece = Piece { duration_s: 1.25, coefficients: [[0.0; COEFFICIENTS]; 4] };
    piece.coefficients[0] = [0.1, 0.2, -0.3, 0.4, 0.5, -0.6, 0.2, -0.05];
    piece.coefficients[3] = [0.3, -0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let original = PiecewisePolynomial::new(vec![piece]).unwrap();
    let bytes = to_bytes(&original).unwrap();
    // x of degree 7, y and z constant, yaw linear.
    assert_eq!((bytes[8], bytes.len()), (0b0100_0011, 8 + 3 + 14 + 2 + 3));
    let read = from_bytes(&bytes).unwrap();
    for k in 0..=125 {
        let t_s = 0.01 * f64::from(k);
        let (a, b) = (original.at(t_s), read.at(t_s));
        assert!((a.position_m - b.position_m).norm() <= 0.5e-3 + 1e-12, "{t_s}");
        assert!((a.heading_rad - b.heading_rad).abs() <= 1.0 / YAW_UNITS, "{t_s}");
    }
    assert_eq!(to_bytes(&read).unwrap(), bytes);
    for cut in 1..bytes.len() {
        // Without its end it is none, but for the end itself, which the firmware's own tools leave out at times.
        assert_eq!(from_bytes(&bytes[..cut]).is_ok(), cut == bytes.len() - 3, "{cut}");
    }
}

#[test]
fn numbers_beyond_sixteen_bits_are_named() {
    let far = |value: f64, duration_s: f64| {
        let mut piece = Piece { duration_s, coefficients: [[0.0; COEFFICIENTS]; 4] };
        piece.coefficients[1][0] = value;
        to_bytes(&PiecewisePolynomial::new(vec![piece]).unwrap()).unwrap_err().to_string()
    };
    assert!(far(33.0, 1.0).starts_with("piece 1: a control point of y is at 33.0 m; the compressed form holds 32.8"));
    assert!(far(1.0, 66.0).contains("lasts 66 s"));
}
