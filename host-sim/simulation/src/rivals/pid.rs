//! The cascaded PID of the Crazyflie's firmware (documentation: "Controllers in the Crazyflie", Cascaded PID controller):
//! position, velocity, attitude and body rates, each a PID that gives the next one its aim.
//!
//! Position and velocity run at 100 Hz in the heading frame, attitude and rates at 500 Hz. Of a setpoint it takes position
//! and heading alone. Angles are roll, pitch and yaw of `R_z R_y R_x`, positive pitch nose down.

use nalgebra::{Vector2, Vector3, Vector4};

use super::{Actuation, FULL, ForceTorque};
use crate::control_law::{ControlLaw, Estimate, Input, Setpoint};
use crate::vehicles;
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::Vehicle;

/// Control steps a second: `ATTITUDE_RATE`.
const RATE_HZ: u32 = 500;
/// Control steps between two of position and velocity: `POSITION_RATE` is 100 Hz.
const POSITION_STEPS: u32 = 5;
/// Limit of its outputs about the axes, in the firmware's numbers: those of 16 bits.
const TORQUE_MAX: f64 = 32_767.0;

/// Gains and limits of one PID, output in units of its output, error in units of the measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PidConfig {
    /// Gain of the error.
    pub proportional: f64,
    /// Gain of its integral.
    pub integral: f64,
    /// Gain of the derivative of the measurement, taken off.
    pub derivative: f64,
    /// Most of the integral, error times s.
    pub integral_max: f64,
    /// Most output, either way.
    pub output_max: f64,
}

/// A PID with its memory: `u = k_p e + k_i int e - k_d y'`.
#[derive(Clone, Copy, Debug)]
pub struct Pid {
    config: PidConfig,
    integral: f64,
    measured_before: Option<f64>,
}

impl Pid {
    /// A PID at rest.
    pub fn new(config: PidConfig) -> Self {
        Self { config, integral: 0.0, measured_before: None }
    }

    /// One step of `period_s`: from target and measurement to the output.
    pub fn step(&mut self, wanted: f64, measured: f64, period_s: f64) -> f64 {
        self.step_by(wanted - measured, measured - self.measured_before.unwrap_or(measured), measured, period_s)
    }

    /// The same for an angle, rad, whose turns do not count.
    fn step_angle(&mut self, wanted: f64, measured: f64, period_s: f64) -> f64 {
        let since = measured - self.measured_before.unwrap_or(measured);
        self.step_by(wrapped(wanted - measured), wrapped(since), measured, period_s)
    }

    fn step_by(&mut self, error: f64, change: f64, measured: f64, period_s: f64) -> f64 {
        let PidConfig { proportional, integral, derivative, integral_max, output_max } = self.config;
        self.measured_before = Some(measured);
        self.integral = (self.integral + error * period_s).max(-integral_max).min(integral_max);
        let output = proportional * error + integral * self.integral - derivative * change / period_s;
        output.max(-output_max).min(output_max)
    }
}

/// An angle within half a turn, rad.
fn wrapped(angle_rad: f64) -> f64 {
    angle_rad - std::f64::consts::TAU * (angle_rad / std::f64::consts::TAU).round()
}

/// All twelve, and the thrust about which the vertical one works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CascadedPidConfig {
    /// m to m/s: forwards, left, up.
    pub position: [PidConfig; 3],
    /// m/s to rad of tilt forwards and to the left, and to N.
    pub velocity: [PidConfig; 3],
    /// Most roll and pitch, rad.
    pub tilt_max_rad: f64,
    /// Added to the vertical velocity's output, N.
    pub thrust_base_n: f64,
    /// Least thrust, N.
    pub thrust_min_n: f64,
    /// Most thrust, N.
    pub thrust_max_n: f64,
    /// rad to rad/s: roll, pitch, yaw.
    pub attitude: [PidConfig; 3],
    /// rad/s to N m: roll, pitch, yaw.
    pub rates: [PidConfig; 3],
}

