//! The firmware's stabilizer around the controller: a course, a measured state in; commanded motor forces out, at 1 kHz.
//!
//! The high-level commander speaks at 100 Hz, in single precision; estimate and gyroscope at every step, in the firmware's
//! units. The power distribution is the firmware's: forces in 65535ths of a motor's largest, a negative one cut to 0,
//! an excess on one motor taken from all.

mod switched_on;

use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Mutex, MutexGuard};

use nalgebra::{Vector3, Vector4};
use quatrack_crazyflie::abi;
use quatrack_crazyflie::ffi;
use quatrack_design::model::GRAVITY_M_S2;

use super::course::Course;
use super::recording::{Before, Recording};
use super::setpoints::{Setpoints, full_state, high_level, vector};
use crate::flight::noise::Source;
use crate::plant::RigidState;
pub use switched_on::{knows, platform};

/// The firmware's steps a second.
pub const STEPS_HZ: u32 = 1000;

/// Steps between two evaluations of the high-level commander.
const COMMANDER_STEPS: u32 = 10;

/// The firmware's numbers for all of a thrust.
const FULL: f64 = 65_535.0;

/// The sensors between the plant and the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Standard deviation of a gyroscope reading, rad/s, white from step to step.
    pub gyro_noise_rad_s: f64,
    /// Steps for which an estimate is held.
    pub estimate_steps: u32,
}

/// The owner's settings; the rest is as the craft is switched on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tune {
    /// The table's number.
    pub table: u8,
    /// The motors' lag as the owner knows it, s; 0: the published figures alone.
    pub motor_lag_s: f64,
    /// Drag over mass as the owner knows it, 1/s; the craft's own where he says nothing.
    pub drag_per_s: Option<f64>,
    /// Likewise the airflow moment, N s.
    pub moment_n_s: Option<[f64; 2]>,
}

impl Tune {
    /// A table and the motors' lag.
    pub const fn new(table: u8, motor_lag_s: f64) -> Self {
        Self { table, motor_lag_s, drag_per_s: None, moment_n_s: None }
    }

    /// The same where there is no air, and the owner knows.
    pub const fn in_vacuum(self) -> Self {
        Self { drag_per_s: Some(0.0), moment_n_s: Some([0.0; 2]), ..self }
    }
}

/// The controller is one for all: a flight locks it against the others.
static CONTROLLER: Mutex<()> = Mutex::new(());

/// The stabilizer of a craft that is switched on.
pub struct Firmware {
    control: abi::Control,
    setpoint: abi::Setpoint,
    estimate: abi::State,
    thrust_max_n: f64,
    mass_kg: f64,
    mixing: [f64; 3],
    step: u32,
    noise: Source,
    sensors: Sensors,
    recording: Option<Recording>,
    before: Before,
    refused_table: bool,
    _alone: MutexGuard<'static, ()>,
}

impl Firmware {
    /// Puts a course's motion at a time into the setpoint, as somebody would send it.
    pub fn command(&mut self, course: &Course, t_s: f64, setpoints: Setpoints) {
        if !self.step.is_multiple_of(COMMANDER_STEPS) {
            return;
        }
        self.setpoint = course.at(t_s).map_or_else(abi::Setpoint::default, |motion| match setpoints {
            Setpoints::HighLevel | Setpoints::HighLevelTurning => {
                high_level(&motion.map(|v| v.map(|c| c as f32)), setpoints.turn(t_s))
            }
            Setpoints::FullState | Setpoints::FullStateTurning => full_state(&motion, setpoints.turn(t_s)),
        });
        self.setpoint.timestamp = self.step;
    }

    /// One step in vacuum: commanded forces, N. A setpoint of one's own replaces the commander's.
    pub fn step(&mut self, state: &RigidState, setpoint: Option<&abi::Setpoint>) -> Vector4<f64> {
        let felt_m_s2 = Vector3::z() * (state.thrusts_n.sum() / self.mass_kg);
        self.step_felt(state, &felt_m_s2, setpoint)
    }

