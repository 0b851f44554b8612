//! Figures of a craft from logs of its flights.

use std::path::PathBuf;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use quatrack_identify::log::ColumnMap;
use quatrack_identify::{Report, vehicle_toml};
use quatrack_plan::bounded;
use serde_json::Value;

use crate::error::refused;
use crate::long_call::long_call;
use crate::values::{Source, from_json};
use crate::vehicle;

/// What logs tell of a craft: figures with 95 % intervals, those that they do not tell with the manoeuvre that would, and how well the
/// last quarter of each flight is predicted.
#[pyclass(frozen, module = "quatrack")]
pub(crate) struct Identified {
    document: Value,
    text: String,
    vehicle: String,
}

/// Identifies a craft from logs of its flights.
///
/// logs: paths of CSV files, plain or by gzip, or of the micro SD deck's binary logs; or the path of one
/// columns: "cflib", "nanobench" or "usd", the path of a map of columns, or its keys as a dictionary
/// vehicle: whose arm, limits and torque per thrust are believed; the map's where left out, else the Crazyflie 2.1
/// mass_kg: as flown; the map's where left out, else the vehicle's
///
/// Returns an Identified. docs/identify.md says what to fly and what to log.
#[pyfunction]
#[pyo3(signature = (logs, *, columns=None, vehicle=None, mass_kg=None))]
pub(crate) fn identify(
    py: Python<'_>,
    logs: &Bound<'_, PyAny>,
    columns: Option<&Bound<'_, PyAny>>,
    vehicle: Option<&Bound<'_, PyAny>>,
    mass_kg: Option<f64>,
) -> PyResult<Identified> {
    let logs = paths(logs)?;
    let map = map(columns)?;
    let named = || map.vehicle.as_deref().unwrap_or("crazyflie-2.1").to_owned();
    let craft = match vehicle {
        Some(vehicle) => vehicle::argument(vehicle)?,
        None => quatrack_simulation::vehicles::by_name(&named()).map_err(refused)?,
    };
    let mass_kg = mass_kg.or(map.mass_kg).unwrap_or_else(|| craft.mass_kg());
    let work = move || -> Result<Identified, String> {
        let report = quatrack_identify::identify(&logs, &map, &craft, mass_kg).map_err(|error| error.to_string())?;
        let Report { fit, logs, .. } = &report;
        Ok(Identified {
            vehicle: vehicle_toml(fit, &craft, logs).map_err(|error| error.to_string())?,
            document: serde_json::to_value(report.document()).map_err(|error| error.to_string())?,
            text: report.text(),
        })
    };
    long_call(py, move |_| work())?.map_err(refused)
}

/// The path of one log, or those of many.
fn paths(logs: &Bound<'_, PyAny>) -> PyResult<Vec<PathBuf>> {
    if let Ok(path) = logs.extract::<PathBuf>() {
        return Ok(vec![path]);
    }
    let kind = |value: &Bound<'_, PyAny>| value.get_type().name().map_or("?".to_owned(), |name| name.to_string());
    let refused = |kind: String| PyTypeError::new_err(format!("logs: {kind}; give a path, or a list of paths"));
    let logs = logs.try_iter().map_err(|_| refused(kind(logs)))?;
    logs.map(|log| log.and_then(|log| log.extract().map_err(|_| refused(format!("{} among them", kind(&log))))))
        .collect()
}

fn map(columns: Option<&Bound<'_, PyAny>>) -> PyResult<ColumnMap> {
    let Some(columns) = columns else { return ColumnMap::built_in("cflib").ok_or_else(|| refused("no map cflib")) };
    if let Some(map) = columns.extract::<String>().ok().and_then(|name| ColumnMap::built_in(&name)) {
        return Ok(map);
    }
    match Source::read("columns", columns)? {
        Source::Path(path) => {
            let name = path.display().to_string();
            let text =
                bounded::read_to_string(&path).map_err(|error| refused(format!("{name}: cannot be read ({error})")))?;
            ColumnMap::parse(&text, &name)
        }
        Source::Text(text) => ColumnMap::parse(&text, "columns"),
    }
    .map_err(refused)
}

#[pymethods]
impl Identified {
    /// By name, each in the unit of its name: value, low and high, or None where the flights do not tell it.
    #[getter]
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_json(py, &self.document["figures"])
    }

    /// By the names of figures that are not told: why, and the manoeuvre that would tell.
    #[getter]
    fn refused<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_json(py, &self.document["refused"])
    }

    /// Mean errors 0.5 s ahead on the last quarter of each flight: ours, no_angular_acceleration, no_change.
    #[getter]
    fn prediction<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_json(py, &self.document["prediction"])
    }

    /// What was found in the logs, in words.
    #[getter]
    fn notes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_json(py, &self.document["notes"])
    }

    /// Built-in tables of the vehicle: whether the craft is inside what each is certified for, and by what it is not.
    #[getter]
    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_json(py, &self.document["tables"])
    }

    /// The text of a vehicle file with each figure's interval and source: what designs take.
    #[getter]
    fn vehicle_toml(&self) -> &str {
        &self.vehicle
    }

    fn __str__(&self) -> &str {
        &self.text
    }
}
