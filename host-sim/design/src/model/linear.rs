//! The two linear models: the hover equilibrium (E-LTI) by differentiating (1), the flat chain (F-LTI) by definition.

use nalgebra::{SMatrix, SVector};
use num_complex::Complex64;

use super::{InputVector, StateVector, dynamics};

/// `A` of a model with 10 states.
pub type SystemMatrix = SMatrix<f64, 10, 10>;

/// Derivatives of (1) at a state and input: `A = df/dx` (10x10) and `B = df/du` (10x4), equation (9).
///
/// Complex step: `f` is polynomial, so the imaginary part of `f(x + i h)` over `h` is the derivative to the last bit
/// for a small enough `h`, with no cancellation (Squire and Trapp 1998).
pub fn linearise(x: &StateVector, u: &InputVector) -> (SystemMatrix, SMatrix<f64, 10, 4>) {
    let step = 1e-100;
    let column = |dx: Option<usize>, du: Option<usize>| -> SVector<f64, 10> {
        let mut xc = x.map(|v| Complex64::new(v, 0.0));
        let mut uc = u.map(|v| Complex64::new(v, 0.0));
        if let Some(i) = dx {
            xc[i].im = step;
        }
        if let Some(i) = du {
            uc[i].im = step;
        }
        dynamics(&xc, &uc).map(|v| v.im / step)
    };
    let mut a = SystemMatrix::zeros();
    let mut b = SMatrix::<f64, 10, 4>::zeros();
    for i in 0..10 {
        a.set_column(i, &column(Some(i), None));
    }
    for i in 0..4 {
        b.set_column(i, &column(None, Some(i)));
    }
    (a, b)
}

/// The flat chain (F-LTI): state `z = [r v a q3]` (6a), input `v = [a j q3']` (6b).
///
/// As printed in the paper: velocity and acceleration are driven by separate inputs.
pub fn flat_chain() -> (SystemMatrix, SMatrix<f64, 10, 7>) {
    let mut a = SystemMatrix::zeros();
    a.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
    let mut b = SMatrix::<f64, 10, 7>::zeros();
    b.fixed_view_mut::<7, 7>(3, 0).fill_with_identity();
    (a, b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{GRAVITY_M_S2, hover_input, hover_state};

    #[test]
    fn derivatives_at_hover_are_the_printed_matrices() {
        let (a, b) = linearise(&hover_state(), &hover_input());
        let mut printed_a = SystemMatrix::zeros();
        printed_a.fixed_view_mut::<3, 3>(0, 7).fill_with_identity();
        printed_a[(7, 5)] = 2.0 * GRAVITY_M_S2;
        printed_a[(8, 4)] = -2.0 * GRAVITY_M_S2;
        printed_a[(9, 3)] = 2.0 * GRAVITY_M_S2;
        let mut printed_b = SMatrix::<f64, 10, 4>::zeros();
        printed_b[(9, 0)] = 1.0;
        printed_b.fixed_view_mut::<3, 3>(4, 1).fill_diagonal(0.5);
        // Small integers times g: the complex step is exact to the last bit of the division by the step.
        assert!((a - printed_a).amax() <= 1e-14);
        assert!((b - printed_b).amax() <= 1e-14);
    }

    #[test]
    fn derivatives_away_from_hover_agree_with_central_differences() {
        let x = StateVector::from_column_slice(&[0.1, -0.2, 0.3, 0.9, 0.2, -0.3, 0.25, 1.0, -2.0, 0.5]);
        let u = InputVector::new(11.0, 0.7, -0.4, 0.9);
        let (a, b) = linearise(&x, &u);
        // f is quadratic in x and bilinear in (x, u): central differences have no truncation error, only rounding,
        // about 1e-16 * |f| / h = 1e-11.
        let h = 1e-4;
        for i in 0..10 {
            let mut dx = StateVector::zeros();
            dx[i] = h;
            let difference = (dynamics(&(x + dx), &u) - dynamics(&(x - dx), &u)) / (2.0 * h);
            assert!((difference - a.column(i)).amax() < 1e-10, "column {i} of A");
        }
        for i in 0..4 {
            let mut du = InputVector::zeros();
            du[i] = h;
            let difference = (dynamics(&x, &(u + du)) - dynamics(&x, &(u - du))) / (2.0 * h);
            assert!((difference - b.column(i)).amax() < 1e-10, "column {i} of B");
        }
    }
}
