//! The body-rate loop: commanded thrust and body rates, and the gyroscope's, in; thrust and torque out.
//!
//! `torque = I k (rates_cmd - rates) + rates x (I rates)`: feedback that makes every rate follow with its bandwidth k, and
//! the gyroscopic torque cancelled, so that the axes do not see each other. It carries the paper's input `[T p q r]` to
//! a craft with inertia; thrust is multiplied by the mass.

use core::fmt;

use nalgebra::Vector3;

use crate::airframe::Airframe;
use crate::command::Command;
use crate::mixer::Wrench;

/// Bandwidths for a craft's inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyRateLoop {
    mass_kg: f32,
    /// `I k`, N m s.
    gain: [f32; 3],
    /// `(Iz - Iy, Ix - Iz, Iy - Ix)`, kg m^2.
    gyroscopic_kg_m2: [f32; 3],
}

/// A bandwidth that is not a positive number up to [`BodyRateLoop::BANDWIDTH_MAX_RAD_S`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BandwidthError {
    /// The bandwidth, rad/s.
    pub bandwidth_rad_s: f32,
}

impl fmt::Display for BandwidthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let max = BodyRateLoop::BANDWIDTH_MAX_RAD_S;
        write!(f, "body-rate loop: bandwidth {} rad/s; must be above 0 and at most {max}", self.bandwidth_rad_s)
    }
}

impl core::error::Error for BandwidthError {}

impl BodyRateLoop {
    /// Beyond it a loop of 1 kHz would not be stable even with motors that answer at once, rad/s.
    pub const BANDWIDTH_MAX_RAD_S: f32 = 1000.0;

    /// A loop with a bandwidth about each of body x, y, z, rad/s.
    ///
    /// # Errors
    /// [`BandwidthError`].
    pub const fn new(airframe: &Airframe, bandwidth_rad_s: [f32; 3]) -> Result<Self, BandwidthError> {
        let mut rest: &[f32] = &bandwidth_rad_s;
        while let Some((bandwidth_rad_s, after)) = rest.split_first() {
            if !(*bandwidth_rad_s > 0.0 && *bandwidth_rad_s <= Self::BANDWIDTH_MAX_RAD_S) {
                return Err(BandwidthError { bandwidth_rad_s: *bandwidth_rad_s });
            }
            rest = after;
        }
        Ok(Self::with(airframe, bandwidth_rad_s))
    }

    /// The fastest loop that the motors' lag leaves well damped: `k = 1 / (2 lag)` about every axis, the bandwidth at which
    /// `k / (s (lag s + 1))` closes with a damping of `1 / sqrt 2`. At most [`Self::BANDWIDTH_MAX_RAD_S`].
    pub const fn behind_lag(airframe: &Airframe) -> Self {
        let fastest = 0.5 / airframe.figures().motor_lag_s;
        Self::with(airframe, [if fastest < Self::BANDWIDTH_MAX_RAD_S { fastest } else { Self::BANDWIDTH_MAX_RAD_S }; 3])
    }

    const fn with(airframe: &Airframe, bandwidth_rad_s: [f32; 3]) -> Self {
        let figures = airframe.figures();
        let ([ix, iy, iz], [kx, ky, kz]) = (figures.inertia_kg_m2, bandwidth_rad_s);
        Self {
            mass_kg: figures.mass_kg,
            gain: [ix * kx, iy * ky, iz * kz],
            gyroscopic_kg_m2: [iz - iy, ix - iz, iy - ix],
        }
    }

    /// Thrust and torque for a command, at measured body rates (rad/s).
    #[inline(always)]
    pub fn wrench(&self, command: &Command, body_rates_rad_s: &Vector3<f32>) -> Wrench {
        let (rates, asked) = (body_rates_rad_s, &command.body_rates_rad_s);
        let ([kx, ky, kz], [gx, gy, gz]) = (self.gain, self.gyroscopic_kg_m2);
        Wrench {
            thrust_n: self.mass_kg * command.thrust_m_s2,
            torque_n_m: Vector3::new(
                kx * (asked.x - rates.x) + gx * (rates.y * rates.z),
                ky * (asked.y - rates.y) + gy * (rates.x * rates.z),
                kz * (asked.z - rates.z) + gz * (rates.x * rates.y),
            ),
        }
    }
}
