//! Intervals of figures that were identified from flights: a design may take them for its region.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::VehicleError;
use super::check::check;

/// Table `identified`: by the names that `quatrack identify` gives its figures, each in the unit of its name.
pub type Identified = BTreeMap<String, Interval>;

/// Where a figure lies with a probability of 95 %.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Its source.
    pub source: String,
}

pub(super) fn sound(identified: &Identified) -> Result<(), VehicleError> {
    for (name, Interval { low, high, .. }) in identified {
        // A printed name stays on one line.
        let plain: String = name.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
        let field = format!("identified.{plain}");
        check(low.is_finite(), &format!("{field}.low"), *low, "a number")?;
        check(high.is_finite() && high >= low, &format!("{field}.high"), *high, format!("at least low, {low}"))?;
    }
    Ok(())
}
