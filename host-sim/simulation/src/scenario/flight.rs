//! The flight of a law: a craft, what is wrong with what is known of it, a course and a law in; where it went out.

use nalgebra::{UnitQuaternion, Vector3, Vector4};
use serde::Deserialize;

use super::course::Flown;
use super::filtered::Estimation;
use super::kept::{Keep, Rows};
use super::track::{SAMPLE_STEPS, STEP_S, Track};
use crate::control_law::{ControlLaw, Estimate, Input, STEPS_HZ};
use crate::flight::closed_loop::Lost;
use crate::flight::rigid_loop::RigidFlight;
use crate::plant::{Plant, PlantGroup, RigidState};

/// Farther than this from its course a craft counts as lost, m.
const LOST_M: f64 = 5.0;

/// How setpoints come.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
pub enum Setpoints {
    /// At 100 Hz to the jerk, as from the Crazyflie's high-level commander; held in between.
    #[default]
    #[serde(rename = "100hz")]
    At100Hz,
    /// At every step, to the crackle.
    #[serde(rename = "exact")]
    Exact,
}

/// A flight outside a scenario: what is flown, how the law is told of it, and where its estimate comes from.
pub struct Bench<'a> {
    /// The course.
    pub flown: &'a Flown,
    /// How setpoints come.
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

/// A law on its way along a track: what is between the craft and the law, and what came of it so far.
pub(super) struct Flying<'a> {
    track: &'a Track,
    law: &'a mut dyn ControlLaw,
    estimation: Estimation,
    law_steps: u32,
    commands_n: Vector4<f64>,
    known: Estimate,
    pub(super) saturated_steps: u64,
    pub(super) lost: Option<Lost>,
}

impl<'a> Flying<'a> {
    /// Before its first step.
    pub(super) fn new(track: &'a Track, law: &'a mut dyn ControlLaw, estimation: Estimation, plant: &Plant) -> Self {
        Self {
            track,
            law_steps: STEPS_HZ / law.rate_hz().clamp(1, STEPS_HZ),
            law,
            estimation,
            commands_n: plant.state().thrusts_n,
            known: truth(plant.state(), &Vector3::zeros()),
            saturated_steps: 0,
            lost: None,
        }
    }

    /// To the end of the track, or where it is lost.
    pub(super) fn fly(&mut self, plant: &mut Plant, keep: &mut impl Keep) {
        for step in 0..=self.track.steps() {
            if !self.decide(step, plant, keep) {
                return;
            }
            plant.advance(&self.commands_n, STEP_S);
        }
    }

    /// One step of the flight but for the craft's own; whether it goes on. Rows every 10 ms of what is measured, and where it
    /// was lost, also before anything is measured.
    fn decide<K: Keep>(&mut self, step: u32, plant: &mut Plant, keep: &mut K) -> bool {
        let (time_s, state) = (f64::from(step) * STEP_S, *plant.state());
        let target_m = self.track.target_m(step);
        let error_m = (state.position_m - target_m).norm();
        // Written so that NaN fails it.
        if !(error_m < LOST_M && state.is_finite()) {
            return self.lose(step, format!("{error_m:.0} m from the course"), plant, keep);
        }
        let measured = self.track.is_measured(time_s);
        let (law_s_turn, row_s_turn) =
            (step.is_multiple_of(self.law_steps), step.is_multiple_of(SAMPLE_STEPS) && measured);
        // An estimate that nobody looks at is left out where that changes none after it.
        if K::SEES_ESTIMATES || law_s_turn || self.estimation.remembers() {
            let felt = K::SEES_ESTIMATES || self.law.feels() || self.estimation.feels();
            let felt_m_s2 = if felt { plant.motion().specific_force_m_s2 } else { Vector3::zeros() };
            self.known = match self.estimation.estimate(&state, &felt_m_s2) {
                Ok(estimate) => estimate,
                Err(error) => return self.lose(step, format!("no estimate: {error}"), plant, keep),
            };
        }
        if law_s_turn {
            let setpoint = *self.track.setpoint(step);
            match self.law.step(&Input { time_s, estimate: self.known, setpoint, battery_v: plant.voltage_v() }) {
                Ok(asked_n) if asked_n.iter().all(|force| force.is_finite()) => self.commands_n = asked_n,
                Ok(_) => return self.lose(step, "a force that is not finite".to_owned(), plant, keep),
                Err(reason) => return self.lose(step, reason, plant, keep),
            }
            self.saturated_steps += u64::from(measured && at_limit(&self.commands_n, plant.command_limits_n()));
        }
        if row_s_turn {
            keep.row(time_s, plant, &self.commands_n, &target_m, &self.known);
        }
        true
    }

    fn lose(&mut self, step: u32, reason: String, plant: &Plant, keep: &mut impl Keep) -> bool {
        let time_s = f64::from(step) * STEP_S;
        self.lost = Some(Lost { time_s, reason });
        if plant.state().is_finite() {
            keep.row(time_s, plant, &self.commands_n, &self.track.target_m(step), &self.known);
        }
        false
    }
}

/// Flies up to four at once, each with the bits that it has alone.
pub(super) fn together(plants: Vec<Plant>, flights: &mut [Flying<'_>], keep: &mut [impl Keep]) {
    let mut group = PlantGroup::new(plants);
    let mut goes_on = [false; PlantGroup::MOST];
    goes_on.iter_mut().take(flights.len()).for_each(|goes| *goes = true);
    let steps = flights.iter().map(|flying| flying.track.steps()).max().unwrap_or(0);
    for step in 0..=steps {
        let mut commands_n = [Vector4::zeros(); PlantGroup::MOST];
        for (lane, (flying, keep)) in flights.iter_mut().zip(keep.iter_mut()).enumerate() {
            let Some(plant) = group.plant_mut(lane).filter(|_| goes_on[lane]) else { continue };
            goes_on[lane] = step <= flying.track.steps() && flying.decide(step, plant, keep);
            commands_n[lane] = flying.commands_n;
            if !goes_on[lane] {
                group.stop(lane);
            }
        }
        if goes_on.iter().all(|goes| !goes) {
            return;
        }
        group.advance(&commands_n, STEP_S);
    }
}

/// Whether a motor is commanded to one of its limits or beyond. Some laws cut their forces in f32 and put them out as 16-bit
/// commands: a thousandth of the range forgives both.
fn at_limit(commands_n: &Vector4<f64>, [least_n, most_n]: [f64; 2]) -> bool {
    let slack_n = 1e-3 * (most_n - least_n);
    commands_n.iter().any(|command_n| *command_n <= least_n + slack_n || *command_n >= most_n - slack_n)
}

/// An estimate that is the truth.
pub(super) fn truth(state: &RigidState, specific_force_m_s2: &Vector3<f64>) -> Estimate {
    Estimate {
        position_m: state.position_m,
        velocity_m_s: state.velocity_m_s,
        attitude: UnitQuaternion::new_normalize(*state.attitude.quaternion()),
        body_rates_rad_s: state.body_rates_rad_s,
        specific_force_m_s2: *specific_force_m_s2,
    }
}
