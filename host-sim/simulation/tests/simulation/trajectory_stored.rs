//! Trajectories as the Crazyflie stores them: bytes, values and refusals, to the bit.

use nalgebra::Vector3;
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::poly4d::{PIECE_BYTES, PIECES_MAX, StoreError, StoredTrajectory};
use quatrack_plan::trajectory::polynomial::{Piece, PiecewisePolynomial};

use super::trajectory_refit::wavy;

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
