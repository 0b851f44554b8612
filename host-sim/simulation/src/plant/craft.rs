//! A whole craft: commanded thrusts held for a time in, the state after it out.

use nalgebra::{Quaternion, Vector4};
use quatrack_design::vehicle::Vehicle;

use super::state::RigidVector;
use super::{Load, MotorBank, RigidBody, RigidState};
use crate::integrator::Method;

/// Longest step of the integration, s. At the body rates and lags of small craft its error is below 1e-9 m a second.
const STEP_MAX_S: f64 = 0.002;

/// A rigid body with motors and loads.
pub struct Craft {
    /// What is moved.
    pub body: RigidBody,
    /// What moves it.
    pub motors: MotorBank,
    /// What else pushes it.
    pub loads: Vec<Box<dyn Load>>,
}

impl Craft {
    /// The vehicle in still air.
    pub fn new(vehicle: &Vehicle) -> Self {
        Self { body: RigidBody::of(vehicle), motors: MotorBank::of(vehicle), loads: Vec::new() }
    }

    /// The same with one more load.
    pub fn with_load(mut self, load: impl Load + 'static) -> Self {
        self.loads.push(Box::new(load));
        self
    }

    /// The state after `commands_n`, the commanded thrusts, have been held for a time: Runge-Kutta 4, in steps of at most
    /// 2 ms.
    pub fn hold(&self, state: &RigidState, commands_n: &Vector4<f64>, from_s: f64, duration_s: f64) -> RigidState {
        let steps = (duration_s / STEP_MAX_S - 1e-9).ceil().max(1.0);
        let h = duration_s / steps;
        (0..steps as u32).fold(*state, |x, k| self.step(&x, commands_n, from_s + f64::from(k) * h, h))
    }

    /// One step of Runge-Kutta 4.
    pub fn step(&self, state: &RigidState, commands_n: &Vector4<f64>, time_s: f64, step_s: f64) -> RigidState {
        let mut rate = |t: f64, x: &RigidVector| self.rate(t, x, commands_n);
        RigidState::from_vector(&Method::RungeKutta4.step(&mut rate, time_s, &state.to_vector(), step_s))
    }

    fn rate(&self, time_s: f64, x: &RigidVector, commands_n: &Vector4<f64>) -> RigidVector {
        let state = RigidState::from_vector(x);
        let rates = &state.body_rates_rad_s;
        let own = self.motors.wrench(&state.thrusts_n);
        let (mut force_n, mut torque_n_m) = (state.attitude * own.force_n, own.torque_n_m);
        for load in &self.loads {
            let wrench = load.wrench(time_s, &state);
            force_n += wrench.force_n;
            torque_n_m += wrench.torque_n_m;
        }
        // Of the quaternion as it is: its length stays what it was.
        let turning = Quaternion::new(x[6], x[7], x[8], x[9]) * Quaternion::from_imag(*rates) * 0.5;
        let mut rate = RigidVector::zeros();
        rate.fixed_rows_mut::<3>(0).copy_from(&state.velocity_m_s);
        rate.fixed_rows_mut::<3>(3).copy_from(&self.body.acceleration_m_s2(&force_n));
        rate.fixed_rows_mut::<4>(6).copy_from_slice(&[turning.w, turning.i, turning.j, turning.k]);
        rate.fixed_rows_mut::<3>(10).copy_from(&self.body.angular_acceleration_rad_s2(&torque_n_m, rates));
        rate.fixed_rows_mut::<4>(13).copy_from(&self.motors.thrust_rates_n_s(&state.thrusts_n, commands_n));
        rate
    }
}
