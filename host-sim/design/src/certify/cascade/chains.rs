//! The closed loop of the cascade, chain by chain, at hover: the core's step where nothing is limited, in f64, on a
//! plant that differs from the told one.
//!
//! A chain is a linear map of its states over a control period; its matrix is found by sending unit vectors through it.
//! The states are the plant's, the commands that wait, and the controller's memory.

mod height;
mod tilt;
mod yaw;

use nalgebra::{DMatrix, DVector};

use super::observers::HELD_RAD_S;
pub(super) use height::HeightChain;
pub(super) use tilt::TiltChain;
pub(super) use yaw::YawChain;

/// A closed loop of one chain.
pub(super) trait Chain {
    /// Number of states.
    fn states(&self) -> usize;
    /// Moves the states on by a period, with something added to the command; gives the command. Every fifth period the
    /// accelerometer is looked at.
    fn advance(&self, x: &mut [f64], added: f64, looks: bool) -> f64;

    /// The matrices of a period: of the states, of an addition to the command, and the command's row.
    fn matrices(&self, looks: bool) -> (DMatrix<f64>, DVector<f64>, DVector<f64>) {
        let n = self.states();
        let (mut a, mut row) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for j in 0..n {
            let mut x = vec![0.0; n];
            x[j] = 1.0;
            row[j] = self.advance(&mut x, 0.0, looks);
            a.set_column(j, &DVector::from_vec(x));
        }
        let mut x = vec![0.0; n];
        let _ = self.advance(&mut x, 1.0, looks);
        (a, DVector::from_vec(x), row)
    }
}

/// `p^`, bias and last velocity: the velocity held to the position.
fn held_velocity(memory: &mut [f64], p: f64, v: f64, h: f64) -> f64 {
    let (moved, bias) = (memory[0] + h * (0.5 * (v + memory[2]) - memory[1]), memory[1]);
    let e = p - moved;
    memory[1] = bias - h * HELD_RAD_S * HELD_RAD_S * e;
    memory[0] = moved + h * 2.0 * HELD_RAD_S * e;
    memory[2] = v;
    v - memory[1]
}
