//! The balances of torques and thrust, and what figures leave of them.

use nalgebra::DVector;

use crate::fit::layout::{ASYMMETRY, COMMAND_POWER, DAMPING, DELAY, DRAG_Z, INERTIA, LAG, LIFT, MOMENT, VOLTAGE_POWER};
use crate::fit::prior::Base;
use crate::fit::problem::{Drive, Driven, Prepared};

/// Parameters before those of each flight: the first of the layout.
pub(super) const SHARED: usize = DAMPING[1] + 1;

/// Every third point: 33 Hz still holds all that lies below the corner.
pub(super) const STRIDE: usize = 3;
/// Torque about x, about y, thrust.
pub(super) const KINDS: usize = 3;

/// What the balances leave.
pub(super) struct Residuals {
    /// By section; rows of one kind after those of another.
    pub(super) rows: Vec<[Vec<f64>; KINDS]>,
}

/// The balances of torques and thrust over all sections.
pub(super) struct Problem<'a> {
    pub(super) sections: &'a [Prepared],
    base: &'a Base,
    /// Of the torque balance, with the mean taken off: angular acceleration, velocity across, rates, product of rates.
    regressors: Vec<[[Vec<f64>; 4]; 2]>,
}

fn drive_of(values: &DVector<f64>) -> Drive {
    let (lag_s, half) = (values[LAG].exp(), 0.5 * values[ASYMMETRY]);
    Drive {
        rise_s: lag_s * half.exp(),
        fall_s: lag_s * (-half).exp(),
        delay_s: values[DELAY],
        jump_s: 0.0,
        powers: [values[COMMAND_POWER], values[VOLTAGE_POWER]],
    }
}

impl<'a> Problem<'a> {
    pub(super) fn new(sections: &'a [Prepared], base: &'a Base) -> Self {
        let thinned =
            |one: &Prepared, signal: &[f64]| -> Vec<f64> { one.centred(signal).into_iter().step_by(STRIDE).collect() };
        let regressors = sections
            .iter()
            .map(|one| {
                [0, 1].map(|axis| {
                    [&one.angular[axis], &one.velocity[1 - axis], &one.rates[axis], &one.products[axis]]
                        .map(|signal| thinned(one, signal))
                })
            })
            .collect();
        Self { sections, base, regressors }
    }

    pub(super) fn driven(&self, values: &DVector<f64>) -> Vec<Driven> {
        let drive = drive_of(values);
        self.sections.iter().map(|one| one.drive(&drive)).collect()
    }

    pub(super) fn residuals(&self, values: &DVector<f64>, driven: &[Driven]) -> Residuals {
        let mut rows: Vec<[Vec<f64>; KINDS]> = Vec::with_capacity(self.sections.len());
        let (mut square, mut count) = ([0.0; 2], 0);
        let inertia = [values[INERTIA[0]].exp(), values[INERTIA[1]].exp(), self.base.inertia_kg_m2[2]];
        for ((one, driven), regressors) in self.sections.iter().zip(driven).zip(&self.regressors) {
            let full = values[SHARED + one.flight].exp();
            let arm_n_m = 0.25 * self.base.mass_kg * full * self.base.half_arm_m;
            let torque = |axis: usize| -> (Vec<f64>, f64) {
                let mixture: Vec<f64> = one.centred(&driven.mixture[axis]).into_iter().step_by(STRIDE).collect();
                let [angular, across, rates, product] = &regressors[axis];
                let moment = if axis == 0 { -values[MOMENT[0]] } else { values[MOMENT[1]] };
                let gyroscopic = if axis == 0 { inertia[2] - inertia[1] } else { inertia[0] - inertia[2] };
                let rest = (0..mixture.len())
                    .map(|i| {
                        arm_n_m * mixture[i]
                            - inertia[axis] * angular[i]
                            - moment * across[i]
                            - values[DAMPING[axis]] * rates[i]
                            - gyroscopic * product[i]
                    })
                    .collect();
                (rest, mixture.iter().map(|m| (arm_n_m * m).powi(2)).sum())
            };
            let ((x, x_square), (y, y_square)) = (torque(0), torque(1));
            square[0] += x_square;
            square[1] += y_square;
            count += x.len();
            let thrust = one
                .inner
                .clone()
                .step_by(STRIDE)
                .map(|i| {
                    one.force[2][i] - full * driven.mean[i] + values[DRAG_Z] * one.velocity[2][i]
                        - values[LIFT] * one.across[i]
                })
                .collect();
            rows.push([x, y, thrust]);
        }
        let scale = square.map(|square| (square / count.max(1) as f64).sqrt().max(1e-300));
        for rows in &mut rows {
            for axis in 0..2 {
                rows[axis].iter_mut().for_each(|r| *r /= scale[axis]);
            }
        }
        Residuals { rows }
    }
}

/// Mean squares of the residuals by kind.
pub(super) fn variances(residuals: &Residuals) -> [f64; KINDS] {
    std::array::from_fn(|k| {
        let (sum, count) = residuals.rows.iter().fold((0.0, 0), |(sum, count), rows| {
            (sum + rows[k].iter().map(|r| r * r).sum::<f64>(), count + rows[k].len())
        });
        (sum / f64::from(count.max(1) as u32)).max(1e-12)
    })
}
