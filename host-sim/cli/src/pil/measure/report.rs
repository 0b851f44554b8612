//! Counts of instructions as they come in; least, mean and most of each part, and the sizes of the images, as they are
//! printed and written, out.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

use crate::pil::estimator;
use crate::pil::link::{self, LinkReport};

/// Counts over steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Count {
    /// Least.
    pub min: u32,
    /// Mean.
    pub mean: f64,
    /// Most.
    pub max: u32,
}

/// Counts as they come in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tally {
    min: u32,
    sum: u64,
    max: u32,
    calls: u64,
}

impl Tally {
    pub(super) const NONE: Self = Self { min: u32::MAX, sum: 0, max: 0, calls: 0 };

    pub(super) fn add(&mut self, [min, sum, max]: [u32; 3], calls: u64) {
        (self.min, self.max) = (self.min.min(min), self.max.max(max));
        (self.sum, self.calls) = (self.sum + u64::from(sum), self.calls + calls);
    }

    pub(super) fn count(&self) -> Count {
        let mean = self.sum as f64 / self.calls.max(1) as f64;
        Count { min: self.min.min(self.max), mean: (mean * 100.0).round() / 100.0, max: self.max }
    }
}

/// Costs of the control path.
#[derive(Clone, Debug, Serialize)]
pub struct InstructionReport {
    /// A step of each law, with validation, sign handling and saturation: each controller's, `any E table` for a gain
    /// without a zero. The cascade is counted in the Crazyflie object.
    pub law: BTreeMap<String, Count>,
    /// The reference of a tick: polynomial to jerk, and the flat map.
    pub reference: Count,
    /// The same on a trajectory that turns.
    #[serde(rename = "reference turning")]
    pub reference_turning: Count,
    /// A whole tick on a trajectory that does not turn.
    pub tick: Count,
    /// The estimator, counted by its own image.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimator: Option<estimator::EstimatorReport>,
    /// The link's frames, counted by an image of their own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub link: Option<LinkReport>,
    /// Steps flown.
    pub steps: usize,
    /// Code and tables of the control path, without stored trajectories: all that its own image puts in flash, start-up
    /// code and vector table included.
    pub flash_bytes: u32,
    /// The same down to the motors: every law, the cascade included, to four forces.
    pub flash_to_motors_bytes: u32,
    /// Variables of the image that flies, uploads included.
    pub ram_bytes: u32,
    /// Most stack that it used in flight.
    pub stack_bytes: u32,
    /// All of its flash.
    pub image_flash_bytes: u32,
}

impl fmt::Display for InstructionReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "Instructions on the emulated Cortex-M4F (target-cpu=cortex-m4, opt-level 3), {} steps of the paper's flights",
            self.steps
        )?;
        writeln!(f, "\n{:<32}{:>8}{:>10}{:>8}", "", "min", "mean", "max")?;
        let mut row =
            |name: &str, count: &Count| writeln!(f, "{name:<32}{:>8}{:>10.1}{:>8}", count.min, count.mean, count.max);
        for (name, count) in &self.law {
            row(&format!("law, {name}"), count)?;
        }
        row("reference", &self.reference)?;
        row("reference, turning", &self.reference_turning)?;
        row("whole tick", &self.tick)?;
        if let Some(estimator) = &self.estimator {
            for (name, count) in &estimator.prediction {
                row(&format!("prediction, {name}"), count)?;
            }
            for (name, count) in &estimator.update {
                row(&format!("position, {name}"), count)?;
            }
        }
        if let Some(LinkReport { frames, signature }) = &self.link {
            writeln!(f, "\n{:<32}{:>8}{:>10}", "", "no tag", "tag")?;
            for link::FrameCost { frame, without_tag, with_tag } in frames {
                writeln!(f, "frame, {frame:<25}{without_tag:>8}{with_tag:>10}")?;
            }
            writeln!(f, "{:<32}{:>18}", "signature of a gain table", signature)?;
        }
        writeln!(f, "\ncontrol path   flash {:>6} bytes, without stored trajectories", self.flash_bytes)?;
        writeln!(f, "to the motors  flash {:>6} bytes, the cascade included", self.flash_to_motors_bytes)?;
        if let Some(estimator::EstimatorReport { prediction_stack_bytes, update_stack_bytes, .. }) = &self.estimator {
            writeln!(
                f,
                "estimator      stack {prediction_stack_bytes:>6} bytes, {update_stack_bytes} bytes of an update"
            )?;
        }
        let Self { image_flash_bytes, ram_bytes, stack_bytes, .. } = self;
        writeln!(
            f,
            "whole image    flash {image_flash_bytes:>6} bytes, RAM {ram_bytes} bytes, stack {stack_bytes} bytes"
        )
    }
}
