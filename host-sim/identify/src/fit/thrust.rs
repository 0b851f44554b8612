//! By how much the command's power may be larger than a fit has it: forces and commanded thrusts in; a factor out.
//!
//! A log of 100 Hz has one command of each 10 ms. Where commands are noisy from step to step it is not their mean, and that noise makes
//! the fitted slope of force over command too flat. The force is regressed on the thrust, and the thrust on the force, both beside
//! drag along the thrust and lift: the two slopes differ by the share of variance that either explains of the other, and
//! the true one lies between.

use nalgebra::{DVector, Matrix4};

use super::layout::{COMMAND_POWER, drive_of};
use super::prior::Base;
use super::problem::{Drive, Prepared};

/// At least 1: up to the other slope, and not beyond the power that is believed of the vehicle.
pub(super) fn steeper(sections: &[Prepared], base: &Base, values: &DVector<f64>) -> f64 {
    let believed = base.powers[0] / values[COMMAND_POWER];
    share(sections, &drive_of(values)).recip().min(believed).max(1.0)
}

/// Share of the variance of the force that the thrust explains, and the other way round.
fn share(sections: &[Prepared], drive: &Drive) -> f64 {
    let mut products = Matrix4::<f64>::zeros();
    for one in sections {
        let driven = one.drive(drive);
        let columns = [&driven.mean, &one.force[2], &one.velocity[2], &one.across].map(|signal| one.centred(signal));
        products += Matrix4::from_fn(|a, b| columns[a].iter().zip(&columns[b]).map(|(x, y)| x * y).sum::<f64>());
    }
    // Of thrust and force that which drag and lift leave of them: the Schur complement.
    let both = products.fixed_view::<2, 2>(0, 0).into_owned();
    let aside = products.fixed_view::<2, 2>(0, 2).into_owned();
    let rest = products.fixed_view::<2, 2>(2, 2).into_owned();
    let left = rest.try_inverse().map_or(both, |inverse| both - aside * inverse * aside.transpose());
    let shared = left[(0, 1)].max(0.0).powi(2) / (left[(0, 0)] * left[(1, 1)]);
    if shared.is_finite() { shared.min(1.0) } else { 0.0 }
}
