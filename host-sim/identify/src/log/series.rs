//! Series of times and values by name.

use std::collections::BTreeMap;

/// One quantity over time; both as long.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// As in the file; the map knows the unit.
    pub times: Vec<f64>,
    /// NaN where the file has no number.
    pub values: Vec<f64>,
}

/// All that a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct RawLog {
    /// The file.
    pub name: String,
    /// By the names of columns or variables.
    pub series: BTreeMap<String, Series>,
    /// Whether times come with every variable, in milliseconds, as on the micro SD deck; else they are a column.
    pub timed: bool,
}