    /// The same with the accelerometer's specific force, body frame, m/s^2.
    pub fn step_felt(
        &mut self,
        state: &RigidState,
        felt_m_s2: &Vector3<f64>,
        setpoint: Option<&abi::Setpoint>,
    ) -> Vector4<f64> {
        if self.step.is_multiple_of(self.sensors.estimate_steps) || self.step < 10 {
            self.estimate = estimate(state);
        }
        let rates = state.body_rates_rad_s.map(|rate| rate + self.sensors.gyro_noise_rad_s * self.noise.normal());
        let sensors = abi::SensorData {
            acc: felt_m_s2.map(|force| (force / GRAVITY_M_S2) as f32).into(),
            gyro: rates.map(|rate| rate.to_degrees() as f32).into(),
            ..Default::default()
        };
        let setpoint = setpoint.unwrap_or(&self.setpoint);
        ffi::controllerOutOfTree(&mut self.control, setpoint, &sensors, &self.estimate, self.step);
        if let Some(recording) = &mut self.recording {
            recording.add(
                self.step,
                std::mem::take(&mut self.before),
                setpoint,
                &sensors,
                &self.estimate,
                &self.control,
            );
        }
        self.step += 1;
        self.distribute()
    }

    /// One step on an estimate and sensors as they are given, unsound ones too.
    pub fn step_given(
        &mut self,
        estimate: &abi::State,
        sensors: &abi::SensorData,
        setpoint: &abi::Setpoint,
    ) -> Vector4<f64> {
        ffi::controllerOutOfTree(&mut self.control, setpoint, sensors, estimate, self.step);
        self.step += 1;
        self.distribute()
    }

    /// The owner asks for another table.
    pub fn ask_for(&mut self, table: u8) {
        ffi::quatrack.parameters.table.store(table, Relaxed);
        ffi::quatrackService();
        self.before.table = Some(table);
    }

    /// Whether the owner's table and lag were refused as the craft was switched on: then it flies with the published lag.
    pub fn refused_table(&self) -> bool {
        self.refused_table
    }

    /// The calls recorded so far.
    pub fn recorded(&mut self) -> Option<Recording> {
        self.recording.take()
    }

    /// The controller's last output.
    pub fn control(&self) -> &abi::Control {
        &self.control
    }

    /// The number of the next step.
    pub fn next_step(&self) -> u32 {
        self.step
    }

    /// `powerDistribution` and `powerDistributionCap`; battery compensation then makes thrust of these numbers.
    fn distribute(&self) -> Vector4<f64> {
        let [a, b, c, d] = self.control.payload.map(f64::from);
        let asked = match self.control.control_mode {
            abi::Control::FORCE_TORQUE => {
                let (thrust, [roll, pitch, yaw]) = (0.25 * a, self.mixing);
                let (roll, pitch, yaw) = (roll * b, pitch * c, yaw * d);
                let forces = [
                    thrust - roll - pitch - yaw,
                    thrust - roll + pitch + yaw,
                    thrust + roll + pitch - yaw,
                    thrust + roll - pitch + yaw,
                ];
                forces.map(|force| (force.max(0.0) / self.thrust_max_n * FULL).trunc())
            }
            _ => [a, b, c, d].map(|force| (force.clamp(0.0, 1.0) * FULL).trunc()),
        };
        let over = asked.iter().fold(0.0_f64, |over, force| over.max(force - FULL));
        Vector4::from(asked.map(|force| (force - over).max(0.0) / FULL * self.thrust_max_n))
    }
}

fn estimate(state: &RigidState) -> abi::State {
    let q = state.attitude.quaternion();
    let (roll, pitch, yaw) = state.attitude.euler_angles();
    let degrees = |angle: f64| angle.to_degrees() as f32;
    abi::State {
        attitude: abi::Attitude { timestamp: 0, roll: degrees(roll), pitch: -degrees(pitch), yaw: degrees(yaw) },
        attitude_quaternion: abi::Quaternion { x: q.i as f32, y: q.j as f32, z: q.k as f32, w: q.w as f32 },
        position: vector(&state.position_m),
        velocity: vector(&state.velocity_m_s),
        acc: abi::Vector::default(),
    }
}
