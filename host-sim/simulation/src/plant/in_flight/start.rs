//! A plant at the start of its flight: a vehicle, its surroundings and its true figures in; the plant, every figure
//! looked at, out.

use nalgebra::Vector3;
use quatrack_design::vehicle::Vehicle;

use super::Plant;
use super::converter::Converter;
use crate::plant::delay::DelayLine;
use crate::plant::environment::Environment;
use crate::plant::ground_effect::GroundEffect;
use crate::plant::kernel;
use crate::plant::refused::PlantError;
use crate::plant::supply::Supply;
use crate::plant::truth::Truth;
use crate::plant::wind::Blowing;
use crate::plant::{Air, Airflow, Contact, Craft, Ground, Load, RigidBody, RigidState, RotorDrag};

impl Plant {
    /// At the start, with the commands that keep the thrusts it starts with.
    ///
    /// # Errors
    /// [`PlantError`] with the first figure that is out of range.
    pub fn new(
        vehicle: &Vehicle,
        environment: &Environment,
        truth: &Truth,
        start: &RigidState,
        seed: u64,
    ) -> Result<Self, PlantError> {
        environment.check()?;
        truth.check()?;
        let mut wind = Blowing::new(&environment.wind, seed);
        let craft = craft(vehicle, environment, truth);
        Ok(Self {
            plain: kernel::figures(&craft),
            craft,
            wind_m_s: wind.at(0.0),
            steady: truth.delay_s <= 0.0 && wind.is_steady() && matches!(truth.supply, Supply::Constant(_)),
            wind,
            line: DelayLine::new(truth.delay_s),
            acting: None,
            supply: truth.supply,
            converter: Converter {
                limits_n: [vehicle.motors().thrust_min_n, vehicle.motors().thrust_max_n],
                map: truth.force_map,
                strength: truth.motor_strength,
                factor: truth.thrust_factor,
                factor_per_s: truth.thrust_factor_per_s,
            },
            time_s: 0.0,
            state: *start,
            finite: start.is_finite(),
        })
    }

    /// The same with one more load.
    pub fn with_load(mut self, load: impl Load + 'static) -> Self {
        self.craft = self.craft.with_load(load);
        self.plain = kernel::figures(&self.craft);
        self
    }

    /// The same with drag rotor by rotor, as RotorPy has it; needs [`Truth::propeller`].
    pub fn with_rotor_drag(mut self, rotors: RotorDrag) -> Self {
        self.craft.air = Some(Airflow { rotors: Some(rotors), ..self.craft.air.unwrap_or_default() });
        self.plain = kernel::figures(&self.craft);
        self
    }
}

/// The vehicle with every figure that is true of it, in its surroundings.
fn craft(vehicle: &Vehicle, environment: &Environment, truth: &Truth) -> Craft {
    let mut craft = Craft::new(vehicle);
    // The inertia has been looked at.
    craft.body = RigidBody::new(truth.mass_kg, truth.inertia_kg_m2).unwrap_or(craft.body);
    craft.motors = craft.motors.with_lag(truth.rise_lag_s, truth.fall_lag_s).around(&truth.centre_of_mass_m);
    craft.motors.propeller = truth.propeller;
    craft.motors.torque_bias_n_m = truth.torque_bias_n_m;
    for motor in &mut craft.motors.motors {
        // The plant cuts commands, by its voltage.
        (motor.thrust_min_n, motor.thrust_max_n) = (0.0, f64::INFINITY);
    }
    let air = &environment.air;
    let mass_kg = vehicle.mass_kg();
    if *air != (Air { wind_max_m_s: air.wind_max_m_s, ..Air::VACUUM }) {
        craft.air = Some(Airflow {
            drag_n_s_m: Vector3::from(air.drag_per_s) * mass_kg,
            moment_n_s: air.moment_n_m_per_m_s,
            lift_n_s2_m2: air.lift_per_m * mass_kg,
            rotors: None,
        });
    }
    if environment.floor {
        craft = craft.with_load(Ground::under(vehicle));
    }
    if let Some(radius_m) = environment.ground_effect_radius_m {
        let effect = GroundEffect::of(&craft.motors, radius_m);
        craft = craft.with_load(effect);
    }
    for wall in &environment.walls {
        let contact = Contact::new(*wall, &craft.motors, environment.guard_reach_m, truth.mass_kg);
        craft = craft.with_load(contact);
    }
    craft
}
