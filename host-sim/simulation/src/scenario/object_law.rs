//! The Crazyflie controller as a law: the object's own C interface, its stabilizer's rates and its units.

use nalgebra::Vector4;
use quatrack_crazyflie::abi::{self, Mode};
use quatrack_design::vehicle::Vehicle;

use super::not_flown::NotFlown;
use super::told::{ToldError, ToldFigures, lag_range_ms};
use crate::control_law::{ControlLaw, Estimate, Input, STEPS_HZ, Setpoint};
use crate::crazyflie::{Firmware, Sensors, Tune, knows, platform, standard_cascade};
use crate::plant::RigidState;

/// The firmware's stabilizer around the controller. There is one controller in a process: another flight of it waits until
/// this one is over.
pub(super) struct ObjectLaw {
    firmware: Firmware,
    setpoint: abi::Setpoint,
    sent_s: Option<f64>,
}

impl ObjectLaw {
    /// Switched on for a vehicle: with its default table for a craft that it knows, otherwise with the one that `quatrack gains craft`
    /// makes for the vehicle. What it is told and does not take is refused, where the firmware would fly on with what it had.
    ///
    /// # Errors
    /// [`NotFlown`].
    pub(super) fn start(vehicle: &Vehicle, told: &ToldFigures) -> Result<Self, NotFlown> {
        let tune = Tune {
            drag_per_s: told.drag_per_s,
            moment_n_s: told.moment_n_m_per_m_s,
            ..Tune::new(0, told.lag_s.unwrap_or(0.0))
        };
        let sensors = Sensors { gyro_noise_rad_s: 0.0, estimate_steps: 1 };
        let firmware = match Firmware::start_told(vehicle, told.mass_kg, &tune, sensors) {
            Some(firmware) => firmware,
            None => with_its_own(vehicle, told, &tune, sensors)?,
        };
        if firmware.refused_table() {
            let Some(lag_s) = told.lag_s else {
                return Err(NotFlown::Object("the controller refuses its own default table".to_owned()));
            };
            let [least, most] = lag_range_ms(vehicle);
            let (key, value) = ("lag_ms", 1e3 * lag_s);
            let must = format!("from {least} to {most} ms, for which the Crazyflie controller has tables");
            return Err(NotFlown::Told(ToldError { key, value, must }));
        }
        Ok(Self { firmware, setpoint: abi::Setpoint::default(), sent_s: None })
    }
}

/// A vehicle that the object does not know, with the table that `quatrack gains craft` makes for it.
fn with_its_own(vehicle: &Vehicle, told: &ToldFigures, tune: &Tune, sensors: Sensors) -> Result<Firmware, NotFlown> {
    let own_kg = vehicle.mass_kg();
    if told.mass_kg != own_kg {
        let must = if knows(vehicle) {
            "within 20 % of the mass of the built-in vehicle that this one is, for which the Crazyflie controller has tables".to_owned()
        } else {
            format!("{own_kg}, the vehicle's own in kg: the Crazyflie controller's table is made for that")
        };
        return Err(NotFlown::Told(ToldError { key: "mass_kg", value: told.mass_kg, must }));
    }
    let standard = standard_cascade(vehicle).map_err(NotFlown::Standard)?;
    told.lag_certified_by(&standard.table.certified).map_err(NotFlown::Told)?;
    Firmware::start_own(vehicle, &platform(vehicle), &standard.craft, tune, sensors).map_err(NotFlown::Object)
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
