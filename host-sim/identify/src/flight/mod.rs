//! A flight on one even grid: a log's series in; checked, cleaned and aligned signals in SI, cut where the craft flies, out.
//!
//! ```text
//! sections   stretches in the air without a gap
//!   motors   whether their columns are in order
//!   tilt     errors of an estimator, mended
//!     inertial  attitude and velocity by gyroscope, accelerometer and position together
//!     align  the shift between the on-board streams and the pose
//!     check  which reading of the attitude agrees with the other signals
//!       units  units and signs of the others
//!         signals  correlation and gain of two signals
//!       grid   one grid of 100 Hz
//!         streams  which column holds what, in which unit
//!           clean  codes, outliers, repeats
//! copies     files that hold the same flight
//! ```

mod align;
mod check;
mod clean;
mod copies;
mod grid;
mod inertial;
mod motors;
mod sections;
mod signals;
mod streams;
mod tilt;
mod units;

use nalgebra::{UnitQuaternion, Vector3};

pub use copies::without_copies;
pub use sections::prepare;

/// Step of the grid, s. Identification uses frequencies below 6 Hz.
pub const STEP_S: f64 = 0.01;
/// Rate of the grid, Hz.
pub const RATE_HZ: f64 = 100.0;

/// Corrections of a log and doubts about it, in words for its owner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Notes(pub Vec<String>);

/// A flight.
#[derive(Clone, Debug)]
pub struct Flight {
    /// Its file.
    pub name: String,
    /// Parts in the air without a gap.
    pub sections: Vec<Section>,
    /// By how much the pose comes later than the on-board streams, s.
    pub pose_shift_s: f64,
    /// Median time between two samples of the motors' commands, the gyroscope or the accelerometer: the longest of the three, s.
    pub period_s: f64,
    /// Root mean square of the on-board position against the pose, after the shift, m; where a log has both.
    pub estimate_rms_m: Option<f64>,
    /// Findings about the log.
    pub notes: Notes,
    /// Whether the log has a voltage.
    pub has_voltage: bool,
}

/// Signals of a part of a flight; all as long.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Since the log's beginning, s.
    pub start_s: f64,
    /// World frame, m.
    pub position: Vec<Vector3<f64>>,
    /// World frame, m/s.
    pub velocity: Vec<Vector3<f64>>,
    /// Body to world.
    pub attitude: Vec<UnitQuaternion<f64>>,
    /// Body frame, rad/s.
    pub gyro: Vec<Vector3<f64>>,
    /// Specific force, body frame, m/s^2.
    pub specific_force: Vec<Vector3<f64>>,
    /// Commands as shares of a full one, from 0 to 1.
    pub commands: [Vec<f64>; 4],
    /// V; empty where the log has none.
    pub voltage: Vec<f64>,
}

impl Section {
    /// The number of points of the grid.
    pub fn len(&self) -> usize {
        self.gyro.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.gyro.is_empty()
    }

    /// The points of a range.
    pub fn part(&self, range: std::ops::Range<usize>) -> Self {
        Self {
            start_s: self.start_s + range.start as f64 * STEP_S,
            position: self.position[range.clone()].to_vec(),
            velocity: self.velocity[range.clone()].to_vec(),
            attitude: self.attitude[range.clone()].to_vec(),
            gyro: self.gyro[range.clone()].to_vec(),
            specific_force: self.specific_force[range.clone()].to_vec(),
            commands: self.commands.each_ref().map(|command| command[range.clone()].to_vec()),
            voltage: if self.voltage.is_empty() { Vec::new() } else { self.voltage[range].to_vec() },
        }
    }

    /// Velocity in the body frame, m/s.
    pub fn body_velocity(&self) -> Vec<Vector3<f64>> {
        self.attitude.iter().zip(&self.velocity).map(|(q, v)| q.inverse_transform_vector(v)).collect()
    }
}
