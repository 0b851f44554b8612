//! The firmware's stabilizer around the controller: a course, a measured state in; commanded motor forces out, at 1 kHz.
//!
//! The high-level commander speaks at 100 Hz, in single precision; estimate and gyroscope at every step, in the firmware's
//! units. The power distribution is the firmware's: forces in 65535ths of a motor's largest, a negative one cut to 0,
//! an excess on one motor taken from all.

use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Mutex, MutexGuard, PoisonError};

use nalgebra::{Vector3, Vector4};
use quatrack_crazyflie::abi::{self, Mode};
use quatrack_crazyflie::craft::Platform;
use quatrack_crazyflie::ffi;
use quatrack_crazyflie::own_craft::OwnCraft;
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::Vehicle;

use super::course::Course;
use super::recording::{Before, Recording};
use crate::flight::noise::Source;
use crate::plant::RigidState;

/// The firmware's steps a second.
pub const STEPS_HZ: u32 = 1000;

/// Steps between two evaluations of the high-level commander.
const COMMANDER_STEPS: u32 = 10;

/// The firmware's numbers for all of a thrust.
const FULL: f64 = 65_535.0;

/// The form in which setpoints are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setpoints {
    /// By the high-level commander: position to jerk, and yaw.
    HighLevel,
    /// By a script on the ground, as full-state packets: whole millimetres, no jerk, the attitude of hover.
    FullState,
    /// Like these two, while the craft turns about the vertical with 1 rad/s.
    HighLevelTurning,
    /// Likewise.
    FullStateTurning,
}

/// Rate of the heading of a course that is flown turning, rad/s.
const TURN_RAD_S: f64 = 1.0;

impl Setpoints {
    /// Heading at a time, rad, and its rate, rad/s.
    fn turn(self, t_s: f64) -> (f64, f64) {
        match self {
            Self::HighLevel | Self::FullState => (0.0, 0.0),
            Self::HighLevelTurning | Self::FullStateTurning => (TURN_RAD_S * t_s, TURN_RAD_S),
        }
    }
}

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
    /// Switches the craft on; waits until nobody else flies.
    pub fn start(vehicle: &Vehicle, tune: &Tune, sensors: Sensors) -> Self {
        Self::recording(vehicle, &platform(vehicle), tune, sensors, None).0
    }

    /// The same, told another mass than the vehicle's, kg; nothing where the controller has no table for that.
    pub fn start_told(vehicle: &Vehicle, mass_kg: f64, tune: &Tune, sensors: Sensors) -> Option<Self> {
        let platform = Platform { mass_kg: mass_kg as f32, ..platform(vehicle) };
        let (firmware, has_tables) = Self::recording(vehicle, &platform, tune, sensors, None);
        has_tables.then_some(firmware)
    }

    /// Switches on a craft that the controller does not know, with its own table; why it does not fly where it does not.
    ///
    /// # Errors
    /// The object's message.
    pub fn start_own(
        vehicle: &Vehicle,
        built_for: &Platform,
        own: &OwnCraft,
        tune: &Tune,
        sensors: Sensors,
    ) -> Result<Self, String> {
        let (firmware, flies) =
            Self::switched_on(vehicle, tune, sensors, None, || ffi::quatrackCraft(built_for, own).is_null());
        match own.on(built_for) {
            Ok(_) if flies => Ok(firmware),
            Ok(_) => Err("the controller is busy".to_owned()),
            Err(error) => Err(error.words().to_string_lossy().into_owned()),
        }
    }

    /// The same, with every call recorded.
    pub fn start_recorded(vehicle: &Vehicle, tune: &Tune, sensors: Sensors) -> Self {
        Self::recording(vehicle, &platform(vehicle), tune, sensors, Some(Recording::default())).0
    }

    /// With whether there are tables for the platform.
    fn recording(
        vehicle: &Vehicle,
        platform: &Platform,
        tune: &Tune,
        sensors: Sensors,
        recording: Option<Recording>,
    ) -> (Self, bool) {
        Self::switched_on(vehicle, tune, sensors, recording, || ffi::quatrackPlatform(platform))
    }

    /// With the object's answer when the app told it which craft this is.
    fn switched_on<T>(
        vehicle: &Vehicle,
        tune: &Tune,
        sensors: Sensors,
        recording: Option<Recording>,
        tell: impl FnOnce() -> T,
    ) -> (Self, T) {
        let alone = CONTROLLER.lock().unwrap_or_else(PoisonError::into_inner);
        let motors = vehicle.motors();
        let parameters = &ffi::quatrack.parameters;
        parameters.table.store(tune.table, Relaxed);
        // No numbers: each is put back to its default.
        parameters.set_all(f32::NAN);
        parameters.motor_lag_s.set(tune.motor_lag_s as f32);
        if let Some(drag_per_s) = tune.drag_per_s {
            parameters.drag_per_s.set(drag_per_s as f32);
        }
        if let Some([x, y]) = tune.moment_n_s {
            parameters.moment_x_n_s.set(x as f32);
            parameters.moment_y_n_s.set(y as f32);
        }
        parameters.learn.store(1, Relaxed);
        parameters.feed_forward.store(1, Relaxed);
        let refused = || ffi::quatrack.log.refused_tables.load(Relaxed);
        let refused_before = refused();
        let answer = tell();
        ffi::quatrackService();
        let mut firmware = Self {
            control: abi::Control::default(),
            setpoint: abi::Setpoint::default(),
            estimate: abi::State::default(),
            thrust_max_n: motors.thrust_max_n,
            mass_kg: vehicle.mass_kg(),
            mixing: [0.25 / motors.half_arm_m(), 0.25 / motors.half_arm_m(), 0.25 / motors.torque_per_thrust_m],
            step: 1,
            noise: Source::new(1),
            sensors,
            recording,
            before: Before::default(),
            refused_table: refused() != refused_before,
            _alone: alone,
        };
        // Motors off, until parameters have been looked at.
        let rest = RigidState::at_rest(Vector3::zeros(), 0.0);
        for _ in 0..9 {
            firmware.step(&rest, None);
        }
        // Selected now: in flight, unless a setpoint says that the motors are off.
        ffi::controllerOutOfTreeInit();
        firmware.before.is_selected = true;
        (firmware, answer)
    }

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

