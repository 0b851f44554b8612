//! The core's controller, for one craft or for many at once.

use std::num::NonZeroUsize;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use quatrack::{ErrorForm, FeedForward};

use crate::arrays::array;
use crate::batch::{self, Craft, Given, Inputs};
use crate::error::refused_of;
use crate::law::{Options, OwnedLaw};
use crate::reference::Reference;
use crate::state::State;

/// A law of the core with its memory, of one craft or of many; to be stepped at its rate. It is neither copied nor pickled.
///
/// law: "quatrack" (the cascade), "actuator-aware", "lqr-e", "lyap-e", "lqr-f", "lyap-f", or a GainTable of any kind
/// vehicle: a Vehicle, a name, a path or the keys of a vehicle file; laws of motor forces need it, the paper's end with thrust and
///     body rates without it
/// mass_kg, lag_s: figures that the law is told where they differ from its file, kg and s
/// drag_per_s, moment_n_m_per_m_s: the air that the cascade is told, 1/s and N m per m/s; all four in the ranges of a scenario's [told]
/// feed_forward: whether the paper's laws add the reference's own input
/// error_form: "heading" or "paper", how the E laws form their error
/// standing: whether the flight begins on the ground with the motors off; in the air at hover otherwise
/// threads: at most so many for many crafts; as many as there are processors where left out
#[pyclass(module = "quatrack")]
pub(crate) struct Controller {
    law: OwnedLaw,
    standing: bool,
    threads: usize,
    /// The leading axis of the steps so far, and the memory of each craft; none before the first step.
    crafts: Option<(Option<usize>, Vec<Craft>)>,
}

