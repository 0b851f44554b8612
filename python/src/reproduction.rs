//! The paper's Table I, flown anew.

use pyo3::prelude::*;
use quatrack_simulation::reproduction::report::Reproduction as Flown;
use serde_json::Value;

use crate::error::refused;
use crate::long_call::long_call;
use crate::trajectory::by_name;
use crate::values::from_json;

/// The paper's Table I beside ours: the output of `quatrack reproduce`, and its numbers.
#[pyclass(frozen, module = "quatrack")]
pub(crate) struct Reproduction {
    text: String,
    report: Value,
    cells: usize,
}

/// Plans the paper's two trajectories from their waypoints, designs its four gains, and flies every cell of its Table I.
///
/// Returns a Reproduction.
#[pyfunction]
pub(crate) fn reproduce(py: Python<'_>) -> PyResult<Reproduction> {
    let work = || -> Result<Reproduction, String> {
        let flown = Flown::fly(&by_name("mild")?, &by_name("aggressive")?).map_err(|error| error.to_string())?;
        let report = serde_json::to_value(flown.report()).map_err(|error| error.to_string())?;
        Ok(Reproduction { text: flown.to_string(), report, cells: flown.reproduced_cells() })
    };
    long_call(py, move |_| work())?.map_err(refused)
}

#[pymethods]
impl Reproduction {
    /// How many of the eight cells round to the digits that are printed.
    #[getter]
    fn reproduced_cells(&self) -> usize {
        self.cells
    }

    /// IAE in m s by trajectory and controller: paper, as_published, exact, core_f32 by rate, feed_forward.
    #[getter]
    fn iae<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_json(py, &self.report["iae"])
    }

    fn __str__(&self) -> &str {
        &self.text
    }
}
