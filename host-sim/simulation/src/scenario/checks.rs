//! Values of one file within their ranges, or why not.

use std::fmt;

use quatrack_plan::quote::plain;

use super::error::ScenarioError;

/// Checks values of one file.
pub(super) struct Checks<'a> {
    /// The file's name.
    pub(super) origin: &'a str,
}

impl Checks<'_> {
    pub(super) fn refuse(&self, key: &'static str, value: &dyn fmt::Display, must: String) -> ScenarioError {
        ScenarioError::Value { origin: self.origin.to_owned(), key, value: plain(&value.to_string()), must }
    }

    /// A value within bounds, both included; the default where there is none. NaN is within no bounds.
    pub(super) fn one(
        &self,
        key: &'static str,
        value: Option<f64>,
        default: f64,
        [least, most]: [f64; 2],
        meaning: &str,
    ) -> Result<f64, ScenarioError> {
        let value = value.unwrap_or(default);
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        Err(self.refuse(key, &value, format!("from {least} to {most}, {meaning}")))
    }

    /// Likewise every component.
    pub(super) fn each<const N: usize>(
        &self,
        key: &'static str,
        values: Option<[f64; N]>,
        bounds: [f64; 2],
        meaning: &str,
    ) -> Result<[f64; N], ScenarioError> {
        let values = values.unwrap_or([0.0; N]);
        values.iter().try_for_each(|value| self.one(key, Some(*value), 0.0, bounds, meaning).map(|_| ()))?;
        Ok(values)
    }
}
