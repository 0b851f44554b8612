//! Tables of gains: bytes, files, designs and built-in ones.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};
use quatrack::gains::table::GainTable as CoreTable;
use quatrack_plan::bounded;
use quatrack_simulation::gains::Table;
use quatrack_simulation::gains::{Design, json_document};

use crate::arrays::shaped;
use crate::error::refused;
use crate::long_call::long_call;
use crate::pickle::{Reduced, by_constructor};
use crate::values::{Source, from_json};

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        /// The tables of `gains/generated`, by their designs' names.
        const BUILT_IN: &[(&str, &[u8])] =
            &[$(($name, include_bytes!(concat!("../../gains/generated/", $name, ".bin")))),*];
    };
}

built_in!(
    "along-aggressive",
    "along-mild",
    "cascade-100ms",
    "cascade-20ms",
    "cascade-63ms",
    "cascade-brushless-110ms",
    "cascade-brushless-20ms",
    "cascade-brushless-50ms",
    "cascade-kit-100ms",
    "cascade-kit-20ms",
    "cascade-kit-63ms",
    "lqi-e",
    "lqr-e",
    "lqr-f",
    "lyap-e",
    "lyap-f",
    "sampled-lqr-e",
    "sampled-lqr-e-100hz",
    "sampled-lqr-f",
);

/// Gains with their vehicle, rate, limits and certificate, as a board loads them.
///
/// bytes: those of a file; GainTable.load reads one, GainTable.builtin knows those of the repository
#[pyclass(frozen, module = "quatrack")]
#[derive(Clone)]
pub(crate) struct GainTable {
    pub(crate) bytes: Vec<u8>,
    table: Table,
}

impl GainTable {
    fn read(bytes: &[u8], origin: Option<&Path>) -> PyResult<Self> {
        let table = Table::from_bytes(bytes).map_err(|error| match origin {
            Some(path) => refused(format!("{}: {error}", path.display())),
            None => refused(error),
        })?;
        Ok(Self { bytes: bytes.to_vec(), table })
    }

    /// As the core reads it.
    pub(crate) fn core(&self) -> PyResult<CoreTable<'_>> {
        CoreTable::from_bytes(&self.bytes).map_err(refused)
    }
}

#[pymethods]
impl GainTable {
    #[new]
    fn new(bytes: &[u8]) -> PyResult<Self> {
        Self::read(bytes, None)
    }

    /// Names of the built-in tables.
    #[classmethod]
    fn names(_cls: &Bound<'_, PyType>) -> Vec<&'static str> {
        BUILT_IN.iter().map(|(name, _)| *name).collect()
    }

    /// A built-in table, by its design's name.
    #[classmethod]
    fn builtin(_cls: &Bound<'_, PyType>, name: &str) -> PyResult<Self> {
        let found = BUILT_IN.iter().find(|(known, _)| *known == name).ok_or_else(|| {
            let known: Vec<&str> = BUILT_IN.iter().map(|(name, _)| *name).collect();
            refused(format!("table {name}: not built in; there are {}", known.join(", ")))
        })?;
        Self::read(found.1, None)
    }

    /// From a file (.bin).
    #[classmethod]
    fn load(_cls: &Bound<'_, PyType>, path: PathBuf) -> PyResult<Self> {
        let bytes = bounded::read(&path).map_err(|error| {
            refused(format!("{}: cannot be read ({error}); name an existing table", path.display()))
        })?;
        Self::read(&bytes, Some(&path))
    }

    /// Makes the gains of a design, certifies them as they are flown, and refuses them below the design's own margins.
    #[classmethod]
    #[pyo3(signature = (design, name="design"))]
    fn design(cls: &Bound<'_, PyType>, design: &Bound<'_, PyAny>, name: &str) -> PyResult<Self> {
        let (origin, read) = match Source::read("design", design)? {
            Source::Path(path) => (path.display().to_string(), Design::from_file(&path)),
            Source::Text(text) => (name.to_owned(), Design::from_toml(name, &text, Path::new(""))),
        };
        let design = read.map_err(|error| refused(format!("{origin}: {error}")))?;
        let certified =
            long_call(cls.py(), move |_| design.certify())?.map_err(|error| refused(format!("{origin}: {error}")))?;
        let bytes = certified.to_bytes().ok_or_else(|| refused(format!("{origin}: {}", certified.why_no_table())))?;
        Self::read(&bytes, None)
    }

    /// The whole certificate of a design, with its gains, as `gains design` writes it.
    #[classmethod]
    #[pyo3(signature = (design, name="design"))]
    fn certificate_of<'py>(
        cls: &Bound<'py, PyType>,
        design: &Bound<'py, PyAny>,
        name: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (origin, read) = match Source::read("design", design)? {
            Source::Path(path) => (path.display().to_string(), Design::from_file(&path)),
            Source::Text(text) => (name.to_owned(), Design::from_toml(name, &text, Path::new(""))),
        };
        let design = read.map_err(|error| refused(format!("{origin}: {error}")))?;
        let certified =
            long_call(cls.py(), move |_| design.certify())?.map_err(|error| refused(format!("{origin}: {error}")))?;
        from_json(cls.py(), &json_document(&certified))
    }

    /// As the bytes of a file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.bytes)
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        self.table.head().name.as_str()
    }

    /// The law that it is for.
    #[getter]
    fn kind(&self) -> String {
        self.table.kind().to_string()
    }

    /// The vehicle that it was made for.
    #[getter]
    fn vehicle(&self) -> &str {
        self.table.head().vehicle.name.as_str()
    }

    /// The control rate that it was certified at, Hz.
    #[getter]
    fn rate_hz(&self) -> u32 {
        self.table.head().rate.hz()
    }

    /// The motor lag that it was designed for, s, where it reckons with one.
    #[getter]
    fn motor_lag_s(&self) -> Option<f32> {
        self.table.motor_lag_s()
    }

    /// The gain as flown; shape (rows, columns), or (knots, rows, columns) along a trajectory.
    #[getter]
    fn gain<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (rows, columns) = self.table.kind().dimensions();
        let entries: Vec<f32> = self.table.by_rows().concat();
        let mut shape = vec![usize::from(rows), usize::from(columns)];
        if let Some(along) = self.table.along() {
            shape.insert(0, along.gains.len());
        }
        shaped(py, &shape, entries)
    }

    /// The certificate that the table states: margins, delay and lag.
    #[getter]
    fn certificate<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let certificate = &self.table.head().certificate;
        let dictionary = PyDict::new(py);
        dictionary.set_item("gain_factor_one_channel", certificate.one_channel.gain_factor)?;
        dictionary.set_item("phase_rad_one_channel", certificate.one_channel.phase_rad)?;
        dictionary.set_item("gain_factor_all_channels", certificate.all_channels.gain_factor)?;
        dictionary.set_item("phase_rad_all_channels", certificate.all_channels.phase_rad)?;
        dictionary.set_item("delay_max_s", certificate.delay_max_s)?;
        dictionary.set_item("motor_lag_max_s", certificate.motor_lag_max_s)?;
        dictionary.set_item("f32_distance", certificate.f32_distance)?;
        Ok(dictionary)
    }

    /// For pickle and copy: its bytes.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        by_constructor::<Self>(py, (self.to_bytes(py),))
    }

    fn __repr__(&self) -> String {
        format!("GainTable({:?}, {} for {} at {} Hz)", self.name(), self.kind(), self.vehicle(), self.rate_hz())
    }
}
