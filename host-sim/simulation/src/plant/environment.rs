//! The surroundings of a flight and the true figures of its craft: plain figures, checked once.

use nalgebra::{Matrix3, Vector3};
use quatrack_design::vehicle::Vehicle;

use super::Wall;
use super::propeller::Propeller;
use super::refused::{Checked, PlantError, positive, within};
use super::supply::{Battery, ForceMap, Supply};
use super::wind::Wind;

/// Drag, airflow moment and lift, by the vehicle's own mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// Linear drag along the body's axes over the mass that the vehicle has in its file, 1/s. A heavier craft of the same
    /// shape has the same force.
    pub drag_per_s: [f64; 3],
    /// Moment of the airflow, `tau_x = +c_x v_y`, `tau_y = -c_y v_x`, N m per m/s.
    pub moment_n_m_per_m_s: [f64; 2],
    /// Acceleration along the thrust over the square of the velocity across it, 1/m.
    pub lift_per_m: f64,
    /// Fastest wind for which that is good, m/s: drag that grows with the square is not in it.
    pub wind_max_m_s: f64,
}

impl Air {
    /// Up to 5 m/s: in the flights of arXiv 2512.14450 the quadratic part of the drag is below 10 % of the linear one at
    /// 2 m/s, so that it is at most a quarter of it there.
    pub const WIND_MAX_M_S: f64 = 5.0;
    /// No air at all.
    pub const VACUUM: Self =
        Self { drag_per_s: [0.0; 3], moment_n_m_per_m_s: [0.0; 2], lift_per_m: 0.0, wind_max_m_s: Self::WIND_MAX_M_S };

    /// The figures known of the vehicle: forces as they were identified, not over the mass of that craft. Unknown figures
    /// are 0.
    pub fn of(vehicle: &Vehicle) -> Option<Self> {
        let known = vehicle.flown().air.as_ref()?;
        let mass_ratio = known.mass_kg / vehicle.mass_kg();
        let [x, y] = known.drag_per_s;
        Some(Self {
            drag_per_s: [x, y, known.drag_z_per_s.unwrap_or(0.0)].map(|drag| drag * mass_ratio),
            moment_n_m_per_m_s: known.moment_n_m_per_m_s,
            lift_per_m: known.lift_per_m.unwrap_or(0.0) * mass_ratio,
            wind_max_m_s: Self::WIND_MAX_M_S,
        })
    }
}

/// The surroundings of a craft.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The air.
    pub air: Air,
    /// Its motion.
    pub wind: Wind,
    /// Whether there is a floor at height 0.
    pub floor: bool,
    /// Radius of the rotors, m, where thrust grows near the floor.
    pub ground_effect_radius_m: Option<f64>,
    /// Walls to lean on.
    pub walls: Vec<Wall>,
    /// How far the craft's guards reach beyond the axes of its rotors, m.
    pub guard_reach_m: f64,
}

impl Environment {
    /// No air, no floor, no walls.
    pub const VACUUM: Self = Self {
        air: Air::VACUUM,
        wind: Wind { mean_m_s: Vector3::new(0.0, 0.0, 0.0), gust: None, turbulence: None },
        floor: false,
        ground_effect_radius_m: None,
        walls: Vec::new(),
        guard_reach_m: 0.0,
    };

    /// Looks at every figure.
    ///
    /// # Errors
    /// [`PlantError`] with the first that is out of range, keys as in a scenario file.
    pub(super) fn check(&self) -> Checked {
        let Air { drag_per_s, moment_n_m_per_m_s, lift_per_m, wind_max_m_s } = self.air;
        for drag in drag_per_s {
            within("air.drag_per_s", drag, 0.0, 10.0, "force over velocity and mass; small craft have 0.2 to 1 1/s")?;
        }
        for moment in moment_n_m_per_m_s {
            within("air.moment_n_m_per_m_s", moment, -0.1, 0.1, "torque over velocity; a Crazyflie has 3e-4 to 1e-3")?;
        }
        within(
            "air.lift_per_m",
            lift_per_m,
            -1.0,
            1.0,
            "acceleration over velocity squared; a Crazyflie has 0.05 to 0.1",
        )?;
        let reach = "beyond it the linear drag is wrong; lower the wind";
        within("air.wind_m_s", self.wind.mean_m_s.norm(), 0.0, wind_max_m_s, reach)?;
        if let Some(gust) = &self.wind.gust {
            within("air.gust.peak_m_s", (gust.peak_m_s + self.wind.mean_m_s).norm(), 0.0, wind_max_m_s, reach)?;
            within("air.gust.from_s", gust.from_s, 0.0, 1e6, "seconds from the start")?;
            within("air.gust.rise_s", gust.rise_s, 1e-3, 1e4, "seconds; a step is no gust")?;
            within("air.gust.stay_s", gust.stay_s, 0.0, 1e6, "seconds")?;
        }
        if let Some(dryden) = &self.wind.turbulence {
            let left_m_s = (wind_max_m_s - self.wind.mean_m_s.norm()) / 2.0;
            for rms in dryden.rms_m_s.iter() {
                within(
                    "air.gust_rms_m_s",
                    *rms,
                    0.0,
                    left_m_s,
                    "two deviations and the mean wind must stay in reach of the linear drag",
                )?;
            }
            dryden.scale_m.iter().try_for_each(|scale| positive("air.gust_scale_m", *scale, 1e6, "metres"))?;
            positive("air.gust_airspeed_m_s", dryden.airspeed_m_s, 100.0, "metres a second")?;
        }
        if let Some(radius_m) = self.ground_effect_radius_m {
            within("air.ground_effect_radius_m", radius_m, 1e-3, 1.0, "the radius of one rotor in metres")?;
        }
        Ok(())
    }
}

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
