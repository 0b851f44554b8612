//! A course as a flight meets it, step by step: where the craft is to be, and the setpoints of its law. Many flights
//! share one.

use nalgebra::Vector3;

use super::course::Flown;
use super::flight::Setpoints;
use crate::control_law::{STEPS_HZ, Setpoint};

/// s.
pub(super) const STEP_S: f64 = 1.0 / STEPS_HZ as f64;
/// Steps between two samples, and between two setpoints at 100 Hz.
pub(super) const SAMPLE_STEPS: u32 = 10;

/// The course, evaluated once.
#[derive(Clone, Debug)]
pub struct Track {
    targets_m: Vec<Vector3<f64>>,
    setpoints: Vec<Setpoint>,
    setpoint_steps: u32,
    steps: u32,
    measured_from: u32,
    /// Where the course jumps.
    jump_m: Option<[Vector3<f64>; 2]>,
}

impl Track {
    /// Of a course, with setpoints as they come.
    pub fn of(flown: &Flown, setpoints: Setpoints) -> Self {
        let steps = (flown.course.duration_s() / STEP_S).round() as u32;
        let setpoint_steps = if setpoints == Setpoints::Exact { 1 } else { SAMPLE_STEPS };
        let mut track = Self {
            targets_m: Vec::with_capacity(steps as usize + 1),
            setpoints: Vec::with_capacity((steps / setpoint_steps) as usize + 1),
            setpoint_steps,
            steps,
            measured_from: 0,
            jump_m: flown.course.jump_m(),
        };
        // Written so that NaN measures nothing.
        let is_measured = |step: u32| f64::from(step) * STEP_S > flown.measured_from_s - 0.5 * STEP_S;
        track.measured_from = (0..=steps).find(|step| is_measured(*step)).unwrap_or(u32::MAX);
        for step in 0..=steps {
            let time_s = f64::from(step) * STEP_S;
            let point = flown.course.at(time_s);
            track.targets_m.push(point.position[0]);
            if step.is_multiple_of(setpoint_steps) {
                track.setpoints.push(match setpoints {
                    Setpoints::At100Hz => Setpoint::to_jerk(&point, time_s),
                    Setpoints::Exact => Setpoint::exact(&point, time_s),
                });
            }
        }
        track
    }

    /// The last step.
    pub(super) fn steps(&self) -> u32 {
        self.steps
    }

    /// The first step that is measured.
    pub(super) fn measured_from(&self) -> u32 {
        self.measured_from
    }

    /// Where the craft is to be at a step, m; at the end beyond it.
    pub(super) fn target_m(&self, step: u32) -> Vector3<f64> {
        self.targets_m.get(step as usize).or(self.targets_m.last()).copied().unwrap_or_default()
    }

    /// How far a place is from the course at a step, m; from the line between its two places where the course jumps.
    pub(super) fn off_m(&self, step: u32, place_m: &Vector3<f64>) -> f64 {
        let Some([from_m, to_m]) = self.jump_m else { return (place_m - self.target_m(step)).norm() };
        let way_m = to_m - from_m;
        // The nearest point of the line is at a share of the way; of none, all of it is one place.
        let share = (place_m - from_m).dot(&way_m) / way_m.norm_squared().max(f64::MIN_POSITIVE);
        (place_m - (from_m + way_m * share.clamp(0.0, 1.0))).norm()
    }

    /// The last setpoint sent at a step.
    pub(super) fn setpoint(&self, step: u32) -> &Setpoint {
        // There is one for the first step of every course.
        &self.setpoints[((step / self.setpoint_steps) as usize).min(self.setpoints.len() - 1)]
    }

    /// The step at which the next setpoint begins; beyond every step for the last one.
    pub(super) fn setpoint_until(&self, step: u32) -> u32 {
        let next = (step / self.setpoint_steps + 1) * self.setpoint_steps;
        if ((next / self.setpoint_steps) as usize) < self.setpoints.len() { next } else { u32::MAX }
    }

    /// The setpoints of a law of a rate at its own steps, each with its time.
    pub(super) fn told(&self, rate_hz: u32) -> impl Iterator<Item = (f64, &Setpoint)> {
        let law_steps = (STEPS_HZ / rate_hz.clamp(1, STEPS_HZ)) as usize;
        (0..=self.steps).step_by(law_steps).map(|step| (f64::from(step) * STEP_S, self.setpoint(step)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn setpoints_and_the_measured_part_begin_at_their_steps() {
        for setpoints in [Setpoints::At100Hz, Setpoints::Exact] {
            let flown = Flown::eight(2.1, 0.05);
            let track = Track::of(&flown, setpoints);
            let (mut told, mut until) = (*track.setpoint(0), 0);
            // Every second step, as a law at 500 Hz, and beyond the end, where the last one stays.
            for step in (0..track.steps() + 30).step_by(2) {
                if step >= until {
                    (told, until) = (*track.setpoint(step), track.setpoint_until(step));
                }
                assert_eq!(told, *track.setpoint(step), "{step}");
                let time_s = f64::from(step) * STEP_S;
                let is_measured = time_s > flown.measured_from_s - 0.5 * STEP_S;
                assert_eq!(step >= track.measured_from(), is_measured, "{time_s} s");
            }
        }
    }
}
