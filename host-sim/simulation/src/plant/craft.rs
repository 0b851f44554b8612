//! A whole craft: commanded thrusts held for a time in, the state after it out.

use nalgebra::{Quaternion, Vector3, Vector4};
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::Vehicle;

use super::kernel::{self, Step};
use super::state::RigidVector;
use super::{Airflow, Load, MotorBank, RigidBody, RigidState};
use crate::integrator::Method;

/// Longest step of the integration, s. At the body rates and lags of small craft its error is below 1e-9 m a second.
pub(super) const STEP_MAX_S: f64 = 0.002;

/// A rigid body with motors and loads.
pub struct Craft {
    /// The body that is moved.
    pub body: RigidBody,
    /// The motors that move it.
    pub motors: MotorBank,
    /// The air's force and torque on it; absent: a vacuum.
    pub air: Option<Airflow>,
    /// All other forces and torques on it.
    pub loads: Vec<Box<dyn Load>>,
}

/// A wind that changes evenly, during a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearWind {
    /// Beginning of the step, s.
    pub from_s: f64,
    /// Velocity of the air then, world frame, m/s.
    pub from_m_s: Vector3<f64>,
    /// Derivative of the velocity, m/s^2.
    pub slope_m_s2: Vector3<f64>,
}

/// Derivatives of a craft's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Of the centre of mass, world frame, m/s^2.
    pub acceleration_m_s2: Vector3<f64>,
    /// Reading of an accelerometer at the centre of mass: that plus g upwards, body frame, m/s^2.
    pub specific_force_m_s2: Vector3<f64>,
    /// Body frame, rad/s^2.
    pub angular_acceleration_rad_s2: Vector3<f64>,
    /// Rate of each thrust, N/s.
    pub thrust_rates_n_s: Vector4<f64>,
}

impl Craft {
    /// The vehicle in a vacuum.
    pub fn new(vehicle: &Vehicle) -> Self {
        Self { body: RigidBody::of(vehicle), motors: MotorBank::of(vehicle), air: None, loads: Vec::new() }
    }

    /// The same with one more load.
    pub fn with_load(mut self, load: impl Load + 'static) -> Self {
        self.loads.push(Box::new(load));
        self
    }

    /// The state after `commands_n`, the commanded thrusts, have been held for a time in still air: Runge-Kutta 4, in steps
    /// of at most 2 ms.
    pub fn hold(&self, state: &RigidState, commands_n: &Vector4<f64>, from_s: f64, duration_s: f64) -> RigidState {
        let steps = (duration_s / STEP_MAX_S - 1e-9).ceil().max(1.0);
        let h = duration_s / steps;
        (0..steps as u32).fold(*state, |x, k| self.step(&x, commands_n, from_s + f64::from(k) * h, h))
    }

    /// One step of Runge-Kutta 4 in still air.
    pub fn step(&self, state: &RigidState, commands_n: &Vector4<f64>, time_s: f64, step_s: f64) -> RigidState {
        self.step_in_wind(state, commands_n, &LinearWind::default(), time_s, step_s)
    }

    /// One step of Runge-Kutta 4 in a wind.
    pub fn step_in_wind(
        &self,
        state: &RigidState,
        commands_n: &Vector4<f64>,
        wind: &LinearWind,
        time_s: f64,
        step_s: f64,
    ) -> RigidState {
        if let Some((figures, has_air)) = kernel::figures(self) {
            let step = Step { goals_n: *commands_n, wind: *wind, from_s: time_s, step_s };
            return kernel::alone(&figures, has_air, state, &step);
        }
        let mut rate = |t: f64, x: &RigidVector| self.rate(t, x, commands_n, wind);
        RigidState::from_vector(&Method::RungeKutta4.step(&mut rate, time_s, &state.to_vector(), step_s))
    }

    /// How the motion changes under commanded thrusts.
    pub fn motion(&self, state: &RigidState, commands_n: &Vector4<f64>, wind: &LinearWind, time_s: f64) -> Motion {
        let rate = self.rate(time_s, &state.to_vector(), commands_n, wind);
        let acceleration_m_s2 = rate.fixed_rows::<3>(3).into_owned();
        let felt = acceleration_m_s2 + Vector3::new(0.0, 0.0, GRAVITY_M_S2);
        Motion {
            acceleration_m_s2,
            specific_force_m_s2: state.attitude.inverse_transform_vector(&felt),
            angular_acceleration_rad_s2: rate.fixed_rows::<3>(10).into_owned(),
            thrust_rates_n_s: rate.fixed_rows::<4>(13).into_owned(),
        }
    }

    fn rate(&self, time_s: f64, x: &RigidVector, commands_n: &Vector4<f64>, wind: &LinearWind) -> RigidVector {
        // Of the quaternion as it is, between the steps of an integrator of almost unit length: no slope needs it longer.
        let state = RigidState::of_numbers((*x).into());
        let rates = &state.body_rates_rad_s;
        let thrust_rates_n_s = self.motors.thrust_rates_n_s(&state.thrusts_n, commands_n);
        let mut own = self.motors.wrench(&state.thrusts_n);
        let mut rotor_drag = None;
        if let Some(air) = &self.air {
            let wind_m_s = wind.from_m_s + wind.slope_m_s2 * (time_s - wind.from_s);
            let through_air = state.attitude.inverse_transform_vector(&(state.velocity_m_s - wind_m_s));
            own += air.wrench(&through_air);
            rotor_drag = air.rotors.map(|drag| (drag, through_air));
        }
        if let Some(propeller) = &self.motors.propeller {
            let drag = rotor_drag.as_ref().map(|(drag, through_air)| (drag, through_air));
            own += self.motors.turning(propeller, &state.thrusts_n, &thrust_rates_n_s, rates, drag);
        }
        let (mut force_n, mut torque_n_m) = (state.attitude * own.force_n, own.torque_n_m);
        for load in &self.loads {
            let wrench = load.wrench(time_s, &state);
            force_n += wrench.force_n;
            torque_n_m += wrench.torque_n_m;
        }
        // Of the quaternion as it is: its length is kept.
        let turning = Quaternion::new(x[6], x[7], x[8], x[9]) * Quaternion::from_imag(*rates) * 0.5;
        let mut rate = RigidVector::zeros();
        rate.fixed_rows_mut::<3>(0).copy_from(&state.velocity_m_s);
        rate.fixed_rows_mut::<3>(3).copy_from(&self.body.acceleration_m_s2(&force_n));
        rate.fixed_rows_mut::<4>(6).copy_from_slice(&[turning.w, turning.i, turning.j, turning.k]);
        rate.fixed_rows_mut::<3>(10).copy_from(&self.body.angular_acceleration_rad_s2(&torque_n_m, rates));
        rate.fixed_rows_mut::<4>(13).copy_from(&thrust_rates_n_s);
        rate
    }
}
