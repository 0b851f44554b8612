//! Priors before a flight: the vehicle's own figures, loosely, and physics.

use quatrack_design::vehicle::Vehicle;

/// The vehicle that a flight's figures are had with.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    /// Its name.
    pub name: String,
    /// Mass flown, kg.
    pub mass_kg: f64,
    /// Distance of the rotors from the body's x and y axes, m.
    pub half_arm_m: f64,
    /// Torque about the rotor's axis per thrust, m.
    pub torque_per_thrust_m: f64,
    /// Inertia about x, y and z, kg m^2.
    pub inertia_kg_m2: [f64; 3],
    /// Lag, s.
    pub lag_s: f64,
    /// Delay, s.
    pub delay_s: f64,
    /// Powers of command and voltage.
    pub powers: [f64; 2],
    /// Voltage that thrusts are given at, V.
    pub reference_v: f64,
    /// Thrust over the square of the rotor's speed, N per (rad/s)^2, where it is known.
    pub thrust_n_s2: Option<f64>,
}

impl Base {
    /// Of a vehicle with the mass that was flown.
    pub fn of(vehicle: &Vehicle, mass_kg: f64) -> Self {
        let (motors, flown, inertia) = (vehicle.motors(), vehicle.flown(), vehicle.inertia_kg_m2());
        let lag_s = flown.motors.map_or(motors.lag_s, |lags| 0.5 * (lags.rise_lag_s + lags.fall_lag_s));
        Self {
            name: vehicle.name().to_owned(),
            mass_kg,
            half_arm_m: motors.half_arm_m(),
            torque_per_thrust_m: motors.torque_per_thrust_m,
            inertia_kg_m2: [inertia[(0, 0)], inertia[(1, 1)], inertia[(2, 2)]],
            lag_s,
            delay_s: flown.motors.map_or(0.0045, |lags| lags.delay_s),
            powers: flown.force.map_or([2.0, 2.0], |force| [force.command_power, force.voltage_power]),
            reference_v: flown.force.map_or(4.0, |force| force.reference_v),
            thrust_n_s2: flown.propeller.and_then(|propeller| propeller.thrust_n_s2),
        }
    }

    /// Mass times the square of the rotors' distance, kg m^2: the damping of rates is a share of it, per second.
    pub(super) fn damping_scale(&self) -> f64 {
        self.mass_kg * self.half_arm_m * self.half_arm_m
    }
}

/// A belief about one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Prior {
    pub(super) centre: f64,
    pub(super) deviation: f64,
    /// Cauchy's instead of Gauss's: close to its centre unless data say otherwise, and hardly in their way then.
    pub(super) heavy_tails: bool,
}

impl Prior {
    pub(super) fn gauss(centre: f64, deviation: f64) -> Self {
        Self { centre, deviation, heavy_tails: false }
    }

    pub(super) fn cauchy(centre: f64, deviation: f64) -> Self {
        Self { centre, deviation, heavy_tails: true }
    }

    /// Precision of the Gaussian that has the same slope at a value.
    pub(super) fn precision(&self, value: f64) -> f64 {
        let square = self.deviation * self.deviation;
        if self.heavy_tails { 2.0 / (square + (value - self.centre).powi(2)) } else { 1.0 / square }
    }

    /// Minus its logarithm at a value.
    pub(super) fn cost(&self, value: f64) -> f64 {
        let away = ((value - self.centre) / self.deviation).powi(2);
        if self.heavy_tails { away.ln_1p() } else { 0.5 * away }
    }
}
