//! The four gains of the paper against the closed forms that pencil gives for their chains.

use nalgebra::{DMatrix, SMatrix};
use quatrack_design::design::synthesis::{
    EquilibriumWeights, FlatWeights, lqr_equilibrium, lqr_flat, lyapunov_equilibrium, lyapunov_flat,
};
use quatrack_design::design::{DesignError, care, decay_rate_design};

const G: f64 = 9.81;

/// Errors in the order of the E gain.
const X: usize = 0;
const Y: usize = 1;
const Z: usize = 2;
const Q1: usize = 3;
const Q2: usize = 4;
const Q3: usize = 5;
const VX: usize = 6;
const VY: usize = 7;
const VZ: usize = 8;

/// The two lateral chains have opposite signs: x'' = 2 g q2, y'' = -2 g q1.
fn equilibrium_gain(height: [f64; 2], lateral: [f64; 3], yaw: f64) -> SMatrix<f64, 4, 9> {
    let mut gain = SMatrix::<f64, 4, 9>::zeros();
    let [position, velocity, tilt] = lateral;
    for (row, column, value) in [
        (0, Z, height[0]),
        (0, VZ, height[1]),
        (1, Y, -position),
        (1, VY, -velocity),
        (1, Q1, tilt),
        (2, X, position),
        (2, VX, velocity),
        (2, Q2, tilt),
        (3, Q3, yaw),
    ] {
        gain[(row, column)] = value;
    }
    gain
}

fn flat_gain(position: f64, velocity: f64, acceleration: f64, yaw: f64) -> SMatrix<f64, 7, 10> {
    let mut gain = SMatrix::<f64, 7, 10>::zeros();
    for axis in 0..3 {
        gain[(axis, axis)] = position;
        gain[(axis, 3 + axis)] = velocity;
        gain[(3 + axis, 6 + axis)] = acceleration;
    }
    gain[(6, 9)] = yaw;
    gain
}

/// Entries within 1e-13 of the closed form, relative; zeros exactly zero.
fn assert_gain<const R: usize, const C: usize>(gain: &SMatrix<f64, R, C>, expected: &SMatrix<f64, R, C>) {
    for i in 0..R {
        for j in 0..C {
            // A solution rounded once and a closed form of a few roundings: some 10 eps = 2e-15.
            let (got, want) = (gain[(i, j)], expected[(i, j)]);
            assert!((got - want).abs() <= 1e-14 * want.abs(), "K[{i},{j}] is {got}, not {want}");
        }
    }
}

/// Closed loop of a triple integrator with weights `q` on position, velocity, acceleration and 1 on the input:
/// s^3 + a s^2 + b s + c, from the spectral factorisation a^2 - 2b = q2, b^2 - 2ac = q1, c^2 = q0.
fn triple_integrator(q: [f64; 3]) -> [f64; 3] {
    let c = q[0].sqrt();
    let mut a = 1.0;
    let mut b = 1.0;
    // A contraction: each round halves the error or better.
    for _ in 0..200 {
        b = (q[1] + 2.0 * a * c).sqrt();
        a = (q[2] + 2.0 * b).sqrt();
    }
    [c, b, a]
}

#[test]
fn lyapunov_gains_are_the_closed_forms() {
    for mu in [1e-4, 1.0, 2.0, 3.7, 1e4] {
        let flat = lyapunov_flat(mu).expect("controllable");
        assert_gain(&flat.gain, &flat_gain(2.0 * mu * mu, 2.0 * mu, mu, mu));
        let equilibrium = lyapunov_equilibrium(mu).expect("controllable");
        let lateral = [4.0 * mu.powi(3) / G, 6.0 * mu * mu / G, 6.0 * mu];
        assert_gain(&equilibrium.gain, &equilibrium_gain([2.0 * mu * mu, 2.0 * mu], lateral, 2.0 * mu));
        assert!(flat.relative_residual <= 1e-15 && equilibrium.relative_residual <= 1e-15);
        for pole in flat.poles.iter().chain(&equilibrium.poles) {
            // Poles of the triple chains are simple, -mu and -mu +- i sqrt(3) mu; rounding moves them by some eps.
            assert!((pole.re + mu).abs() <= 1e-12 * mu, "{pole}");
        }
    }
}