/// Whether the object has tables for a vehicle.
pub fn knows(vehicle: &Vehicle) -> bool {
    quatrack_crazyflie::craft::Craft::of(&platform(vehicle)).is_some()
}

/// The figures that the firmware was built with.
pub fn platform(vehicle: &Vehicle) -> Platform {
    let motors = vehicle.motors();
    Platform {
        mass_kg: vehicle.mass_kg() as f32,
        arm_m: motors.arm_m as f32,
        thrust_max_n: motors.thrust_max_n as f32,
        torque_per_thrust_m: motors.torque_per_thrust_m as f32,
    }
}

fn vector(v: &Vector3<f64>) -> abi::Vector {
    let [x, y, z]: [f64; 3] = (*v).into();
    abi::Vector { timestamp: 0, x: x as f32, y: y as f32, z: z as f32 }
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

/// `crtpCommanderHighLevelGetSetpoint`, the rate about the body's z axis as `poly4d_eval` has it to first order in the rate.
fn high_level(motion: &[Vector3<f32>; 4], (heading_rad, rate_rad_s): (f64, f64)) -> abi::Setpoint {
    let thrust = motion[2] + Vector3::z() * 9.81;
    let body_rate_rad_s = rate_rad_s * f64::from(thrust.z / thrust.norm());
    let [position, velocity, acceleration, jerk] = motion.map(|v| abi::Vector { timestamp: 0, x: v.x, y: v.y, z: v.z });
    let modes = abi::Modes {
        x: Mode::ABSOLUTE,
        y: Mode::ABSOLUTE,
        z: Mode::ABSOLUTE,
        yaw: Mode::ABSOLUTE,
        ..Default::default()
    };
    let attitude = abi::Attitude { yaw: heading_rad.to_degrees() as f32, ..Default::default() };
    let attitude_rate = abi::Attitude { yaw: body_rate_rad_s.to_degrees() as f32, ..Default::default() };
    abi::Setpoint { attitude, attitude_rate, position, velocity, acceleration, jerk, mode: modes, ..Default::default() }
}

/// `fullStateDecoder`: whole millimetres, and whole thousandths of a radian a second.
fn full_state(motion: &[Vector3<f64>; 4], (heading_rad, rate_rad_s): (f64, f64)) -> abi::Setpoint {
    let [position, velocity, acceleration, _] = motion.map(|v| vector(&v.map(|c| (c * 1e3).trunc() / 1e3)));
    let (sin, cos) = (0.5 * heading_rad).sin_cos();
    let modes = abi::Modes {
        x: Mode::ABSOLUTE,
        y: Mode::ABSOLUTE,
        z: Mode::ABSOLUTE,
        quat: Mode::ABSOLUTE,
        ..Default::default()
    };
    abi::Setpoint {
        position,
        velocity,
        acceleration,
        attitude_quaternion: abi::Quaternion { w: cos as f32, z: sin as f32, ..Default::default() },
        attitude_rate: abi::Attitude { yaw: rate_rad_s.to_degrees() as f32, ..Default::default() },
        mode: modes,
        ..Default::default()
    }
}
