//! A rigid body: force (world frame, N) and torque (body frame, N m) in, linear and angular acceleration out.

use nalgebra::{Matrix3, Vector3};
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::vehicle::Vehicle;

/// Mass and inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    mass_kg: f64,
    inertia_kg_m2: Matrix3<f64>,
    inverse_inertia: Matrix3<f64>,
}

impl RigidBody {
    /// The vehicle's.
    pub fn of(vehicle: &Vehicle) -> Self {
        Self {
            mass_kg: vehicle.mass_kg(),
            inertia_kg_m2: *vehicle.inertia_kg_m2(),
            inverse_inertia: *vehicle.inverse_inertia(),
        }
    }

    /// Of a mass, kg, and an inertia, kg m^2; none where that is not positive definite.
    pub fn new(mass_kg: f64, inertia_kg_m2: Matrix3<f64>) -> Option<Self> {
        let inverse_inertia = inertia_kg_m2.cholesky()?.inverse();
        Some(Self { mass_kg, inertia_kg_m2, inverse_inertia })
    }

    /// The same with mass and inertia multiplied by positive factors, each.
    pub fn scaled(&self, mass_factor: f64, inertia_factor: f64) -> Self {
        Self {
            mass_kg: self.mass_kg * mass_factor,
            inertia_kg_m2: self.inertia_kg_m2 * inertia_factor,
            inverse_inertia: self.inverse_inertia / inertia_factor,
        }
    }

    /// Mass, kg.
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// Inertia, body frame, kg m^2.
    pub fn inertia_kg_m2(&self) -> &Matrix3<f64> {
        &self.inertia_kg_m2
    }

    /// Its inverse, 1/(kg m^2).
    pub(super) fn inverse_inertia(&self) -> &Matrix3<f64> {
        &self.inverse_inertia
    }

    /// `F / m - g z`, world frame, m/s^2, from a force in the world frame, N.
    pub(super) fn acceleration_m_s2(&self, force_n: &Vector3<f64>) -> Vector3<f64> {
        force_n / self.mass_kg - Vector3::new(0.0, 0.0, GRAVITY_M_S2)
    }

    /// `I^-1 (tau - omega x I omega)`, body frame, rad/s^2, from a torque in the body frame, N m.
    pub(super) fn angular_acceleration_rad_s2(&self, torque_n_m: &Vector3<f64>, rates: &Vector3<f64>) -> Vector3<f64> {
        self.inverse_inertia * (torque_n_m - rates.cross(&(self.inertia_kg_m2 * rates)))
    }
}