#[test]
fn lqr_gains_are_the_closed_forms() {
    let flat = lqr_flat(&FlatWeights::paper()).expect("weights of the paper");
    let position = (200.0_f64 / 0.1).sqrt();
    let velocity = (50.0 / 0.1 + 2.0 * position).sqrt();
    assert_gain(&flat.gain, &flat_gain(position, velocity, (10.0_f64 / 0.01).sqrt(), (20.0_f64 / 0.05).sqrt()));

    let equilibrium = lqr_equilibrium(&EquilibriumWeights::paper()).expect("weights of the paper");
    let height = (100.0_f64 / 0.01).sqrt();
    let climb = (50.0 / 0.01 + 2.0 * height).sqrt();
    // x''' = g q: the chain's own input is g q with weight 0.1 / g^2, its acceleration 2 g q2.
    let r = 0.1 / (G * G);
    let [c, b, a] = triple_integrator([100.0 / r, 50.0 / r, 10.0 / (4.0 * G * G) / r]);
    let yaw = (10.0_f64 / 0.1).sqrt();
    assert_gain(&equilibrium.gain, &equilibrium_gain([height, climb], [c / G, b / G, 2.0 * a], yaw));
    assert!(flat.relative_residual <= 1e-15 && equilibrium.relative_residual <= 1e-15);
    assert!(flat.poles.iter().chain(&equilibrium.poles).all(|pole| pole.re < -1.0));
}

#[test]
fn lqr_gains_have_the_six_digits_of_the_authors_project() {
    let gain = lqr_equilibrium(&EquilibriumWeights::paper()).expect("weights of the paper").gain;
    for (row, column, value) in
        [(0, VZ, 72.111), (2, X, 31.6228), (2, VX, 25.4484), (2, Q2, 45.7951), (1, Y, -31.6228), (1, Q1, 45.7951)]
    {
        assert!(
            (gain[(row, column)] - value).abs() < 5e-5 + 5e-4 * f64::from(u8::from(column == VZ)),
            "{row} {column}"
        );
    }
}

#[test]
fn p_is_positive_definite_and_solves_the_equation_in_the_order_of_the_errors() {
    let design = lqr_equilibrium(&EquilibriumWeights::paper()).expect("weights of the paper");
    assert!(design.p.cholesky().is_some());
    // K = R^-1 B' P ties P's order to the gain's: B drives vz by T and q_i by half the body rates.
    let b = SMatrix::<f64, 9, 4>::from_fn(|i, j| match (i, j) {
        (VZ, 0) => 1.0,
        (Q1, 1) | (Q2, 2) | (Q3, 3) => 0.5,
        _ => 0.0,
    });
    let r_inverse = SMatrix::<f64, 4, 4>::from_diagonal(&[100.0, 10.0, 10.0, 10.0].into());
    let gain = r_inverse * b.transpose() * design.p;
    // Three products of factors that were each rounded once.
    assert!((gain - design.gain).amax() <= 1e-14 * design.gain.amax());
}

#[test]
fn a_decay_rate_that_is_no_positive_number_is_refused() {
    for mu in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = lyapunov_flat(mu).expect_err("no decay rate");
        assert!(matches!(error, DesignError::DecayRate { .. }), "{error}");
    }
}

#[test]
fn a_plant_that_decays_faster_than_mu_is_refused_by_name_of_its_pole() {
    // P would be 2 (mu - 5) < 0: the lemma's "for any mu > 0" does not hold for a stable plant.
    let (a, b) = (DMatrix::from_element(1, 1, -5.0), DMatrix::from_element(1, 1, 1.0));
    let error = decay_rate_design(&a, &b, 1.0).expect_err("too slow");
    assert!(matches!(error, DesignError::AlreadyFaster { .. }));
    assert!(error.to_string().contains("-5.0") && error.to_string().contains("above 5"), "{error}");
    let design = decay_rate_design(&a, &b, 6.0).expect("fast enough");
    assert_eq!(design.gain[(0, 0)], 1.0);
}

#[test]
fn the_unreduced_hover_model_is_refused_by_both_designs() {
    let (a, b) = quatrack_design::model::linear::linearise(
        &quatrack_design::model::hover_state(),
        &quatrack_design::model::hover_input(),
    );
    let a = DMatrix::from_column_slice(10, 10, a.as_slice());
    let b = DMatrix::from_column_slice(10, 4, b.as_slice());
    let error = decay_rate_design(&a, &b, 2.0).expect_err("q0 is out of reach");
    assert!(matches!(error, DesignError::NotControllable { eigenvalue } if eigenvalue.norm() == 0.0), "{error}");
    let error = care(&a, &b, &DMatrix::identity(10, 10), &DMatrix::identity(4, 4)).expect_err("q0 is out of reach");
    assert!(matches!(error, DesignError::NotStabilisable { eigenvalue } if eigenvalue.norm() == 0.0), "{error}");
}
