//! Figures of a vehicle in flight beyond those that designs take: the air's action on it, its motors' answer to a command.
//!
//! All of it is optional, and none is part of a vehicle's identity: a table stays the table of its vehicle when somebody
//! measures more.

use serde::{Deserialize, Serialize};

use super::VehicleError;
use super::check::{lag, within};

/// Force at full command over the largest that is commanded.
const FULL_SHARES: [f64; 2] = [0.5, 2.0];

/// The measured figures; those that nobody has measured are absent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlightFigures {
    /// Forces and moments of the air.
    pub air: Option<AirFigures>,
    /// Lags and delay of the motors.
    pub motors: Option<MotorFigures>,
    /// Force of a motor by command and voltage.
    pub force: Option<ForceFigures>,
    /// The propellers.
    pub propeller: Option<PropellerFigures>,
    /// The source of the motors' voltage.
    pub battery: Option<BatteryFigures>,
}

/// Table `air`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AirFigures {
    /// Mass of the craft on which they were identified, kg.
    pub mass_kg: f64,
    /// Linear drag along body x and y over that mass, 1/s.
    pub drag_per_s: [f64; 2],
    /// Along body z.
    pub drag_z_per_s: Option<f64>,
    /// Moment of the airflow, `tau_x = +c_x v_y`, `tau_y = -c_y v_x`, N m per m/s.
    pub moment_n_m_per_m_s: [f64; 2],
    /// Acceleration along the thrust over the square of the velocity across it, at that mass, 1/m.
    pub lift_per_m: Option<f64>,
}

/// Table `motors.flown`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct MotorFigures {
    /// Time constant of a thrust that grows, s.
    pub rise_lag_s: f64,
    /// Lag of a force that falls, s.
    pub fall_lag_s: f64,
    /// From a command to its first effect, s.
    pub delay_s: f64,
}

/// Table `motors.force`: `F = full_n u^command_power (V / reference_v)^voltage_power`, u the command over `thrust_max_n`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ForceFigures {
    /// N.
    pub full_n: f64,
    /// Power of the command.
    pub command_power: f64,
    /// Power of the voltage.
    pub voltage_power: f64,
    /// V.
    pub reference_v: f64,
}

/// Table `propeller`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PropellerFigures {
    /// m.
    pub radius_m: f64,
    /// Thrust over the square of the speed, N per (rad/s)^2.
    pub thrust_n_s2: Option<f64>,
    /// Of all that turns on one motor, about its axis, kg m^2.
    pub inertia_kg_m2: Option<f64>,
}

/// Table `battery`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BatteryFigures {
    /// A h.
    pub capacity_a_h: f64,
    /// Open-circuit voltage at 0, 10, .. 100 % of the charge, V.
    pub open_circuit_v: [f64; 11],
    /// ohm.
    pub resistance_ohm: f64,
    /// How long a full one lets the craft hover, s.
    pub hover_s: f64,
}

impl FlightFigures {
    pub(super) fn check(&self, arm_m: f64, thrust_max_n: f64) -> Result<(), VehicleError> {
        if let Some(air) = &self.air {
            within("air.mass_kg", air.mass_kg, 1e-3, 1e3, "kilograms: 45 g are 0.045")?;
            let drag = "a force over velocity and mass: small craft have 0.2 to 1";
            for value in air.drag_per_s.into_iter().chain(air.drag_z_per_s) {
                within("air.drag_per_s", value, 0.0, 10.0, drag)?;
            }
            for value in air.moment_n_m_per_m_s {
                within(
                    "air.moment_n_m_per_m_s",
                    value,
                    -0.1,
                    0.1,
                    "a torque over velocity: a Crazyflie has 3e-4 to 1e-3",
                )?;
            }
            if let Some(value) = air.lift_per_m {
                within("air.lift_per_m", value, -1.0, 1.0, "a Crazyflie has 0.05 to 0.1")?;
            }
        }
        if let Some(motors) = &self.motors {
            lag("motors.flown.rise_lag_s", motors.rise_lag_s)?;
            lag("motors.flown.fall_lag_s", motors.fall_lag_s)?;
            within("motors.flown.delay_s", motors.delay_s, 0.0, 0.25, "seconds: 5 ms are 0.005")?;
        }
        if let Some(force) = &self.force {
            let [least, most] = FULL_SHARES.map(|share| share * thrust_max_n);
            within("motors.force.full_n", force.full_n, least, most, "newtons, 0.5 to 2 times motors.thrust_max_n")?;
            within("motors.force.command_power", force.command_power, 0.5, 3.0, "from a root to a cube")?;
            within("motors.force.voltage_power", force.voltage_power, 0.0, 3.0, "up to a cube")?;
            within("motors.force.reference_v", force.reference_v, 1.0, 100.0, "volts")?;
        }
        if let Some(propeller) = &self.propeller {
            within("propeller.radius_m", propeller.radius_m, 0.1 * arm_m, 3.0 * arm_m, "metres, 0.1 to 3 arms")?;
            propeller.thrust_n_s2.map_or(Ok(()), |value| positive_below("propeller.thrust_n_s2", value, 1.0))?;
            propeller.inertia_kg_m2.map_or(Ok(()), |value| positive_below("propeller.inertia_kg_m2", value, 1.0))?;
        }
        if let Some(battery) = &self.battery {
            within("battery.capacity_a_h", battery.capacity_a_h, 1e-3, 1e3, "ampere hours: 250 mAh are 0.25")?;
            within("battery.resistance_ohm", battery.resistance_ohm, 0.0, 10.0, "ohms")?;
            within("battery.hover_s", battery.hover_s, 10.0, 1e5, "seconds: 7 minutes are 420")?;
            let mut before_v = 0.0;
            for value in battery.open_circuit_v {
                within("battery.open_circuit_v", value, before_v, 100.0, "volts, growing from empty to full")?;
                before_v = value;
            }
        }
        Ok(())
    }
}

fn positive_below(field: &str, value: f64, most: f64) -> Result<(), VehicleError> {
    within(field, value, f64::MIN_POSITIVE, most, "SI units, above 0")
}
