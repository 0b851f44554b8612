//! The Crazyflie firmware's ways to a setpoint (crazyflie-firmware, 2026-08): arguments of a cflib call, or of an order to
//! the high-level commander, in; the `setpoint_t` that reaches the controller out.

use quatrack_crazyflie::abi::{Attitude, Mode, Modes, Quaternion, Setpoint, Vector};

/// Nothing is asked of any axis.
pub(crate) const NOTHING: Modes = Modes {
    x: Mode::DISABLED,
    y: Mode::DISABLED,
    z: Mode::DISABLED,
    roll: Mode::DISABLED,
    pitch: Mode::DISABLED,
    yaw: Mode::DISABLED,
    quat: Mode::DISABLED,
};

const ANGLES: Modes = Modes { roll: Mode::ABSOLUTE, pitch: Mode::ABSOLUTE, yaw: Mode::VELOCITY, ..NOTHING };
const POSITION: Modes = Modes { x: Mode::ABSOLUTE, y: Mode::ABSOLUTE, z: Mode::ABSOLUTE, ..NOTHING };

pub(crate) fn vector([x, y, z]: [f32; 3]) -> Vector {
    Vector { timestamp: 0, x, y, z }
}

/// Parameters of `flightmode`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FlightMode {
    pub(crate) alt_hold: bool,
    pub(crate) pos_hold: bool,
    pub(crate) pos_set: bool,
    pub(crate) roll_rate: bool,
    pub(crate) pitch_rate: bool,
    pub(crate) yaw_angle: bool,
}

/// `Commander.send_setpoint` and `crtpCommanderRpytDecodeSetpoint`: cflib turns the sign of pitch, the firmware that of a
/// yaw rate, and fields that are not written keep their earlier values.
pub(crate) fn rpyt(setpoint: &mut Setpoint, flight: FlightMode, [roll, pitch, yaw]: [f32; 3], thrust: u16) {
    let (pitch, mode) = (-pitch, &mut setpoint.mode);
    setpoint.thrust = if thrust < 1000 { 0.0 } else { f32::from(thrust).min(60_000.0) };
    mode.z = Mode::DISABLED;
    if flight.alt_hold {
        (setpoint.thrust, mode.z) = (0.0, Mode::VELOCITY);
        setpoint.velocity.z = (f32::from(thrust) - 32_767.0) / 32_767.0;
    }
    if flight.pos_hold {
        (mode.x, mode.y, mode.roll, mode.pitch) = (Mode::VELOCITY, Mode::VELOCITY, Mode::DISABLED, Mode::DISABLED);
        (setpoint.velocity.x, setpoint.velocity.y) = (pitch / 30.0, roll / 30.0);
        (setpoint.attitude.roll, setpoint.attitude.pitch) = (0.0, 0.0);
    } else if flight.pos_set && thrust != 0 {
        *mode = Modes { yaw: Mode::ABSOLUTE, quat: mode.quat, ..POSITION };
        setpoint.position = vector([-pitch, roll, f32::from(thrust) / 1000.0]);
        (setpoint.attitude, setpoint.thrust) = (Attitude { yaw, ..Attitude::default() }, 0.0);
    } else {
        (mode.x, mode.y) = (Mode::DISABLED, Mode::DISABLED);
        let either = |is_rate: bool| if is_rate { Mode::VELOCITY } else { Mode::ABSOLUTE };
        (mode.roll, mode.pitch) = (either(flight.roll_rate), either(flight.pitch_rate));
        let parts = |is_rate: bool, value: f32| if is_rate { (value, 0.0) } else { (0.0, value) };
        (setpoint.attitude_rate.roll, setpoint.attitude.roll) = parts(flight.roll_rate, roll);
        (setpoint.attitude_rate.pitch, setpoint.attitude.pitch) = parts(flight.pitch_rate, pitch);
        (setpoint.velocity.x, setpoint.velocity.y) = (0.0, 0.0);
    }
    if !flight.pos_set {
        if flight.yaw_angle {
            (setpoint.mode.yaw, setpoint.attitude_rate.yaw, setpoint.attitude.yaw) = (Mode::ABSOLUTE, 0.0, yaw);
        } else {
            (setpoint.mode.yaw, setpoint.attitude_rate.yaw) = (Mode::VELOCITY, -yaw);
        }
    }
}

/// `Commander.send_setpoint_manual` and `manualDecoder`; thrust in 65535ths.
pub(crate) fn manual([roll, pitch, yaw_rate]: [f32; 3], thrust: f32, is_rate: bool) -> Setpoint {
    let angles = Attitude { roll, pitch: -pitch, ..Attitude::default() };
    let turn = Attitude { yaw: yaw_rate, ..Attitude::default() };
    let mut setpoint = Setpoint { thrust, attitude: angles, attitude_rate: turn, mode: ANGLES, ..Setpoint::OFF };
    if is_rate {
        (setpoint.mode.roll, setpoint.mode.pitch) = (Mode::VELOCITY, Mode::VELOCITY);
        (setpoint.attitude, setpoint.attitude_rate) =
            (Attitude::default(), Attitude { yaw: yaw_rate, ..setpoint.attitude });
    }
    setpoint
}

