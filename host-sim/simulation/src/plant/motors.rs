//! Motors: commanded thrusts in; thrusts that follow with a lag, and the force and torque of all, out.

use nalgebra::{Vector3, Vector4};
use quatrack_design::vehicle::{ROTOR_SIDES, ROTOR_TORQUE_SIGNS, Vehicle};

use super::{Propeller, RotorDrag, Wrench};

/// One motor with its rotor, whose axis is the body's z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Place of the rotor, body frame, m.
    pub position_m: Vector3<f64>,
    /// Torque about body z per thrust, with its sign, m.
    pub torque_per_thrust_m: f64,
    /// Time constant while the thrust grows, s.
    pub rise_lag_s: f64,
    /// Time constant while it falls, s.
    pub fall_lag_s: f64,
    /// Least thrust, N.
    pub thrust_min_n: f64,
    /// Most thrust, N.
    pub thrust_max_n: f64,
}

/// The four motors of a craft, in the order of its vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorBank {
    /// Each motor.
    pub motors: [Motor; 4],
    /// The propeller on each, where its speed counts: for its momentum, its own torque and its drag.
    pub propeller: Option<Propeller>,
    /// Torque that is always there, body frame, N m.
    pub torque_bias_n_m: Vector3<f64>,
}

impl Motor {
    /// `f' = (u - f) / tau`, N/s, with the command within the motor's limits.
    fn thrust_rate_n_s(&self, thrust_n: f64, command_n: f64) -> f64 {
        let missing_n = command_n.max(self.thrust_min_n).min(self.thrust_max_n) - thrust_n;
        missing_n / if missing_n > 0.0 { self.rise_lag_s } else { self.fall_lag_s }
    }
}

impl MotorBank {
    /// The vehicle's, which rise and fall alike.
    pub fn of(vehicle: &Vehicle) -> Self {
        let all = vehicle.motors();
        let a = all.half_arm_m();
        let motor = |i: usize| Motor {
            position_m: Vector3::new(a * ROTOR_SIDES[i][0], a * ROTOR_SIDES[i][1], 0.0),
            torque_per_thrust_m: all.torque_per_thrust_m * ROTOR_TORQUE_SIGNS[i],
            rise_lag_s: all.lag_s,
            fall_lag_s: all.lag_s,
            thrust_min_n: all.thrust_min_n,
            thrust_max_n: all.thrust_max_n,
        };
        Self { motors: [0, 1, 2, 3].map(motor), propeller: None, torque_bias_n_m: Vector3::zeros() }
    }

    /// The same about a centre of mass that is elsewhere, body frame, m.
    pub fn around(mut self, centre_of_mass_m: &Vector3<f64>) -> Self {
        for motor in &mut self.motors {
            motor.position_m -= centre_of_mass_m;
        }
        self
    }

    /// The same with other time constants, s.
    pub fn with_lag(mut self, rise_lag_s: f64, fall_lag_s: f64) -> Self {
        for motor in &mut self.motors {
            (motor.rise_lag_s, motor.fall_lag_s) = (rise_lag_s, fall_lag_s);
        }
        self
    }

    /// Rates of the thrusts under commands, N/s.
    pub(super) fn thrust_rates_n_s(&self, thrusts_n: &Vector4<f64>, commands_n: &Vector4<f64>) -> Vector4<f64> {
        Vector4::from_fn(|i, _| {
            let motor = &self.motors[i];
            let goal_n = commands_n[i].max(motor.thrust_min_n).min(motor.thrust_max_n);
            let by_speed = self.propeller.and_then(|propeller| propeller.thrust_rate_n_s(thrusts_n[i], goal_n));
            by_speed.unwrap_or_else(|| motor.thrust_rate_n_s(thrusts_n[i], commands_n[i]))
        })
    }

    /// Angular momentum of the propellers about body z, kg m^2/s. Each turns against the torque that the air exerts on it.
    pub fn momentum_n_m_s(&self, thrusts_n: &Vector4<f64>) -> f64 {
        self.propeller.map_or(0.0, |propeller| {
            let speeds = self.motors.iter().zip(thrusts_n.iter());
            let spin = |motor: &Motor| -motor.torque_per_thrust_m.signum();
            propeller.inertia_kg_m2 * speeds.map(|(m, f)| spin(m) * propeller.speed_rad_s(*f)).sum::<f64>()
        })
    }

    /// The share of the propellers' speeds in force and torque, body frame: their torque where it is not in proportion to
    /// the thrust, `-h' z - omega x h z` of their momentum h, and the drag of each that moves through the air.
    pub(super) fn turning(
        &self,
        propeller: &Propeller,
        thrusts_n: &Vector4<f64>,
        thrust_rates_n_s: &Vector4<f64>,
        rates: &Vector3<f64>,
        drag: Option<(&RotorDrag, &Vector3<f64>)>,
    ) -> Wrench {
        let mut whole = Wrench::default();
        let (mut momentum, mut momentum_rate) = (0.0, 0.0);
        for (i, motor) in self.motors.iter().enumerate() {
            let speed = propeller.speed_rad_s(thrusts_n[i]);
            let against = motor.torque_per_thrust_m.signum();
            if let Some(torque_n_m) = propeller.torque_n_m(speed) {
                whole.torque_n_m.z += against * torque_n_m - motor.torque_per_thrust_m * thrusts_n[i];
            }
            momentum -= against * speed;
            momentum_rate -= against * propeller.speed_rate_rad_s2(speed, thrust_rates_n_s[i]);
            if let Some((drag, through_air)) = drag {
                let force_n = drag.force_n(speed, &(through_air + rates.cross(&motor.position_m)));
                whole.force_n += force_n;
                whole.torque_n_m += motor.position_m.cross(&force_n);
            }
        }
        let inertia = propeller.inertia_kg_m2;
        whole.torque_n_m += Vector3::new(-rates.y * momentum, rates.x * momentum, -momentum_rate) * inertia;
        whole
    }

    /// Force and torque of all, body frame.
    pub(super) fn wrench(&self, thrusts_n: &Vector4<f64>) -> Wrench {
        let bias = Wrench { torque_n_m: self.torque_bias_n_m, ..Wrench::default() };
        self.motors.iter().zip(thrusts_n.iter()).fold(bias, |sum, (motor, thrust_n)| {
            let force_n = Vector3::new(0.0, 0.0, *thrust_n);
            let reaction = Vector3::new(0.0, 0.0, motor.torque_per_thrust_m * thrust_n);
            Wrench {
                force_n: sum.force_n + force_n,
                torque_n_m: sum.torque_n_m + motor.position_m.cross(&force_n) + reaction,
            }
        })
    }
}
