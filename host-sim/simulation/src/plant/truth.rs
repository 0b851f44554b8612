//! The true figures of a craft, apart from the law's beliefs: plain figures, checked once.

use nalgebra::{Matrix3, Vector3};
use quatrack_design::vehicle::Vehicle;

use super::propeller::Propeller;
use super::refused::{Checked, PlantError, positive, within};
use super::supply::{Battery, ForceMap, Supply};

/// The true figures of the craft, apart from the law's beliefs.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Inertia about the centre of mass, kg m^2.
    pub inertia_kg_m2: Matrix3<f64>,
    /// Time constant of a thrust that grows, s.
    pub rise_lag_s: f64,
    /// Lag of a force that falls, s.
    pub fall_lag_s: f64,
    /// Delay of the commands, s.
    pub delay_s: f64,
    /// Thrust over the commanded one at the start.
    pub thrust_factor: f64,
    /// Rate of that factor, 1/s.
    pub thrust_factor_per_s: f64,
    /// Torque that is always there, body frame, N m.
    pub torque_bias_n_m: Vector3<f64>,
    /// Centre of mass from the centre of the rotors, body frame, m.
    pub centre_of_mass_m: Vector3<f64>,
    /// Thrust of each motor over that of a sound one: 0 is a dead one.
    pub motor_strength: [f64; 4],
    /// The map from command to force; absent: a force in newtons that the motors give.
    pub force_map: Option<ForceMap>,
    /// The source of the motors' voltage; looked at where there is a force map.
    pub supply: Supply,
    /// The propellers, where their momentum counts.
    pub propeller: Option<Propeller>,
}

impl Truth {
    /// Exactly as the vehicle's designs believe: their lag, no delay, thrust as commanded.
    pub fn as_designed(vehicle: &Vehicle) -> Self {
        let lag_s = vehicle.motors().lag_s;
        Self {
            mass_kg: vehicle.mass_kg(),
            inertia_kg_m2: *vehicle.inertia_kg_m2(),
            rise_lag_s: lag_s,
            fall_lag_s: lag_s,
            delay_s: 0.0,
            thrust_factor: 1.0,
            thrust_factor_per_s: 0.0,
            torque_bias_n_m: Vector3::zeros(),
            centre_of_mass_m: Vector3::zeros(),
            motor_strength: [1.0; 4],
            force_map: None,
            supply: Supply::Constant(0.0),
            propeller: None,
        }
    }

    /// All that is known of the vehicle in flight: lags, delay, force by command and a battery that is full at first,
    /// momentum of the rotors. Unknown figures are as designed.
    pub fn as_flown(vehicle: &Vehicle) -> Self {
        let (flown, mut truth) = (vehicle.flown(), Self::as_designed(vehicle));
        if let Some(motors) = &flown.motors {
            (truth.rise_lag_s, truth.fall_lag_s) = (motors.rise_lag_s, motors.fall_lag_s);
            truth.delay_s = motors.delay_s;
        }
        truth.force_map = flown.force.as_ref().map(|force| ForceMap {
            full_n: force.full_n,
            command_power: force.command_power,
            voltage_power: force.voltage_power,
            reference_v: force.reference_v,
        });
        truth.supply = match (&flown.battery, &flown.force) {
            (Some(battery), _) => Supply::Battery { battery: Battery::of(battery, vehicle), charge: 1.0 },
            (None, Some(force)) => Supply::Constant(force.reference_v),
            (None, None) => Supply::Constant(0.0),
        };
        truth.propeller = flown
            .propeller
            .as_ref()
            .and_then(|propeller| Some(Propeller::quadratic(propeller.thrust_n_s2?, propeller.inertia_kg_m2?)));
        truth
    }

    /// Looks at every figure.
    ///
    /// # Errors
    /// [`PlantError`] with the first that is out of range, keys as in a scenario file.
    pub(super) fn check(&self) -> Checked {
        within("errors.mass_kg", self.mass_kg, 1e-3, 1e3, "kilograms: 29 g are 0.029")?;
        if self.inertia_kg_m2.cholesky().is_none() || self.inertia_kg_m2 != self.inertia_kg_m2.transpose() {
            return Err(PlantError::new(
                "errors.inertia_kg_m2",
                self.inertia_kg_m2.trace(),
                "symmetric and positive definite; this is its trace",
                "kg m^2",
            ));
        }
        for (key, lag_s) in [("errors.lag_rise_ms", self.rise_lag_s), ("errors.lag_fall_ms", self.fall_lag_s)] {
            within(key, 1e3 * lag_s, 1.0, 1000.0, "milliseconds: 0.067 s are 67")?;
        }
        within("errors.delay_ms", 1e3 * self.delay_s, 0.0, 250.0, "milliseconds: 0.005 s are 5")?;
        within(
            "errors.thrust_factor",
            self.thrust_factor,
            0.1,
            3.0,
            "thrust over the commanded one: 3 % less are 0.97",
        )?;
        within("errors.thrust_factor_per_s", self.thrust_factor_per_s, -1.0, 1.0, "change of the factor a second")?;
        for torque in self.torque_bias_n_m.iter() {
            within(
                "errors.torque_bias_n_m",
                *torque,
                -1.0,
                1.0,
                "newton metres; a battery that is 0.5 mm off makes 1.5e-4",
            )?;
        }
        for offset in self.centre_of_mass_m.iter() {
            within("errors.centre_of_mass_m", *offset, -0.1, 0.1, "metres: 0.5 mm are 0.0005")?;
        }
        for strength in self.motor_strength {
            within("errors.motor_strength", strength, 0.0, 2.0, "thrust over that of a sound motor; a dead one has 0")?;
        }
        if let Some(map) = &self.force_map {
            within("motors.force.full_n", map.full_n, 1e-4, 1e3, "newtons")?;
            within("motors.force.command_power", map.command_power, 0.5, 3.0, "between a root and a cube")?;
            within("motors.force.voltage_power", map.voltage_power, 0.0, 3.0, "up to a cube")?;
            within("motors.force.reference_v", map.reference_v, 1.0, 100.0, "volts")?;
            match &self.supply {
                Supply::Constant(volts) => within("battery.voltage_v", *volts, 1.0, 100.0, "volts")?,
                Supply::Battery { charge, .. } => {
                    within("battery.charge", *charge, 0.0, 1.0, "the share of a full battery: 80 % are 0.8")?;
                }
            }
        }
        if let Some(propeller) = &self.propeller {
            within("propeller.inertia_kg_m2", propeller.inertia_kg_m2, 0.0, 1.0, "kg m^2")?;
            positive("propeller.thrust_n_s2", propeller.thrust[1], 1.0, "newtons over (rad/s)^2")?;
        }
        Ok(())
    }
}
