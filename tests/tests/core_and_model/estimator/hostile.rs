//! Any input gives an error or an estimate of finite numbers, never a panic.

use nalgebra::{SMatrix, Vector3};
use proptest::collection::vec;
use proptest::prelude::*;
use quatrack::estimator::{Estimate, Estimator, EstimatorConfig, EstimatorError, Gate, Imu};
use quatrack::{Quaternion, State};

use crate::estimator::simulation::told_the_truth;

/// Sound numbers, huge ones, tiny ones, none.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => -20.0_f32..20.0,
        1 => any::<f32>(),
        1 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(f32::NEG_INFINITY), Just(f32::MAX), Just(0.0), Just(1e-40)],
        1 => -1000.0_f32..1000.0,
    ]
}

fn vector() -> impl Strategy<Value = Vector3<f32>> {
    (number(), number(), number()).prop_map(|(x, y, z)| Vector3::new(x, y, z))
}

fn deviation() -> impl Strategy<Value = f32> {
    prop_oneof![3 => Just(1e-3_f32), 2 => 1e-6_f32..1e3, 1 => number()]
}

fn attitude() -> impl Strategy<Value = Quaternion> {
    let any = (number(), number(), number(), number()).prop_map(|(w, x, y, z)| Quaternion::new(w, x, y, z));
    let unit = (-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0, 0.1_f32..1.0).prop_map(|(w, x, y, z)| {
        let q = Quaternion::new(w, x, y, z);
        let scale = 1.0 / q.dot(q).sqrt();
        Quaternion::new(w * scale, x * scale, y * scale, z * scale)
    });
    prop_oneof![1 => any, 3 => unit]
}

#[derive(Clone, Debug)]
enum Input {
    Predict(Imu, f32),
    Position(Vector3<f32>, f32),
    Velocity(Vector3<f32>, f32),
    Attitude(Quaternion, f32),
    Pose(Vector3<f32>, Quaternion, f32, f32),
    Height(f32, f32),
    Distance(Vector3<f32>, f32, f32),
}

fn input() -> impl Strategy<Value = Input> {
    let period = prop_oneof![4 => 1e-3_f32..0.1, 1 => number()];
    prop_oneof![
        4 => (vector(), vector(), period).prop_map(|(body_rates_rad_s, specific_force_m_s2, period)| {
            Input::Predict(Imu { body_rates_rad_s, specific_force_m_s2 }, period)
        }),
        2 => (vector(), deviation()).prop_map(|(r, d)| Input::Position(r, d)),
        1 => (vector(), deviation()).prop_map(|(v, d)| Input::Velocity(v, d)),
        1 => (attitude(), deviation()).prop_map(|(q, d)| Input::Attitude(q, d)),
        1 => (vector(), attitude(), deviation(), deviation()).prop_map(|(r, q, d, e)| Input::Pose(r, q, d, e)),
        1 => (number(), deviation()).prop_map(|(z, d)| Input::Height(z, d)),
        1 => (vector(), number(), deviation()).prop_map(|(r, x, d)| Input::Distance(r, x, d)),
    ]
}

fn give(estimator: &Estimator, estimate: &mut Estimate, input: &Input) -> Result<(), EstimatorError> {
    match input {
        Input::Predict(imu, period) => estimator.predict(estimate, imu, *period),
        Input::Position(r, d) => estimator.update_position(estimate, r, *d).map(|_| ()),
        Input::Velocity(v, d) => estimator.update_velocity(estimate, v, *d).map(|_| ()),
        Input::Attitude(q, d) => estimator.update_attitude(estimate, *q, *d).map(|_| ()),
        Input::Pose(r, q, d, e) => estimator.update_pose(estimate, r, *q, *d, *e).map(|_| ()),
        Input::Height(z, d) => estimator.update_height(estimate, *z, *d).map(|_| ()),
        Input::Distance(r, x, d) => estimator.update_distance(estimate, r, *x, *d).map(|_| ()),
    }
}

/// The least eigenvalue of the matrix of correlations, at least 0 of a positive one.
fn least_correlation(estimate: &Estimate) -> f64 {
    let rows = estimate.covariance().to_rows();
    let correlation = SMatrix::<f64, 9, 9>::from_fn(|row, column| {
        f64::from(rows[row][column]) / (f64::from(rows[row][row]) * f64::from(rows[column][column])).sqrt()
    });
    correlation.symmetric_eigenvalues().min()
}

