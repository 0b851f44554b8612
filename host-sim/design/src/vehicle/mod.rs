//! Vehicles: figures in; mass, inertia, motors and limits out, every one in range.
//!
//! Rotors are numbered as in the Crazyflie's firmware and placed in an X: 1 front right, 2 rear right, 3 rear left, 4
//! front left; 1 and 3 turn anticlockwise seen from above, so that the air turns the body clockwise. Body frame: x
//! forwards, y left, z up.

mod check;
mod error;
mod file;
mod flown;
mod identified;

use nalgebra::{Matrix3, Matrix4, Vector3};

pub use error::VehicleError;
pub use file::VehicleFile;
pub use flown::{AirFigures, BatteryFigures, FlightFigures, ForceFigures, MotorFigures, PropellerFigures};
pub use identified::{Identified, Interval};

use crate::model::GRAVITY_M_S2;

/// Places of the rotors, in units of the half arm: x forwards, y left.
pub const ROTOR_SIDES: [[f64; 2]; 4] = [[1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];

/// Torque about body z of each rotor, in units of thrust times torque per thrust.
pub const ROTOR_TORQUE_SIGNS: [f64; 4] = [-1.0, 1.0, -1.0, 1.0];

/// A vehicle whose figures are in range: made from a [`VehicleFile`].
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    name: String,
    mass_kg: f64,
    inertia_kg_m2: Matrix3<f64>,
    inverse_inertia: Matrix3<f64>,
    motors: Motors,
    body_rates_max_rad_s: Vector3<f64>,
    flown: FlightFigures,
    identified: Identified,
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

    /// Its figures in flight.
    pub fn flown(&self) -> &FlightFigures {
        &self.flown
    }

    /// Intervals of figures that were identified from its flights; part of its identity as little as those figures are.
    pub fn identified(&self) -> &Identified {
        &self.identified
    }

    /// Body rates that a rate loop of this vehicle follows, rad/s.
    pub fn body_rates_max_rad_s(&self) -> &Vector3<f64> {
        &self.body_rates_max_rad_s
    }
}
