//! The record of a flight: every row of it, or their sums.

use nalgebra::{Vector3, Vector4};

use super::recording::Around;
use crate::control_law::Estimate;
use crate::flight::closed_loop::{Lost, SAMPLE_PERIOD_S};
use crate::flight::rigid_loop::RigidSample;
use crate::plant::Plant;

/// Takes the rows of a flight.
pub(super) trait Keep {
    /// Whether estimates, and the rows before anything is measured, are part of the record.
    const SEES_ALL: bool;

    /// One row.
    fn row(&mut self, time_s: f64, plant: &Plant, commands_n: &Vector4<f64>, target_m: &Vector3<f64>, known: &Estimate);

    /// The last row is from before anything is measured.
    fn set_aside(&mut self) {}
}

/// Everything.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) samples: Vec<RigidSample>,
    pub(super) around: Vec<Around>,
    /// Those from before anything is measured.
    pub(super) before: Vec<(RigidSample, Around)>,
}

impl Keep for Rows {
    const SEES_ALL: bool = true;

    fn row(
        &mut self,
        time_s: f64,
        plant: &Plant,
        commands_n: &Vector4<f64>,
        target_m: &Vector3<f64>,
        known: &Estimate,
    ) {
        self.around.push(Around::of(plant, *known));
        self.samples.push(RigidSample { time_s, state: *plant.state(), commands_n: *commands_n, target_m: *target_m });
    }

    fn set_aside(&mut self) {
        self.before.extend(self.samples.pop().zip(self.around.pop()));
    }
}

/// Sums over the position errors of the rows, in the order in which they came.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Errors {
    sum_m: f64,
    most_m: f64,
}

impl Keep for Errors {
    const SEES_ALL: bool = false;

    fn row(&mut self, _: f64, plant: &Plant, _: &Vector4<f64>, target_m: &Vector3<f64>, _: &Estimate) {
        let error_m = (plant.state().position_m - target_m).norm();
        self.sum_m += error_m;
        self.most_m = self.most_m.max(error_m);
    }
}

/// The result of a flight, to the bit as [`crate::flight::rigid_loop::RigidFlight`] has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tally {
    /// Sum of the position error's norm over samples of 10 ms, times 10 ms, m s; none for a flight that was lost.
    pub iae_m_s: Option<f64>,
    /// Largest position error, m.
    pub max_error_m: f64,
    /// Control steps with a motor at its limit.
    pub saturated_steps: u64,
    /// Time and reason of its loss.
    pub lost: Option<Lost>,
}

impl Tally {
    pub(super) fn of(errors: &Errors, saturated_steps: u64, lost: Option<Lost>) -> Self {
        Self {
            iae_m_s: lost.is_none().then_some(errors.sum_m * SAMPLE_PERIOD_S),
            max_error_m: errors.most_m,
            saturated_steps,
            lost,
        }
    }
}