impl CascadedPidConfig {
    /// The gains that `platform_defaults_cf2.h` and `platform_defaults_cf21bl.h` document for a vehicle, with
    /// `position_controller_pid.c` and `attitude_pid_controller.c`.
    ///
    /// The Brushless has its own gains of roll and pitch rates and its own base thrust, every other craft those of the
    /// Crazyflie 2.1. A craft that is none of the built-in ones has its weight, `mass_kg`, for base thrust.
    pub fn firmware(vehicle: &Vehicle, mass_kg: f64) -> Self {
        let actuation = Actuation::of(vehicle);
        let is_built_in = vehicles::is_built_in(vehicle);
        let is_brushless = is_built_in && vehicle.name().starts_with("crazyflie-2.1-brushless");
        let base = if is_brushless {
            30_000.0
        } else if is_built_in {
            36_000.0
        } else {
            mass_kg * GRAVITY_M_S2 / actuation.force_per_number()
        };
        let rate = if is_brushless { [200.0, 400.0, 2.5] } else { [250.0, 500.0, 2.5] };
        let (force, torque) = (actuation.force_per_number(), actuation.torque_per_number());
        // Gains of the firmware are of degrees.
        let degree = 1_f64.to_radians();
        let pid = |[proportional, integral, derivative]: [f64; 3], integral_max, output_max| PidConfig {
            proportional,
            integral,
            derivative,
            integral_max,
            output_max,
        };
        let position = |integral| pid([2.0, integral, 0.0], 5000.0, 1.1);
        let tilt = pid([25.0 * degree, 1.0 * degree, 0.0], 5000.0, 22.0 * degree);
        let climb = pid([25_000.0 * force, 15_000.0 * force, 0.0], 5000.0, 0.5 * FULL * force);
        let angle = pid([6.0, 3.0, 0.0], 20.0 * degree, f64::INFINITY);
        let turn = |gains: [f64; 3], integral_max: f64, torque: f64| {
            pid(gains.map(|gain| gain * torque / degree), integral_max * degree, TORQUE_MAX * torque)
        };
        Self {
            position: [position(0.0), position(0.0), position(0.5)],
            velocity: [tilt, tilt, climb],
            tilt_max_rad: 20.0 * degree,
            thrust_base_n: base * force,
            thrust_min_n: 20_000.0 * force,
            thrust_max_n: FULL * force,
            attitude: [angle, angle, pid([6.0, 1.0, 0.35], 360.0 * degree, f64::INFINITY)],
            rates: [turn(rate, 33.3, torque.x), turn(rate, 33.3, torque.y), turn([120.0, 16.7, 0.0], 166.7, torque.z)],
        }
    }
}

/// The law with its memory.
#[derive(Clone, Debug)]
pub struct CascadedPid {
    config: CascadedPidConfig,
    actuation: Actuation,
    position: [Pid; 3],
    velocity: [Pid; 3],
    attitude: [Pid; 3],
    rates: [Pid; 3],
    /// Control steps until position and velocity are looked at again.
    steps_left: u32,
    force_n: f64,
    tilt_rad: Vector2<f64>,
}

impl CascadedPid {
    /// The law at the start of a flight.
    pub fn new(config: CascadedPidConfig, actuation: Actuation) -> Self {
        Self {
            config,
            actuation,
            position: config.position.map(Pid::new),
            velocity: config.velocity.map(Pid::new),
            attitude: config.attitude.map(Pid::new),
            rates: config.rates.map(Pid::new),
            steps_left: 0,
            force_n: config.thrust_base_n,
            tilt_rad: Vector2::zeros(),
        }
    }

    /// Force and torque after one control step of 2 ms.
    pub fn force_torque(&mut self, input: &Input) -> ForceTorque {
        const PERIOD_S: f64 = 1.0 / RATE_HZ as f64;
        let (roll, pitch, yaw) = input.estimate.attitude.euler_angles();
        if self.steps_left == 0 {
            self.steps_left = POSITION_STEPS;
            self.aim(&input.estimate, &input.setpoint, yaw);
        }
        self.steps_left -= 1;
        let rates = input.estimate.body_rates_rad_s;
        let [roll_pid, pitch_pid, yaw_pid] = &mut self.attitude;
        let wanted = [
            roll_pid.step(self.tilt_rad.x, roll, PERIOD_S),
            pitch_pid.step(self.tilt_rad.y, pitch, PERIOD_S),
            yaw_pid.step_angle(input.setpoint.heading_rad, yaw, PERIOD_S),
        ];
        let torque_n_m = Vector3::from_fn(|i, _| self.rates[i].step(wanted[i], rates[i], PERIOD_S));
        ForceTorque { force_n: self.force_n, torque_n_m }
    }

    /// Position and velocity: thrust, roll and pitch to aim at.
    fn aim(&mut self, estimate: &Estimate, setpoint: &Setpoint, yaw_rad: f64) {
        const PERIOD_S: f64 = POSITION_STEPS as f64 / RATE_HZ as f64;
        let (sin, cos) = yaw_rad.sin_cos();
        let ahead = |v: &Vector3<f64>| Vector3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z);
        let (wanted, position) = (ahead(&setpoint.position_m), ahead(&estimate.position_m));
        let velocity = ahead(&estimate.velocity_m_s);
        let [forwards, left, up] = [0, 1, 2].map(|i| {
            let wanted_m_s = self.position[i].step(wanted[i], position[i], PERIOD_S);
            self.velocity[i].step(wanted_m_s, velocity[i], PERIOD_S)
        });
        let CascadedPidConfig { tilt_max_rad, thrust_base_n, thrust_min_n, thrust_max_n, .. } = self.config;
        self.tilt_rad = Vector2::new(-left, forwards).map(|angle| angle.max(-tilt_max_rad).min(tilt_max_rad));
        self.force_n = (thrust_base_n + up).max(thrust_min_n).min(thrust_max_n);
    }
}

impl ControlLaw for CascadedPid {
    fn rate_hz(&self) -> u32 {
        RATE_HZ
    }

    fn feels(&self) -> bool {
        false
    }

    fn step(&mut self, input: &Input) -> Result<Vector4<f64>, String> {
        let wanted = self.force_torque(input);
        Ok(self.actuation.forces_n(&wanted))
    }
}

#[cfg(test)]
mod tests;
