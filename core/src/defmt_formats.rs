//! The defmt formats of types that hold vectors, which have none of their own: their numbers, with their units.

use defmt::{Format, Formatter, write};
use nalgebra::Vector3;

use crate::command::Command;
use crate::control::Step;
use crate::reference::FlatSample;
use crate::rigid_state::RigidState;
use crate::state::State;

fn xyz(v: &Vector3<f32>) -> [f32; 3] {
    [v.x, v.y, v.z]
}

impl Format for State {
    fn format(&self, f: Formatter<'_>) {
        let (r, v) = (xyz(&self.position_m), xyz(&self.velocity_m_s));
        write!(f, "State {{ r {} m, {}, v {} m/s }}", r, self.attitude, v);
    }
}

impl Format for RigidState {
    fn format(&self, f: Formatter<'_>) {
        write!(f, "RigidState {{ {}, {} rad/s }}", self.state, xyz(&self.body_rates_rad_s));
    }
}

impl Format for Command {
    fn format(&self, f: Formatter<'_>) {
        write!(f, "Command {{ {=f32} m/s^2, {} rad/s }}", self.thrust_m_s2, xyz(&self.body_rates_rad_s));
    }
}

impl Format for Step {
    fn format(&self, f: Formatter<'_>) {
        write!(f, "Step {{ {}, {} }}", self.command, self.limited);
    }
}

impl Format for FlatSample {
    fn format(&self, f: Formatter<'_>) {
        let (r, v) = (xyz(&self.position_m), xyz(&self.velocity_m_s));
        let (a, j) = (xyz(&self.acceleration_m_s2), xyz(&self.jerk_m_s3));
        write!(f, "FlatSample {{ r {} m, v {} m/s, a {} m/s^2, j {} m/s^3, ", r, v, a, j);
        write!(f, "heading {=f32} rad, {=f32} rad/s }}", self.heading_rad, self.heading_rate_rad_s);
    }
}
