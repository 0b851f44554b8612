//! Gains over time: the error dynamics against the model itself, a hover, and the letter W.

use nalgebra::{DMatrix, Quaternion, Rotation3, SMatrix, SVector, UnitQuaternion, Vector3};
use quatrack_design::design::DesignError;
use quatrack_design::design::along::{error_dynamics, gains_along};
use quatrack_design::design::sampled::{Sampling, equilibrium_pair, sampled_equilibrium};
use quatrack_design::design::synthesis::EquilibriumWeights;
use quatrack_design::model::flat::FlatSample;
use quatrack_design::model::flat::{ReferencePoint, reference_point, scalar_first, unit};
use quatrack_design::model::{
    ATTITUDE, InputVector, POSITION, StateVector, VELOCITY, attitude, dynamics, position, velocity,
};
use quatrack_plan::plan::paper;
use quatrack_simulation::flight::closed_loop::{HeldCommand, LOST_M, fly_sampled};
use quatrack_simulation::flight::law::{Feedback, Law};
use quatrack_simulation::flight::metrics::Metrics;
use quatrack_simulation::flight::reference::{Exact, Reference};

fn at_rest() -> ReferencePoint {
    let zero = Vector3::zeros();
    reference_point(&FlatSample {
        position_m: zero,
        velocity_m_s: zero,
        acceleration_m_s2: zero,
        jerk_m_s3: zero,
        heading_rad: 0.0,
        heading_rate_rad_s: 0.0,
    })
}

/// A point in the middle of a hard turn.
fn turning() -> ReferencePoint {
    reference_point(&FlatSample {
        position_m: Vector3::new(0.3, -0.2, 1.0),
        velocity_m_s: Vector3::new(1.0, 2.0, -0.5),
        acceleration_m_s2: Vector3::new(4.0, -3.0, 2.0),
        jerk_m_s3: Vector3::new(-6.0, 5.0, 8.0),
        heading_rad: 0.7,
        heading_rate_rad_s: 1.1,
    })
}

fn heading_frame(heading_rad: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), -heading_rad)
}

/// The state with an error from a reference.
fn displaced(reference: &StateVector, heading_rad: f64, error: &SVector<f64, 9>) -> StateVector {
    let back = heading_frame(heading_rad).inverse();
    let part = |first: usize| Vector3::new(error[first], error[first + 1], error[first + 2]);
    let q = part(3);
    let turn = Quaternion::from_parts((1.0 - q.norm_squared()).sqrt(), q);
    let turned = unit(&attitude(reference)) * UnitQuaternion::new_normalize(turn);
    let mut x = *reference;
    x.fixed_rows_mut::<3>(POSITION).copy_from(&(position(reference) + back * part(0)));
    x.fixed_rows_mut::<4>(ATTITUDE).copy_from(&scalar_first(&turned));
    x.fixed_rows_mut::<3>(VELOCITY).copy_from(&(velocity(reference) + back * part(6)));
    x
}

fn error(x: &StateVector, reference: &StateVector, heading_rad: f64) -> SVector<f64, 9> {
    let frame = heading_frame(heading_rad);
    let q = unit(&attitude(reference)).inverse() * unit(&attitude(x));
    let (r, v) = (frame * (position(x) - position(reference)), frame * (velocity(x) - velocity(reference)));
    SVector::from_iterator(r.iter().copied().chain([q.i, q.j, q.k]).chain(v.iter().copied()))
}

/// How fast the error changes: both states moved a moment forwards and back by the model.
fn error_rate(point: &ReferencePoint, displacement: &SVector<f64, 9>, du: &InputVector) -> SVector<f64, 9> {
    let x = displaced(&point.state, point.heading_rad, displacement);
    let moment_s = 1e-4;
    let after = |dt: f64| {
        let reference = point.state + dynamics(&point.state, &point.input) * dt;
        let moved = x + dynamics(&x, &(point.input + du)) * dt;
        error(&moved, &reference, point.heading_rad + point.heading_rate_rad_s * dt)
    };
    (after(moment_s) - after(-moment_s)) / (2.0 * moment_s)
}

#[test]
fn the_error_moves_as_the_model_says() {
    let point = turning();
    let (a, b) = error_dynamics(&point);
    let size = 1e-4;
    // Central differences twice over: truncation of about 1e-8 in each, rounding 1e-16 / (1e-4 * 1e-4).
    let tolerance = 2e-6;
    for j in 0..9 {
        let mut step = SVector::<f64, 9>::zeros();
        step[j] = size;
        let none = InputVector::zeros();
        let column = (error_rate(&point, &step, &none) - error_rate(&point, &-step, &none)) / (2.0 * size);
        for i in 0..9 {
            assert!((column[i] - a[(i, j)]).abs() < tolerance, "A[{i},{j}]: {} {}", column[i], a[(i, j)]);
        }
    }
    for j in 0..4 {
        let mut step = InputVector::zeros();
        step[j] = size;
        let none = SVector::zeros();
        let column = (error_rate(&point, &none, &step) - error_rate(&point, &none, &-step)) / (2.0 * size);
        for i in 0..9 {
            assert!((column[i] - b[(i, j)]).abs() < tolerance, "B[{i},{j}]: {} {}", column[i], b[(i, j)]);
        }
    }
}

