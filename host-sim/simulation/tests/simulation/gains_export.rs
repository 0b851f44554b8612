//! An exported design determines its gain: residuals of the equations, from the JSON alone.

use std::path::Path;

use nalgebra::DMatrix;
use quatrack_simulation::gains::{Design, Export};
use serde_json::Value;

fn export(name: &str, text: &str) -> Value {
    let design = Design::from_toml(name, text, Path::new("")).unwrap();
    // Through its text, as another tool reads it.
    serde_json::from_str(&Export::of(&design).unwrap().to_json().to_string()).unwrap()
}

fn matrix(export: &Value, name: &str) -> DMatrix<f64> {
    let matrix = &export["matrices"][name];
    let rows: Vec<Vec<f64>> = serde_json::from_value(matrix["entries"].clone()).unwrap();
    let count = |key: &str| matrix[key].as_array().unwrap().len();
    assert_eq!((rows.len(), rows[0].len()), (count("rows"), count("columns")), "{name}: a name for each");
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

/// Rounding of a few products of matrices of this size.
fn assert_small(residual: &DMatrix<f64>, terms: f64, equation: &str) {
    assert!(residual.norm() <= 1e-12 * terms, "{equation}: {:e}", residual.norm() / terms);
}

#[test]
fn continuous_designs_solve_their_equations() {
    let lqr_e = include_str!("../../../../gains/lqr-e.toml");
    let lqr_f = include_str!("../../../../gains/lqr-f.toml");
    for (name, text) in [("lqr-e", lqr_e), ("lqr-f", lqr_f)] {
        let e = export(name, text);
        let [a, b, q, r, k, p] = ["A", "B", "Q", "R", "K", "P"].map(|name| matrix(&e, name));
        let pa = &p * &a;
        let quadratic = k.transpose() * &r * &k;
        assert_small(&(&pa + pa.transpose() + &q - &quadratic), q.norm() + quadratic.norm(), "Riccati equation");
        let gain = r.try_inverse().unwrap() * b.transpose() * &p;
        assert_small(&(&gain - &k), k.norm(), "K = R^-1 B' P");
        assert_eq!(e["method"], "lqr");
        assert!(e["poles"]["re_im"].as_array().unwrap().iter().all(|pole| pole[0].as_f64().unwrap() < 0.0));
        assert_eq!(e["poles"]["re_im"].as_array().unwrap().len(), a.nrows());
    }
    for (name, text) in [
        ("lyap-e", include_str!("../../../../gains/lyap-e.toml")),
        ("lyap-f", include_str!("../../../../gains/lyap-f.toml")),
    ] {
        let e = export(name, text);
        let [a, b, k, p] = ["A", "B", "K", "P"].map(|name| matrix(&e, name));
        let mu = e["mu_1_s"].as_f64().unwrap();
        let pa = &p * &a;
        let pb = &p * &b;
        let quadratic = &pb * pb.transpose();
        // (15), (17): P A + A' P - P B B' P = -2 mu P.
        assert_small(&(&pa + pa.transpose() - &quadratic + &p * (2.0 * mu)), quadratic.norm(), "Lyapunov design");
        assert_small(&(pb.transpose() * 0.5 - &k), k.norm(), "K = B' P / 2");
        assert!(e["matrices"]["Q"].is_null() && e["matrices"]["R"].is_null());
    }
}

#[test]
fn sampled_designs_solve_theirs() {
    let plain = include_str!("../../../../gains/sampled-lqr-e-100hz.toml");
    let with_integral = include_str!("../../../../gains/lqi-e.toml");
    for (text, states, period_s) in [(plain, 9, 0.01), (with_integral, 12, 0.002)] {
        let e = export("sampled", text);
        let [a, b, q, s, r, k, p] = ["A_d", "B_d", "Q_d", "S_d", "R_d", "K", "P"].map(|name| matrix(&e, name));
        assert_eq!(k.shape(), (4, states));
        let middle = &r + b.transpose() * &p * &b;
        let driven = b.transpose() * &p * &a + s.transpose();
        let gain = middle.clone().try_inverse().unwrap() * &driven;
        // The rounding of P, of the size of 1e4 times K.
        assert!((&gain - &k).norm() <= 1e-10 * k.norm(), "K: {:e}", (&gain - &k).norm() / k.norm());
        let residual = a.transpose() * &p * &a - &p + &q - gain.transpose() * &middle * &gain;
        assert_small(&residual, 2.0 * p.norm(), "discrete Riccati equation");
        assert_eq!((e["period_s"].as_f64(), &e["poles"]["unit"]), (Some(period_s), &"per sample".into()));
    }
}

#[test]
fn the_staircase_takes_out_the_mode_that_no_input_moves() {
    let e = export("lqr-e", include_str!("../../../../gains/lqr-e.toml"));
    let [a, b, t] = ["A_10", "B_10", "T_e"].map(|name| matrix(&e, name));
    assert_small(&(&t * t.transpose() - DMatrix::identity(10, 10)), 10.0, "T_e is orthogonal");
    let (a, b) = (&t * a * t.transpose(), &t * b);
    // (11): the first new state is q0, which nothing reaches.
    assert!((t[(0, 3)].abs() - 1.0).abs() < 1e-15);
    assert!(a.row(0).norm() < 1e-14 && b.row(0).norm() < 1e-14);
}
