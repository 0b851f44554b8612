//! The forms in which setpoints are sent: a course's motion and heading in; the firmware's setpoint, as its commander
//! or its packet decoder makes it, out.

use nalgebra::Vector3;
use quatrack_crazyflie::abi::{self, Mode};

/// The form in which setpoints are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setpoints {
    /// By the high-level commander: position to jerk, and yaw.
    HighLevel,
    /// By a script on the ground, as full-state packets: whole millimetres, no jerk, the attitude of hover.
    FullState,
    /// Like these two, while the craft turns about the vertical with 1 rad/s.
    HighLevelTurning,
    /// Likewise.
    FullStateTurning,
}

/// Rate of the heading of a course that is flown turning, rad/s.
const TURN_RAD_S: f64 = 1.0;

impl Setpoints {
    /// Heading at a time, rad, and its rate, rad/s.
    pub(super) fn turn(self, t_s: f64) -> (f64, f64) {
        match self {
            Self::HighLevel | Self::FullState => (0.0, 0.0),
            Self::HighLevelTurning | Self::FullStateTurning => (TURN_RAD_S * t_s, TURN_RAD_S),
        }
    }
}

/// `crtpCommanderHighLevelGetSetpoint`, the rate about the body's z axis as `poly4d_eval` has it to first order in the rate.
pub(super) fn high_level(motion: &[Vector3<f32>; 4], (heading_rad, rate_rad_s): (f64, f64)) -> abi::Setpoint {
    let thrust = motion[2] + Vector3::z() * 9.81;
    let body_rate_rad_s = rate_rad_s * f64::from(thrust.z / thrust.norm());
    let [position, velocity, acceleration, jerk] = motion.map(|v| abi::Vector { timestamp: 0, x: v.x, y: v.y, z: v.z });
    let modes = abi::Modes {
        x: Mode::ABSOLUTE,
        y: Mode::ABSOLUTE,
        z: Mode::ABSOLUTE,
        yaw: Mode::ABSOLUTE,
        ..Default::default()
    };
    let attitude = abi::Attitude { yaw: heading_rad.to_degrees() as f32, ..Default::default() };
    let attitude_rate = abi::Attitude { yaw: body_rate_rad_s.to_degrees() as f32, ..Default::default() };
    abi::Setpoint { attitude, attitude_rate, position, velocity, acceleration, jerk, mode: modes, ..Default::default() }
}

/// `fullStateDecoder`: whole millimetres, and whole thousandths of a radian a second.
pub(super) fn full_state(motion: &[Vector3<f64>; 4], (heading_rad, rate_rad_s): (f64, f64)) -> abi::Setpoint {
    let [position, velocity, acceleration, _] = motion.map(|v| vector(&v.map(|c| (c * 1e3).trunc() / 1e3)));
    let (sin, cos) = (0.5 * heading_rad).sin_cos();
    let modes = abi::Modes {
        x: Mode::ABSOLUTE,
        y: Mode::ABSOLUTE,
        z: Mode::ABSOLUTE,
        quat: Mode::ABSOLUTE,
        ..Default::default()
    };
    abi::Setpoint {
        position,
        velocity,
        acceleration,
        attitude_quaternion: abi::Quaternion { w: cos as f32, z: sin as f32, ..Default::default() },
        attitude_rate: abi::Attitude { yaw: rate_rad_s.to_degrees() as f32, ..Default::default() },
        mode: modes,
        ..Default::default()
    }
}

pub(super) fn vector(v: &Vector3<f64>) -> abi::Vector {
    let [x, y, z]: [f64; 3] = (*v).into();
    abi::Vector { timestamp: 0, x: x as f32, y: y as f32, z: z as f32 }
}
