//! Why there is no plant: a key, its value, its range and a remedy, in one line.

/// A figure of a plant that is out of range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value}: must be {range} ({remedy})")]
pub struct PlantError {
    /// The key, as in a scenario file.
    pub key: &'static str,
    /// The figure.
    pub value: f64,
    /// The range that it must be in.
    pub range: String,
    /// Its meaning, or a remedy.
    pub remedy: &'static str,
}

/// Nothing, or why not.
pub(super) type Checked = Result<(), PlantError>;

impl PlantError {
    pub(super) fn new(key: &'static str, value: f64, range: impl Into<String>, remedy: &'static str) -> Self {
        Self { key, value, range: range.into(), remedy }
    }
}

/// A NaN makes every comparison false and so never passes.
pub(super) fn within(key: &'static str, value: f64, least: f64, most: f64, remedy: &'static str) -> Checked {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(PlantError::new(key, value, format!("from {least} to {most}"), remedy))
    }
}

pub(super) fn positive(key: &'static str, value: f64, most: f64, remedy: &'static str) -> Checked {
    if value > 0.0 && value <= most {
        Ok(())
    } else {
        Err(PlantError::new(key, value, format!("above 0, up to {most}"), remedy))
    }
}
