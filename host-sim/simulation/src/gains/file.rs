//! Design files: TOML in, their entries out, key by key. Entries that depend on each other are checked in
//! [`super::design`].

use quatrack_plan::quote::{is_plain, line_of, one_line, quoted};
use serde::Deserialize;

use super::GainsError;

/// A design as written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DesignFile {
    #[serde(default)]
    pub(super) description: String,
    pub(super) vehicle: String,
    pub(super) linearisation: Linearisation,
    pub(super) method: MethodName,
    pub(super) control_rate_hz: u32,
    pub(super) mu_1_s: Option<f64>,
    pub(super) delay_samples: Option<u32>,
    pub(super) trajectory: Option<String>,
    pub(super) rate_loop_gain_1_s: Option<f64>,
    pub(super) motor_lag_ms: Option<f64>,
    pub(super) air: Option<AirEntry>,
    pub(super) region: Option<RegionEntry>,
    pub(super) weights: Option<Weights>,
    #[serde(default)]
    pub(super) limits: LimitsEntry,
    #[serde(default)]
    pub(super) minimum: MinimumEntry,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Linearisation {
    Equilibrium,
    FlatOutput,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum MethodName {
    Lyapunov,
    Lqr,
    SampledLqr,
    Lqi,
    Along,
    ActuatorAware,
    Cascade,
}

/// The air that the cascade is told.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AirEntry {
    pub(super) drag_per_s: Option<f64>,
    pub(super) moment_n_m_per_m_s: Option<[f64; 2]>,
    pub(super) share_of_identified: Option<f64>,
    pub(super) gust: Option<f64>,
    pub(super) learn: Option<bool>,
}

/// Crafts, links and air that gains down to the motors must be stable on, besides their own.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RegionEntry {
    pub(super) from: Option<RegionSource>,
    pub(super) motor_lag_ms: Option<[f64; 2]>,
    pub(super) mass_percent: Option<f64>,
    pub(super) inertia_percent: Option<f64>,
    pub(super) delay_ms: Option<f64>,
    pub(super) force_percent: Option<[f64; 2]>,
    pub(super) drag_per_s: Option<f64>,
    pub(super) moment_n_m_per_m_s: Option<[f64; 2]>,
}

/// Where a region is taken from as far as its own keys do not say it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum RegionSource {
    /// The intervals of the vehicle's file.
    Identified,
}

/// Diagonal weights of errors and inputs, by group.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Weights {
    pub(super) position: Option<[f64; 3]>,
    pub(super) attitude: Option<[f64; 3]>,
    pub(super) velocity: Option<[f64; 3]>,
    pub(super) acceleration: Option<[f64; 3]>,
    pub(super) q3: Option<f64>,
    pub(super) position_integral: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 3]>,
    pub(super) body_rates: Option<[f64; 3]>,
    pub(super) force_input: Option<f64>,
    pub(super) thrust_input: Option<f64>,
    pub(super) body_rate_input: Option<[f64; 3]>,
    pub(super) acceleration_input: Option<[f64; 3]>,
    pub(super) jerk_input: Option<[f64; 3]>,
    pub(super) q3_rate_input: Option<f64>,
}

impl Weights {
    /// The first key that is given and that only a model without motors has.
    pub(super) fn of_the_paper_alone(&self) -> Option<&'static str> {
        let keys = [
            ("attitude", self.attitude.is_some()),
            ("acceleration", self.acceleration.is_some()),
            ("q3", self.q3.is_some()),
            ("thrust_input", self.thrust_input.is_some()),
            ("body_rate_input", self.body_rate_input.is_some()),
            ("acceleration_input", self.acceleration_input.is_some()),
            ("jerk_input", self.jerk_input.is_some()),
            ("q3_rate_input", self.q3_rate_input.is_some()),
        ];
        keys.into_iter().find(|(_, given)| *given).map(|(key, _)| key)
    }
}

/// Limits tighter than the vehicle's.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LimitsEntry {
    pub(super) thrust_min_m_s2: Option<f64>,
    pub(super) thrust_max_m_s2: Option<f64>,
    pub(super) body_rates_max_rad_s: Option<[f64; 3]>,
}

/// The least that the design asks of its certificate, at the control rate and of all channels at once unless it says
/// `each`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MinimumEntry {
    pub(super) gain_factor_each: Option<f64>,
    pub(super) gain_factor_all: Option<f64>,
    pub(super) phase_each_deg: Option<f64>,
    pub(super) phase_all_deg: Option<f64>,
    pub(super) delay_ms: Option<f64>,
    pub(super) motor_lag_ms: Option<f64>,
    pub(super) decay_1_s: Option<f64>,
}

impl std::fmt::Display for Linearisation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Equilibrium => "linearisation = \"equilibrium\"",
            Self::FlatOutput => "linearisation = \"flat-output\"",
        })
    }
}

impl MethodName {
    /// The value as it is written.
    pub(super) fn quoted(self) -> &'static str {
        match self {
            Self::Lyapunov => "\"lyapunov\"",
            Self::Lqr => "\"lqr\"",
            Self::SampledLqr => "\"sampled-lqr\"",
            Self::Lqi => "\"lqi\"",
            Self::Along => "\"along\"",
            Self::ActuatorAware => "\"actuator-aware\"",
            Self::Cascade => "\"cascade\"",
        }
    }
}

impl std::fmt::Display for MethodName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "method = {}", self.quoted())
    }
}

pub(super) fn read(text: &str) -> Result<DesignFile, GainsError> {
    let file: DesignFile = toml::from_str(text).map_err(|error| {
        let line = line_of(text, &error);
        let written = quoted(text.lines().nth(line - 1).unwrap_or_default().trim());
        GainsError::Syntax { line, written, reason: one_line(error.message()) }
    })?;
    match file.description.chars().find(|c| *c != '\n' && !is_plain(*c)) {
        None => Ok(file),
        Some(c) => Err(GainsError::Value {
            key: "description".to_owned(),
            value: format!("a text with U+{:04X}", u32::from(c)),
            must: "plain text: it becomes a comment in Rust, where such a character turns or hides the rest".to_owned(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_description_is_plain_text() {
        let design = |description: &str| {
            read(&format!(
                "description = \"{description}\"\nvehicle = \"crazyflie-2.1\"\nlinearisation = \"equilibrium\"\n\
                 method = \"lqr\"\ncontrol_rate_hz = 500"
            ))
        };
        assert!(design("The paper's, in two\\nlines: 3 \u{b5}s").is_ok());
        for bad in ["\\r", "\\u0000", "\\u001b[2J", "\u{202e}", "\\u2066", "\\u200f", "\\t", "\\u2028"] {
            let error = design(bad).unwrap_err().to_string();
            assert!(error.starts_with("description = a text with U+"), "{error}");
        }
    }

    #[test]
    fn an_error_quotes_a_line_and_not_a_book() {
        let error = read(&format!("vehicle = {}", "x".repeat(100_000))).unwrap_err().to_string();
        assert!(error.len() < 600, "{} bytes", error.len());
    }
}
