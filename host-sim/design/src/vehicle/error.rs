//! Why there is no vehicle, in one line that names the field and the remedy.

/// Why there is no vehicle.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VehicleError {
    /// A name that the head of a table cannot carry.
    #[error("vehicle: name = \"{name}\": must be 1 to {longest} letters, digits or any of - . _")]
    Name {
        /// The name as read.
        name: String,
        /// Its longest length, bytes.
        longest: usize,
    },
    /// A figure out of range.
    #[error("vehicle: {field} = {value}: must be {must}")]
    Value {
        /// The key with its table.
        field: String,
        /// The figure as read.
        value: f64,
        /// The range that it must be in.
        must: String,
    },
}
