//! Why nothing was identified, in one line that names the file, the place and the remedy.

/// Why nothing was identified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// A file that cannot be read.
    #[error("{path}: cannot be read ({reason})")]
    Unreadable {
        /// The file.
        path: String,
        /// The system's words.
        reason: String,
    },
    /// A file that is no log.
    #[error("{path}: {reason}")]
    Format {
        /// The file.
        path: String,
        /// The fault and the remedy.
        reason: String,
    },
    /// A map of columns that says something without sense.
    #[error("{map}: {reason}")]
    Map {
        /// The map's name or file.
        map: String,
        /// The fault and the remedy.
        reason: String,
    },
    /// A column that the map names and the log does not have.
    #[error(
        "{path}: no column \"{column}\" for the {quantity}; the log has {present}; give --columns a map for this log"
    )]
    Column {
        /// The file.
        path: String,
        /// The column.
        column: String,
        /// The quantity that it was to hold.
        quantity: &'static str,
        /// The first of those that are there.
        present: String,
    },
    /// No log holds enough flight.
    #[error("{0}")]
    TooLittle(String),
    /// A mass that is not that of the vehicle, nor near it.
    #[error(
        "mass = {mass_kg} kg: {vehicle} has {own_kg} kg, and a craft with its arms a third to three times that: 27 g are 0.027; \
         or give another --vehicle"
    )]
    Mass {
        /// As given, kg.
        mass_kg: f64,
        /// Of the vehicle, kg.
        own_kg: f64,
        /// The vehicle.
        vehicle: String,
    },
    /// Figures that make no vehicle.
    #[error("the figures make no vehicle file: {0}")]
    Vehicle(String),
    /// A figure that was given from outside.
    #[error("{field} = {value}: must be {must}")]
    Value {
        /// The field.
        field: &'static str,
        /// The value given.
        value: f64,
        /// Its required range, in words.
        must: &'static str,
    },
}
