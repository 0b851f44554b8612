//! Figures with their 95 % intervals: a posterior, regressions and biases in; each figure told, or refused with the manoeuvre
//! that would tell it, out.

mod of_posterior;
mod of_regressions;

use std::collections::BTreeMap;

use super::BLOCK_S;
use super::estimate::{Estimate, told};
use super::posterior::Posterior;
use super::prior::Base;
use crate::filter::mean;

/// Every figure of a craft, told with an interval or refused with a manoeuvre.
pub(super) struct Figures<'a> {
    base: &'a Base,
    pub(super) all: BTreeMap<&'static str, Result<Estimate, String>>,
    spread: f64,
    steeper: f64,
}

/// Share of the torques about an axis that has to be explained before anything is told of them: less, and the flight is at rest, or its
/// columns are not what the map says.
const TORQUES_LEAST: f64 = 0.5;

/// Least effective number of blocks that tell of a figure: one alone shows no spread.
const BLOCKS_LEAST: f64 = 1.5;

pub(super) const EVERY_STEP: &str = "log every control step";
pub(super) const STEPS: &str = "fly 20 s of steps between corners, which turn the craft fast";
const SPEED: &str = "fly 30 s at 1 m/s and more in both directions";
const CLIMBS: &str = "fly climbs and drops of 0.5 m and more, as fast as they go";
const DISCHARGE: &str = "log the battery's voltage over a few minutes, or two flights, one with a full battery";
const TURNS: &str = "turn the heading by 90 degrees and back, fast, a few times";

impl<'a> Figures<'a> {
    /// None yet. `spread`: by how much intervals of few blocks are wider than those of many; `steeper`: by how much the force may grow
    /// faster with the command than the fit has it.
    pub(super) fn new(base: &'a Base, spread: f64, steeper: f64) -> Self {
        Self { base, all: BTreeMap::new(), spread, steeper }
    }

    fn put(&mut self, name: &'static str, value: f64, draws: &[f64], most: f64, manoeuvre: &str) {
        self.all.insert(name, told(name, value, draws, self.spread, most, manoeuvre));
    }

    /// A figure that goes with the slope of force over command, and is larger by a factor where that is as steep as it may be: the middle
    /// of both by ratio, in an interval that holds both.
    fn put_by_slope(&mut self, name: &'static str, value: f64, draws: &[f64], most: f64, factor: f64, manoeuvre: &str) {
        self.put(name, value, draws, most, manoeuvre);
        let Some(Ok(estimate)) = self.all.get_mut(name) else { return };
        let more = (factor - 1.0) * value;
        estimate.low += more.min(0.0);
        estimate.high += more.max(0.0);
        estimate.value *= factor.sqrt();
        if more.abs() > most {
            let reason = format!(
                "it may be {factor:.2} times as large, since the commands of this log are noisy: {EVERY_STEP}, and {CLIMBS}"
            );
            self.all.insert(name, Err(reason));
        }
    }

    /// Refuses some.
    pub(super) fn refuse(&mut self, reasons: Vec<(&'static str, String)>) {
        self.all.extend(reasons.into_iter().map(|(name, reason)| (name, Err(reason))));
    }

    /// Refuses a figure that one block of the flight tells alone.
    fn repeated(&mut self, posterior: &Posterior, name: &'static str, j: usize, manoeuvre: &str) {
        if posterior.effective_blocks(j) < BLOCKS_LEAST {
            let reason = format!("one stretch of {BLOCK_S} s alone tells it, which shows no spread: {manoeuvre}");
            self.all.insert(name, Err(reason));
        }
    }

    /// Refuses a figure that the prior tells, or one block, and not the flight.
    fn excited(&mut self, posterior: &Posterior, name: &'static str, j: usize, most: f64, manoeuvre: &str) {
        self.repeated(posterior, name, j, manoeuvre);
        let by_data = 1.96 * posterior.by_data(j);
        if by_data > most {
            let reason = format!("this flight does not tell it, at most +-{most:.2e} at 95 % would: {manoeuvre}");
            self.all.insert(name, Err(reason));
        }
    }

    /// Refuses what torques tell about axes whose torques are not explained.
    pub(super) fn turning(&mut self, explained: [f64; 3], yaw: f64) {
        let shares = [("x", explained[0]), ("y", explained[1]), ("z", yaw)];
        for (axis, share) in shares.into_iter().filter(|(_, share)| *share < TORQUES_LEAST) {
            let manoeuvre = if axis == "z" { TURNS } else { STEPS };
            let names = self.all.keys().filter(|name| {
                let turns = ["inertia_", "moment_", "rate_damping_"].iter().any(|start| name.starts_with(start));
                turns && name.split('_').any(|part| part == axis) || axis == "z" && name.starts_with("rotor_")
            });
            for name in names.copied().collect::<Vec<_>>() {
                let reason = format!(
                    "the motors explain {share:.2} of the torque about {axis}, {TORQUES_LEAST} is the least: {manoeuvre}"
                );
                self.all.insert(name, Err(reason));
            }
        }
        if explained[0].max(explained[1]) < TORQUES_LEAST {
            for name in ["lag_ms", "lag_rise_ms", "lag_fall_ms", "delay_ms"] {
                let reason = format!("the motors explain less than {TORQUES_LEAST} of the torques: {STEPS}");
                self.all.insert(name, Err(reason));
            }
        }
    }
}

fn variance(signal: &[f64]) -> f64 {
    let m = mean(signal);
    mean(&signal.iter().map(|v| (v - m).powi(2)).collect::<Vec<_>>())
}
