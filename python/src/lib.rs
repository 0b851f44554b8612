//! The quatrack crates as a Python package. Nothing is computed here: arguments are read and checked, the crates called, their
//! answers written.
//!
//! ```text
//! campaign          thousands of flights
//! flight            scenarios flown by name, by table or by a law of one's own
//!   own_law         a callable as a law
//!   plant           the plant of a scenario, for many crafts
//!     scenario
//! identify          logs in, figures of a craft out
//! reproduction      the paper's table
//! crazyflie         the Crazyflie object through its C interface
//! controller        the core's controller, for many crafts
//!   batch           one step of all of them
//!     law           a law with its borrowed parts
//! estimator
//! gains, trajectory, design
//!   player          a trajectory as a board plays it
//!   state, reference, vehicle
//!     long_call     without the interpreter's lock, ended by Ctrl-C
//!     values        dictionaries
//!     pickle        objects taken apart
//!     arrays        NumPy
//!       error
//! ```
#![expect(clippy::needless_pass_by_value, reason = "arguments of Python come by value")]

mod arrays;
mod batch;
mod campaign;
mod controller;
mod crazyflie;
mod design;
mod error;
mod estimator;
mod flight;
mod gains;
mod identify;
mod law;
mod long_call;
mod own_law;
mod pickle;
mod plant;
mod player;
mod reference;
mod reproduction;
mod scenario;
mod state;
mod trajectory;
mod values;
mod vehicle;

/// The module that Python imports; the package `quatrack` names it.
#[pyo3::pymodule]
mod _quatrack {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::campaign::campaign;
    #[pymodule_export]
    use crate::controller::{Controller, Step};
    #[pymodule_export]
    use crate::crazyflie::{CrazyflieControl, CrazyflieController};
    #[pymodule_export]
    use crate::design::{Feedback, care, certify, dare, dlqr, hover_model, lqr, lyapunov, stein};
    #[pymodule_export]
    use crate::error::QuatrackError;
    #[pymodule_export]
    use crate::estimator::Estimator;
    #[pymodule_export]
    use crate::flight::{Comparison, Flight, compare, fly};
    #[pymodule_export]
    use crate::gains::GainTable;
    #[pymodule_export]
    use crate::identify::{Identified, identify};
    #[pymodule_export]
    use crate::own_law::LawInput;
    #[pymodule_export]
    use crate::plant::Plant;
    #[pymodule_export]
    use crate::player::Player;
    #[pymodule_export]
    use crate::reference::Reference;
    #[pymodule_export]
    use crate::reproduction::{Reproduction, reproduce};
    #[pymodule_export]
    use crate::scenario::{Course, Scenario};
    #[pymodule_export]
    use crate::state::State;
    #[pymodule_export]
    use crate::trajectory::{Trajectory, plan};
    #[pymodule_export]
    use crate::vehicle::Vehicle;

    /// Version of the workspace.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    /// Looks up NumPy's array interface while the package is imported: an interrupt in the middle of that, at the first call, would be
    /// a panic.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        drop(numpy::PyArray1::<f64>::zeros(module.py(), 0, false));
        Ok(())
    }
}
