//! The largest delay and the largest actuator lag up to which the sampled loop stays stable.
//!
//! In flow independent loops; out flow limits by channel and for all channels at once. The search walks outwards in steps
//! of [`STEP`] until the loop is unstable and then bisects: it returns the first crossing, unless an interval of
//! instability narrower than a step comes before it. Delays are exact at any fraction of a sample: stability is decided
//! by the principle of the argument, lags by the poles.

use serde::Serialize;

use super::CertifyError;
use super::linear_loop::LinearLoop;
use super::plant::{LagModel, Timing};
use super::sampled_loop::SampledLoop;
use crate::analysis::eigenvalues;

/// Ratio of two neighbouring trials.
const STEP: f64 = 1.08;
/// Bisections of the last step: to 1e-9 of the limit.
const BISECTIONS: i32 = 27;
/// Longest delay and lag tried, s, and in samples.
const LONGEST_S: f64 = 3.0;
const MOST_SAMPLES: f64 = 5_000.0;

/// Up to where a loop is stable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StabilityLimit {
    /// Which channels: a name, or all of them.
    pub channels: String,
    /// Stable up to this, s.
    pub stable_to_s: f64,
    /// Unstable this much further on, s; absent where the search ended without instability.
    pub resolution_s: Option<f64>,
}

/// The quantity that is increased.
#[derive(Clone, Copy)]
pub(super) enum Disturbance {
    /// A delay of the commands on top of the timing's.
    Delay,
    /// An actuator lag.
    Lag(LagModel),
}

/// Limits of each channel alone, then of all at once.
pub(super) fn limits(
    loops: &[LinearLoop],
    timing: &Timing,
    names: &[String],
    disturbance: Disturbance,
) -> Result<Vec<StabilityLimit>, CertifyError> {
    let mut each = Vec::new();
    let mut all: Option<StabilityLimit> = None;
    for part in loops.iter().filter(|part| !part.channels.is_empty()) {
        let mut weakest: Option<StabilityLimit> = None;
        for (i, channel) in part.channels.iter().enumerate() {
            let name = names.get(*channel).cloned().unwrap_or_default();
            let limit = search(part, timing, disturbance, &|j| j == i, name)?;
            weakest = Some(limit.clone());
            each.push((*channel, limit));
        }
        if part.channels.len() > 1 {
            weakest = Some(search(part, timing, disturbance, &|_| true, String::new())?);
        }
        // Independent loops: all at once are as strong as the weakest.
        all = match (all, weakest) {
            (Some(held), Some(new)) if new.stable_to_s >= held.stable_to_s => Some(held),
            (held, new) => new.or(held),
        };
    }
    each.sort_by_key(|(channel, _)| *channel);
    let all = all.map(|limit| StabilityLimit { channels: String::from("all"), ..limit });
    Ok(each.into_iter().map(|(_, limit)| limit).chain(all).collect())
}

fn search(
    part: &LinearLoop,
    timing: &Timing,
    disturbance: Disturbance,
    chosen: &impl Fn(usize) -> bool,
    channels: String,
) -> Result<StabilityLimit, CertifyError> {
    let stable = |duration_s: f64| is_stable(part, timing, disturbance, chosen, duration_s);
    let longest_s = LONGEST_S.min(MOST_SAMPLES * timing.period_s);
    let mut low_s = 0.0;
    let mut high_s = 0.02 * timing.period_s;
    loop {
        if !stable(high_s)? {
            break;
        }
        low_s = high_s;
        if high_s >= longest_s {
            return Ok(StabilityLimit { channels, stable_to_s: low_s, resolution_s: None });
        }
        high_s = (high_s * STEP).min(longest_s);
    }
    // Halved exactly, so that it is the same number wherever the limit's last digits fall.
    let resolution_s = (high_s - low_s) * f64::from(-BISECTIONS).exp2();
    for _ in 0..BISECTIONS {
        let middle_s = 0.5 * (low_s + high_s);
        if stable(middle_s)? { low_s = middle_s } else { high_s = middle_s }
    }
    Ok(StabilityLimit { channels, stable_to_s: low_s, resolution_s: Some(resolution_s) })
}

fn is_stable(
    part: &LinearLoop,
    timing: &Timing,
    disturbance: Disturbance,
    chosen: &impl Fn(usize) -> bool,
    duration_s: f64,
) -> Result<bool, CertifyError> {
    match disturbance {
        Disturbance::Delay => {
            let delays: Vec<f64> = (0..part.channels.len()).map(|i| if chosen(i) { duration_s } else { 0.0 }).collect();
            Ok(SampledLoop::new(part, timing, &delays)?.is_stable())
        }
        Disturbance::Lag(model) => {
            let lagging = part.behind_actuators(duration_s, model, chosen);
            let poles = eigenvalues(&SampledLoop::new(&lagging, timing, &[])?.closed_loop())?;
            Ok(poles.iter().all(|pole| pole.norm() < 1.0))
        }
    }
}
