//! The firmware's C types as they lie in memory: `stabilizer_types.h` and `imu_types.h` of crazyflie-firmware, 2026-08.
//!
//! The ARM compiler gives an enum the fewest bytes it needs, the host's gives it four: offsets behind one differ. Both are
//! asserted below. An enum is an integer here, because nothing keeps a caller from any other value.

/// An enum of the firmware.
#[cfg(target_arch = "arm")]
pub type CEnum = u8;
/// An enum of the firmware.
#[cfg(not(target_arch = "arm"))]
pub type CEnum = u32;

/// `Axis3f`: x, y, z.
pub type Axis3 = [f32; 3];

/// `attitude_t`: Euler angles or their rates, degrees.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude {
    /// Time of its computation, ms.
    pub timestamp: u32,
    /// About body x.
    pub roll: f32,
    /// About body y, of the opposite sign where it is an angle.
    pub pitch: f32,
    /// About z.
    pub yaw: f32,
}

/// `vector_t`, `point_t`, `velocity_t`, `acc_t`, `jerk_t`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector {
    /// Time of its computation, ms.
    pub timestamp: u32,
    /// World x.
    pub x: f32,
    /// World y.
    pub y: f32,
    /// World z, up.
    pub z: f32,
}

/// `quaternion_t`: scalar last, body to world.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quaternion {
    /// First vector component.
    pub x: f32,
    /// Second vector component.
    pub y: f32,
    /// Third vector component.
    pub z: f32,
    /// Scalar part.
    pub w: f32,
}

/// `baro_t`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Barometer {
    /// mbar.
    pub pressure: f32,
    /// Degrees Celsius.
    pub temperature: f32,
    /// Above sea level, m.
    pub asl: f32,
}

/// `sensorData_t`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorData {
    /// Accelerometer, g.
    pub acc: Axis3,
    /// Gyroscope, degrees a second.
    pub gyro: Axis3,
    /// Magnetometer, gauss.
    pub mag: Axis3,
    /// Barometer.
    pub baro: Barometer,
    /// Time of the sensors' reading, us.
    pub interrupt_timestamp: u64,
}

/// `state_t`: the estimate.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Euler angles, degrees, pitch of the opposite sign.
    pub attitude: Attitude,
    /// The same attitude.
    pub attitude_quaternion: Quaternion,
    /// m.
    pub position: Vector,
    /// m/s.
    pub velocity: Vector,
    /// g, gravity taken off.
    pub acc: Vector,
}

/// `stab_mode_t`, one of [`Self::DISABLED`], [`Self::ABSOLUTE`], [`Self::VELOCITY`].
#[repr(transparent)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mode(pub CEnum);

impl Mode {
    /// `modeDisable`.
    pub const DISABLED: Self = Self(0);
    /// `modeAbs`.
    pub const ABSOLUTE: Self = Self(1);
    /// `modeVelocity`.
    pub const VELOCITY: Self = Self(2);
}

/// `setpoint_mode_t`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modes {
    /// Position along world x.
    pub x: Mode,
    /// Position along world y.
    pub y: Mode,
    /// Height.
    pub z: Mode,
    /// Roll.
    pub roll: Mode,
    /// Pitch.
    pub pitch: Mode,
    /// Yaw.
    pub yaw: Mode,
    /// Attitude as a quaternion.
    pub quat: Mode,
}

/// `setpoint_t`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint {
    /// Time at which the commander took it, ms.
    pub timestamp: u32,
    /// Degrees, pitch of the opposite sign.
    pub attitude: Attitude,
    /// Degrees a second.
    pub attitude_rate: Attitude,
    /// Body to world.
    pub attitude_quaternion: Quaternion,
    /// 0 to 65535, the most that four motors can do.
    pub thrust: f32,
    /// m.
    pub position: Vector,
    /// m/s.
    pub velocity: Vector,
    /// m/s^2.
    pub acceleration: Vector,
    /// m/s^3.
    pub jerk: Vector,
    /// Whether the velocity is given in the body's heading frame; a C `bool`, never looked at as a Rust one.
    pub velocity_body: u8,
    /// The modes, which choose the fields that count.
    pub mode: Modes,
}

impl Setpoint {
    /// The commander's null setpoint: motors off.
    pub const OFF: Self = {
        const VECTOR: Vector = Vector { timestamp: 0, x: 0.0, y: 0.0, z: 0.0 };
        const ANGLES: Attitude = Attitude { timestamp: 0, roll: 0.0, pitch: 0.0, yaw: 0.0 };
        const OFF: Mode = Mode::DISABLED;
        Self {
            timestamp: 0,
            attitude: ANGLES,
            attitude_rate: ANGLES,
            attitude_quaternion: Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 0.0 },
            thrust: 0.0,
            position: VECTOR,
            velocity: VECTOR,
            acceleration: VECTOR,
            jerk: VECTOR,
            velocity_body: 0,
            mode: Modes { x: OFF, y: OFF, z: OFF, roll: OFF, pitch: OFF, yaw: OFF, quat: OFF },
        }
    };
}

/// `control_t`: a union of three meanings and which of them holds. The legacy one is never written.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Control {
    /// Thrust (N) and torque (N m), or forces of the motors from 0 to 1.
    pub payload: [f32; 4],
    /// [`Self::FORCE_TORQUE`] or [`Self::FORCE`].
    pub control_mode: CEnum,
}

impl Control {
    /// `controlModeForceTorque`.
    pub const FORCE_TORQUE: CEnum = 1;
    /// `controlModeForce`.
    pub const FORCE: CEnum = 2;
}

/// Size of a setpoint and where its modes begin.
const SETPOINT_BYTES: usize = if cfg!(target_arch = "arm") { 128 } else { 152 };
const MODES_AT: usize = if cfg!(target_arch = "arm") { 121 } else { 124 };

macro_rules! assert_layout {
    ($type:ty, $size:expr, $($($field:ident).+ @ $offset:expr),+) => {
        const _: () = assert!(size_of::<$type>() == $size);
        $(const _: () = assert!(core::mem::offset_of!($type, $($field).+) == $offset);)+
    };
}

assert_layout!(Control, 20, payload @ 0, control_mode @ 16);
assert_layout!(State, 80, attitude @ 0, attitude_quaternion @ 16, position @ 32, velocity @ 48, acc @ 64);
assert_layout!(SensorData, 56, acc @ 0, gyro @ 12, mag @ 24, baro @ 36, interrupt_timestamp @ 48);
const _: () = assert!(align_of::<SensorData>() == 8);
assert_layout!(
    Setpoint, SETPOINT_BYTES,
    timestamp @ 0, attitude @ 4, attitude.roll @ 8, attitude_rate @ 20, attitude_quaternion @ 36, thrust @ 52,
    position @ 56, position.x @ 60, velocity @ 72, acceleration @ 88, jerk @ 104, velocity_body @ 120,
    mode @ MODES_AT, mode.y @ MODES_AT + size_of::<CEnum>(), mode.quat @ SETPOINT_BYTES - size_of::<CEnum>()
);