fn check(config: &EstimatorConfig, before: &Estimate, after: &Estimate, outcome: Result<(), EstimatorError>) {
    let state = after.state();
    assert!(state.validated().is_ok(), "{state:?}");
    assert!((state.attitude.dot(state.attitude) - 1.0).abs() < 1e-6);
    let rows = after.covariance().to_rows();
    for (row, numbers) in rows.iter().enumerate() {
        let variance = numbers[row];
        let (min, max) = (config.deviation_min.powi(2), config.deviation_max.powi(2));
        assert!(variance >= 0.9999 * min && variance <= 1.0001 * max, "variance {variance} of {row}");
        for (column, number) in numbers.iter().enumerate() {
            assert!(number.is_finite() && *number == rows[column][row], "{row} {column}: {number}");
        }
    }
    match outcome {
        Ok(()) => {}
        Err(EstimatorError::OutOfRange { .. }) => assert_eq!(before, after),
        Err(EstimatorError::Restarted) => assert_eq!(before.state(), after.state()),
        Err(error) => panic!("an error that no test knows: {error}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn an_estimate_stays_one(inputs in vec(input(), 1..60), as_crazyflie in any::<bool>(), gated in any::<bool>()) {
        let config = if as_crazyflie { EstimatorConfig::CRAZYFLIE } else { told_the_truth() };
        let config = EstimatorConfig { gate: if gated { Gate::PerMille999 } else { Gate::Open }, ..config };
        let estimator = Estimator::new(config).unwrap();
        let mut estimate = estimator.start(&State::at_rest(Vector3::new(0.0, 0.0, 1.0))).unwrap();
        for input in &inputs {
            let before = estimate;
            let outcome = give(&estimator, &mut estimate, input);
            check(&config, &before, &estimate, outcome);
            // Roundings of f32 among nine correlated errors.
            let least = least_correlation(&estimate);
            prop_assert!(least > -1e-3, "{least} after {input:?}");
        }
    }

    #[test]
    fn any_config_is_refused_or_flies(figures in proptest::array::uniform14(number())) {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = figures;
        let config = EstimatorConfig {
            drag_per_s: [a, b],
            acceleration_noise: [c, d, e],
            gyro_noise: [f, g, h],
            deviation_min: i,
            deviation_max: j,
            at_start: quatrack::estimator::DeviationsAtStart { position_m: k, velocity_m_s: l, tilt_rad: m, heading_rad: n },
            ..EstimatorConfig::CRAZYFLIE
        };
        match Estimator::new(config) {
            Err(error) => prop_assert_ne!(error, EstimatorError::Restarted),
            Ok(estimator) => {
                let mut estimate = estimator.start(&State::at_rest(Vector3::zeros())).unwrap();
                let level = Vector3::new(0.0, 0.0, 9.81);
                let imu = Imu { body_rates_rad_s: Vector3::zeros(), specific_force_m_s2: level };
                for _ in 0..10 {
                    let before = estimate;
                    let outcome = estimator.predict(&mut estimate, &imu, 0.01);
                    check(&config, &before, &estimate, outcome);
                }
            }
        }
    }
}

/// A gate shuts out a jump, and opens as the filter gets less sure.
#[test]
fn a_jump_is_shut_out_and_an_outlier_does_no_harm() {
    let config = EstimatorConfig { gate: Gate::PerMille999, ..told_the_truth() };
    let estimator = Estimator::new(config).unwrap();
    let home = Vector3::new(0.0, 0.0, 1.0);
    let mut estimate = estimator.start(&State::at_rest(home)).unwrap();
    let level = Vector3::new(0.0, 0.0, 9.81);
    let imu = Imu { body_rates_rad_s: Vector3::zeros(), specific_force_m_s2: level };
    let at = |estimate: &mut Estimate, position: &Vector3<f32>| {
        estimator.predict(estimate, &imu, 0.01).unwrap();
        estimator.update_position(estimate, position, 1e-3).unwrap()
    };
    for _ in 0..200 {
        assert!(at(&mut estimate, &home).is_taken);
    }
    let jumped = Vector3::new(0.5, 0.0, 1.0);
    let refused = at(&mut estimate, &jumped);
    assert!(!refused.is_taken && refused.normalised_squared > 16.266);
    assert!((estimate.state().position_m - home).norm() < 1e-3);
    let steps = (1..1000).find(|_| at(&mut estimate, &jumped).is_taken).unwrap();
    println!("taken after {steps} positions");
    // An uncertainty of 0.03 m/s^2 and of the tilt grows to a quarter of half a metre in about 2 s.
    assert!((50..400).contains(&steps), "{steps}");
    for _ in 0..200 {
        at(&mut estimate, &jumped);
    }
    assert!((estimate.state().position_m - jumped).norm() < 5e-3);
}
