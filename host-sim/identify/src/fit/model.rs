//! A craft's model with the most likely figures: their values in; the model, the share of torques and thrust that it explains, and
//! the biases of each flight out.

use nalgebra::{DVector, Vector3};

use super::drag::Regression;
use super::layout::{DAMPING, DRAG_Z, INERTIA, LIFT, MOMENT, SHARED, drive_of};
use super::prior::Base;
use super::problem::{Drive, Prepared};
use super::yaw::Yaw;
use crate::filter::mean;

/// Figures that differ from flight to flight.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightFit {
    /// Thrust over mass that a full command gives at the reference voltage, m/s^2.
    pub full_m_s2: f64,
    /// Torque that is always there, N m.
    pub torque_bias_n_m: Vector3<f64>,
    /// Bias of the accelerometer, m/s^2.
    pub force_bias_m_s2: Vector3<f64>,
    /// Bias of the gyroscope, rad/s.
    pub gyro_bias_rad_s: Vector3<f64>,
}

/// Figures as the prediction takes them, whether or not they are known well enough to be told.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Model {
    pub(crate) drive: Drive,
    pub(crate) inertia: [f64; 3],
    pub(crate) moment: [f64; 2],
    pub(crate) damping: [f64; 3],
    pub(crate) drag: [f64; 3],
    pub(crate) lift: f64,
    pub(crate) yaw_lead_s: f64,
}

/// Share of the mixtures about x and y and of the thrust that the balances explain below the corner.
fn explained(sections: &[Prepared], base: &Base, model: &Model, full: &[f64]) -> [f64; 3] {
    let (mut whole, mut rest) = ([0.0; 3], [0.0; 3]);
    let mut add = |kind: usize, all: &[f64], left: &[f64]| {
        whole[kind] += all.iter().map(|v| v * v).sum::<f64>();
        rest[kind] += left.iter().map(|v| v * v).sum::<f64>();
    };
    for one in sections {
        let driven = one.drive(&model.drive);
        let full = full[one.flight];
        for axis in 0..2 {
            let arm_n_m = 0.25 * base.mass_kg * full * base.half_arm_m;
            let torque: Vec<f64> = one.centred(&driven.mixture[axis]).iter().map(|m| arm_n_m * m).collect();
            let (angular, across, rates) =
                (one.centred(&one.angular[axis]), one.centred(&one.velocity[1 - axis]), one.centred(&one.rates[axis]));
            let moment = if axis == 0 { -model.moment[0] } else { model.moment[1] };
            let left: Vec<f64> = (0..torque.len())
                .map(|i| {
                    torque[i] - model.inertia[axis] * angular[i] - moment * across[i] - model.damping[axis] * rates[i]
                })
                .collect();
            add(axis, &torque, &left);
        }
        let felt = one.centred(&one.force[2]);
        let (given, up, across) = (one.centred(&driven.mean), one.centred(&one.velocity[2]), one.centred(&one.across));
        let left: Vec<f64> = (0..felt.len())
            .map(|i| felt[i] - full * given[i] + model.drag[2] * up[i] - model.lift * across[i])
            .collect();
        add(2, &felt, &left);
    }
    std::array::from_fn(|kind| 1.0 - rest[kind] / whole[kind].max(1e-12))
}

/// Figures that follow from the values.
pub(super) struct Summary {
    /// Thrust over mass of a full command at the reference voltage, flight by flight, m/s^2.
    pub(super) full: Vec<f64>,
    pub(super) yaws: Yaw,
    pub(super) model: Model,
    /// Share of the torques about x and y and of the thrust's variation.
    pub(super) explained: [f64; 3],
}

pub(super) fn summary(sections: &[Prepared], base: &Base, values: &DVector<f64>, drags: &[Regression; 2]) -> Summary {
    let full: Vec<f64> = values.iter().skip(SHARED).map(|full| full.exp()).collect();
    let drive = drive_of(values);
    let yaws = Yaw::of(sections, base, &drive, &full);
    let model = model(values, drags, &yaws.forward);
    let explained = explained(sections, base, &model, &full);
    Summary { full, yaws, model, explained }
}

fn model(values: &DVector<f64>, drags: &[Regression; 2], yaws: &Regression) -> Model {
    Model {
        drive: drive_of(values),
        inertia: [values[INERTIA[0]].exp(), values[INERTIA[1]].exp(), yaws.values[0].max(1e-9)],
        moment: MOMENT.map(|j| values[j]),
        damping: [values[DAMPING[0]], values[DAMPING[1]], yaws.values[1].max(0.0)],
        drag: [drags[0].values[0], drags[1].values[0], values[DRAG_Z]],
        lift: values[LIFT],
        yaw_lead_s: yaws.values[2].max(0.0),
    }
}

/// Biases of each flight: the mean residuals of the balances.
pub(super) fn flight_fits(sections: &[Prepared], base: &Base, model: &Model, full: &[f64]) -> Vec<FlightFit> {
    full.iter()
        .enumerate()
        .map(|(flight, full)| {
            let (mut torque, mut force, mut gyro, mut points) =
                (Vector3::zeros(), Vector3::zeros(), Vector3::zeros(), 0.0);
            for one in sections.iter().filter(|one| one.flight == flight) {
                let count = one.inner.len() as f64;
                torque += section_bias(one, base, model, *full) * count;
                force += one.force_bias * count;
                gyro += one.gyro_bias * count;
                points += count;
            }
            let points = f64::max(points, 1.0);
            FlightFit {
                full_m_s2: *full,
                torque_bias_n_m: torque / points,
                force_bias_m_s2: force / points,
                gyro_bias_rad_s: gyro / points,
            }
        })
        .collect()
}

/// Torque that a section needs beyond that of its motors, N m.
fn section_bias(one: &Prepared, base: &Base, model: &Model, full: f64) -> Vector3<f64> {
    let driven = one.drive(&model.drive);
    let newton = 0.25 * base.mass_kg * full;
    let arms = [newton * base.half_arm_m, newton * base.half_arm_m, newton * base.torque_per_thrust_m];
    let average = |signal: &[f64]| mean(&signal[one.inner.clone()]);
    let moments = [model.moment[0] * average(&one.velocity[1]), -model.moment[1] * average(&one.velocity[0]), 0.0];
    Vector3::from_fn(|axis, _| {
        let rate = average(&one.rates[axis]) - one.gyro_bias[axis];
        model.inertia[axis] * average(&one.angular[axis]) + model.damping[axis] * rate
            - moments[axis]
            - arms[axis] * average(&driven.mixture[axis])
    })
}
