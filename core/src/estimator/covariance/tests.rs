//! Blocks beside whole matrices.

use nalgebra::{SMatrix, SVector};

use super::*;

type Matrix9 = SMatrix<f32, 9, 9>;

fn whole(covariance: &Covariance) -> Matrix9 {
    let rows = covariance.to_rows();
    Matrix9::from_fn(|row, column| rows[row][column])
}

/// A full matrix: of one of small whole numbers, times its transposed.
fn full() -> Covariance {
    let root = Matrix9::from_fn(|row, column| ((row * 5 + column * 7 + row * column) % 11) as f32 * 0.2 - 1.0);
    let p = root * root.transpose();
    let block = |row: usize, column: usize| p.fixed_view::<3, 3>(3 * row, 3 * column).into_owned();
    Covariance {
        position: block(0, 0),
        position_velocity: block(0, 1),
        position_attitude: block(0, 2),
        velocity: block(1, 1),
        velocity_attitude: block(1, 2),
        attitude: block(2, 2),
    }
}

#[test]
fn blocks_are_carried_as_the_whole_matrix_is() {
    let h = 0.5;
    let g = Matrix3::new(0.1, -0.2, 0.3, 0.4, 0.1, -0.5, 0.2, 0.6, -0.3);
    let a = Matrix3::new(0.9, -0.3, 0.1, 0.3, 0.9, -0.2, 0.0, 0.2, 1.0);
    let e = Matrix3::new(0.9, 0.1, 0.2, 0.1, 0.8, 0.0, 0.2, 0.0, 0.7);
    for velocity in [None, Some(e)] {
        let mut f = Matrix9::identity();
        f.fixed_view_mut::<3, 3>(0, 3).copy_from(&(Matrix3::identity() * h));
        f.fixed_view_mut::<3, 3>(0, 6).copy_from(&(g * (0.5 * h)));
        f.fixed_view_mut::<3, 3>(3, 3).copy_from(&velocity.unwrap_or_else(Matrix3::identity));
        f.fixed_view_mut::<3, 3>(3, 6).copy_from(&g);
        f.fixed_view_mut::<3, 3>(6, 6).copy_from(&a);
        let mut carried = full();
        let wanted = f * whole(&carried) * f.transpose();
        carried.carry(&Transition { period_s: h, velocity, velocity_from_attitude: g, attitude: a });
        // Some thirty roundings of numbers up to 20.
        assert!((whole(&carried) - wanted).norm() < 1e-4, "{}", whole(&carried) - wanted);
    }
}

#[test]
fn a_number_is_taken_as_of_the_whole_matrix() {
    let row = Vector3::new(0.6, -0.8, 0.2);
    for (index, group) in [Group::Position, Group::Velocity, Group::Attitude].into_iter().enumerate() {
        let mut h = SVector::<f32, 9>::zeros();
        h.fixed_rows_mut::<3>(3 * index).copy_from(&row);
        let mut left = full();
        let p = whole(&left) * h;
        let inverse = 1.0 / (h.dot(&p) + 0.5);
        let wanted = whole(&left) - p * p.transpose() * inverse;
        let column = left.column(group, &row);
        left.subtract(&Column::ZERO.plus(&column, inverse), &column);
        assert!((whole(&left) - wanted).norm() < 1e-4);
    }
}

#[test]
fn bounds_keep_correlations() {
    let mut bounded = full();
    let before = bounded;
    let max = 0.5 * before.velocity.m11.min(before.attitude.m22);
    assert!(max > 0.1);
    bounded.bound(1e-6, max);
    let correlation = |c: &Covariance| c.velocity_attitude.m12 / sqrt(c.velocity.m11 * c.attitude.m22);
    assert!((bounded.velocity.m11 / max - 1.0).abs() < 1e-6 && (bounded.attitude.m22 / max - 1.0).abs() < 1e-6);
    assert!((correlation(&bounded) - correlation(&before)).abs() < 1e-6);
    bounded.bound(2.0 * max, 100.0);
    assert_eq!(bounded.attitude.m22, 2.0 * max);
}
