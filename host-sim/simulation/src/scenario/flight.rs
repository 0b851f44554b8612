//! The flight of a law: a craft, what is wrong with what is known of it, a course and a law in; where it went out.

use nalgebra::{UnitQuaternion, Vector3, Vector4};
use serde::Deserialize;

use super::course::Flown;
use super::filtered::Estimation;
use super::recording::{Around, Recording};
use crate::control_law::{ControlLaw, Estimate, Input, STEPS_HZ, Setpoint};
use crate::flight::closed_loop::Lost;
use crate::flight::rigid_loop::{RigidFlight, RigidSample};
use crate::plant::{Plant, RigidState};

/// Farther than this from its course a craft counts as lost, m.
const LOST_M: f64 = 5.0;
/// Steps between two samples, and between two setpoints at 100 Hz.
const SAMPLE_STEPS: u32 = 10;
/// s.
const STEP_S: f64 = 1.0 / STEPS_HZ as f64;

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

/// What is flown, how the law is told of it, and what is between the craft and the law.
pub struct Bench<'a> {
    /// What is flown.
    pub flown: &'a Flown,
    /// How the law is told of it.
    pub setpoints: Setpoints,
    /// Where its estimate comes from.
    pub estimation: Estimation,
}

impl Bench<'_> {
    /// Flies a law from where a craft is; rows every 10 ms of what is measured.
    pub fn fly(self, plant: &mut Plant, law: &mut dyn ControlLaw) -> RigidFlight {
        self.record(plant, law).flight
    }

    /// The same, with what was around the craft and known of it at every row.
    pub fn record(mut self, plant: &mut Plant, law: &mut dyn ControlLaw) -> Recording {
        let (mut around, mut known) = (Vec::new(), truth(plant.state(), &Vector3::zeros()));
        let mut flight = RigidFlight { samples: Vec::new(), saturated_steps: 0, lost: None };
        let steps = (self.flown.course.duration_s() / STEP_S).round() as u32;
        let law_steps = STEPS_HZ / law.rate_hz().clamp(1, STEPS_HZ);
        let (mut setpoint, mut commands_n) = (self.setpoint(0.0), plant.state().thrusts_n);
        for step in 0..=steps {
            let (time_s, state) = (f64::from(step) * STEP_S, *plant.state());
            let target_m = self.flown.course.at(time_s).position[0];
            let error_m = (state.position_m - target_m).norm();
            // Written so that NaN fails it.
            if !(error_m < LOST_M && state.is_finite()) {
                flight.lost = Some(Lost { time_s, reason: format!("{error_m:.0} m from the course") });
                break;
            }
            if step.is_multiple_of(SAMPLE_STEPS) || self.setpoints == Setpoints::Exact {
                setpoint = self.setpoint(time_s);
            }
            let measured = time_s > self.flown.measured_from_s - 0.5 * STEP_S;
            known = match self.estimation.estimate(&state, &plant.motion().specific_force_m_s2) {
                Ok(estimate) => estimate,
                Err(error) => {
                    flight.lost = Some(Lost { time_s, reason: format!("no estimate: {error}") });
                    break;
                }
            };
            if step.is_multiple_of(law_steps) {
                match law.step(&Input { time_s, estimate: known, setpoint, battery_v: plant.voltage_v() }) {
                    Ok(asked_n) if asked_n.iter().all(|force| force.is_finite()) => commands_n = asked_n,
                    Ok(_) => flight.lost = Some(Lost { time_s, reason: "a force that is not finite".to_owned() }),
                    Err(reason) => flight.lost = Some(Lost { time_s, reason }),
                }
                if flight.lost.is_some() {
                    break;
                }
                flight.saturated_steps += u64::from(measured && at_limit(&commands_n, plant.command_limits_n()));
            }
            if step.is_multiple_of(SAMPLE_STEPS) && measured {
                around.push(Around::of(plant, known));
                flight.samples.push(RigidSample { time_s, state, commands_n, target_m });
            }
            plant.advance(&commands_n, STEP_S);
        }
        // Where it was lost counts, also before anything is measured.
        if let Some(Lost { time_s, .. }) = flight.lost {
            let (state, target_m) = (*plant.state(), self.flown.course.at(time_s).position[0]);
            if state.is_finite() {
                around.push(Around::of(plant, known));
                flight.samples.push(RigidSample { time_s, state, commands_n, target_m });
            }
        }
        Recording { flight, around, gust_rms_m_s: plant.realised_gust_rms_m_s() }
    }

    fn setpoint(&self, time_s: f64) -> Setpoint {
        let point = self.flown.course.at(time_s);
        match self.setpoints {
            Setpoints::At100Hz => Setpoint::to_jerk(&point, time_s),
            Setpoints::Exact => Setpoint::exact(&point, time_s),
        }
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
