//! A figure with its 95 % interval: the most likely value and draws of it in; the interval, or the refusal of one that is too
//! wide, out.

use crate::filter::quantile;

/// A figure with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Most likely.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Systematic errors of figures, as a share and at 95 %, on simulated crafts whose flights are as long as one likes:
/// attitude and velocity are of an estimator that does not know of drag, and the course of a command between its samples
/// is not in the log.
const SYSTEMATIC: [(&str, f64); 8] = [
    ("lag_", 0.11),
    ("command_power", 0.07),
    ("inertia_z", 0.16),
    ("inertia_", 0.08),
    ("drag_", 0.07),
    ("moment_", 0.12),
    ("thrust_", 0.05),
    ("hover_command", 0.02),
];

/// Figures that are above 0 on every craft.
const POSITIVE: [&str; 6] = ["lag_", "inertia_", "rotor_inertia", "command_power", "thrust_", "hover_command"];

/// The estimate; or why it is not told: its interval by draws is wider than `most` to either side, or holds 0 where the figure is above
/// it on every craft. `spread`: by how much intervals of few blocks are wider than those of many.
pub(super) fn told(
    name: &str,
    value: f64,
    draws: &[f64],
    spread: f64,
    most: f64,
    manoeuvre: &str,
) -> Result<Estimate, String> {
    let mut estimate = interval(value, draws, spread);
    let half = 0.5 * (estimate.high - estimate.low);
    let positive = POSITIVE.iter().any(|start| name.starts_with(start));
    let is_told = half <= most && half.is_finite() && value.is_finite() && !(positive && estimate.low <= 0.0);
    if let Some((_, share)) = SYSTEMATIC.iter().find(|(start, _)| name.starts_with(start)) {
        // Errors of estimator and model, which drawing blocks of the same flight does not show.
        let more = share * value.abs();
        estimate.low = value - (value - estimate.low).hypot(more);
        estimate.high = value + (estimate.high - value).hypot(more);
    }
    if is_told {
        return Ok(estimate);
    }
    Err(format!("+-{half:.2e} about {value:.3e} at 95 %, and no more than +-{most:.2e} is told: {manoeuvre}"))
}

/// From the draws' quantiles, made wider for few units, and shifted so that it is about the value.
pub(super) fn interval(value: f64, draws: &[f64], spread: f64) -> Estimate {
    let (low, high, middle) = (quantile(draws, 0.025), quantile(draws, 0.975), quantile(draws, 0.5));
    Estimate { value, low: value - spread * (middle - low).max(0.0), high: value + spread * (high - middle).max(0.0) }
}
