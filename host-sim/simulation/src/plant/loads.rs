//! Forces on a craft besides its motors': time and state in, force and torque out.

use nalgebra::Vector3;
use quatrack_design::vehicle::{ROTOR_SIDES, Vehicle};

use super::RigidState;

/// A force and a torque about the centre of mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force, N; of a load in the world frame.
    pub force_n: Vector3<f64>,
    /// Torque, body frame, N m.
    pub torque_n_m: Vector3<f64>,
}

impl std::ops::AddAssign for Wrench {
    fn add_assign(&mut self, other: Self) {
        self.force_n += other.force_n;
        self.torque_n_m += other.torque_n_m;
    }
}

/// Something that pushes.
pub trait Load: Send + Sync {
    /// Force in the world frame and torque in the body frame.
    fn wrench(&self, time_s: f64, state: &RigidState) -> Wrench;
}

/// A force at the centre of mass for some time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shove {
    /// From when, s.
    pub from_s: f64,
    /// Until when, s.
    pub to_s: f64,
    /// World frame, N.
    pub force_n: Vector3<f64>,
}

impl Load for Shove {
    fn wrench(&self, time_s: f64, _state: &RigidState) -> Wrench {
        let on = (self.from_s..self.to_s).contains(&time_s);
        Wrench { force_n: if on { self.force_n } else { Vector3::zeros() }, ..Wrench::default() }
    }
}

/// A floor at height 0 on which four feet stand, one below each rotor: a spring and a damper each, with friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    feet_m: [Vector3<f64>; 4],
    stiffness_n_m: f64,
    damping_n_s_m: f64,
}

impl Ground {
    /// How far below the centre of mass the feet end, m.
    pub const FOOT_DEPTH_M: f64 = 0.015;
    /// How far the feet give way under the weight, m.
    const SETTLING_M: f64 = 1e-3;
    /// Share of the critical damping of the craft on its feet.
    const DAMPING_RATIO: f64 = 0.7;
    /// Coefficient of friction of plastic on a floor.
    const FRICTION: f64 = 0.5;
    /// Sliding speed at which friction has three quarters of its full force, m/s.
    const CREEP_M_S: f64 = 0.02;

    /// Under a vehicle's feet.
    pub fn under(vehicle: &Vehicle) -> Self {
        let a = vehicle.motors().half_arm_m();
        let stiffness_n_m = vehicle.hover_thrust_n() / Self::SETTLING_M;
        Self {
            feet_m: ROTOR_SIDES.map(|[x, y]| Vector3::new(a * x, a * y, -Self::FOOT_DEPTH_M)),
            stiffness_n_m,
            damping_n_s_m: 2.0 * Self::DAMPING_RATIO * (stiffness_n_m * 0.25 * vehicle.mass_kg()).sqrt(),
        }
    }

    /// Height of the centre of mass of a craft that stands still, m.
    pub fn standing_height_m() -> f64 {
        Self::FOOT_DEPTH_M - Self::SETTLING_M
    }
}

impl Load for Ground {
    fn wrench(&self, _time_s: f64, state: &RigidState) -> Wrench {
        let mut whole = Wrench::default();
        for foot_m in &self.feet_m {
            let place_m = state.position_m + state.attitude * foot_m;
            if place_m.z >= 0.0 {
                continue;
            }
            let velocity = state.velocity_m_s + state.attitude * state.body_rates_rad_s.cross(foot_m);
            // The floor pushes; it does not pull.
            let normal_n = (-self.stiffness_n_m * place_m.z - self.damping_n_s_m * velocity.z).max(0.0);
            let sliding = Vector3::new(velocity.x, velocity.y, 0.0);
            let speed = sliding.norm();
            let per_speed = if speed > 0.0 { (speed / Self::CREEP_M_S).tanh() / speed } else { 1.0 / Self::CREEP_M_S };
            let force_n = Vector3::new(0.0, 0.0, normal_n) - sliding * (Self::FRICTION * normal_n * per_speed);
            whole.force_n += force_n;
            whole.torque_n_m += foot_m.cross(&state.attitude.inverse_transform_vector(&force_n));
        }
        whole
    }
}
