//! A craft that is switched on: a vehicle, its figures as the app tells them, and the owner's settings in; a stabilizer
//! before its first step out.

use std::sync::PoisonError;
use std::sync::atomic::Ordering::Relaxed;

use nalgebra::Vector3;
use quatrack_crazyflie::abi;
use quatrack_crazyflie::craft::Platform;
use quatrack_crazyflie::ffi;
use quatrack_crazyflie::own_craft::OwnCraft;
use quatrack_design::vehicle::Vehicle;

use super::{CONTROLLER, Firmware, Sensors, Tune};
use crate::crazyflie::recording::{Before, Recording};
use crate::flight::noise::Source;
use crate::plant::RigidState;

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
