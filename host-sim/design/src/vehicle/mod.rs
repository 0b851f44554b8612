//! Vehicles: a name or a TOML file in; mass, inertia, motors and limits out, every figure in range.
//!
//! The built-in ones stand in `gains/vehicles`, each figure with its source beside it. Rotors are numbered as in the
//! Crazyflie's firmware and stand in an X: 1 front right, 2 rear right, 3 rear left, 4 front left; 1 and 3 turn
//! anticlockwise seen from above, so that the air turns the body clockwise. Body frame: x forwards, y left, z up.

mod error;
mod file;

use std::path::Path;

use nalgebra::{Matrix3, Matrix4, Vector3};
use quatrack::Limits;
use quatrack::checksum::crc32c;

pub use error::VehicleError;

use crate::model::GRAVITY_M_S2;

/// The built-in vehicles: what they are asked for by, and their file.
const BUILT_IN: [(&str, &str); 3] = [
    ("crazyflie-2.1", include_str!("../../../gains/vehicles/crazyflie-2.1.toml")),
    ("crazyflie-2.1-upgrade-kit", include_str!("../../../gains/vehicles/crazyflie-2.1-upgrade-kit.toml")),
    ("crazyflie-2.1-brushless", include_str!("../../../gains/vehicles/crazyflie-2.1-brushless.toml")),
];

/// Where the rotors stand, in units of the half arm: x forwards, y left.
pub const ROTOR_SIDES: [[f64; 2]; 4] = [[1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];

/// Torque about body z of each rotor, in units of thrust times torque per thrust.
pub const ROTOR_TORQUE_SIGNS: [f64; 4] = [-1.0, 1.0, -1.0, 1.0];

/// A vehicle whose figures are in range.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    name: String,
    mass_kg: f64,
    inertia_kg_m2: Matrix3<f64>,
    inverse_inertia: Matrix3<f64>,
    motors: Motors,
    body_rates_max_rad_s: Vector3<f64>,
}

/// Four equal motors in an X.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motors {
    /// Centre to rotor axis, m.
    pub arm_m: f64,
    /// Least thrust of one motor, N.
    pub thrust_min_n: f64,
    /// Most thrust of one motor, N.
    pub thrust_max_n: f64,
    /// Torque about the rotor's axis per thrust, m.
    pub torque_per_thrust_m: f64,
    /// Time constant from command to thrust that tables are designed for, s.
    pub lag_s: f64,
    /// The shortest and the longest published, s.
    pub published_lag_s: [f64; 2],
}

impl Motors {
    /// Distance of the rotors from the body's x and y axes, `arm / sqrt 2`, m.
    pub fn half_arm_m(&self) -> f64 {
        self.arm_m * std::f64::consts::FRAC_1_SQRT_2
    }

    /// `[T, tau_x, tau_y, tau_z]` (N, N m) from the four thrusts (N).
    pub fn mixing(&self) -> Matrix4<f64> {
        let (a, c) = (self.half_arm_m(), self.torque_per_thrust_m);
        Matrix4::from_fn(|row, motor| {
            let [x, y] = ROTOR_SIDES[motor];
            [1.0, a * y, -a * x, c * ROTOR_TORQUE_SIGNS[motor]][row]
        })
    }
}

impl Vehicle {
    /// Names of the built-in vehicles.
    pub fn names() -> [&'static str; 3] {
        BUILT_IN.map(|(name, _)| name)
    }

    /// A built-in vehicle, by one of [`Self::names`] or by its own name, which is shorter for the upgrade kit.
    ///
    /// # Errors
    /// [`VehicleError::Unknown`].
    pub fn by_name(name: &str) -> Result<Self, VehicleError> {
        let (_, text) = BUILT_IN
            .iter()
            .find(|(held, _)| *held == name || held.strip_suffix("-kit") == Some(name))
            .ok_or_else(|| VehicleError::Unknown { name: name.to_owned(), known: Self::names().join(", ") })?;
        Self::from_toml(text)
    }

    /// A vehicle from the text of a file.
    ///
    /// # Errors
    /// [`VehicleError::Syntax`] for what is not TOML of this form; [`VehicleError::Value`] for a figure out of range.
    pub fn from_toml(text: &str) -> Result<Self, VehicleError> {
        file::read(text)
    }

    /// A vehicle from a file.
    ///
    /// # Errors
    /// As [`Self::from_toml`], and [`VehicleError::Unreadable`].
    pub fn from_file(path: &Path) -> Result<Self, VehicleError> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| VehicleError::Unreadable { path: path.to_owned(), reason: error.to_string() })?;
        Self::from_toml(&text)
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Mass, kg.
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// Inertia about the centre of mass in the body frame, kg m^2; symmetric.
    pub fn inertia_kg_m2(&self) -> &Matrix3<f64> {
        &self.inertia_kg_m2
    }

    /// The inverse of that, 1/(kg m^2).
    pub fn inverse_inertia(&self) -> &Matrix3<f64> {
        &self.inverse_inertia
    }

    /// Its motors.
    pub fn motors(&self) -> &Motors {
        &self.motors
    }

    /// Thrust of each motor at hover, N.
    pub fn hover_thrust_n(&self) -> f64 {
        0.25 * self.mass_kg * GRAVITY_M_S2
    }

    /// Least and most thrust of all motors over mass, m/s^2.
    pub fn thrust_limits_m_s2(&self) -> [f64; 2] {
        [self.motors.thrust_min_n, self.motors.thrust_max_n].map(|thrust_n| 4.0 * thrust_n / self.mass_kg)
    }

    /// Body rates that a rate loop of this vehicle follows, rad/s.
    pub fn body_rates_max_rad_s(&self) -> &Vector3<f64> {
        &self.body_rates_max_rad_s
    }

    /// What commands of thrust and body rates are cut to on board.
    ///
    /// # Errors
    /// [`VehicleError::Value`] where a limit vanishes in the rounding to f32.
    pub fn limits(&self) -> Result<Limits, VehicleError> {
        let [min, max] = self.thrust_limits_m_s2().map(|value| value as f32);
        Limits::new(min, max, self.body_rates_max_rad_s.map(|value| value as f32)).map_err(|_| VehicleError::Value {
            field: "limits.body_rates_rad_s".to_owned(),
            value: self.body_rates_max_rad_s.min(),
            must: "large enough for an f32".to_owned(),
        })
    }

    /// CRC-32C of its name and figures, each rounded to f32, lowest byte first: mass; inertia xx, xy, xz, yy, yz, zz;
    /// arm, least and most thrust, torque per thrust, lag; body rates. It tells a table whether it was made for this
    /// vehicle.
    pub fn id(&self) -> u32 {
        let (i, m, rates) = (&self.inertia_kg_m2, &self.motors, &self.body_rates_max_rad_s);
        let inertia = [i.m11, i.m12, i.m13, i.m22, i.m23, i.m33];
        let motors = [m.arm_m, m.thrust_min_n, m.thrust_max_n, m.torque_per_thrust_m, m.lag_s];
        let figures = [self.mass_kg].into_iter().chain(inertia).chain(motors).chain(rates.iter().copied());
        let mut bytes = self.name.clone().into_bytes();
        bytes.extend(figures.flat_map(|figure| (figure as f32).to_le_bytes()));
        crc32c(&bytes)
    }
}
