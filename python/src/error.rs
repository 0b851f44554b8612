//! Errors as exceptions, with the text of the command.

use std::fmt::Display;

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

create_exception!(
    quatrack,
    QuatrackError,
    PyValueError,
    "A refusal of the crates: one line that names the fault, its place and the remedy. It is a ValueError."
);

/// An error of a crate as the exception.
pub(crate) fn refused(error: impl Display) -> PyErr {
    QuatrackError::new_err(error.to_string())
}

/// The same of one craft among many.
pub(crate) fn refused_of(craft: Option<usize>, error: impl Display) -> PyErr {
    match craft {
        None => refused(error),
        Some(craft) => refused(format!("craft {craft}: {error}")),
    }
}
