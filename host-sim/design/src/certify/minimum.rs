//! The least a design asks of its certificate; the first figure that falls short is named.

use serde::Serialize;
use thiserror::Error;

use super::Certificate;
use super::limits::StabilityLimit;

/// The least figures that a design demands of the sampled loop; an absent one is not demanded.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
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
    /// Motor lag of all channels at once, s: first order, and inside the rate loop where that was certified.
    pub lag_s: Option<f64>,
    /// Decay of the slowest pole, `-ln(spectral radius) / period`, 1/s.
    pub decay_1_s: Option<f64>,
}

/// The unit of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// No unit.
    Number,
    /// rad; told in degrees.
    Phase,
    /// s; told in ms.
    Duration,
    /// 1/s.
    Decay,
}

/// A figure of the certificate that a design may put a least value to.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Name of the figure, with its channel.
    pub figure: String,
    /// Its unit.
    pub quantity: Quantity,
    /// Its value; infinite where there is no limit.
    pub found: f64,
    /// The least that was asked for.
    pub asked: Option<f64>,
}

/// A figure of the certificate below the design's minimum.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{figure} is {}; the design asks for at least {}", .quantity.told(*.found), .quantity.told(*.asked))]
pub struct MarginTooSmall {
    /// Name of the figure, with its channel.
    pub figure: String,
    /// Its unit.
    pub quantity: Quantity,
    /// Its value.
    pub found: f64,
    /// The figure that was demanded.
    pub asked: f64,
}

impl Quantity {
    /// A value in the unit that people give it in, and that unit.
    pub fn in_unit(self, value: f64) -> (f64, &'static str) {
        let (value, unit) = match self {
            Self::Number => (value, ""),
            Self::Phase => (value.to_degrees(), "deg"),
            Self::Duration => (value * 1e3, "ms"),
            Self::Decay => (value, "1/s"),
        };
        // Millionths are more than anybody asks for; the rounding of the conversion of units is less.
        (if value.is_finite() { (value * 1e6).round() / 1e6 } else { value }, unit)
    }

    fn told(self, value: f64) -> String {
        let (value, unit) = self.in_unit(value);
        if unit.is_empty() { value.to_string() } else { format!("{value} {unit}") }
    }
}

impl Judged {
    /// Whether it reaches its minimum; NaN on either side falls short.
    pub fn holds(&self) -> bool {
        self.asked.is_none_or(|asked| self.found >= asked)
    }
}

/// Holds a certificate against the least that is asked for.
///
/// The Lyapunov function must hold in any case.
///
/// # Errors
/// [`MarginTooSmall`] with the first figure that falls short.
pub fn require(certificate: &Certificate, minimum: &Minimum) -> Result<(), MarginTooSmall> {
    match judge(certificate, minimum).into_iter().find(|judged| !judged.holds()) {
        Some(Judged { figure, quantity, found, asked }) => {
            Err(MarginTooSmall { figure, quantity, found, asked: asked.unwrap_or(f64::NAN) })
        }
        None => Ok(()),
    }
}

/// Every figure that a design can bound, beside the minimum of this one, always in the same order.
pub fn judge(certificate: &Certificate, minimum: &Minimum) -> Vec<Judged> {
    let mut figures = Vec::new();
    let mut add = |figure: String, quantity: Quantity, found: f64, asked: Option<f64>| {
        figures.push(Judged { figure, quantity, found, asked });
    };
    let sampled = &certificate.sampled;
    let holds = sampled.decrease.holds && certificate.continuous.as_ref().is_none_or(lyapunov_holds);
    let decrease = "decrease of the Lyapunov function (1 if it holds)".to_owned();
    add(decrease, Quantity::Number, f64::from(u8::from(holds)), Some(1.0));
    let decay_1_s = -sampled.spectral_radius.ln() * certificate.rate_hz;
    add("decay of the slowest pole".to_owned(), Quantity::Decay, decay_1_s, minimum.decay_1_s);
    for margins in &sampled.margins.each {
        let (name, disk) = (&margins.channel, &margins.balanced);
        add(format!("disk margin of {name}"), Quantity::Number, disk.alpha, minimum.disk_each);
        let gain = disk.gain_max.unwrap_or(f64::INFINITY);
        add(format!("gain margin of {name}"), Quantity::Number, gain, minimum.gain_factor_each);
        add(format!("phase margin of {name}"), Quantity::Phase, disk.phase_rad, minimum.phase_each_rad);
    }
    let all = &sampled.margins.all.balanced;
    let of_all = |figure: &str| format!("{figure} of all channels at once");
    add(of_all("disk margin"), Quantity::Number, all.alpha, minimum.disk_all);
    add(of_all("gain margin"), Quantity::Number, all.gain_max.unwrap_or(f64::INFINITY), minimum.gain_factor_all);
    add(of_all("phase margin"), Quantity::Phase, all.phase_rad, minimum.phase_all_rad);
    add(of_all("largest delay"), Quantity::Duration, of_all_channels(&certificate.delay), minimum.delay_s);
    add(of_all("largest motor lag"), Quantity::Duration, of_all_channels(&certificate.lag), minimum.lag_s);
    if let Some(limits) = &certificate.motors_in_rate_loop {
        let name = "largest motor lag inside the rate loop".to_owned();
        add(name, Quantity::Duration, of_all_channels(limits), minimum.lag_s);
    }
    figures
}

/// A loop that is unstable in continuous time is none that a Lyapunov function was asked of: its rate decides.
fn lyapunov_holds(figures: &super::ContinuousLoop) -> bool {
    figures.decrease.as_ref().is_none_or(|decrease| decrease.holds)
}

/// The limit of all channels at once is the last.
fn of_all_channels(limits: &[StabilityLimit]) -> f64 {
    limits.last().map_or(0.0, |limit| limit.stable_to_s)
}
