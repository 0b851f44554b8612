//! The certificate that a table carries on board, as a short document: figures rounded to the safe side, the same on every
//! processor.
//!
//! f64 figures differ in their last digits between processors with and without fused multiplication; a hash or an f32
//! must not. So a figure is first moved to the safe side by [`GUARD`], far more than those digits, and then rounded down
//! to four digits: figures that are round numbers by design (a phase of 60 degrees, a delay of one sample) are no
//! longer on the edge of a digit.

use quatrack::gains::table::{self, Hash, Margins};
use quatrack_design::certify::{Certificate, StabilityLimit};
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::design::Design;
use super::designed::Designed;

/// Share of a figure that is taken off before it is rounded down.
const GUARD: f64 = 1e-6;
/// Unit of the distance from the f64 gain, which is rounded up.
const DISTANCE_UNIT: f64 = 1e-10;

/// The document of which a table carries the hash.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BoardCertificate {
    format: &'static str,
    design_sha256: String,
    control_rate_hz: u32,
    delay_samples: usize,
    gain_f32: Vec<Vec<f32>>,
    /// Disk margins, least of the channels, each disturbed alone.
    one_channel: MarginsStated,
    /// Disk margins, all channels disturbed at once.
    all_channels: MarginsStated,
    delay_max_s: f64,
    motor_lag_max_s: f64,
    /// Largest difference from the f64 gain over its largest entry.
    f32_distance: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct MarginsStated {
    gain_factor: f64,
    phase_rad: f64,
}

impl BoardCertificate {
    pub(super) fn new(design: &Design, design_sha256: &Hash, designed: &Designed, certificate: &Certificate) -> Self {
        let each = certificate.sampled.margins.each.iter().map(|channel| channel.balanced);
        let largest = table::Certificate::GAIN_FACTOR_MAX;
        let stated = |gain: f64, phase_rad: f64| MarginsStated {
            gain_factor: safe(gain.min(f64::from(largest))),
            phase_rad: safe(phase_rad),
        };
        let one_channel = each.fold((f64::INFINITY, f64::INFINITY), |(gain, phase_rad), disk| {
            (gain.min(disk.gain_max.unwrap_or(f64::INFINITY)), phase_rad.min(disk.phase_rad))
        });
        let all = &certificate.sampled.margins.all.balanced;
        let lags = certificate.lag.iter().chain(certificate.motors_in_rate_loop.iter().flatten());
        let distance = certificate.rounding.largest_absolute / designed.gains.dense().amax();
        Self {
            format: "quatrack certificate 1",
            design_sha256: design_sha256.to_string(),
            control_rate_hz: design.rate.hz(),
            delay_samples: certificate.delay_samples,
            gain_f32: designed.gains.by_rows(),
            one_channel: stated(one_channel.0, one_channel.1),
            all_channels: stated(all.gain_max.unwrap_or(f64::INFINITY), all.phase_rad),
            delay_max_s: safe(least(certificate.delay.iter())),
            motor_lag_max_s: safe(least(lags)),
            f32_distance: (distance / DISTANCE_UNIT + GUARD).ceil() * DISTANCE_UNIT,
        }
    }

    /// SHA-256 of the document as compact JSON.
    pub(super) fn hash(&self) -> Hash {
        sha256(self)
    }

    /// The certificate in a table's form.
    pub(super) fn on_board(&self) -> table::Certificate {
        let margins = |stated: &MarginsStated| Margins {
            gain_factor: stated.gain_factor as f32,
            phase_rad: stated.phase_rad as f32,
        };
        table::Certificate {
            hash: self.hash(),
            one_channel: margins(&self.one_channel),
            all_channels: margins(&self.all_channels),
            delay_max_s: self.delay_max_s as f32,
            motor_lag_max_s: self.motor_lag_max_s as f32,
            f32_distance: self.f32_distance as f32,
        }
    }
}

/// Of a value as compact JSON, which is the same text everywhere: keys in the order of their declaration, the shortest
/// digits that read back as the same number.
pub(super) fn sha256(value: &impl Serialize) -> Hash {
    // Structs of numbers and strings are written without fail.
    let text = serde_json::to_string(value).unwrap_or_default();
    Hash(Sha256::digest(text.as_bytes()).into())
}

fn least<'a>(limits: impl Iterator<Item = &'a StabilityLimit>) -> f64 {
    limits.map(|limit| limit.stable_to_s).fold(f64::INFINITY, f64::min)
}

/// At least [`GUARD`] below a positive figure, as a decimal of four digits.
fn safe(figure: f64) -> f64 {
    let below = figure * (1.0 - GUARD);
    if !(below.is_finite() && below > 0.0) {
        return 0.0;
    }
    let exponent = below.log10().floor() as i32 - 3;
    // Read from its decimal, so that it is the f64 next to it and no product's.
    format!("{}e{exponent}", (below / 10_f64.powi(exponent)).floor()).parse().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_stated_below_the_computed_ones_and_the_same_around_round_numbers() {
        assert_eq!(safe(1.234_567), 1.234);
        assert_eq!(safe(0.017_091_3), 0.017_09);
        assert_eq!(safe(999.96), 999.9);
        // A round number and its neighbours of rounding: all on one side of the edge.
        for figure in [2.0, 0.1, 1e-3, 1e3, 1.047] {
            for last_digits in [-1e-12, 0.0, 1e-12] {
                let found = figure * (1.0 + last_digits);
                assert_eq!(safe(found), safe(figure), "{figure}");
                assert!(safe(found) < found && safe(found) >= 0.9989 * found, "{figure}");
                assert!(f64::from(safe(found) as f32) < found, "as an f32");
            }
        }
        assert_eq!(safe(f64::NAN), 0.0);
    }
}
