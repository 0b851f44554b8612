//! The four committed tables: closed forms -> synthesis -> f32 -> the source in the core.

use nalgebra::SMatrix;
use quatrack::gains::paper;
use quatrack_design::design::codegen::{ENTRY_MIN, paper_tables, rounded};
use quatrack_design::design::synthesis::{
    EquilibriumWeights, FlatWeights, PAPER_MU, lqr_equilibrium, lqr_flat, lyapunov_equilibrium, lyapunov_flat,
};
use quatrack_design::model::GRAVITY_M_S2 as G;

/// A gain that is zero but for the entries given as (row, column, value).
fn sparse<const M: usize, const N: usize>(entries: &[(usize, usize, f64)]) -> SMatrix<f64, M, N> {
    let mut gain = SMatrix::zeros();
    for (row, column, value) in entries {
        gain[(*row, *column)] = *value;
    }
    gain
}

/// Rows [T p q r], columns [x y z q1 q2 q3 vx vy vz]: thrust on z, pitch on x, roll on y with the other sign, yaw on q3.
fn equilibrium(thrust: [f64; 2], tilt: [f64; 3], yaw: f64) -> SMatrix<f64, 4, 9> {
    let [position, velocity, attitude] = tilt;
    sparse(&[
        (0, 2, thrust[0]),
        (0, 8, thrust[1]),
        (1, 1, -position),
        (1, 7, -velocity),
        (1, 3, attitude),
        (2, 0, position),
        (2, 6, velocity),
        (2, 4, attitude),
        (3, 5, yaw),
    ])
}

fn flat(position: f64, velocity: f64, acceleration: f64, q3: f64) -> SMatrix<f64, 7, 10> {
    let axes = (0..3).flat_map(|i| [(i, i, position), (i, i + 3, velocity), (i + 3, i + 6, acceleration)]);
    let mut entries: Vec<_> = axes.collect();
    entries.push((6, 9, q3));
    sparse(&entries)
}

fn assert_close<const M: usize, const N: usize>(found: &SMatrix<f64, M, N>, exact: &SMatrix<f64, M, N>) {
    let error = (found - exact).amax() / exact.amax();
    assert!(error <= 1e-12, "relative error {error:e}: {found} instead of {exact}");
}

#[test]
fn lyapunov_gains_are_their_closed_forms() {
    for mu in [0.5, 1.0, PAPER_MU, 3.0] {
        let e = equilibrium([2.0 * mu * mu, 2.0 * mu], [4.0 * mu.powi(3) / G, 6.0 * mu * mu / G, 6.0 * mu], 2.0 * mu);
        assert_close(&lyapunov_equilibrium(mu).unwrap().gain, &e);
        assert_close(&lyapunov_flat(mu).unwrap().gain, &flat(2.0 * mu * mu, 2.0 * mu, mu, mu));
    }
}

#[test]
fn every_decay_rate_has_its_gains() {
    // The poles are one eigenvalue ten times over, on which the sweeps of the QR iteration stall for one rate in a hundred.
    for hundredths in 30..400 {
        let mu = f64::from(hundredths) * 0.01;
        assert!(lyapunov_equilibrium(mu).is_ok() && lyapunov_flat(mu).is_ok(), "mu = {mu}");
    }
}

#[test]
fn riccati_gains_are_their_closed_forms() {
    // Scalar chains by hand: k = sqrt(q/r) for one integrator, sqrt(q_v/r + 2 sqrt(q_r/r)) for the second of two.
    let position = (200.0_f64 / 0.1).sqrt();
    let f = flat(position, (50.0 / 0.1 + 2.0 * position).sqrt(), (10.0_f64 / 0.01).sqrt(), (20.0_f64 / 0.05).sqrt());
    assert_close(&lqr_flat(&FlatWeights::paper()).unwrap().gain, &f);

    let thrust = (100.0_f64 / 0.01).sqrt();
    // The lateral chain x'' = 2 g q2, q2' = q/2 with u = -k e: its closed loop s^3 + a s^2 + b s + c must have the
    // spectral factor's coefficients a^2 - 2 b = (1/4) q_q/r, b^2 - 2 a c = g^2 q_v/r, c^2 = g^2 q_x/r.
    let (qx, qv, qq, r): (f64, f64, f64, f64) = (100.0, 50.0, 10.0, 0.1);
    let c = (G * G * qx / r).sqrt();
    let b_of = |a: f64| 0.5 * (a * a - 0.25 * qq / r);
    let residual = |a: f64| b_of(a).powi(2) - 2.0 * a * c - G * G * qv / r;
    // The largest root, by bisection from a bracket that holds it alone.
    let (mut low, mut high) = (10.0, 100.0);
    assert!(residual(low) < 0.0 && residual(high) > 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if residual(middle) < 0.0 { low = middle } else { high = middle }
    }
    let a = 0.5 * (low + high);
    let tilt = [c / G, b_of(a) / G, 2.0 * a];
    let e = equilibrium([thrust, (50.0 / 0.01 + 2.0 * thrust).sqrt()], tilt, (10.0_f64 / 0.1).sqrt());
    assert_close(&lqr_equilibrium(&EquilibriumWeights::paper()).unwrap().gain, &e);
}

#[test]
fn the_committed_tables_are_the_synthesis_rounded_to_f32() {
    assert_eq!(*paper::LYAP_E.gain().rows(), rounded(&lyapunov_equilibrium(PAPER_MU).unwrap().gain));
    assert_eq!(*paper::LYAP_F.gain().rows(), rounded(&lyapunov_flat(PAPER_MU).unwrap().gain));
    assert_eq!(*paper::LQR_E.gain().rows(), rounded(&lqr_equilibrium(&EquilibriumWeights::paper()).unwrap().gain));
    assert_eq!(*paper::LQR_F.gain().rows(), rounded(&lqr_flat(&FlatWeights::paper()).unwrap().gain));
}

#[test]
fn the_committed_source_is_the_generators_output() {
    assert_eq!(include_str!("../../../../core/src/gains/paper.rs"), paper_tables().unwrap());
}

/// The design crate does without the core and so has the number once more.
#[test]
fn entries_below_the_cores_smallest_become_zero() {
    assert_eq!(ENTRY_MIN.to_bits(), quatrack::gains::table::ENTRY_MIN.to_bits());
}
