//! Contact with walls: a plane that pushes the tips of the rotors' guards by spring and damper and holds them by
//! friction; state in, force and torque on the craft out.

use nalgebra::{Unit, Vector3};
use quatrack_design::model::GRAVITY_M_S2;

use super::{Load, MotorBank, RigidState, Wrench};

/// How far it gives way under the craft's weight, m.
const SETTLING_M: f64 = 1e-3;
/// Share of the critical damping of the craft on one tip.
const DAMPING_RATIO: f64 = 0.7;
/// Sliding speed at which friction has three quarters of its full force, m/s.
const CREEP_M_S: f64 = 0.02;

/// A plane with air on one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// A point of it, world frame, m.
    pub point_m: Vector3<f64>,
    /// Into the air, world frame.
    pub normal: Unit<Vector3<f64>>,
    /// Coefficient of friction.
    pub friction: f64,
}

/// A wall and the craft that touches it: a spring and a damper at each tip, with friction that creeps, as the ground under
/// the feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    wall: Wall,
    tips_m: [Vector3<f64>; 4],
    stiffness_n_m: f64,
    damping_n_s_m: f64,
}

impl Contact {
    /// Of a craft of a mass, kg, whose guards reach a radius, m, beyond the axes of its rotors.
    pub fn new(wall: Wall, motors: &MotorBank, reach_m: f64, mass_kg: f64) -> Self {
        let stiffness_n_m = mass_kg * GRAVITY_M_S2 / SETTLING_M;
        let tip = |place: Vector3<f64>| place + place.try_normalize(0.0).map_or(Vector3::zeros(), |out| out * reach_m);
        Self {
            wall,
            tips_m: motors.motors.map(|motor| tip(motor.position_m)),
            stiffness_n_m,
            damping_n_s_m: 2.0 * DAMPING_RATIO * (0.25 * stiffness_n_m * mass_kg).sqrt(),
        }
    }
}

impl Load for Contact {
    fn wrench(&self, _time_s: f64, state: &RigidState) -> Wrench {
        let normal = &self.wall.normal;
        let mut whole = Wrench::default();
        for tip_m in &self.tips_m {
            let depth_m = normal.dot(&(self.wall.point_m - state.position_m - state.attitude * tip_m));
            if depth_m <= 0.0 {
                continue;
            }
            let velocity = state.velocity_m_s + state.attitude * state.body_rates_rad_s.cross(tip_m);
            let approach = normal.dot(&velocity);
            // A wall pushes; it does not pull.
            let push_n = (self.stiffness_n_m * depth_m - self.damping_n_s_m * approach).max(0.0);
            let sliding = velocity - normal.scale(approach);
            let speed = sliding.norm();
            let per_speed = if speed > 0.0 { (speed / CREEP_M_S).tanh() / speed } else { 1.0 / CREEP_M_S };
            let force_n = normal.scale(push_n) - sliding * (self.wall.friction * push_n * per_speed);
            whole.force_n += force_n;
            whole.torque_n_m += tip_m.cross(&state.attitude.inverse_transform_vector(&force_n));
        }
        whole
    }
}
