//! The variables behind the firmware's parameters and logs: one C struct of atomics, which every task may read and write.
//!
//! `quatrack.h` has the same struct in C, field by field.

use core::sync::atomic::{AtomicI16, AtomicU8, AtomicU16, AtomicU32, Ordering::Relaxed};

use quatrack::Leash;

/// An `f32` that tasks may share: a C `float` in memory.
#[repr(transparent)]
#[derive(Debug)]
pub struct AtomicF32(AtomicU32);

impl AtomicF32 {
    /// Holding a value.
    pub const fn new(value: f32) -> Self {
        Self(AtomicU32::new(value.to_bits()))
    }

    /// Its value.
    pub fn get(&self) -> f32 {
        f32::from_bits(self.0.load(Relaxed))
    }

    /// Gives it a value.
    pub fn set(&self, value: f32) {
        self.0.store(value.to_bits(), Relaxed);
    }
}

/// Parameters, log variables and the gains in use.
#[repr(C)]
#[derive(Debug)]
pub struct Shared {
    /// Set by the owner.
    pub parameters: Parameters,
    /// Shown to the owner.
    pub log: Log,
    /// Learned in flight.
    pub learned: Learned,
    /// The gains that are flown, read-only.
    pub gains: Gains,
}

/// Set by the owner; a value out of range counts as the nearest one in it, and a NaN is put back to its default:
/// for the air the craft's own, which is known once the app has said which craft this is.
#[repr(C)]
#[derive(Debug)]
pub struct Parameters {
    /// Stiffness of the cascade in position; of the paper's laws a factor on the feedback of thrust, roll and pitch.
    pub position_scale: AtomicF32,
    /// Factor on the paper's laws' feedback about the vertical.
    pub yaw_scale: AtomicF32,
    /// Farthest error that the paper's laws act on: of position, m, and of velocity, m/s.
    pub leash_m: AtomicF32,
    /// Largest speed of a velocity setpoint, m/s.
    pub speed_m_s: AtomicF32,
    /// Largest acceleration of a velocity setpoint, m/s^2.
    pub acceleration_m_s2: AtomicF32,
    /// Largest roll and pitch rate that a law may command through the body-rate loop, rad/s.
    pub roll_pitch_rate_rad_s: AtomicF32,
    /// Largest yaw rate, likewise, rad/s.
    pub yaw_rate_rad_s: AtomicF32,
    /// Time constant of this craft's motors as its owner knows it, s; 0: the published figures alone.
    pub motor_lag_s: AtomicF32,
    /// Linear drag over mass that is told, 1/s.
    pub drag_per_s: AtomicF32,
    /// Airflow moment about body x over the velocity along body y that is told, N s.
    pub moment_x_n_s: AtomicF32,
    /// The same about y and along x, N s.
    pub moment_y_n_s: AtomicF32,
    /// Share of the wind's moment that is fed forward.
    pub gust: AtomicF32,
    /// Speed over ground with which the cascade makes a position error good, m/s.
    pub goal_speed_m_s: AtomicF32,
    /// The same up and down, m/s.
    pub goal_climb_m_s: AtomicF32,
    /// Its largest tilt on the way, degrees.
    pub tilt_deg: AtomicF32,
    /// The table to fly, by its number.
    pub table: AtomicU8,
    /// Whether the paper's laws are fed forward.
    pub feed_forward: AtomicU8,
    /// Whether drag and moment are corrected in flight.
    pub learn: AtomicU8,
}

impl Parameters {
    /// Number of those that are floats.
    pub const FLOATS: usize = 15;

    /// Sets all that are floats.
    pub fn set_all(&self, value: f32) {
        self.floats().iter().for_each(|parameter| parameter.set(value));
    }

    /// All that are floats, in order.
    pub(crate) const fn floats(&self) -> [&AtomicF32; Self::FLOATS] {
        [
            &self.position_scale,
            &self.yaw_scale,
            &self.leash_m,
            &self.speed_m_s,
            &self.acceleration_m_s2,
            &self.roll_pitch_rate_rad_s,
            &self.yaw_rate_rad_s,
            &self.motor_lag_s,
            &self.drag_per_s,
            &self.moment_x_n_s,
            &self.moment_y_n_s,
            &self.gust,
            &self.goal_speed_m_s,
            &self.goal_climb_m_s,
            &self.tilt_deg,
        ]
    }
}