#[pymethods]
impl Controller {
    #[new]
    #[pyo3(signature = (law, vehicle=None, *, mass_kg=None, lag_s=None, drag_per_s=None, moment_n_m_per_m_s=None,
        feed_forward=true, error_form="heading", standing=false, threads=None))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword")]
    fn new(
        law: &Bound<'_, PyAny>,
        vehicle: Option<&Bound<'_, PyAny>>,
        mass_kg: Option<f64>,
        lag_s: Option<f64>,
        drag_per_s: Option<f64>,
        moment_n_m_per_m_s: Option<[f64; 2]>,
        feed_forward: bool,
        error_form: &str,
        standing: bool,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let options = Options {
            vehicle,
            mass_kg,
            lag_s,
            drag_per_s,
            moment_n_m_per_m_s,
            feed_forward: if feed_forward { FeedForward::With } else { FeedForward::Without },
            error_form: match error_form {
                "heading" => ErrorForm::HeadingFrame,
                "paper" => ErrorForm::Paper,
                other => return Err(PyValueError::new_err(format!("error_form: {other}; there are heading, paper"))),
            },
        };
        let there_are = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        Ok(Self {
            law: OwnedLaw::new(law, &options)?,
            standing,
            threads: threads.unwrap_or_else(there_are).max(1),
            crafts: None,
        })
    }

    /// One control step.
    ///
    /// state: State of one craft or of N, always as many
    /// reference: Reference of as many rows, or of one for all
    /// on_fault: "raise" raises QuatrackError with the first craft that gets no answer and why; "nan" leaves NaN in its rows. Its
    ///     memory is as it was; the other crafts have moved on either way
    ///
    /// Returns a Step.
    #[pyo3(signature = (state, reference, *, on_fault="raise"))]
    fn step(&mut self, py: Python<'_>, state: &State, reference: &Reference, on_fault: &str) -> PyResult<Step> {
        let raises = match on_fault {
            "raise" => true,
            "nan" => false,
            other => return Err(PyValueError::new_err(format!("on_fault: {other}; there are raise, nan"))),
        };
        if reference.crafts.is_some() && reference.len() != state.len() {
            return Err(PyValueError::new_err(format!(
                "reference: {} rows, but state has {}; give as many, or one for all",
                reference.len(),
                state.len()
            )));
        }
        let (leading, crafts) = self.crafts.get_or_insert_with(|| {
            let craft = Craft::new(self.law.memory(self.standing));
            (state.crafts, vec![craft; state.len()])
        });
        if *leading != state.crafts {
            return Err(PyValueError::new_err(format!(
                "state: {}, but the steps before were of {}; make another controller, or reset() this one",
                said(state.crafts),
                said(*leading)
            )));
        }
        let (law, threads) = (&self.law, self.threads);
        let inputs = Inputs { state, reference, rate: law.rate };
        let (given, fault) = if crafts.len() < batch::WORTH_RELEASING {
            law.with_controller(|controller| batch::step(controller, inputs, threads, crafts))?
        } else {
            py.detach(|| law.with_controller(|controller| batch::step(controller, inputs, threads, crafts)))?
        };
        if let (true, Some((row, reason))) = (raises, fault) {
            return Err(refused_of(state.crafts.map(|_| row), reason));
        }
        Ok(Step { crafts: state.crafts, given })
    }

    /// Forgets the flight so far: of all crafts, or of those where a mask of shape (N,) is true.
    #[pyo3(signature = (mask=None))]
    fn reset(&mut self, mask: Option<Vec<bool>>) -> PyResult<()> {
        let Some(mask) = mask else {
            self.crafts = None;
            return Ok(());
        };
        let Some((_, crafts)) = &mut self.crafts else { return Ok(()) };
        if mask.len() != crafts.len() {
            return Err(PyValueError::new_err(format!("mask: {} rows for {} crafts", mask.len(), crafts.len())));
        }
        for (craft, _) in crafts.iter_mut().zip(mask).filter(|(_, is_reset)| *is_reset) {
            *craft = Craft::new(self.law.memory(self.standing));
        }
        Ok(())
    }

    /// Name of the law or of its table.
    #[getter]
    fn law(&self) -> &str {
        &self.law.name
    }

    /// Control steps a second that it is made for.
    #[getter]
    fn rate_hz(&self) -> u32 {
        self.law.rate.hz()
    }

    /// How many crafts it has stepped; None before the first step and for one.
    #[getter]
    fn crafts(&self) -> Option<usize> {
        self.crafts.as_ref().and_then(|(leading, _)| *leading)
    }

    /// Forces that the motors should have by now, N; shape (4,) or (N, 4), None before the first step.
    #[getter]
    fn motor_forces<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some((leading, crafts)) = &self.crafts else { return Ok(None) };
        let forces: Vec<[f32; 4]> = crafts.iter().map(|craft| craft.memory.forces_n()).collect();
        array(py, *leading, forces).map(Some)
    }

    /// Drag over mass (1/s) and the air's moment c_x, c_y (N s) that the cascade flies with, told and learned; shape (3,) or (N, 3).
    #[getter]
    fn air<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let (Some(cascade), Some((leading, crafts))) = (self.law.cascade(), &self.crafts) else { return Ok(None) };
        let air = |craft: &Craft| {
            let (drag, [c_x, c_y]) = cascade.air(craft.memory.cascade());
            [drag, c_x, c_y]
        };
        let rows: Vec<[f32; 3]> = crafts.iter().map(air).collect();
        array(py, *leading, rows).map(Some)
    }

    /// For pickle and copy: refused, since a copy without its memory would fly on as if it had just started.
    fn __reduce__(&self) -> PyResult<()> {
        Err(PyTypeError::new_err(
            "Controller: its memory of the flight is not copied; make another from the same arguments, a GainTable and a \
             Vehicle among them can be copied, and begin its flight anew",
        ))
    }

    fn __repr__(&self) -> String {
        format!("Controller({:?} at {} Hz)", self.law.name, self.law.rate.hz())
    }
}

fn said(crafts: Option<usize>) -> String {
    crafts.map_or_else(|| "one craft".to_owned(), |crafts| format!("{crafts} crafts"))
}

/// The output of a step, for one craft or for many; single precision, as the core computes it.
#[pyclass(frozen, module = "quatrack")]
pub(crate) struct Step {
    crafts: Option<usize>,
    given: Vec<Given>,
}

impl Step {
    fn column<'py, T: numpy::Element + Copy, const W: usize>(
        &self,
        py: Python<'py>,
        of: impl Fn(&Given) -> [T; W],
    ) -> PyResult<Bound<'py, PyAny>> {
        let rows: Vec<[T; W]> = self.given.iter().map(of).collect();
        array(py, self.crafts, rows)
    }
}

#[pymethods]
impl Step {
    /// Commanded forces of M1 to M4, N; shape (4,) or (N, 4). NaN where the law ends with thrust and body rates.
    #[getter]
    fn motor_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, |given| given.forces)
    }

    /// Commanded thrust over mass, m/s^2; shape () or (N,). NaN where the law gives motor forces at once.
    #[getter]
    fn thrust<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, |given| [given.command[0]])
    }

    /// Commanded body rates p, q, r, rad/s; shape (3,) or (N, 3). NaN likewise.
    #[getter]
    fn body_rates<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, |Given { command: [_, p, q, r], .. }| [*p, *q, *r])
    }

    /// The limits that cut the output, as bits; 0 is nothing. Shape () or (N,).
    #[getter]
    fn limited<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, |given| [given.limited])
    }
}