#[test]
fn at_hover_the_table_is_the_stationary_gain() {
    let (a, b) = equilibrium_pair();
    let (along_a, along_b) = error_dynamics(&at_rest());
    assert!((a - along_a).amax() < 1e-14 && (b - along_b).amax() < 1e-14, "(E-LTI)");
    let (weights, sampling) = (EquilibriumWeights::paper(), Sampling::at_rate(100));
    let table = gains_along(|_| at_rest(), 0.95, &weights, &sampling, 10).expect("solvable");
    assert_eq!(table.gains.len(), 11, "knots at 0, 0.1, ..., 1.0 s");
    let stationary = sampled_equilibrium(&weights, &sampling).expect("solvable").gain;
    for gain in &table.gains {
        let gain = DMatrix::from_column_slice(4, 9, gain.as_slice());
        // A hundred steps of f64 arithmetic on a contraction.
        assert!((gain - &stationary).norm() < 1e-12 * stationary.norm());
    }
    assert!(table.interpolation_error < 1e-13);
    let late = Sampling { delay_samples: 1, ..sampling };
    assert!(matches!(gains_along(|_| at_rest(), 1.0, &weights, &late, 1), Err(DesignError::Delay { .. })));
    assert!(matches!(gains_along(|_| at_rest(), f64::NAN, &weights, &sampling, 1), Err(DesignError::Period { .. })));
}

/// The cost `int e' Q e + du' R du dt` of coming back from a displacement at `start_s` within 2 s, by the model (1).
fn cost_of_return(
    reference: &dyn Reference,
    gain_at: &dyn Fn(f64) -> SMatrix<f64, 4, 9>,
    weights: &EquilibriumWeights,
    start_s: f64,
    displacement: &SVector<f64, 9>,
) -> f64 {
    let (period_s, substeps) = (0.01, 10);
    let h = period_s / f64::from(substeps);
    let start = reference.at(start_s);
    let mut x = displaced(&start.state, start.heading_rad, displacement);
    let mut cost = 0.0;
    for k in 0..200 {
        let time_s = start_s + f64::from(k) * period_s;
        let target = reference.at(time_s);
        let correction = -gain_at(time_s) * error(&x, &target.state, target.heading_rad);
        // The input of the middle of the period: held, the reference's input is then right to second order.
        let input = reference.at(time_s + 0.5 * period_s).input + correction;
        for step in 0..substeps {
            let k1 = dynamics(&x, &input);
            let k2 = dynamics(&(x + k1 * (h / 2.0)), &input);
            let k3 = dynamics(&(x + k2 * (h / 2.0)), &input);
            let k4 = dynamics(&(x + k3 * h), &input);
            x += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
            let now = reference.at(time_s + f64::from(step + 1) * h);
            let e = error(&x, &now.state, now.heading_rad);
            cost += h * e.iter().zip(&weights.state).map(|(e, weight)| weight * e * e).sum::<f64>();
            cost += h * correction.iter().zip(&weights.input).map(|(u, weight)| weight * u * u).sum::<f64>();
        }
    }
    cost
}

#[test]
fn along_the_w_the_table_brings_errors_back_at_less_cost_than_the_stationary_gain() {
    let trajectory = paper::aggressive().expect("the plan file is sound").solve().expect("feasible");
    let reference = Exact(&trajectory);
    let (weights, rate_hz) = (EquilibriumWeights::paper(), 100);
    let sampling = Sampling::at_rate(rate_hz);
    let stationary = sampled_equilibrium(&weights, &sampling).expect("solvable").gain;
    let stationary = SMatrix::<f64, 4, 9>::from_iterator(stationary.iter().copied());
    let along =
        gains_along(|t_s| reference.at(t_s), reference.duration_s(), &weights, &sampling, 10).expect("solvable");
    let (mut plain_cost, mut along_cost) = (0.0, 0.0);
    for start_s in [2.0, 4.0, 6.0, 8.0] {
        for direction in 0..9 {
            let mut displacement = SVector::<f64, 9>::zeros();
            displacement[direction] = 0.05;
            let plain = cost_of_return(&reference, &|_| stationary, &weights, start_s, &displacement);
            let table = cost_of_return(&reference, &|t_s| along.at(t_s), &weights, start_s, &displacement);
            // Optimal for the linearisation: the model's curvature and the interpolation take a few per cent.
            assert!(table < 1.03 * plain, "{start_s} s, {direction}: {table} {plain}");
            plain_cost += plain;
            along_cost += table;
        }
    }
    println!("cost of return: stationary {plain_cost}, along {along_cost}");
    assert!(along_cost < plain_cost, "{along_cost} {plain_cost}");
    // Ten steps a knot follow the gains to a hundredth.
    assert!(along.interpolation_error < 0.01, "{}", along.interpolation_error);
    let fly = |gain_at: &dyn Fn(f64) -> SMatrix<f64, 4, 9>| {
        let flight = fly_sampled(&reference, rate_hz, LOST_M, |_, t_s, x| {
            let gain = gain_at(t_s);
            let feedback = Feedback { law: Law::EquilibriumHeading(&gain), feed_forward: true };
            Ok(HeldCommand { input: feedback.input(x, &reference.at(t_s)), limited: false })
        });
        Metrics::of(&flight).iae_m_s.expect("flown to its end")
    };
    // Without any displacement the hold of the feed-forward is all the error there is, for either.
    assert!(fly(&|_| stationary) < 0.003 && fly(&|t_s| along.at(t_s)) < 0.003);
}
