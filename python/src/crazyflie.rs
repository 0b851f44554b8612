//! The Crazyflie object through its C interface: the firmware's structs in, by their names; its control out.
//!
//! There is one controller in a process, as in a craft: switching another one on ends the flight of the one before.

mod fields;

use std::sync::atomic::{AtomicU8, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use quatrack_crazyflie::abi::{self, CEnum, Control, Quaternion, SensorData, Setpoint};
use quatrack_crazyflie::craft::Platform;
use quatrack_crazyflie::ffi;
use quatrack_crazyflie::shared::{AtomicF32, Parameters};
use quatrack_simulation::crazyflie::platform;

use crate::error::refused;
use crate::vehicle;
use fields::{sensors, setpoint, state};

/// How many controllers have been switched on here: the last one flies.
static SWITCHED_ON: Mutex<u64> = Mutex::new(0);

fn switched_on() -> MutexGuard<'static, u64> {
    SWITCHED_ON.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A flight of the simulation switches its own on.
pub(crate) fn end_the_one_before() {
    *switched_on() += 1;
}

/// A parameter's name in the firmware, and where it is.
type Named<T> = (&'static str, fn(&Parameters) -> &T);

/// The parameters of the group `quatrack` that hold a number.
const FLOATS: [Named<AtomicF32>; Parameters::FLOATS] = [
    ("posScale", |parameters| &parameters.position_scale),
    ("yawScale", |parameters| &parameters.yaw_scale),
    ("motorLag", |parameters| &parameters.motor_lag_s),
    ("drag", |parameters| &parameters.drag_per_s),
    ("momentX", |parameters| &parameters.moment_x_n_s),
    ("momentY", |parameters| &parameters.moment_y_n_s),
    ("gust", |parameters| &parameters.gust),
    ("speed", |parameters| &parameters.goal_speed_m_s),
    ("climb", |parameters| &parameters.goal_climb_m_s),
    ("tilt", |parameters| &parameters.tilt_deg),
    ("leash", |parameters| &parameters.leash_m),
    ("speedMax", |parameters| &parameters.speed_m_s),
    ("accMax", |parameters| &parameters.acceleration_m_s2),
    ("rpRateMax", |parameters| &parameters.roll_pitch_rate_rad_s),
    ("yawRateMax", |parameters| &parameters.yaw_rate_rad_s),
];

/// Likewise, those that hold a whole number.
const WHOLE: [Named<AtomicU8>; 3] = [
    ("table", |parameters| &parameters.table),
    ("feedForward", |parameters| &parameters.feed_forward),
    ("learn", |parameters| &parameters.learn),
];

/// How long a setpoint without a stamp counts as the one that was given before, if it is the same, ms. Then it is one that was sent
/// again: a turn that has ended must not go on.
const SAME_MS: u32 = 100;

/// The object as the firmware calls it, at 1 kHz.
///
/// vehicle: one that the object has tables for
/// mass_kg: CF_MASS where it differs from the vehicle's, kg
///
/// `step` takes objects with the fields of the firmware's setpoint_t, sensorData_t and state_t, in its units (degrees, g, pitch of
/// the opposite sign): those of quatrack.crazyflie, of the firmware's own Python bindings, or any other. A setpoint whose timestamp
/// is 0 is dated by the tick at which it changes. There is one controller in a process: a later one, or a flight of "crazyflie", ends this one.
#[pyclass(module = "quatrack")]
pub(crate) struct CrazyflieController {
    number: u64,
    control: Control,
    tick: u32,
    /// The last setpoint without a stamp, and the one that it got.
    undated: Option<(Setpoint, u32)>,
}

/// The object's command, as control_t has it.
#[pyclass(frozen, module = "quatrack")]
pub(crate) struct CrazyflieControl {
    /// 1: force and torque; 2: forces of the motors.
    #[pyo3(get, name = "controlMode")]
    mode: CEnum,
    payload: [f32; 4],
}

#[pymethods]
impl CrazyflieControl {
    /// Forces of M1 to M4 over the largest, 0 to 1, where controlMode is 2.
    #[getter(normalizedForces)]
    fn normalized_forces(&self) -> Option<[f32; 4]> {
        (self.mode == Control::FORCE).then_some(self.payload)
    }

    /// Thrust (N) and torques about x, y, z (N m), where controlMode is 1.
    #[getter(forceTorque)]
    fn force_torque(&self) -> Option<[f32; 4]> {
        (self.mode == Control::FORCE_TORQUE).then_some(self.payload)
    }
}

impl CrazyflieController {
    /// The state that is shared by the process, as long as it is this one's.
    fn own(&self) -> PyResult<MutexGuard<'static, u64>> {
        let number = switched_on();
        if *number == self.number {
            Ok(number)
        } else {
            Err(refused(
                "another Crazyflie controller has been switched on in this process, which has one; make this one anew",
            ))
        }
    }
}

#[pymethods]
impl CrazyflieController {
    #[new]
    #[pyo3(signature = (vehicle, *, mass_kg=None))]
    fn new(vehicle: &Bound<'_, PyAny>, mass_kg: Option<f32>) -> PyResult<Self> {
        let vehicle = vehicle::argument(vehicle)?;
        let built_for = platform(&vehicle);
        let built_for = Platform { mass_kg: mass_kg.unwrap_or(built_for.mass_kg), ..built_for };
        let mut number = switched_on();
        *number += 1;
        let parameters = &ffi::quatrack.parameters;
        // As switched on: a NaN is put back to its default.
        parameters.set_all(f32::NAN);
        parameters.table.store(0, Relaxed);
        parameters.feed_forward.store(1, Relaxed);
        parameters.learn.store(1, Relaxed);
        if !ffi::quatrackPlatform(&built_for) {
            return Err(refused(format!(
                "the Crazyflie controller has no table for {} told {} kg; tell a mass within 20 % of a built-in vehicle's",
                vehicle.name(),
                built_for.mass_kg
            )));
        }
        ffi::quatrackService();
        let mut new = Self { number: *number, control: Control::default(), tick: 1, undated: None };
        // Motors off, until parameters have been looked at.
        for _ in 0..9 {
            new.call(&Setpoint::OFF, &SensorData::default(), &at_rest());
        }
        ffi::controllerOutOfTreeInit();
        Ok(new)
    }

    /// One call of the stabilizer; every other one steps the controller, and the one between leaves its control as it is.
    ///
    /// tick: milliseconds, as the firmware counts them; one more than the last where left out
    #[pyo3(name = "step", signature = (setpoint, sensors, state, tick=None))]
    fn step_py(
        &mut self,
        setpoint: &Bound<'_, PyAny>,
        sensors: &Bound<'_, PyAny>,
        state: &Bound<'_, PyAny>,
        tick: Option<u32>,
    ) -> PyResult<CrazyflieControl> {
        let tick = tick.unwrap_or(self.tick);
        let mut given = (self::setpoint(setpoint)?, self::sensors(sensors)?, self::state(state)?);
        let _own = self.own()?;
        self.tick = tick;
        if given.0.timestamp == 0 {
            let before = self.undated.filter(|(before, at)| *before == given.0 && tick.wrapping_sub(*at) <= SAME_MS);
            let (_, stamp) = *self.undated.insert(before.unwrap_or((given.0, tick)));
            given.0.timestamp = stamp;
        }
        self.call(&given.0, &given.1, &given.2);
        Ok(CrazyflieControl { mode: self.control.control_mode, payload: self.control.payload })
    }

    /// Names of the parameters of the firmware's group `quatrack` that can be set.
    #[getter]
    fn parameters(&self) -> Vec<&'static str> {
        WHOLE.map(|(name, _)| name).into_iter().chain(FLOATS.map(|(name, _)| name)).collect()
    }

    /// Sets a parameter, by its name in the firmware, and lets the app look at it.
    fn set(&self, name: &str, value: f32) -> PyResult<()> {
        let _own = self.own()?;
        let parameters = &ffi::quatrack.parameters;
        let whole = WHOLE.iter().find(|(known, _)| *known == name);
        match (FLOATS.iter().find(|(known, _)| *known == name), whole) {
            (Some((_, of)), _) => of(parameters).set(value),
            (None, Some((_, of))) => {
                let code = value as u8;
                if f32::from(code) != value {
                    return Err(refused(format!("{name} is {value}; it holds a whole number from 0 to 255")));
                }
                of(parameters).store(code, Relaxed);
            }
            (None, None) => return Err(self.unknown(name)),
        }
        ffi::quatrackService();
        Ok(())
    }

    /// Value of a parameter, by its name in the firmware.
    fn get(&self, name: &str) -> PyResult<f32> {
        let _own = self.own()?;
        let parameters = &ffi::quatrack.parameters;
        let whole = WHOLE.iter().find(|(known, _)| *known == name);
        match (FLOATS.iter().find(|(known, _)| *known == name), whole) {
            (Some((_, of)), _) => Ok(of(parameters).get()),
            (None, Some((_, of))) => Ok(f32::from(of(parameters).load(Relaxed))),
            (None, None) => Err(self.unknown(name)),
        }
    }

    /// The table that is flown, by its number.
    #[getter]
    fn table(&self) -> PyResult<u8> {
        let _own = self.own()?;
        Ok(ffi::quatrack.log.table.load(Relaxed))
    }

    /// How the last setpoint is flown, as the log variable quatrack.mode has it; 4: no table for the craft.
    #[getter]
    fn mode(&self) -> PyResult<u8> {
        let _own = self.own()?;
        Ok(ffi::quatrack.log.mode.load(Relaxed))
    }
}

impl CrazyflieController {
    fn call(&mut self, setpoint: &Setpoint, sensors: &SensorData, state: &abi::State) {
        ffi::controllerOutOfTree(&mut self.control, setpoint, sensors, state, self.tick);
        self.tick = self.tick.wrapping_add(1);
    }

    fn unknown(&self, name: &str) -> PyErr {
        PyKeyError::new_err(format!(
            "{name}: no parameter of the group quatrack; there are {}",
            self.parameters().join(", ")
        ))
    }
}

fn at_rest() -> abi::State {
    abi::State { attitude_quaternion: Quaternion { w: 1.0, ..Quaternion::default() }, ..abi::State::default() }
}
