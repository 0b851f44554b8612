//! Mellinger and Kumar, "Minimum snap trajectory generation and control for quadrotors" (ICRA 2011), section IV.
//!
//! `F = -K_p e_p - K_v e_v + m g z + m a`, the thrust its part along the craft's axis, the wanted attitude that of
//! [`attitude_along`], `tau = -K_R e_R - K_w e_w`. The firmware adds integrals of position and rotation error, a term
//! in the derivative of the rates' error, and limits.

use nalgebra::{Matrix3, Vector3, Vector4};

use super::{Actuation, ForceTorque, rotation_error, within};
use crate::control_law::{ControlLaw, Input, attitude_along};
use quatrack_design::model::GRAVITY_M_S2;

/// Control steps a second: `ATTITUDE_RATE`.
const RATE_HZ: u32 = 500;

/// Gains and limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MellingerConfig {
    /// Mass that the law reckons with, kg.
    pub mass_kg: f64,
    /// Thrust that comes of 1 N asked for. It is 1 where the law knows the force of its motors. The firmware's own
    /// factor of force to command, `massThrust = 132000` for every craft, makes it 0.967 with motors of 0.12 N, 1.450
    /// with 0.18 N and
    /// 1.611 with 0.2 N.
    pub thrust_factor: f64,
    /// `K_p`, N/m.
    pub position: Vector3<f64>,
    /// `K_v`, N s/m.
    pub velocity: Vector3<f64>,
    /// Of the position error's integral, N/(m s).
    pub position_integral: Vector3<f64>,
    /// Most of that integral, m s.
    pub position_integral_max: Vector3<f64>,
    /// `K_R`, N m.
    pub rotation: Vector3<f64>,
    /// `K_w`, N m s.
    pub rates: Vector3<f64>,
    /// Of the rotation error's integral, N m/s.
    pub rotation_integral: Vector3<f64>,
    /// Most of that integral, s.
    pub rotation_integral_max: Vector3<f64>,
    /// Of the derivative of the rates' error, N m s^2.
    pub rates_derivative: Vector3<f64>,
    /// Most torque about each axis, N m.
    pub torque_max_n_m: Vector3<f64>,
}

impl MellingerConfig {
    /// The gains that `controller_mellinger.c` documents, for a known mass and a known motor force.
    ///
    /// Its rotation error is twice the paper's, so its gains and integrals of it are turned into those of the paper's.
    pub fn firmware(mass_kg: f64, actuation: &Actuation) -> Self {
        let numbers = actuation.torque_per_number();
        let torque = |roll_pitch: f64, yaw: f64| numbers.component_mul(&Vector3::new(roll_pitch, roll_pitch, yaw));
        Self {
            mass_kg,
            thrust_factor: 1.0,
            position: Vector3::new(0.4, 0.4, 1.25),
            velocity: Vector3::new(0.2, 0.2, 0.4),
            position_integral: Vector3::repeat(0.05),
            position_integral_max: Vector3::new(2.0, 2.0, 0.4),
            rotation: 2.0 * torque(70_000.0, 60_000.0),
            rates: torque(20_000.0, 12_000.0),
            rotation_integral: 2.0 * torque(0.0, 500.0),
            rotation_integral_max: 0.5 * Vector3::new(1.0, 1.0, 1500.0),
            rates_derivative: torque(200.0, 0.0),
            torque_max_n_m: torque(32_000.0, 32_000.0),
        }
    }
}

/// The law with its memory.
#[derive(Clone, Debug)]
pub struct Mellinger {
    config: MellingerConfig,
    actuation: Actuation,
    position_integral_m_s: Vector3<f64>,
    rotation_integral_s: Vector3<f64>,
    rates_error_before: Option<Vector3<f64>>,
}

impl Mellinger {
    /// The law at the start of a flight.
    pub fn new(config: MellingerConfig, actuation: Actuation) -> Self {
        Self {
            config,
            actuation,
            position_integral_m_s: Vector3::zeros(),
            rotation_integral_s: Vector3::zeros(),
            rates_error_before: None,
        }
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
        let integral = self.position_integral_m_s + position_error * PERIOD_S;
        self.position_integral_m_s = within(&integral, &config.position_integral_max);
        let wanted_n = (setpoint.acceleration_m_s2 + Vector3::z() * GRAVITY_M_S2) * config.mass_kg
            - config.position.component_mul(&position_error)
            - config.velocity.component_mul(&velocity_error)
            - config.position_integral.component_mul(&self.position_integral_m_s);

        let axes =
            attitude_along(&wanted_n, setpoint.heading_rad).ok_or("Mellinger: the wanted force has no attitude")?;
        let attitude = estimate.attitude.to_rotation_matrix();
        let rotation = rotation_error(attitude.matrix(), &Matrix3::from_columns(&axes));
        let rates = estimate.body_rates_rad_s - setpoint.body_rates_rad_s;
        let before = self.rates_error_before.replace(rates).unwrap_or(rates);
        let integral = self.rotation_integral_s + rotation * PERIOD_S;
        self.rotation_integral_s = within(&integral, &config.rotation_integral_max);
        let torque_n_m = -config.rotation.component_mul(&rotation)
            - config.rates.component_mul(&rates)
            - config.rotation_integral.component_mul(&self.rotation_integral_s)
            - config.rates_derivative.component_mul(&(rates - before)) / PERIOD_S;

        let force_n = config.thrust_factor * wanted_n.dot(&(attitude * Vector3::z()));
        if force_n > 0.0 {
            return Ok(ForceTorque { force_n, torque_n_m: within(&torque_n_m, &config.torque_max_n_m) });
        }
        (self.position_integral_m_s, self.rotation_integral_s) = (Vector3::zeros(), Vector3::zeros());
        Ok(ForceTorque { force_n, torque_n_m: Vector3::zeros() })
    }
}

