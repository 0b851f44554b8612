//! The least a design asks of its certificate; the first figure that falls short is named.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::Certificate;
use super::limits::StabilityLimit;

/// What a design demands of the sampled loop. What is absent is not asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Minimum {
    /// Balanced disk margin alpha of each channel alone.
    pub disk_each: Option<f64>,
    /// Balanced disk margin alpha of all channels at once.
    pub disk_all: Option<f64>,
    /// Gain factor upwards of each channel, by the balanced disk.
    pub gain_factor_each: Option<f64>,
    /// Gain factor upwards of all channels at once, by the balanced disk.
    pub gain_factor_all: Option<f64>,
    /// Phase of each channel, rad, by the balanced disk.
    pub phase_each_rad: Option<f64>,
    /// Phase of all channels at once, rad, by the balanced disk.
    pub phase_all_rad: Option<f64>,
    /// Delay of all channels at once, s.
    pub delay_s: Option<f64>,
    /// First-order lag of all channels at once, s.
    pub lag_s: Option<f64>,
    /// Decay of the slowest pole, `-ln(spectral radius) / period`, 1/s.
    pub decay_1_s: Option<f64>,
}

/// A figure of the certificate below what the design asks for.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{figure} is {found:.6}; the design asks for at least {asked}")]
pub struct MarginTooSmall {
    /// Name of the figure, with its channel.
    pub figure: String,
    /// Its value.
    pub found: f64,
    /// What was asked for.
    pub asked: f64,
}

/// Holds a certificate against the least that is asked for.
///
/// The Lyapunov function must hold in any case.
///
/// # Errors
/// [`MarginTooSmall`] with the first figure that falls short.
pub fn require(certificate: &Certificate, minimum: &Minimum) -> Result<(), MarginTooSmall> {
    let at_least = |figure: &str, found: f64, asked: Option<f64>| match asked {
        // NaN on either side falls short.
        Some(asked) if found < asked || found.is_nan() || asked.is_nan() => {
            Err(MarginTooSmall { figure: figure.to_owned(), found, asked })
        }
        _ => Ok(()),
    };
    let sampled = &certificate.sampled;
    let holds = sampled.decrease.holds && certificate.continuous.as_ref().is_none_or(lyapunov_holds);
    at_least("decrease of the Lyapunov function (1 if it holds)", f64::from(u8::from(holds)), Some(1.0))?;
    let decay_1_s = -sampled.spectral_radius.ln() * certificate.rate_hz;
    at_least("decay of the slowest pole in 1/s", decay_1_s, minimum.decay_1_s)?;
    for margins in &sampled.margins.each {
        let (name, disk) = (&margins.channel, &margins.balanced);
        at_least(&format!("disk margin of {name}"), disk.alpha, minimum.disk_each)?;
        let gain = disk.gain_max.unwrap_or(f64::INFINITY);
        at_least(&format!("gain margin of {name}"), gain, minimum.gain_factor_each)?;
        at_least(&format!("phase margin of {name} in rad"), disk.phase_rad, minimum.phase_each_rad)?;
    }
    let all = &sampled.margins.all.balanced;
    at_least("disk margin of all channels at once", all.alpha, minimum.disk_all)?;
    at_least("gain margin of all channels at once", all.gain_max.unwrap_or(f64::INFINITY), minimum.gain_factor_all)?;
    at_least("phase margin of all channels at once in rad", all.phase_rad, minimum.phase_all_rad)?;
    at_least("largest delay of all channels at once in s", of_all(&certificate.delay), minimum.delay_s)?;
    at_least("largest lag of all channels at once in s", of_all(&certificate.lag), minimum.lag_s)
}

/// A loop that is unstable in continuous time is none that a Lyapunov function was asked of: its rate decides.
fn lyapunov_holds(figures: &super::ContinuousLoop) -> bool {
    figures.decrease.as_ref().is_none_or(|decrease| decrease.holds)
}

/// The limit of all channels at once stands last.
fn of_all(limits: &[StabilityLimit]) -> f64 {
    limits.last().map_or(0.0, |limit| limit.stable_to_s)
}
