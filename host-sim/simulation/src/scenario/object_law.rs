//! The Crazyflie controller as a law: the object's own C interface, its stabilizer's rates and its units.

use nalgebra::Vector4;
use quatrack_crazyflie::abi::{self, Mode};

use super::laws::ToldFigures;
use crate::control_law::{ControlLaw, Estimate, Input, STEPS_HZ, Setpoint};
use crate::crazyflie::{Firmware, Sensors, Tune, own_craft, platform, standard_design};
use crate::plant::RigidState;
use quatrack_design::vehicle::Vehicle;

/// The firmware's stabilizer around the controller. There is one controller in a process: another flight of it waits until
/// this one is over.
pub(super) struct ObjectLaw {
    firmware: Firmware,
    setpoint: abi::Setpoint,
    sent_s: Option<f64>,
}

impl ObjectLaw {
    /// Switched on for a vehicle, with one of the object's tables, or with one made for the vehicle; nothing where there is none.
    pub(super) fn start(vehicle: &Vehicle, told: &ToldFigures, table: u8) -> Option<Self> {
        let tune = Tune {
            drag_per_s: told.drag_per_s,
            moment_n_s: told.moment_n_m_per_m_s,
            ..Tune::new(table, told.lag_s.unwrap_or(0.0))
        };
        let sensors = Sensors { gyro_noise_rad_s: 0.0, estimate_steps: 1 };
        let firmware = Firmware::start_told(vehicle, told.mass_kg, &tune, sensors)
            .or_else(|| with_its_own(vehicle, told.mass_kg, &tune, sensors))?;
        Some(Self { firmware, setpoint: abi::Setpoint::default(), sent_s: None })
    }
}

/// A vehicle that the object does not know, with the table that `quatrack gains craft` makes for it.
fn with_its_own(vehicle: &Vehicle, told_kg: f64, tune: &Tune, sensors: Sensors) -> Option<Firmware> {
    // The table is for the vehicle as its file has it.
    if tune.table != 0 || told_kg != vehicle.mass_kg() {
        return None;
    }
    let certified = standard_design(vehicle).and_then(|design| design.certify()).ok()?;
    let own = own_craft(&certified).ok()?;
    Firmware::start_own(vehicle, &platform(vehicle), &own, tune, sensors).ok()
}

impl ControlLaw for ObjectLaw {
    fn rate_hz(&self) -> u32 {
        STEPS_HZ
    }

    fn step(&mut self, input: &Input) -> Result<Vector4<f64>, String> {
        if self.sent_s != Some(input.setpoint.sent_s) {
            self.sent_s = Some(input.setpoint.sent_s);
            self.setpoint = setpoint(&input.setpoint);
            self.setpoint.timestamp = self.firmware.next_step();
        }
        let felt_m_s2 = &input.estimate.specific_force_m_s2;
        Ok(self.firmware.step_felt(&state(&input.estimate), felt_m_s2, Some(&self.setpoint)))
    }
}

/// The state that the firmware is told, its thrusts apart.
fn state(estimate: &Estimate) -> RigidState {
    RigidState {
        position_m: estimate.position_m,
        velocity_m_s: estimate.velocity_m_s,
        attitude: estimate.attitude,
        body_rates_rad_s: estimate.body_rates_rad_s,
        thrusts_n: Vector4::zeros(),
    }
}

/// As the high-level commander puts it.
fn setpoint(of: &Setpoint) -> abi::Setpoint {
    let vector = |v: &nalgebra::Vector3<f64>| abi::Vector { timestamp: 0, x: v.x as f32, y: v.y as f32, z: v.z as f32 };
    let degrees = |angle: f64| angle.to_degrees() as f32;
    let [roll, pitch, yaw] = of.body_rates_rad_s.map(degrees).into();
    let absolute = Mode::ABSOLUTE;
    abi::Setpoint {
        attitude: abi::Attitude { yaw: degrees(of.heading_rad), ..Default::default() },
        attitude_rate: abi::Attitude { roll, pitch, yaw, ..Default::default() },
        position: vector(&of.position_m),
        velocity: vector(&of.velocity_m_s),
        acceleration: vector(&of.acceleration_m_s2),
        jerk: vector(&of.jerk_m_s3),
        mode: abi::Modes { x: absolute, y: absolute, z: absolute, yaw: absolute, ..Default::default() },
        ..Default::default()
    }
}
