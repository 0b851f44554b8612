//! Errors of a prediction, and their means.

use super::craft::State;
use crate::filter::mean;
use crate::flight::Section;
use nalgebra::Vector3;

/// Mean errors, each the mean over all starts of the length of the error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// m.
    pub position_m: f64,
    /// m/s.
    pub velocity_m_s: f64,
    /// rad.
    pub rotation_rad: f64,
    /// rad/s.
    pub body_rate_rad_s: f64,
}

/// Errors of one way to predict at every step ahead, from 1 to [`super::HORIZON`].
pub type Course = Vec<Errors>;

impl Errors {
    pub(super) fn of(section: &Section, i: usize, bias: &Vector3<f64>, state: &State) -> Self {
        Self {
            position_m: (section.position[i] - state.position).norm(),
            velocity_m_s: (section.velocity[i] - state.velocity).norm(),
            rotation_rad: section.attitude[i].angle_to(&state.attitude),
            body_rate_rad_s: (section.gyro[i] - bias - state.rates).norm(),
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.position_m += other.position_m;
        self.velocity_m_s += other.velocity_m_s;
        self.rotation_rad += other.rotation_rad;
        self.body_rate_rad_s += other.body_rate_rad_s;
    }

    pub(super) fn over(&self, count: usize) -> Self {
        let share = 1.0 / count.max(1) as f64;
        Self {
            position_m: self.position_m * share,
            velocity_m_s: self.velocity_m_s * share,
            rotation_rad: self.rotation_rad * share,
            body_rate_rad_s: self.body_rate_rad_s * share,
        }
    }
}

/// Mean of a course over all steps ahead.
pub fn overall(course: &[Errors]) -> Errors {
    let over = |f: fn(&Errors) -> f64| mean(&course.iter().map(f).collect::<Vec<_>>());
    Errors {
        position_m: over(|e| e.position_m),
        velocity_m_s: over(|e| e.velocity_m_s),
        rotation_rad: over(|e| e.rotation_rad),
        body_rate_rad_s: over(|e| e.body_rate_rad_s),
    }
}
