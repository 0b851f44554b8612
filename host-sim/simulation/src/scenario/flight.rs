//! The flight of a law: a craft, its deviations, a course and a law in; its motion out.

mod together;

use nalgebra::{Vector3, Vector4};
use serde::Deserialize;

use super::course::Flown;
use super::filtered::Estimation;
use super::kept::{Keep, Rows};
use super::track::{SAMPLE_STEPS, STEP_S, Track};
use crate::control_law::{ControlLaw, Estimate, Input, STEPS_HZ};
use crate::flight::closed_loop::{LOST_M, Lost};
use crate::flight::rigid_loop::RigidFlight;
use crate::plant::{Plant, RigidState};
pub(super) use together::together;

/// The form of the setpoints.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
pub enum Setpoints {
    /// At 100 Hz to the jerk, as from the Crazyflie's high-level commander; held in between.
    #[default]
    #[serde(rename = "100hz")]
    At100Hz,
    /// A setpoint at every step, to the crackle.
    #[serde(rename = "exact")]
    Exact,
}

/// A flight outside a scenario: the course, how the law is told of it, and where its estimate comes from.
pub struct Bench<'a> {
    /// The course.
    pub flown: &'a Flown,
    /// The form of the setpoints.
    pub setpoints: Setpoints,
    /// The estimate.
    pub estimation: Estimation,
}

impl Bench<'_> {
    /// Flies a law on any plant from where it is; rows every 10 ms of the part that is measured.
    pub fn fly(self, plant: &mut Plant, law: &mut dyn ControlLaw) -> RigidFlight {
        let track = Track::of(self.flown, self.setpoints);
        let mut flying = Flying::new(&track, law, self.estimation, plant);
        let mut rows = Rows::default();
        flying.fly(plant, &mut rows);
        RigidFlight { samples: rows.samples, saturated_steps: flying.saturated_steps, lost: flying.lost }
    }
}

/// A law on its way along a track: the sensors between craft and law, and the result so far.
pub(super) struct Flying<'a> {
    track: &'a Track,
    law: &'a mut dyn ControlLaw,
    estimation: Estimation,
    law_steps: u32,
    /// Steps that the craft goes on at once.
    stride: u32,
    /// Whether anybody looks at the accelerometer.
    feels: bool,
    /// Whether an estimate changes those after it.
    draws: bool,
    /// The first step that is measured.
    measured_from: u32,
    /// A command at most the first or at least the second is at a limit, N.
    limits_n: [f64; 2],
    /// The step at which the law gets its next setpoint.
    setpoint_until: u32,
    /// How far off its course the craft began, m.
    start_off_m: f64,
    commands_n: Vector4<f64>,
    /// The law's last input.
    told: Input,
    pub(super) saturated_steps: u64,
    /// Of the part before what is measured, which counts where the craft is lost there.
    saturated_before: u64,
    pub(super) lost: Option<Lost>,
}

impl<'a> Flying<'a> {
    /// Before its first step.
    pub(super) fn new(track: &'a Track, law: &'a mut dyn ControlLaw, estimation: Estimation, plant: &Plant) -> Self {
        let law_steps = STEPS_HZ / law.rate_hz().clamp(1, STEPS_HZ);
        Self {
            track,
            law_steps,
            stride: stride(law_steps, &estimation),
            feels: law.feels() || estimation.feels(),
            draws: estimation.remembers(),
            measured_from: track.measured_from(),
            limits_n: at_limit_n(plant.command_limits_n()),
            setpoint_until: 0,
            start_off_m: (plant.state().position_m - track.target_m(0)).norm(),
            law,
            estimation,
            commands_n: plant.state().thrusts_n,
            told: Input {
                time_s: 0.0,
                estimate: truth(plant.state(), &Vector3::zeros()),
                setpoint: *track.setpoint(0),
                battery_v: plant.voltage_v(),
            },
            saturated_before: 0,
            saturated_steps: 0,
            lost: None,
        }
    }

    /// To the end of the track, or where it is lost.
    pub(super) fn fly(&mut self, plant: &mut Plant, keep: &mut impl Keep) {
        for step in (0..=self.track.steps()).step_by(self.stride as usize) {
            if !self.decide(step, plant, keep) {
                return;
            }
            plant.advance(&self.commands_n, self.stride_s());
        }
    }

    /// Steps that the craft goes on at once.
    pub(super) fn stride(&self) -> u32 {
        self.stride
    }

    fn stride_s(&self) -> f64 {
        f64::from(self.stride) * STEP_S
    }