/// Written by the controller: 26 bytes that matter, for one log packet, then counters and figures for others.
#[repr(C)]
#[derive(Debug)]
pub struct Log {
    /// Position error, measured less asked, mm, world frame.
    pub error_mm: [AtomicI16; 3],
    /// Rotation error, mrad, body frame.
    pub rotation_mrad: [AtomicI16; 3],
    /// Forces that the motors should have, thousandths of the largest; 0 under a law of thrust and torque.
    pub forces: [AtomicU16; 4],
    /// The limits that cut the last step, see `quatrack.h`.
    pub limited: AtomicU16,
    /// Processor cycles of the last step.
    pub cycles: AtomicU16,
    /// How the last setpoint is flown.
    pub mode: AtomicU8,
    /// The table in use.
    pub table: AtomicU8,
    /// Steps on estimates or gyroscope readings that had to be bridged.
    pub bad_states: AtomicU16,
    /// Setpoints that make no sense: to rest, or level, and slowly down.
    pub bad_setpoints: AtomicU16,
    /// Steps on which something was given up.
    pub limited_steps: AtomicU16,
    /// Setpoints that were not where the ones before led.
    pub jumps: AtomicU16,
    /// Tables that were asked for or sent and are not flown.
    pub refused_tables: AtomicU16,
    /// Why the last of them was not, see `quatrack.h`.
    pub refusal: AtomicU16,
    /// Parameters that were NaN and were put back to their defaults.
    pub put_back: AtomicU16,
    /// Which of them was the last, counted from 1 in the order of [`Parameters`].
    pub parameter: AtomicU16,
    /// Why the newest flight was last left, see `quatrack.h`.
    pub reason: AtomicU16,
}

/// The figures that the cascade has learned in flight and flies with.
#[repr(C)]
#[derive(Debug)]
pub struct Learned {
    /// Drag over mass, 1/s.
    pub drag_per_s: AtomicF32,
    /// Airflow moment about body x and y over the velocity along y and x, N s.
    pub moment_n_s: [AtomicF32; 2],
    /// Force of the motors as a share of the commanded one.
    pub motor_share: AtomicF32,
    /// Disturbance: x and y in the world frame and along the thrust, m/s^2.
    pub disturbance_m_s2: [AtomicF32; 3],
    /// Whether the craft is taken to stand on the ground, 1, or to fly, 0.
    pub stands: AtomicF32,
}

/// Read-only: the gain in use, as flown (scales included).
#[repr(C)]
#[derive(Debug)]
pub struct Gains {
    /// The smallest and the largest factor on the feedback that is taken.
    pub scale_min: AtomicF32,
    /// See [`Self::scale_min`].
    pub scale_max: AtomicF32,
    /// Entries of the gain: thrust from z, vz, force, integral of z; roll from y, vy, rotation, rate, force, integral of y;
    /// pitch from x likewise; yaw from rotation, rate, force. Zero where a law has none.
    pub entries: [AtomicF32; GAINS],
}

/// Entries of [`Gains`].
pub const GAINS: usize = 19;

const _: () = assert!(size_of::<Parameters>() == 64 && size_of::<Log>() == 44);
const _: () = assert!(core::mem::offset_of!(Log, bad_states) == 26, "one log packet");

impl Shared {
    /// As it is when the craft is switched on.
    pub(crate) const fn new() -> Self {
        Self {
            parameters: Parameters {
                position_scale: AtomicF32::new(1.0),
                yaw_scale: AtomicF32::new(1.0),
                leash_m: AtomicF32::new(Leash::STANDARD.length_m),
                speed_m_s: AtomicF32::new(1.5),
                acceleration_m_s2: AtomicF32::new(4.0),
                roll_pitch_rate_rad_s: AtomicF32::new(20.0),
                yaw_rate_rad_s: AtomicF32::new(10.0),
                motor_lag_s: AtomicF32::new(0.0),
                drag_per_s: AtomicF32::new(f32::NAN),
                moment_x_n_s: AtomicF32::new(f32::NAN),
                moment_y_n_s: AtomicF32::new(f32::NAN),
                gust: AtomicF32::new(f32::NAN),
                goal_speed_m_s: AtomicF32::new(f32::NAN),
                goal_climb_m_s: AtomicF32::new(f32::NAN),
                tilt_deg: AtomicF32::new(f32::NAN),
                table: AtomicU8::new(0),
                feed_forward: AtomicU8::new(1),
                learn: AtomicU8::new(1),
            },
            log: Log {
                error_mm: [const { AtomicI16::new(0) }; 3],
                rotation_mrad: [const { AtomicI16::new(0) }; 3],
                forces: [const { AtomicU16::new(0) }; 4],
                limited: AtomicU16::new(0),
                cycles: AtomicU16::new(0),
                mode: AtomicU8::new(0),
                table: AtomicU8::new(0),
                bad_states: AtomicU16::new(0),
                bad_setpoints: AtomicU16::new(0),
                limited_steps: AtomicU16::new(0),
                jumps: AtomicU16::new(0),
                refused_tables: AtomicU16::new(0),
                refusal: AtomicU16::new(0),
                put_back: AtomicU16::new(0),
                parameter: AtomicU16::new(0),
                reason: AtomicU16::new(0),
            },
            learned: Learned {
                drag_per_s: AtomicF32::new(0.0),
                moment_n_s: [const { AtomicF32::new(0.0) }; 2],
                motor_share: AtomicF32::new(1.0),
                disturbance_m_s2: [const { AtomicF32::new(0.0) }; 3],
                stands: AtomicF32::new(0.0),
            },
            gains: Gains {
                scale_min: AtomicF32::new(1.0),
                scale_max: AtomicF32::new(1.0),
                entries: [const { AtomicF32::new(0.0) }; GAINS],
            },
        }
    }
}
