//! NEES and NIS: whether errors and innovations are as large as the filter says.
//!
//! Over N independent runs the sum of the normalised errors squared has the chi-square distribution with 9 N degrees of
//! freedom if the filter is consistent (Bar-Shalom, Li and Kirubarajan, "Estimation with Applications to Tracking and
//! Navigation", section 5.4), which for N = 200 is normal with mean 9 N and variance 18 N to a fraction of its
//! deviation.

use nalgebra::{SMatrix, SVector, UnitQuaternion, Vector3};
use quatrack::estimator::{Estimate, Estimator, EstimatorConfig, ImuAverager};
use quatrack::{Quaternion, State};

use crate::estimator::simulation::{Flight, POSITION_M, STEP_S, Truth, told_the_truth};

const RUNS: u64 = 200;
/// Positions at 100 Hz.
const STEPS_PER_POSITION: u32 = 10;
/// Looked at every half second of 3 s.
const LOOKS: usize = 6;
const POSITIONS_PER_LOOK: u32 = 50;

/// The error of an estimate, true minus estimated, by its covariance.
fn nees(estimate: &Estimate, truth: &Truth) -> f64 {
    let State { position_m, attitude: Quaternion { w, x, y, z }, velocity_m_s } = estimate.state();
    let q = nalgebra::Quaternion::new(*w, *x, *y, *z).cast::<f64>();
    let turn = (UnitQuaternion::from_quaternion(q).inverse() * truth.attitude).scaled_axis();
    let (r, v): (Vector3<f64>, Vector3<f64>) =
        (truth.position - position_m.cast(), truth.velocity - velocity_m_s.cast());
    let error = SVector::<f64, 9>::from_row_slice(&[r.x, r.y, r.z, v.x, v.y, v.z, turn.x, turn.y, turn.z]);
    let rows = estimate.covariance().to_rows();
    let covariance = SMatrix::<f64, 9, 9>::from_fn(|row, column| f64::from(rows[row][column]));
    covariance.cholesky().map_or(f64::INFINITY, |factor| error.dot(&factor.solve(&error)))
}

/// Mean NEES at each look, and mean NIS over the half second before it.
struct Consistency {
    nees: [f64; LOOKS],
    nis: [f64; LOOKS],
}

fn fly(config: EstimatorConfig, steps_per_prediction: u32) -> Consistency {
    let estimator = Estimator::new(config).unwrap();
    let mut found = Consistency { nees: [0.0; LOOKS], nis: [0.0; LOOKS] };
    for seed in 0..RUNS {
        let mut flight = Flight::new(seed);
        let guess = flight.guess(&config.at_start);
        let mut estimate = estimator.start(&guess).unwrap();
        let mut averager = ImuAverager::new();
        for look in 0..LOOKS {
            for _ in 0..POSITIONS_PER_LOOK {
                for step in 1..=STEPS_PER_POSITION {
                    averager.add(&flight.step()).unwrap();
                    if step % steps_per_prediction == 0 {
                        let period = steps_per_prediction as f32 * STEP_S as f32;
                        estimator.predict(&mut estimate, &averager.take().unwrap(), period).unwrap();
                    }
                }
                let position = flight.position();
                let taken = estimator.update_position(&mut estimate, &position, POSITION_M as f32).unwrap();
                found.nis[look] += f64::from(taken.normalised_squared) / f64::from(POSITIONS_PER_LOOK) / RUNS as f64;
            }
            found.nees[look] += nees(&estimate, &flight.truth) / RUNS as f64;
        }
    }
    found
}

/// How far a mean of `count` numbers, each chi-square with `freedom`, may be off: 3.9 standard deviations, which of all
/// 36 numbers that are looked at a consistent filter exceeds in one case of 290.
fn bound(freedom: f64, count: f64) -> f64 {
    3.9 * (2.0 * freedom / count).sqrt()
}

#[test]
fn with_the_true_drag_and_noise_the_errors_are_as_large_as_the_filter_says() {
    for steps_per_prediction in [10, 2, 1] {
        let Consistency { nees, nis } = fly(told_the_truth(), steps_per_prediction);
        println!("every {steps_per_prediction} ms: NEES {nees:.3?} (9), NIS {nis:.3?} (3)");
        for (nees, nis) in nees.into_iter().zip(nis) {
            assert!((nees - 9.0).abs() < bound(9.0, RUNS as f64), "NEES {nees}, every {steps_per_prediction} ms");
            let positions = RUNS as f64 * f64::from(POSITIONS_PER_LOOK);
            assert!((nis - 3.0).abs() < bound(3.0, positions), "NIS {nis}, every {steps_per_prediction} ms");
        }
    }
}

#[test]
fn without_the_drag_they_are_larger() {
    let Consistency { nees, nis } = fly(EstimatorConfig { drag_per_s: [0.0; 2], ..told_the_truth() }, 10);
    println!("without drag: NEES {nees:.1?} (9), NIS {nis:.2?} (3)");
    // Drag of 0.9 m/s^2 at 2 m/s against 0.03 m/s^2 per root hertz: neither passes at any time.
    for (nees, nis) in nees.into_iter().zip(nis) {
        assert!(nees > 9.0 + bound(9.0, RUNS as f64), "NEES {nees}");
        assert!(nis > 3.0 + bound(3.0, RUNS as f64 * f64::from(POSITIONS_PER_LOOK)), "NIS {nis}");
    }
}