    /// The checks before the craft goes on; whether it goes on. Rows every 10 ms of the measured part, and where it
    /// was lost, also before anything is measured. Inlined: a call costs a tenth of it.
    #[inline(always)]
    fn decide<K: Keep>(&mut self, step: u32, plant: &mut Plant, keep: &mut K) -> bool {
        let time_s = f64::from(step) * STEP_S;
        let error_m = (plant.state().position_m - self.track.target_m(step)).norm();
        // Written so that NaN fails it.
        if !(error_m < LOST_M && plant.is_finite())
            && let Some(off_m) = self.lost_at_m(step, plant)
        {
            return self.lose(step, format!("{off_m:.0} m from the course"), plant, keep);
        }
        let measured = step >= self.measured_from;
        let (law_s_turn, row_s_turn) = (
            self.stride == self.law_steps || step.is_multiple_of(self.law_steps),
            step.is_multiple_of(SAMPLE_STEPS) && (measured || K::SEES_ALL),
        );
        // An estimate that nobody looks at is left out where that changes none after it.
        if K::SEES_ALL || law_s_turn || self.draws {
            let known = &mut self.told.estimate;
            let estimated = if K::SEES_ALL || self.feels {
                let felt_m_s2 = plant.specific_force_m_s2();
                self.estimation.estimate(plant.state(), Some(&felt_m_s2), known)
            } else {
                self.estimation.estimate(plant.state(), None, known)
            };
            if let Err(error) = estimated {
                return self.lose(step, format!("no estimate: {error}"), plant, keep);
            }
        }
        if law_s_turn {
            if step >= self.setpoint_until {
                self.told.setpoint = *self.track.setpoint(step);
                self.setpoint_until = self.track.setpoint_until(step);
            }
            (self.told.time_s, self.told.battery_v) = (time_s, plant.voltage_v());
            match self.law.step(&self.told) {
                // Times 0 their sum is 0 or NaN.
                Ok(asked_n) if asked_n.sum() * 0.0 == 0.0 => self.commands_n = asked_n,
                Ok(_) => return self.lose(step, "a force that is not finite".to_owned(), plant, keep),
                Err(reason) => return self.lose(step, reason, plant, keep),
            }
            let is_at_limit = u64::from(is_at(&self.commands_n, self.limits_n));
            if measured {
                self.saturated_steps += is_at_limit;
            } else {
                self.saturated_before += is_at_limit;
            }
        }
        if row_s_turn {
            keep.row(time_s, plant, &self.commands_n, &self.track.target_m(step), &self.told.estimate);
            if K::SEES_ALL && !measured {
                keep.set_aside();
            }
        }
        if self.draws {
            self.estimation.pass_over(self.stride - 1);
        }
        true
    }

    /// How far off its course a craft is that is lost: of a step from the line between its places, of a start beside the course
    /// by as much more as that is off.
    #[cold]
    fn lost_at_m(&self, step: u32, plant: &Plant) -> Option<f64> {
        let off_m = self.track.off_m(step, &plant.state().position_m);
        (!(off_m < LOST_M + self.start_off_m && plant.is_finite())).then_some(off_m)
    }

    #[cold]
    fn lose(&mut self, step: u32, reason: String, plant: &Plant, keep: &mut impl Keep) -> bool {
        let time_s = f64::from(step) * STEP_S;
        self.lost = Some(Lost { time_s, reason });
        if step < self.measured_from {
            self.saturated_steps = self.saturated_before;
        }
        if plant.is_finite() {
            keep.row(time_s, plant, &self.commands_n, &self.track.target_m(step), &self.told.estimate);
        }
        false
    }
}

/// Steps between two looks at a craft: at the steps of its law and for the rows, but at every one where a filter follows it.
fn stride(law_steps: u32, estimation: &Estimation) -> u32 {
    let most = if estimation.feels() { 1 } else { SAMPLE_STEPS };
    (1..=most).rev().find(|n| law_steps.is_multiple_of(*n) && SAMPLE_STEPS.is_multiple_of(*n)).unwrap_or(1)
}

/// The highest command at the lower limit of a motor, and the lowest at its upper one, N. Some laws cut their forces in f32 and put them out
/// as 16-bit commands: a thousandth of the range forgives both.
fn at_limit_n([least_n, most_n]: [f64; 2]) -> [f64; 2] {
    let slack_n = 1e-3 * (most_n - least_n);
    [least_n + slack_n, most_n - slack_n]
}

/// Whether a motor is commanded to one of its limits or beyond; no command is NaN.
#[inline]
fn is_at(commands_n: &Vector4<f64>, [low_n, high_n]: [f64; 2]) -> bool {
    // By comparison: f64::min also looks for NaN.
    let (less, more) = (|a: f64, b: f64| if a < b { a } else { b }, |a: f64, b: f64| if a > b { a } else { b });
    let [a, b, c, d] = *commands_n.as_ref();
    less(less(a, b), less(c, d)) <= low_n || more(more(a, b), more(c, d)) >= high_n
}

/// An estimate that is the truth.
#[inline]
pub(super) fn truth(state: &RigidState, specific_force_m_s2: &Vector3<f64>) -> Estimate {
    Estimate {
        position_m: state.position_m,
        velocity_m_s: state.velocity_m_s,
        attitude: state.attitude,
        body_rates_rad_s: state.body_rates_rad_s,
        specific_force_m_s2: *specific_force_m_s2,
    }
}

#[cfg(test)]
mod tests;
