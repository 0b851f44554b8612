//! The field's control laws, written from their papers, as rivals for the same scenario: Mellinger and Kumar 2011, Lee,
//! Leok and McClamroch 2010, and the cascaded PID.
//!
//! Each has the gains, the integral terms, the limits and the rates that the Crazyflie's firmware documents for it
//! (bitcraze/crazyflie-firmware 2a18fc29, of 2026-08-21), turned into SI; its configuration is apart from its state.
//! All end in a force and a torque, which [`Actuation::forces_n`] gives to the motors as the firmware does.

mod lee;
mod mellinger;
mod pid;

use nalgebra::{Matrix3, Vector3, Vector4};

pub use lee::{Lee, LeeConfig};
pub use mellinger::{Mellinger, MellingerConfig};
pub use pid::{CascadedPid, CascadedPidConfig, Pid, PidConfig};

use quatrack_design::vehicle::{ROTOR_SIDES, ROTOR_TORQUE_SIGNS, Vehicle};

/// The number by which the firmware commands all of a motor's thrust.
const FULL: f64 = 65_535.0;

/// Force along the body's z axis and torque about the centre of mass, body frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceTorque {
    /// N.
    pub force_n: f64,
    /// N m.
    pub torque_n_m: Vector3<f64>,
}

/// Four equal motors in an X: force and torque from commands in the firmware's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuation {
    /// Distance of the rotors from the body's x and y axes, m.
    pub half_arm_m: f64,
    /// Torque about a rotor's axis per thrust, m.
    pub torque_per_thrust_m: f64,
    /// Most thrust of one motor, N.
    pub thrust_max_n: f64,
}

impl Actuation {
    /// A vehicle's.
    pub fn of(vehicle: &Vehicle) -> Self {
        let motors = vehicle.motors();
        Self {
            half_arm_m: motors.half_arm_m(),
            torque_per_thrust_m: motors.torque_per_thrust_m,
            thrust_max_n: motors.thrust_max_n,
        }
    }

    /// The forces that make a force and a torque. Where one exceeds the most that a motor does, the excess is taken off all
    /// four; a force that is then negative is 0 (`powerDistributionForceTorque` and `powerDistributionCap` in
    /// `power_distribution_quadrotor.c`, without their rounding to whole numbers).
    pub fn forces_n(&self, wanted: &ForceTorque) -> Vector4<f64> {
        let (torque, a) = (wanted.torque_n_m, self.half_arm_m);
        let asked = Vector4::from_fn(|i, _| {
            let [x, y] = ROTOR_SIDES[i];
            let turning =
                (torque.x * y - torque.y * x) / a + torque.z * ROTOR_TORQUE_SIGNS[i] / self.torque_per_thrust_m;
            0.25 * (wanted.force_n + turning)
        });
        let excess = (asked.max() - self.thrust_max_n).max(0.0);
        asked.map(|force| (force - excess).max(0.0))
    }

    /// N of all four motors for 1 of the firmware's numbers of thrust.
    fn force_per_number(&self) -> f64 {
        4.0 * self.thrust_max_n / FULL
    }

    /// N m for 1 of the firmware's numbers of roll, pitch and yaw: half of roll and pitch and all of yaw go to each motor
    /// (`powerDistributionLegacy`).
    fn torque_per_number(&self) -> Vector3<f64> {
        let a_motor = self.thrust_max_n / FULL;
        let tilt = 2.0 * self.half_arm_m * a_motor;
        Vector3::new(tilt, tilt, 4.0 * self.torque_per_thrust_m * a_motor)
    }
}

/// `e_R = 1/2 (R_d^T R - R^T R_d)^vee`, the rotation error of both geometric laws.
fn rotation_error(attitude: &Matrix3<f64>, desired: &Matrix3<f64>) -> Vector3<f64> {
    let difference = desired.transpose() * attitude;
    let skew = (difference - difference.transpose()) * 0.5;
    Vector3::new(skew.m32, skew.m13, skew.m21)
}

