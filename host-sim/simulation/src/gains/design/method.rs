//! Linearisation and method: a design's entries in; a problem whose numbers belong to its method out.

use std::path::Path;

use quatrack::Rate;
use quatrack_design::design::integral::IntegralWeights;
use quatrack_design::vehicle::Vehicle;

use super::actuator_aware::{actuator_aware, not_of_motors};
use super::along::along;
use super::cascade::cascade;
use super::entry::{check, misplaced, missing, positive};
use super::problem::{Method, Problem};
use super::weights::{equilibrium_weights, flat_weights};
use crate::gains::GainsError;
use crate::gains::file::{DesignFile, Linearisation, MethodName};

/// Most samples of known delay.
const MOST_DELAY_SAMPLES: u32 = 20;

pub(super) fn problem(file: &DesignFile, vehicle: &Vehicle, folder: &Path, rate: Rate) -> Result<Problem, GainsError> {
    let lyapunov = file.method == MethodName::Lyapunov;
    if let (Some(mu), false) = (file.mu_1_s, lyapunov) {
        return Err(misplaced("mu_1_s", &mu, &file.method));
    }
    if let (Some(delay), false) = (file.delay_samples, file.method == MethodName::SampledLqr) {
        return Err(misplaced("delay_samples", &delay, &file.method));
    }
    if let (Some(trajectory), false) = (&file.trajectory, file.method == MethodName::Along) {
        return Err(misplaced("trajectory", &format!("\"{trajectory}\""), &file.method));
    }
    if lyapunov {
        let mu_1_s = file.mu_1_s.ok_or_else(|| missing("mu_1_s", &file.method, "mu_1_s = 2.0"))?;
        positive("mu_1_s", mu_1_s)?;
        if file.weights.is_some() {
            return Err(misplaced("[weights]", &"...", &file.method));
        }
        return Ok(match file.linearisation {
            Linearisation::Equilibrium => Problem::Equilibrium(Method::Lyapunov { mu_1_s }),
            Linearisation::FlatOutput => Problem::FlatOutput(Method::Lyapunov { mu_1_s }),
        });
    }
    if file.method == MethodName::Cascade {
        return cascade(file, vehicle);
    }
    if file.air.is_some() {
        return Err(misplaced("[air]", &"...", &file.method));
    }
    let weights = file.weights.as_ref().ok_or_else(|| missing("[weights]", &file.method, "[weights]"))?;
    let integrates = matches!(file.method, MethodName::Lqi | MethodName::ActuatorAware);
    if let (Some(weight), false) = (weights.position_integral, integrates) {
        return Err(misplaced("weights.position_integral", &format!("{weight:?}"), &file.method));
    }
    if file.method == MethodName::ActuatorAware {
        return actuator_aware(file, weights);
    }
    not_of_motors(file, weights)?;
    let delay_samples = file.delay_samples.unwrap_or(0);
    check(
        delay_samples <= MOST_DELAY_SAMPLES,
        "delay_samples",
        f64::from(delay_samples),
        format!("from 0 to {MOST_DELAY_SAMPLES}"),
    )?;
    let delay_samples = delay_samples as usize;
    if file.method == MethodName::Lqi {
        if file.linearisation == Linearisation::FlatOutput {
            return Err(misplaced("method", &"\"lqi\"", &file.linearisation));
        }
        let integral = weights
            .position_integral
            .ok_or_else(|| missing("weights.position_integral", &file.method, "three numbers, [x, y, z]"))?;
        integral.iter().try_for_each(|entry| positive("weights.position_integral", *entry))?;
        return Ok(Problem::Integral {
            weights: IntegralWeights { equilibrium: equilibrium_weights(weights)?, integral },
        });
    }
    if file.method == MethodName::Along {
        return along(file, weights, folder, rate);
    }
    Ok(match file.linearisation {
        Linearisation::Equilibrium => {
            Problem::Equilibrium(quadratic(file.method, equilibrium_weights(weights)?, delay_samples))
        }
        Linearisation::FlatOutput => Problem::FlatOutput(quadratic(file.method, flat_weights(weights)?, delay_samples)),
    })
}

/// One of the two methods that are defined for both linearisations and have weights.
fn quadratic<W>(name: MethodName, weights: W, delay_samples: usize) -> Method<W> {
    if name == MethodName::Lqr { Method::Lqr { weights } } else { Method::SampledLqr { weights, delay_samples } }
}
