//! Lee, Leok and McClamroch, "Geometric tracking control of a quadrotor UAV on SE(3)" (CDC 2010), section III, equations
//! (15) and (16).
//!
//! `F = a + g z - k_x e_x - k_v e_v` a unit of mass, the thrust its part along the craft's axis, the wanted attitude
//! that of [`attitude_along`], `tau = -k_R e_R - k_W e_W + W x J W`. The firmware adds integrals of position and
//! rotation error and leaves out the paper's last term, the wanted angular acceleration.

use nalgebra::{Matrix3, Vector3, Vector4};

use super::{Actuation, ForceTorque, rotation_error, within};
use crate::control_law::{ControlLaw, Input, attitude_along};
use quatrack_design::model::GRAVITY_M_S2;

/// Control steps a second: `ATTITUDE_RATE`.
const RATE_HZ: u32 = 500;
/// Below this thrust the craft counts as standing and the integrals are emptied, N.
const STANDING_N: f64 = 0.01;

/// Gains and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeeConfig {
    /// Mass that the law reckons with, kg.
    pub mass_kg: f64,
    /// Principal moments of inertia that it reckons with, kg m^2.
    pub inertia_kg_m2: Vector3<f64>,
    /// `k_x / m`, 1/s^2.
    pub position: Vector3<f64>,
    /// Most position error, m.
    pub position_error_max_m: f64,
    /// `k_v / m`, 1/s.
    pub velocity: Vector3<f64>,
    /// Most velocity error, m/s.
    pub velocity_error_max_m_s: f64,
    /// Of the position error's integral, 1/s^3.
    pub position_integral: Vector3<f64>,
    /// `k_R`, N m.
    pub rotation: Vector3<f64>,
    /// `k_W`, N m s.
    pub rates: Vector3<f64>,
    /// Of the rotation error's integral, N m/s. The integral has no limit.
    pub rotation_integral: Vector3<f64>,
}

impl LeeConfig {
    /// The gains that `controller_lee.c` documents, for a known mass. Gains and inertia are the same for every craft there.
    pub fn firmware(mass_kg: f64) -> Self {
        Self {
            mass_kg,
            inertia_kg_m2: Vector3::new(16.571_710e-6, 16.655_602e-6, 29.261_652e-6),
            position: Vector3::repeat(7.0),
            position_error_max_m: 100.0,
            velocity: Vector3::repeat(4.0),
            velocity_error_max_m_s: 100.0,
            position_integral: Vector3::zeros(),
            rotation: Vector3::new(0.007, 0.007, 0.008),
            rates: Vector3::new(0.001_15, 0.001_15, 0.002),
            rotation_integral: Vector3::repeat(0.03),
        }
    }
}

/// The law with its memory.
#[derive(Clone, Debug)]
pub struct Lee {
    config: LeeConfig,
    actuation: Actuation,
    position_integral_m_s: Vector3<f64>,
    rotation_integral_s: Vector3<f64>,
}

impl Lee {
    /// The law at the start of a flight.
    pub fn new(config: LeeConfig, actuation: Actuation) -> Self {
        Self { config, actuation, position_integral_m_s: Vector3::zeros(), rotation_integral_s: Vector3::zeros() }
    }

    /// Force and torque after one control step of 2 ms.
    ///
    /// # Errors
    /// Where the wanted force has no direction, or lies along the heading.
    pub fn force_torque(&mut self, input: &Input) -> Result<ForceTorque, String> {
        const PERIOD_S: f64 = 1.0 / RATE_HZ as f64;
        let (config, estimate, setpoint) = (&self.config, &input.estimate, &input.setpoint);
        let position_error = estimate.position_m - setpoint.position_m;
        let velocity_error = estimate.velocity_m_s - setpoint.velocity_m_s;
        let position_error = within(&position_error, &Vector3::repeat(config.position_error_max_m));
        let velocity_error = within(&velocity_error, &Vector3::repeat(config.velocity_error_max_m_s));
        self.position_integral_m_s += position_error * PERIOD_S;
        let wanted_m_s2 = setpoint.acceleration_m_s2 + Vector3::z() * GRAVITY_M_S2
            - config.position.component_mul(&position_error)
            - config.velocity.component_mul(&velocity_error)
            - config.position_integral.component_mul(&self.position_integral_m_s);
        let attitude = estimate.attitude.to_rotation_matrix();
        let thrust_m_s2 = wanted_m_s2.dot(&(attitude * Vector3::z()));
        let force_n = config.mass_kg * thrust_m_s2;
        if force_n < STANDING_N {
            (self.position_integral_m_s, self.rotation_integral_s) = (Vector3::zeros(), Vector3::zeros());
        }

        let axes = attitude_along(&wanted_m_s2, setpoint.heading_rad).ok_or("Lee: the wanted force has no attitude")?;
        let [x, y, z] = axes;
        let desired = Matrix3::from_columns(&axes);
        let rotation = rotation_error(attitude.matrix(), &desired);
        // W_d: how the wanted attitude turns as the wanted force follows the jerk.
        let turning = if force_n == 0.0 {
            Vector3::zeros()
        } else {
            (setpoint.jerk_m_s3 - z * z.dot(&setpoint.jerk_m_s3)) / thrust_m_s2
        };
        let desired_rates = Vector3::new(-turning.dot(&y), turning.dot(&x), setpoint.heading_rate_rad_s * z.z);
        let rates = estimate.body_rates_rad_s;
        let rates_error = rates - attitude.matrix().transpose() * desired * desired_rates;
        self.rotation_integral_s += rotation * PERIOD_S;
        let torque_n_m = rates.cross(&config.inertia_kg_m2.component_mul(&rates))
            - config.rotation.component_mul(&rotation)
            - config.rates.component_mul(&rates_error)
            - config.rotation_integral.component_mul(&self.rotation_integral_s);
        Ok(ForceTorque { force_n, torque_n_m })
    }
}