/// Each component within plus and minus a bound.
fn within(value: &Vector3<f64>, bound: &Vector3<f64>) -> Vector3<f64> {
    value.zip_map(bound, |value, bound| value.max(-bound).min(bound))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicles;

    fn actuation() -> Actuation {
        Actuation { half_arm_m: 0.03, torque_per_thrust_m: 0.006, thrust_max_n: 0.12 }
    }

    #[test]
    fn forces_within_range_make_the_wanted_force_and_torque() {
        let vehicle = vehicles::by_name("crazyflie-2.1").unwrap();
        let wanted = ForceTorque { force_n: 0.25, torque_n_m: Vector3::new(8e-4, -5e-4, 1e-4) };
        let made = vehicle.motors().mixing() * Actuation::of(&vehicle).forces_n(&wanted);
        let asked = Vector4::new(wanted.force_n, wanted.torque_n_m.x, wanted.torque_n_m.y, wanted.torque_n_m.z);
        assert!((made - asked).amax() < 1e-15, "{made} {asked}");
    }

    #[test]
    fn an_excess_is_taken_off_all_four() {
        // 0.11 N each and 0.03 N of roll: 0.14 and 0.08 become 0.12 and 0.06; the torque is kept, 0.08 N of thrust is not.
        let wanted = ForceTorque { force_n: 0.44, torque_n_m: Vector3::new(0.03 * 4.0 * 0.03, 0.0, 0.0) };
        let forces = actuation().forces_n(&wanted);
        assert!((forces - Vector4::new(0.06, 0.06, 0.12, 0.12)).amax() < 1e-15, "{forces}");
    }

    #[test]
    fn nothing_is_asked_below_zero() {
        let wanted = ForceTorque { force_n: 0.04, torque_n_m: Vector3::new(0.0, 0.02 * 4.0 * 0.03, 0.0) };
        // Nose down: the rear motors.
        let forces = actuation().forces_n(&wanted);
        assert!((forces - Vector4::new(0.0, 0.03, 0.03, 0.0)).amax() < 1e-15, "{forces}");
    }

    #[test]
    fn numbers_of_the_firmware_come_to_the_forces_of_its_mixing() {
        // Roll 1000: 500 numbers on each motor, up on the left, at 0.12 N for 65535 and 0.03 m; yaw 1000: all of it.
        let torque = actuation().torque_per_number() * 1000.0;
        assert!((torque.x - 4.0 * 0.03 * 500.0 * 0.12 / 65535.0).abs() < 1e-18);
        assert!((torque.z - 4.0 * 0.006 * 1000.0 * 0.12 / 65535.0).abs() < 1e-18);
        // Full numbers on all: four times the most of one.
        assert!((actuation().force_per_number() * 65535.0 - 0.48).abs() < 1e-15);
    }

    #[test]
    fn the_rotation_error_is_the_sine_of_the_angle_along_its_axis() {
        let axis = nalgebra::Unit::new_normalize(Vector3::new(0.3, -0.5, 0.8));
        let turn = |angle: f64| *nalgebra::Rotation3::from_axis_angle(&axis, angle).matrix();
        let error = rotation_error(&turn(1.1), &turn(0.4));
        assert!((error - axis.into_inner() * 0.7_f64.sin()).norm() < 1e-15, "{error}");
    }
}

#[cfg(test)]
mod testing {
    //! Inputs at hover.

    use nalgebra::{UnitQuaternion, Vector3};

    use super::Actuation;
    use crate::control_law::{Estimate, Input, Setpoint};
    use crate::vehicles;
    use quatrack_design::model::GRAVITY_M_S2;
    use quatrack_plan::trajectory::fifth_order::FifthOrder;

    pub(super) fn actuation() -> Actuation {
        Actuation::of(&vehicles::by_name("crazyflie-2.1").unwrap())
    }

    /// At rest, upright and where it should be.
    pub(super) fn hover() -> Input {
        Input {
            time_s: 0.0,
            estimate: Estimate {
                position_m: Vector3::zeros(),
                velocity_m_s: Vector3::zeros(),
                attitude: UnitQuaternion::identity(),
                body_rates_rad_s: Vector3::zeros(),
                specific_force_m_s2: Vector3::z() * GRAVITY_M_S2,
            },
            setpoint: Setpoint::exact(&FifthOrder::at_rest(Vector3::zeros(), 0.0), 0.0),
            battery_v: 4.0,
        }
    }

    /// Tilted forwards by an angle, rad, and turned by a heading.
    pub(super) fn attitude(heading_rad: f64, pitch_rad: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad)
            * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), pitch_rad)
    }
}
