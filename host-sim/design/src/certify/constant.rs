//! Gains that stay as they are: a plant, a controller and a timing in; the certificate of the loop as flown out.

use nalgebra::DMatrix;

use super::CertifyError;
use super::certificate::{Certificate, ContinuousLoop, SampledLoopFigures, pairs};
use super::decrease;
use super::limits::{Disturbance, limits};
use super::linear_loop::LinearLoop;
use super::margins;
use super::plant::{Controller, LagModel, Plant, Predictor, Timing};
use super::rounding::{Rounding, single_precision};
use super::sampled_loop::SampledLoop;
use crate::analysis::eigenvalues;

/// Periods for which the searches end in seconds, s.
const SHORTEST_PERIOD_S: f64 = 1e-5;
const LONGEST_PERIOD_S: f64 = 10.0;
/// A rounding below this share of an entry is the f64 design's own.
const NO_ROUNDING: f64 = 1e-12;
/// Each known sample of delay is a state a channel.
const MOST_DELAY_SAMPLES: usize = 100;

/// Certifies a controller, every gain rounded to f32 first.
///
/// `motors_in_rate_loop`: the gain of the body rate loop, 1/s, for one more set of lag limits.
///
/// # Errors
/// [`CertifyError::Matrix`] for a gain that does not fit the plant or is not finite; [`CertifyError::NotSinglePrecision`];
/// [`CertifyError::Unstable`] for a loop that is not stable at its rate; [`CertifyError::RateGain`];
/// [`CertifyError::Period`] and [`CertifyError::DelaySamples`] for a timing out of range; [`CertifyError::Design`] for an
/// equation without a solution.
pub fn certify(
    plant: &Plant,
    controller: &Controller,
    timing: &Timing,
    motors_in_rate_loop: Option<f64>,
) -> Result<Certificate, CertifyError> {
    plant.require_fitting(controller)?;
    // Written so that NaN is refused.
    if !(SHORTEST_PERIOD_S..=LONGEST_PERIOD_S).contains(&timing.period_s) {
        return Err(CertifyError::Period { period_s: timing.period_s });
    }
    let memory = timing.delay_samples.max(controller.past_command_gains.len());
    if memory > MOST_DELAY_SAMPLES {
        return Err(CertifyError::DelaySamples { delay_samples: memory });
    }
    if let Some(gain_1_s) = motors_in_rate_loop.filter(|gain| !(gain.is_finite() && *gain > 0.0)) {
        return Err(CertifyError::RateGain { gain_1_s });
    }
    let flown = Controller {
        gain: single_precision(&controller.gain)?,
        past_command_gains: controller.past_command_gains.iter().map(single_precision).collect::<Result<_, _>>()?,
        predictor: controller
            .predictor
            .as_ref()
            .map(|held| Ok::<_, CertifyError>(Predictor { gain: single_precision(&held.gain)?, ..*held }))
            .transpose()?,
    };
    let whole = LinearLoop::new(plant, &flown);
    let parts = whole.independent();
    let names = plant.input_names();
    let closed = SampledLoop::new(&whole, timing, &[])?.closed_loop();
    let poles = eigenvalues(&closed)?;
    let spectral_radius = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let rate_hz = 1.0 / timing.period_s;
    let unstable = CertifyError::Unstable { rate_hz, spectral_radius };
    if spectral_radius >= 1.0 {
        return Err(unstable);
    }
    let sampled = SampledLoopFigures {
        poles: pairs(&poles),
        spectral_radius,
        decrease: decrease::sampled(&closed)?,
        margins: margins::sampled(&parts, timing, names)?.ok_or(unstable)?,
    };
    let has_continuous_form =
        flown.past_command_gains.is_empty() && flown.predictor.is_none() && timing.delay_samples == 0;
    let search = |disturbance| limits(&parts, timing, names, disturbance);
    Ok(Certificate {
        rate_hz,
        delay_samples: timing.delay_samples,
        rounding: rounding(controller, &flown),
        continuous: if has_continuous_form { Some(continuous(&whole, &parts, names)?) } else { None },
        sampled,
        delay: search(Disturbance::Delay)?,
        lag: search(Disturbance::Lag(LagModel::FirstOrder))?,
        motors_in_rate_loop: motors_in_rate_loop
            .map(|rate_gain_1_s| search(Disturbance::Lag(LagModel::MotorsInRateLoop { rate_gain_1_s })))
            .transpose()?,
        along: None,
    })
}

fn continuous(whole: &LinearLoop, parts: &[LinearLoop], names: &[String]) -> Result<ContinuousLoop, CertifyError> {
    let (a, b, gain) = whole.continuous();
    let closed = a - b * gain;
    let poles = eigenvalues(&closed)?;
    let abscissa_1_s = poles.iter().map(|pole| pole.re).fold(f64::NEG_INFINITY, f64::max);
    let stable = abscissa_1_s < 0.0;
    Ok(ContinuousLoop {
        poles_1_s: pairs(&poles),
        abscissa_1_s,
        decrease: if stable { Some(decrease::continuous(&closed)?) } else { None },
        margins: if stable { margins::continuous(parts, names)? } else { None },
    })
}

fn rounding(designed: &Controller, flown: &Controller) -> Rounding {
    let matrices = |controller: &Controller| -> Vec<DMatrix<f64>> {
        let predictor = controller.predictor.iter().map(|held| &held.gain);
        std::iter::once(&controller.gain).chain(&controller.past_command_gains).chain(predictor).cloned().collect()
    };
    let mut found = Rounding { largest_absolute: 0.0, largest_relative: 0.0 };
    for (designed, flown) in matrices(designed).iter().zip(&matrices(flown)) {
        for (designed, flown) in designed.iter().zip(flown.iter()).filter(|(designed, _)| **designed != 0.0) {
            let difference = (designed - flown).abs();
            if difference < NO_ROUNDING * designed.abs() {
                continue;
            }
            found.largest_absolute = found.largest_absolute.max(difference);
            found.largest_relative = found.largest_relative.max(difference / designed.abs());
        }
    }
    found
}