/// `Commander.send_zdistance_setpoint` and `zDistanceDecoder`: the pitch as it is.
pub(crate) fn z_distance([roll, pitch, yaw_rate]: [f32; 3], height: f32) -> Setpoint {
    let mut setpoint = manual([roll, -pitch, yaw_rate], 0.0, false);
    (setpoint.mode.z, setpoint.position.z) = (Mode::ABSOLUTE, height);
    setpoint
}

/// `altHoldDecoder`.
pub(crate) fn alt_hold([roll, pitch, yaw_rate]: [f32; 3], climb: f32) -> Setpoint {
    let mut setpoint = manual([roll, -pitch, yaw_rate], 0.0, false);
    (setpoint.mode.z, setpoint.velocity.z) = (Mode::VELOCITY, climb);
    setpoint
}

/// `Commander.send_velocity_world_setpoint` and `velocityDecoder`.
pub(crate) fn velocity_world(velocity: [f32; 3], yaw_rate: f32) -> Setpoint {
    let (on, turn) = (Mode::VELOCITY, Attitude { yaw: yaw_rate, ..Attitude::default() });
    let mode = Modes { x: on, y: on, z: on, yaw: on, ..NOTHING };
    Setpoint { velocity: vector(velocity), attitude_rate: turn, mode, ..Setpoint::OFF }
}

/// `Commander.send_hover_setpoint` and `hoverDecoder`.
pub(crate) fn hover([vx, vy]: [f32; 2], yaw_rate: f32, height: f32) -> Setpoint {
    let mut setpoint = velocity_world([vx, vy, 0.0], yaw_rate);
    (setpoint.mode.z, setpoint.position.z, setpoint.velocity_body) = (Mode::ABSOLUTE, height, 1);
    setpoint
}

/// `Commander.send_position_setpoint` and `positionDecoder`.
pub(crate) fn position(at: [f32; 3], yaw: f32) -> Setpoint {
    let attitude = Attitude { yaw, ..Attitude::default() };
    Setpoint { position: vector(at), attitude, mode: Modes { yaw: Mode::ABSOLUTE, ..POSITION }, ..Setpoint::OFF }
}

/// `Commander.send_full_state_setpoint` and `fullStateDecoder`: whole millimetres, no jerk, an attitude of nine bits a
/// component, and a yaw rate that cflib multiplies by 1000 and the firmware takes for milliradians: rad/s.
pub(crate) fn full_state([p, v, a]: [[f32; 3]; 3], attitude: [f32; 4], yaw_rate_rad_s: f32) -> Setpoint {
    let millimetres = |v: [f32; 3]| vector(v.map(|c| (c * 1000.0).trunc() / 1000.0));
    let [x, y, z, w] = compressed(attitude);
    let rate = (yaw_rate_rad_s * 1000.0).trunc() * 180.0 / (std::f32::consts::PI * 1000.0);
    Setpoint {
        position: millimetres(p),
        velocity: millimetres(v),
        acceleration: millimetres(a),
        attitude_quaternion: Quaternion { x, y, z, w },
        attitude_rate: Attitude { yaw: rate, ..Attitude::default() },
        mode: Modes { quat: Mode::ABSOLUTE, ..POSITION },
        ..Setpoint::OFF
    }
}

/// `quatcompress` and `quatdecompress`, x to w.
fn compressed(q: [f32; 4]) -> [f32; 4] {
    let largest = (0..4).max_by(|a, b| q[*a].abs().total_cmp(&q[*b].abs())).unwrap_or(3);
    let sign = q[largest].signum();
    let steps = |c: f32| (511.0 * c.abs() / std::f32::consts::FRAC_1_SQRT_2 + 0.5).trunc();
    let mut out = q.map(|c| (c * sign).signum() * std::f32::consts::FRAC_1_SQRT_2 * steps(c) / 511.0);
    out[largest] = 0.0;
    out[largest] = (1.0 - out.iter().map(|c| c * c).sum::<f32>()).sqrt();
    out
}

/// `supervisorOverrideSetpoint` half a second after the last setpoint.
pub(crate) fn level_out(setpoint: &Setpoint) -> Setpoint {
    let mut level = *setpoint;
    level.mode = Modes { z: setpoint.mode.z, quat: setpoint.mode.quat, ..ANGLES };
    (level.attitude.roll, level.attitude.pitch, level.attitude_rate.yaw) = (0.0, 0.0, 0.0);
    level
}
