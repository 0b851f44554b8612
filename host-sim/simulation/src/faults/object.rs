//! The Crazyflie object, through its C interface: the inputs of a step in, the firmware's motor forces out.

use std::sync::atomic::Ordering::Relaxed;

use nalgebra::{Vector3, Vector4};
use quatrack::Tick;
use quatrack::supervisor::{Mode, Reason, Tumble};
use quatrack_crazyflie::abi;
use quatrack_crazyflie::ffi;
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::Vehicle;

use super::signals::{Signals, UnderTest};
use crate::crazyflie::{Firmware, Sensors, Tune};

/// Steps of 2 ms between two setpoints.
const SETPOINT_STEPS: Tick = 5;

/// The object in the firmware.
pub(super) struct Object {
    firmware: Firmware,
    estimate: abi::State,
    setpoint: abi::Setpoint,
    /// Bridged steps that were counted so far, and whether the last one was.
    bridged: u16,
    is_bridging: bool,
}

impl Object {
    /// Selected in flight, as it is switched on.
    pub(super) fn hovering(vehicle: &Vehicle) -> Self {
        let sensors = Sensors { gyro_noise_rad_s: 0.0, estimate_steps: 1 };
        Self {
            firmware: Firmware::start(vehicle, &Tune::new(0, 0.0), sensors),
            estimate: abi::State::default(),
            setpoint: abi::Setpoint::default(),
            bridged: 0,
            is_bridging: false,
        }
    }

    /// The high-level commander's setpoint, where there is one.
    fn command(&mut self, [position, velocity, acceleration]: [Vector3<f32>; 3], [heading, rate]: [f32; 2]) {
        let on = abi::Mode::ABSOLUTE;
        self.setpoint = abi::Setpoint {
            timestamp: self.firmware.next_step(),
            position: vector(&position),
            velocity: vector(&velocity),
            acceleration: vector(&acceleration),
            attitude: abi::Attitude { yaw: heading.to_degrees(), ..Default::default() },
            attitude_rate: abi::Attitude { yaw: rate.to_degrees(), ..Default::default() },
            mode: abi::Modes { x: on, y: on, z: on, yaw: on, ..Default::default() },
            ..Default::default()
        };
    }
}

impl UnderTest for Object {
    fn step(&mut self, now: Tick, signals: &Signals<'_>) -> Option<Vector4<f64>> {
        if let Some(asked) = signals.asked.filter(|_| (now / 2).is_multiple_of(SETPOINT_STEPS)) {
            self.command(asked, signals.heading);
        }
        // An estimate that does not come leaves the one before.
        if let Some(state) = &signals.state {
            let q = state.attitude;
            self.estimate = abi::State {
                attitude_quaternion: abi::Quaternion { x: q.x, y: q.y, z: q.z, w: q.w },
                position: vector(&state.position_m),
                velocity: vector(&state.velocity_m_s),
                ..Default::default()
            };
        }
        let felt = signals.felt.unwrap_or_default();
        let sensors = abi::SensorData {
            acc: (felt / GRAVITY_M_S2 as f32).into(),
            gyro: signals.body_rates.map(f32::to_degrees).into(),
            ..Default::default()
        };
        let mut commands_n = Vector4::zeros();
        for _ in 0..2 {
            commands_n = self.firmware.step_given(&self.estimate, &sensors, &self.setpoint);
        }
        let bridged = ffi::quatrack.log.bad_states.load(Relaxed);
        (self.is_bridging, self.bridged) = (bridged != self.bridged, bridged);
        (commands_n != Vector4::zeros()).then_some(commands_n)
    }

    /// As the log has it: the supervisor's own words for it are not in there.
    fn mode(&self) -> Mode {
        let log = &ffi::quatrack.log;
        let reason = log.reason.load(Relaxed);
        match (log.mode.load(Relaxed), reason) {
            (1, _) => Mode::Flying,
            (2, _) => Mode::LevelAndDown(named(reason)),
            (3, 9) => Mode::Tumbled(Tumble::Tilted),
            (3, 10) => Mode::Tumbled(Tumble::UpsideDown),
            (3, 11) => Mode::Tumbled(Tumble::NoClimb),
            (3, _) => Mode::Stopped(named(reason)),
            _ => Mode::OnGround,
        }
    }

    fn is_bridging(&self) -> bool {
        self.is_bridging
    }
}

fn named(reason: u16) -> Reason {
    match reason {
        1 => Reason::BadReference,
        2 => Reason::StateLost,
        3 => Reason::AttitudeLost,
        4 => Reason::BodyRatesLost,
        5 => Reason::StepFailed,
        6 => Reason::Saturated,
        7 => Reason::Landed,
        _ => Reason::NoGround,
    }
}

fn vector(v: &Vector3<f32>) -> abi::Vector {
    abi::Vector { timestamp: 0, x: v.x, y: v.y, z: v.z }
}
