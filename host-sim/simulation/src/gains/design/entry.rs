//! One entry of a design file: its range, and the refusal that names it.

use crate::gains::GainsError;

/// Range of weights, of mu and of the rate loop's gain: far beyond any craft, and no product of them overflows.
const LARGEST: f64 = 1e9;
/// Shortest positive figure.
const SMALLEST: f64 = 1e-9;

pub(super) fn check(holds: bool, key: &str, value: f64, must: impl Into<String>) -> Result<(), GainsError> {
    // A NaN makes every comparison false and so never passes.
    if holds {
        Ok(())
    } else {
        Err(GainsError::Value { key: key.to_owned(), value: value.to_string(), must: must.into() })
    }
}

pub(super) fn positive(key: &str, value: f64) -> Result<(), GainsError> {
    check((SMALLEST..=LARGEST).contains(&value), key, value, format!("from {SMALLEST:e} to {LARGEST:e}"))
}

pub(super) fn non_negative(key: &str, value: f64) -> Result<(), GainsError> {
    let holds = value == 0.0 || (SMALLEST..=LARGEST).contains(&value);
    check(holds, key, value, format!("0, or from {SMALLEST:e} to {LARGEST:e}"))
}

pub(super) fn misplaced(key: &str, value: &dyn ToString, with: &dyn ToString) -> GainsError {
    GainsError::Misplaced { key: key.to_owned(), value: value.to_string(), with: with.to_string() }
}

pub(super) fn missing(key: &str, with: &dyn ToString, example: &'static str) -> GainsError {
    GainsError::Missing { key: key.to_owned(), with: with.to_string(), example }
}