impl ControlLaw for Mellinger {
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

    fn law() -> Mellinger {
        Mellinger::new(MellingerConfig::firmware(MASS_KG, &actuation()), actuation())
    }

    #[test]
    fn gains_are_the_firmwares_in_si() {
        // 70000 numbers of roll for a rotation error that is twice the paper's: half of them on each motor of 0.12 N at
        // 0.046 m / sqrt 2 = 32.527 mm, 4 * 32.527e-3 * 70000 * 0.12 / 65535 = 16.676 mN m.
        let config = MellingerConfig::firmware(MASS_KG, &actuation());
        assert!((config.rotation.x - 16.676e-3).abs() < 1e-6, "{}", config.rotation.x);
        // 32000 of yaw, all on each motor of 6.9929 mm: 4 * 6.9929e-3 * 32000 * 0.12 / 65535 = 1.6390 mN m.
        assert!((config.torque_max_n_m.z - 1.6390e-3).abs() < 1e-7, "{}", config.torque_max_n_m.z);
    }

    #[test]
    fn it_holds_a_hover_with_its_weight_alone() {
        let output = law().force_torque(&hover()).unwrap();
        assert!((output.force_n - MASS_KG * GRAVITY_M_S2).abs() < 1e-15 && output.torque_n_m.norm() < 1e-18);
        let forces = law().step(&hover()).unwrap();
        assert!((forces - Vector4::repeat(0.25 * MASS_KG * GRAVITY_M_S2)).amax() < 1e-15, "{forces}");
    }

    #[test]
    fn near_a_hover_it_is_its_linear_law() {
        let (config, weight) = (MellingerConfig::firmware(MASS_KG, &actuation()), MASS_KG * GRAVITY_M_S2);
        let mut input = hover();
        let (x, v, pitch, rate) = (1e-5, -2e-5, 3e-5, 4e-5);
        input.estimate.position_m = Vector3::new(x, 0.0, -x);
        input.estimate.velocity_m_s = Vector3::new(v, 0.0, 0.0);
        input.estimate.attitude = attitude(0.0, pitch);
        input.estimate.body_rates_rad_s.y = rate;
        let output = law().force_torque(&input).unwrap();
        // The wanted pitch is the wanted force forwards over the weight; integrals have run for one step of 2 ms.
        let forwards = -(0.4 + 0.05 * 0.002) * x - 0.2 * v;
        let torque = -config.rotation.y * (pitch - forwards / weight) - config.rates.y * rate;
        // Second-order terms: 1e-4 of the first.
        assert!((output.torque_n_m.y - torque).abs() < 1e-4 * torque.abs(), "{} {torque}", output.torque_n_m.y);
        let climb = (1.25 + 0.05 * 0.002) * x;
        assert!((output.force_n - weight - climb).abs() < 1e-4 * climb, "{} {climb}", output.force_n - weight);
    }

    #[test]
    fn integrals_end_where_the_firmware_ends_them() {
        // 10 m too low for a second is an integral of 10 m s, ended at 0.4: 0.05 * 0.4 = 0.02 N. Ahead by 1 m for 3 s:
        // 2 m s.
        let config = MellingerConfig::firmware(MASS_KG, &actuation());
        let unbounded = MellingerConfig { torque_max_n_m: Vector3::repeat(1.0), ..config };
        let mut law = Mellinger::new(unbounded, actuation());
        let mut input = hover();
        input.estimate.position_m = Vector3::new(1.0, 0.0, -10.0);
        for _ in 0..1500 {
            law.force_torque(&input).unwrap();
        }
        input.estimate.position_m = Vector3::zeros();
        let output = law.force_torque(&input).unwrap();
        assert!((output.force_n - MASS_KG * GRAVITY_M_S2 - 0.02).abs() < 1e-12, "{}", output.force_n);
        let pitch = (-0.05 * 2.0_f64).atan2(MASS_KG * GRAVITY_M_S2 + 0.02);
        let torque = config.rotation.y * pitch.sin();
        assert!((output.torque_n_m.y - torque).abs() < 1e-12, "{} {torque}", output.torque_n_m.y);
        // That is more torque than the firmware's law asks for.
        law.config = config;
        assert_eq!(law.force_torque(&input).unwrap().torque_n_m.y, -config.torque_max_n_m.y);
    }

    #[test]
    fn a_change_of_the_rates_error_is_damped_from_the_second_step_on() {
        let mut law = law();
        let mut input = hover();
        law.force_torque(&input).unwrap();
        input.estimate.body_rates_rad_s = Vector3::new(1e-3, 0.0, 1e-3);
        let output = law.force_torque(&input).unwrap();
        let config = MellingerConfig::firmware(MASS_KG, &actuation());
        let roll = -1e-3 * (config.rates.x + config.rates_derivative.x / 0.002);
        assert!((output.torque_n_m.x - roll).abs() < 1e-15, "{} {roll}", output.torque_n_m.x);
        assert!((output.torque_n_m.z + 1e-3 * config.rates.z).abs() < 1e-15, "{}", output.torque_n_m.z);
    }

    #[test]
    fn upside_down_it_asks_for_nothing() {
        let mut input = hover();
        input.estimate.attitude = attitude(0.0, 3.0);
        let output = law().force_torque(&input).unwrap();
        assert!(output.force_n < 0.0 && output.torque_n_m == Vector3::zeros(), "{output:?}");
        assert!(law().step(&input).unwrap() == Vector4::zeros());
    }
}
