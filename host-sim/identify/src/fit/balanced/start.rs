//! Where the search begins, and what is believed before it.

use nalgebra::DVector;

use crate::filter::mean;
use crate::fit::drag::Regression;
use crate::fit::lag_curve::{LagPoint, most_explained};
use crate::fit::prior::{Base, Prior};
use crate::fit::problem::{Drive, Prepared};

/// Start values of the parameters and their priors.
pub(in crate::fit) struct Start {
    pub(in crate::fit) values: DVector<f64>,
    pub(in crate::fit) priors: Vec<Prior>,
    /// Parameters that keep their values.
    pub(in crate::fit) fixed: Vec<usize>,
}

/// From the best lag of the curve, the vehicle's own powers, and the thrust that carries the craft.
pub(in crate::fit) fn start(
    sections: &[Prepared],
    base: &Base,
    flights: usize,
    curve: &[LagPoint],
    drags: &[Regression; 2],
    fixed: Vec<usize>,
) -> Start {
    let best = most_explained(curve);
    let lag_s = best.lag_s.min(0.12);
    let drive = Drive { rise_s: lag_s, fall_s: lag_s, delay_s: base.delay_s, jump_s: 0.0, powers: base.powers };
    let full: Vec<f64> = (0..flights)
        .map(|flight| {
            let (mut felt, mut given) = (0.0, 0.0);
            for one in sections.iter().filter(|one| one.flight == flight) {
                let driven = one.drive(&drive);
                felt += one.inner.clone().map(|i| one.force[2][i]).sum::<f64>();
                given += one.inner.clone().map(|i| driven.mean[i]).sum::<f64>();
            }
            (felt / given.max(1e-9)).max(1e-3)
        })
        .collect();
    let arm_n_m = 0.25 * base.mass_kg * mean(&full) * base.half_arm_m;
    let drag = 0.5 * (drags[0].values[0] + drags[1].values[0]).clamp(0.0, 2.0);
    let damping = base.damping_scale();
    let mut values = vec![lag_s.ln(), 0.0, base.delay_s, base.powers[0], base.powers[1], drag, 0.0];
    let mut priors = vec![
        Prior::gauss(base.lag_s.ln(), 0.7),
        Prior::gauss(0.0, 0.4),
        Prior::cauchy(base.delay_s, 1e-3),
        Prior::cauchy(base.powers[0], 0.05),
        Prior::gauss(base.powers[1], 0.3),
        Prior::gauss(drag, 0.3),
        Prior::gauss(0.0, 0.15),
    ];
    for axis in 0..2 {
        let inertia =
            (arm_n_m * best.inertia[axis]).clamp(0.2 * base.inertia_kg_m2[axis], 5.0 * base.inertia_kg_m2[axis]);
        values.extend([inertia.ln(), arm_n_m * best.moment[axis], 0.15 * damping]);
        priors.extend([
            Prior::gauss(base.inertia_kg_m2[axis].ln(), 0.7),
            Prior::gauss(0.0, 0.5 * base.half_arm_m * base.mass_kg),
            Prior::gauss(0.15 * damping, 0.35 * damping),
        ]);
    }
    let middle = mean(&full.iter().map(|full| full.ln()).collect::<Vec<_>>());
    for full in &full {
        values.push(full.ln());
        priors.push(Prior::gauss(middle, 1.0));
    }
    Start { values: DVector::from_vec(values), priors, fixed }
}
