//! A stretch of flight with its prediction, for pictures.

use nalgebra::Vector3;

use super::craft::{BEFORE, Craft, HORIZON, Habits};
use crate::filter::quantile;
use crate::fit::Fit;
use crate::flight::{Flight, RATE_HZ, STEP_S, Section};

/// A stretch of flight with its prediction.
#[derive(Clone, Debug, PartialEq)]
pub struct Example {
    /// Its file.
    pub flight: String,
    /// s.
    pub times_s: Vec<f64>,
    /// Position as flown, m.
    pub position_m: Vec<Vector3<f64>>,
    /// As predicted, from a new start every half second.
    pub predicted_m: Vec<Vector3<f64>>,
    /// Body rates as flown and as predicted, rad/s.
    pub rates_rad_s: [Vec<Vector3<f64>>; 2],
}

/// The liveliest held-out part.
pub(super) fn example(held: &[Flight], fit: &Fit, habits: &Habits) -> Option<Example> {
    let lively = |section: &Section| quantile(&section.gyro.iter().map(|w| w.xy().norm()).collect::<Vec<_>>(), 0.9);
    let parts =
        held.iter().zip(&fit.flights).flat_map(|(flight, own)| flight.sections.iter().map(move |s| (flight, own, s)));
    let (flight, own, section) =
        parts.filter(|(_, _, s)| s.len() > BEFORE + 4 * HORIZON).max_by(|a, b| lively(a.2).total_cmp(&lively(b.2)))?;
    let craft = Craft::of(fit, own);
    let track = craft.track(section, habits);
    let mut example = Example {
        flight: flight.name.clone(),
        times_s: Vec::new(),
        position_m: Vec::new(),
        predicted_m: Vec::new(),
        rates_rad_s: [Vec::new(), Vec::new()],
    };
    let last = section.len().min((RATE_HZ * 11.0) as usize) - HORIZON - 1;
    for start in (BEFORE..last).step_by(HORIZON) {
        for (k, state) in craft.ahead(&track, start, habits, true).iter().enumerate() {
            let i = start + k + 1;
            example.times_s.push(section.start_s + i as f64 * STEP_S);
            example.position_m.push(section.position[i]);
            example.predicted_m.push(state.position);
            example.rates_rad_s[0].push(section.gyro[i] - own.gyro_bias_rad_s);
            example.rates_rad_s[1].push(state.rates);
        }
    }
    Some(example)
}
