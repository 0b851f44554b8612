//! Dictionaries in, as the text of a file; a report's values out, as dictionaries.

use std::path::PathBuf;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString};
use serde_json::Value as Json;
use toml::{Table, Value};

use crate::error::refused;

/// A file that a command reads: by its path, or its contents as a dictionary.
pub(crate) enum Source {
    Path(PathBuf),
    Text(String),
}

impl Source {
    /// From a path (str or os.PathLike) or a dictionary with the keys of the file.
    pub(crate) fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(dictionary) = value.cast::<PyDict>() {
            let text = toml::to_string(&table(name, dictionary, DEEPEST)?)
                .map_err(|error| PyTypeError::new_err(format!("{name}: {error}")))?;
            return Ok(Self::Text(text));
        }
        match value.extract::<PathBuf>() {
            Ok(path) => Ok(Self::Path(path)),
            Err(_) => {
                let kind = value.get_type().name()?;
                Err(PyTypeError::new_err(format!(
                    "{name}: {kind}; give a path, or a dictionary with the keys of the file"
                )))
            }
        }
    }
}

/// How deep dictionaries and lists may lie in each other: one that holds itself is refused.
const DEEPEST: u32 = 16;

fn table(path: &str, dictionary: &Bound<'_, PyDict>, left: u32) -> PyResult<Table> {
    let mut table = Table::new();
    for (key, value) in dictionary {
        let key: String =
            key.extract().map_err(|_| PyTypeError::new_err(format!("{path}: key {key}; keys are text")))?;
        // A key whose value is None is as absent.
        if !value.is_none() {
            let entry = entry(&format!("{path}.{key}"), &value, left)?;
            table.insert(key, entry);
        }
    }
    Ok(table)
}

fn entry(path: &str, value: &Bound<'_, PyAny>, left: u32) -> PyResult<Value> {
    let Some(left) = left.checked_sub(1) else {
        return Err(PyTypeError::new_err(format!("{path}: deeper than any file is")));
    };
    if let Ok(dictionary) = value.cast::<PyDict>() {
        return table(path, dictionary, left).map(Value::Table);
    }
    if value.is_instance_of::<PyString>() {
        return value.extract().map(Value::String);
    }
    if value.is_instance_of::<PyBool>() {
        return value.extract().map(Value::Boolean);
    }
    if value.is_instance_of::<PyInt>() {
        return whole(path, value).map(Value::Integer);
    }
    if value.is_instance_of::<PyFloat>() {
        return value.extract().map(Value::Float);
    }
    // Arrays and numbers of NumPy convert themselves to Python's own types.
    if value.hasattr("tolist")? {
        return entry(path, &value.call_method0("tolist")?, left);
    }
    if let Ok(items) = value.try_iter() {
        return items.map(|item| entry(path, &item?, left)).collect::<PyResult<_>>().map(Value::Array);
    }
    if value.hasattr("__fspath__")? {
        return value.call_method0("__fspath__")?.extract().map(Value::String);
    }
    Err(PyTypeError::new_err(format!("{path}: {}; give a number, text, list or dictionary", value.get_type().name()?)))
}

/// A whole number as a file has them: TOML's are of 64 bits with a sign.
fn whole(path: &str, value: &Bound<'_, PyAny>) -> PyResult<i64> {
    value.extract().map_err(|_| {
        let is_seed = path.rsplit('.').next() == Some("seed");
        let seed = if is_seed { "; Scenario.with_seed and campaign's seed take more, to 2^64 - 1" } else { "" };
        refused(format!("{path}: {value}; must be from {} to {}, as in a file{seed}", i64::MIN, i64::MAX))
    })
}

/// A seed of an argument.
pub(crate) fn seed(value: &Bound<'_, PyAny>) -> PyResult<u64> {
    if !value.hasattr("__index__")? {
        return Err(PyTypeError::new_err(format!("seed: {}; give a whole number", value.get_type().name()?)));
    }
    value.extract().map_err(|_| refused(format!("seed: {value}; must be from 0 to {}", u64::MAX)))
}

/// A value of a report.
pub(crate) fn from_json<'py>(py: Python<'py>, value: &Json) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Json::Null => py.None().into_bound(py),
        Json::Bool(value) => PyBool::new(py, *value).to_owned().into_any(),
        Json::Number(number) => match number.as_i64() {
            Some(whole) => whole.into_pyobject(py)?.into_any(),
            None => PyFloat::new(py, number.as_f64().unwrap_or(f64::NAN)).into_any(),
        },
        Json::String(text) => PyString::new(py, text).into_any(),
        Json::Array(items) => {
            let items = items.iter().map(|item| from_json(py, item)).collect::<PyResult<Vec<_>>>()?;
            PyList::new(py, items)?.into_any()
        }
        Json::Object(entries) => {
            let dictionary = PyDict::new(py);
            for (key, value) in entries {
                dictionary.set_item(key, from_json(py, value)?)?;
            }
            dictionary.into_any()
        }
    })
}