impl ControlLaw for Lee {
    fn rate_hz(&self) -> u32 {
        RATE_HZ
    }

    fn feels(&self) -> bool {
        false
    }

    fn step(&mut self, input: &Input) -> Result<Vector4<f64>, String> {
        let wanted = self.force_torque(input)?;
        Ok(self.actuation.forces_n(&wanted))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{actuation, attitude, hover};
    use super::*;

    const MASS_KG: f64 = 0.029;

    fn law() -> Lee {
        Lee::new(LeeConfig::firmware(MASS_KG), actuation())
    }

    #[test]
    fn it_holds_a_hover_with_its_weight_alone() {
        let output = law().force_torque(&hover()).unwrap();
        assert!((output.force_n - MASS_KG * GRAVITY_M_S2).abs() < 1e-15 && output.torque_n_m.norm() < 1e-18);
    }

    #[test]
    fn near_a_hover_it_is_its_linear_law() {
        let mut input = hover();
        let (x, v, pitch, rate, jerk) = (1e-5, -2e-5, 3e-5, 4e-5, 5e-4);
        input.estimate.position_m.x = x;
        input.estimate.velocity_m_s.x = v;
        input.estimate.attitude = attitude(0.0, pitch);
        input.estimate.body_rates_rad_s.y = rate;
        input.setpoint.jerk_m_s3.x = jerk;
        let output = law().force_torque(&input).unwrap();
        // Wanted pitch: wanted acceleration over g. Wanted rate: jerk over g. The integral has run for one step of 2 ms.
        let error = pitch - (-7.0 * x - 4.0 * v) / GRAVITY_M_S2;
        let torque = -(0.007 + 0.03 * 0.002) * error - 0.001_15 * (rate - jerk / GRAVITY_M_S2);
        assert!((output.torque_n_m.y - torque).abs() < 1e-4 * torque.abs(), "{} {torque}", output.torque_n_m.y);
    }

    #[test]
    fn a_case_by_hand() {
        // At rest, pitched by 0.3 rad and wanted upright, turning about all axes: thrust m g cos 0.3; e_R = sin 0.3
        // about y; W x J W = (W_y W_z (J_z - J_y), W_z W_x (J_x - J_z), W_x W_y (J_y - J_x)).
        let mut input = hover();
        input.estimate.attitude = attitude(0.0, 0.3);
        input.estimate.body_rates_rad_s = Vector3::new(1.0, 2.0, 3.0);
        let output = law().force_torque(&input).unwrap();
        assert!((output.force_n - 0.029 * 9.81 * 0.3_f64.cos()).abs() < 1e-15, "{}", output.force_n);
        let by_hand = Vector3::new(
            6.0 * (29.261_652e-6 - 16.655_602e-6) - 0.001_15,
            3.0 * (16.571_710e-6 - 29.261_652e-6) - 0.001_15 * 2.0 - (0.007 + 0.03 * 0.002) * 0.3_f64.sin(),
            2.0 * (16.655_602e-6 - 16.571_710e-6) - 0.002 * 3.0,
        );
        assert!((output.torque_n_m - by_hand).amax() < 1e-15, "{} {by_hand}", output.torque_n_m);
    }

    #[test]
    fn the_wanted_rates_are_turned_into_the_body() {
        // Turned by 90 degrees to where it should be, about z: a wanted rate about its y is one about x of the body.
        let mut input = hover();
        input.setpoint.jerk_m_s3 = Vector3::new(GRAVITY_M_S2, 0.0, 0.0);
        input.estimate.attitude = attitude(-std::f64::consts::FRAC_PI_2, 0.0);
        let output = law().force_torque(&input).unwrap();
        // R^T R_d turns by +90 degrees: (0, 1, 0) becomes (-1, 0, 0).
        assert!((output.torque_n_m.x + 0.001_15).abs() < 1e-15 && output.torque_n_m.y.abs() < 1e-15, "{output:?}");
    }

    #[test]
    fn standing_empties_its_integrals() {
        let mut law = law();
        let mut input = hover();
        input.estimate.attitude = attitude(0.0, 0.3);
        for _ in 0..500 {
            law.force_torque(&input).unwrap();
        }
        input.setpoint.acceleration_m_s2.z = -2.0 * GRAVITY_M_S2;
        input.estimate.attitude = attitude(0.0, 0.0);
        assert!(law.force_torque(&input).unwrap().force_n < 0.0);
        let output = law.force_torque(&hover()).unwrap();
        assert!(output.torque_n_m.y.abs() < 1e-18, "{output:?}");
    }
}
