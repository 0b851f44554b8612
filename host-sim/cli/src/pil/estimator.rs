//! Instructions and stack of the estimator on the target: samples of a flight in; counts of a prediction and of an
//! update out.
//!
//! After every step a hash of state and covariance is compared with the host's: the filter is the same to the bit.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

use quatrack::State;
use quatrack::estimator::{Estimate, Estimator, EstimatorConfig, EstimatorError, Force, Imu, Integration};
use quatrack::nalgebra::Vector3;
use serde::Serialize;

use super::PilError;
use super::emulator::{Emulator, Folder};
use super::interrupt::Interrupt;
use super::measure::Count;

/// Longest time for an emulator to count.
const LIMIT: Duration = Duration::from_secs(60);

/// Steps of 10 ms.
const STEPS: u16 = 250;

const WITH_DRAG: EstimatorConfig = EstimatorConfig {
    integration: Integration::SecondOrder,
    drag_per_s: [0.447, 0.435],
    deviation_min: 1e-5,
    ..EstimatorConfig::CRAZYFLIE
};

/// The filters of the image, in its order.
const FILTERS: [(&str, EstimatorConfig); 3] = [
    ("with drag", WITH_DRAG),
    ("all axes", EstimatorConfig { force: Force::AllAxes, ..WITH_DRAG }),
    ("as the Crazyflie's", EstimatorConfig::CRAZYFLIE),
];

/// Costs of the estimator.
#[derive(Clone, Debug, Serialize)]
pub struct EstimatorReport {
    /// A prediction, by the filter: with drag along two axes, by all axes of the accelerometer, as the Crazyflie's.
    pub prediction: BTreeMap<&'static str, Count>,
    /// An update with a position.
    pub update: BTreeMap<&'static str, Count>,
    /// Most stack of a prediction, bytes.
    pub prediction_stack_bytes: u32,
    /// Most stack of an update, bytes.
    pub update_stack_bytes: u32,
}

/// A sample: the measurements of a period, and the craft's state after it. A banked circle with a slow nod.
fn sample(step: u16) -> (Imu, Vector3<f32>) {
    let time = 0.01 * f64::from(step);
    let f32s = |x: f64, y: f64, z: f64| Vector3::new(x as f32, y as f32, z as f32);
    let imu = Imu {
        body_rates_rad_s: f32s(0.3 * (1.1 * time).sin(), 0.4 * (0.9 * time).cos(), 0.5),
        specific_force_m_s2: f32s(-0.2 * time.cos(), 0.1, 9.81 + time.sin()),
    };
    (imu, f32s((1.4 * time).sin(), 1.0 - (1.4 * time).cos(), 1.0 + 0.2 * time.sin()))
}

fn hash(estimate: &Estimate) -> u32 {
    let (state, rows) = (estimate.state(), estimate.covariance().to_rows());
    let (r, q, v) = (&state.position_m, &state.attitude, &state.velocity_m_s);
    let words = [r.x, r.y, r.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z];
    let all = words.iter().chain(rows.as_flattened());
    all.fold(0x811c_9dc5_u32, |hash, word| (hash ^ word.to_bits()).wrapping_mul(0x0100_0193))
}

/// The host's hash after each step.
fn hashes(config: EstimatorConfig) -> Result<Vec<u32>, EstimatorError> {
    let estimator = Estimator::new(config)?;
    let mut estimate = estimator.start(&State::at_rest(sample(0).1))?;
    let step = |step| {
        let (imu, position) = sample(step);
        estimator.predict(&mut estimate, &imu, 0.01)?;
        estimator.update_position(&mut estimate, &position, 1e-3)?;
        Ok(hash(&estimate))
    };
    (0..STEPS).map(step).collect()
}

/// Counts every step of the image's filters.
///
/// # Errors
/// [`PilError`].
pub fn count(image: &Path, interrupt: &Interrupt) -> Result<EstimatorReport, PilError> {
    let folder = Folder::create()?;
    let samples = (0..STEPS).flat_map(|step| {
        let (imu, position) = sample(step);
        let vectors = [imu.body_rates_rad_s, imu.specific_force_m_s2, position];
        vectors.into_iter().flat_map(|v| [v.x, v.y, v.z]).flat_map(f32::to_le_bytes)
    });
    fs::write(folder.path().join("samples.bin"), samples.collect::<Vec<u8>>())
        .map_err(PilError::io("writing the samples"))?;
    Emulator::start(image, folder.path(), &["-serial", "none"])?.wait(LIMIT, interrupt)?;
    let counts = fs::read(folder.path().join("counts.bin")).map_err(PilError::io("reading the counts"))?;
    let words: Vec<u32> = counts.as_chunks::<4>().0.iter().copied().map(u32::from_le_bytes).collect();
    report(&words)
        .ok_or_else(|| PilError::Answer("the estimator's image counted another number of steps".to_owned()))?
}

/// Nothing where words are missing.
fn report(words: &[u32]) -> Option<Result<EstimatorReport, PilError>> {
    let ([_, short, long], words) = words.split_first_chunk::<3>()?;
    let counted = long.wrapping_sub(*short);
    if counted != super::measure::LOOP_INSTRUCTIONS {
        return Some(Err(PilError::Miscounts { counted, instructions: super::measure::LOOP_INSTRUCTIONS }));
    }
    let (words, [prediction_stack_bytes, update_stack_bytes]) = words.split_last_chunk::<2>()?;
    let (prediction_stack_bytes, update_stack_bytes) = (*prediction_stack_bytes, *update_stack_bytes);
    let (steps, _) = words.as_chunks::<3>();
    let [mut prediction, mut update] = [BTreeMap::new(), BTreeMap::new()];
    for ((name, config), steps) in FILTERS.into_iter().zip(steps.chunks_exact(usize::from(STEPS))) {
        let wanted = match hashes(config) {
            Ok(wanted) => wanted,
            Err(error) => return Some(Err(PilError::Answer(error.to_string()))),
        };
        if let Some(step) = steps.iter().zip(&wanted).position(|([_, _, found], wanted)| found != wanted) {
            let reason = format!("estimator {name}, step {step}: another estimate than the host's");
            return Some(Err(PilError::Answer(reason)));
        }
        prediction.insert(name, of(steps.iter().map(|[count, ..]| *count))?);
        update.insert(name, of(steps.iter().map(|[_, count, _]| *count))?);
    }
    (update.len() == FILTERS.len()).then_some(Ok(EstimatorReport {
        prediction,
        update,
        prediction_stack_bytes,
        update_stack_bytes,
    }))
}

fn of(counts: impl Iterator<Item = u32> + Clone) -> Option<Count> {
    let sum: u64 = counts.clone().map(u64::from).sum();
    let mean = sum as f64 / counts.clone().count().max(1) as f64;
    Some(Count { min: counts.clone().min()?, mean: (mean * 100.0).round() / 100.0, max: counts.max()? })
}
