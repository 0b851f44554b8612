//! A craft in the air: setpoints as they are sent in, its motion out.

use std::sync::atomic::Ordering::Relaxed;

use nalgebra::Vector3;
use quatrack_crazyflie::abi::Setpoint;
use quatrack_crazyflie::ffi;
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::crazyflie::{Firmware, Sensors, Tune};
use quatrack_simulation::plant::{Craft, RigidState};
use quatrack_simulation::vehicles;

use super::planner::Planned;
use super::sent::position;

const QUIET: Sensors = Sensors { gyro_noise_rad_s: 0.0, estimate_steps: 1 };
pub(crate) const CRAFTS: [&str; 3] = ["crazyflie-2.1", "crazyflie-2.1-upgrade-kit", "crazyflie-2.1-brushless"];

/// A craft in the air, its firmware and the sender of its setpoints.
pub(crate) struct Flight {
    pub(crate) vehicle: Vehicle,
    pub(crate) craft: Craft,
    pub(crate) firmware: Firmware,
    pub(crate) state: RigidState,
    pub(crate) sent: Setpoint,
}

impl Flight {
    pub(crate) fn of(name: &str, table: u8, motor_lag_s: f64) -> Self {
        let vehicle = vehicles::by_name(name).unwrap();
        let firmware = Firmware::start(&vehicle, &Tune::new(table, motor_lag_s), QUIET);
        let state = RigidState::at_rest(Vector3::z(), vehicle.hover_thrust_n());
        let mut craft = Craft::new(&vehicle);
        if motor_lag_s > 0.0 {
            craft.motors = craft.motors.with_lag(motor_lag_s, motor_lag_s);
        }
        Self { craft, vehicle, firmware, state, sent: Setpoint::OFF }
    }

    /// Hovering at 1 m.
    pub(crate) fn hovering() -> Self {
        let mut flight = Self::of("crazyflie-2.1", 0, 0.0);
        flight.hold(&position([0.0, 0.0, 1.0], 0.0), 500);
        flight
    }

    /// The commander takes a setpoint and stamps it.
    pub(crate) fn send(&mut self, setpoint: &Setpoint) {
        self.sent = Setpoint { timestamp: self.firmware.next_step(), ..*setpoint };
    }

    /// One step with the setpoint as supervisor or collision avoidance change it.
    pub(crate) fn step(&mut self, change: impl Fn(&Setpoint, &RigidState) -> Setpoint) {
        let setpoint = change(&self.sent, &self.state);
        let commands_n = self.firmware.step(&self.state, Some(&setpoint));
        self.state = self.craft.hold(&self.state, &commands_n, 0.0, 1e-3);
        assert!(self.state.is_finite());
    }

    pub(crate) fn pass(&mut self, steps: u32) {
        (0..steps).for_each(|_| self.step(|sent, _| *sent));
    }

    /// Sends the same a hundred times a second.
    pub(crate) fn hold(&mut self, setpoint: &Setpoint, steps: u32) {
        for _ in 0..steps / 10 {
            self.send(setpoint);
            self.pass(10);
        }
    }

    /// Flies the high-level commander's setpoints; the largest distance from them.
    pub(crate) fn follow(&mut self, duration_s: f32, at: impl Fn(f32) -> Planned) -> f64 {
        let (steps, mut largest_m) = ((duration_s * 1e3) as u32, 0.0_f64);
        for step in 0..steps {
            let planned = at(step as f32 * 1e-3);
            if step % 10 == 0 {
                self.send(&planned.setpoint());
            }
            largest_m = largest_m.max((self.state.position_m - planned.position.map_into()).norm());
            self.pass(1);
        }
        largest_m
    }

    /// Thrust of all motors in 65535ths that carries the craft.
    pub(crate) fn hover_thrust(&self) -> f32 {
        (65_535.0 * self.vehicle.hover_thrust_n() / self.vehicle.motors().thrust_max_n) as f32
    }

    pub(crate) fn euler_deg(&self) -> [f64; 3] {
        let (roll, pitch, yaw) = self.state.attitude.euler_angles();
        [roll.to_degrees(), pitch.to_degrees(), yaw.to_degrees()]
    }

    pub(crate) fn rates_deg_s(&self) -> Vector3<f64> {
        self.state.body_rates_rad_s.map(f64::to_degrees)
    }

    pub(crate) fn is_off(&self) -> bool {
        self.firmware.control().payload == [0.0; 4]
    }
}

pub(crate) trait MapInto {
    fn map_into(self) -> Vector3<f64>;
}

impl MapInto for [f32; 3] {
    fn map_into(self) -> Vector3<f64> {
        self.map(f64::from).into()
    }
}

pub(crate) fn mode() -> u8 {
    ffi::quatrack.log.mode.load(Relaxed)
}

pub(crate) const FLYING: u8 = 1;
pub(crate) const DESCENDING: u8 = 2;

pub(crate) fn assert_near(found: &[f64], wanted: &[f64], tolerance: f64) {
    let is_near = found.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(is_near && found.len() == wanted.len(), "{found:?}, not {wanted:?} within {tolerance}");
}
