//! A law of one's own in Python, as the simulation flies it; and any law with an end by Ctrl-C.

use nalgebra::Vector4;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatrack_plan::trajectory::fifth_order::FifthOrder;
use quatrack_simulation::control_law::{ControlLaw, Input, STEPS_HZ};

use crate::arrays::Quantity;
use crate::error::refused;
use crate::long_call::Cancelled;
use crate::reference::Reference;
use crate::state::State;

/// The inputs of a law at a control step.
#[pyclass(frozen, module = "quatrack")]
pub(crate) struct LawInput(Input);

#[pymethods]
impl LawInput {
    /// Now, s since the start of the flight.
    #[getter]
    fn time(&self) -> f64 {
        self.0.time_s
    }

    /// Time at which the setpoint was sent, s.
    #[getter]
    fn sent(&self) -> f64 {
        self.0.setpoint.sent_s
    }

    /// Voltage of the battery, V; 0 where nothing depends on it.
    #[getter]
    fn battery_voltage(&self) -> f64 {
        self.0.battery_v
    }

    /// Where the craft is, as far as anybody on board knows, with gyroscope and accelerometer.
    #[getter]
    fn state(&self) -> State {
        State::of_estimates(None, std::iter::once(&self.0.estimate))
    }

    /// The setpoint as it was sent.
    #[getter]
    fn setpoint(&self) -> Reference {
        let s = &self.0.setpoint;
        let position = [s.position_m, s.velocity_m_s, s.acceleration_m_s2, s.jerk_m_s3, s.snap_m_s4, s.crackle_m_s5];
        let heading = [s.heading_rad, s.heading_rate_rad_s, 0.0, 0.0];
        self.known(&FifthOrder { position, heading })
    }

    /// The setpoint carried on to now by its own derivatives.
    #[getter]
    fn reference(&self) -> Reference {
        self.known(&self.0.setpoint.carried_to(self.0.time_s))
    }
}

impl LawInput {
    /// A point whose snap is only given where the setpoint has one.
    fn known(&self, point: &FifthOrder) -> Reference {
        let setpoint = &self.0.setpoint;
        let mut reference = Reference::of_points(None, std::slice::from_ref(point));
        if setpoint.snap_m_s4.norm() == 0.0 && setpoint.crackle_m_s5.norm() == 0.0 {
            reference.beyond = None;
        }
        reference
    }
}

/// A callable that flies.
pub(crate) struct OwnLaw {
    callable: Py<PyAny>,
    rate_hz: u32,
    /// The exception that it raised: the flight ends there.
    pub(crate) raised: Option<PyErr>,
}

impl OwnLaw {
    /// From a callable; its attribute `rate_hz` says how often it is called, 500 times a second by default.
    pub(crate) fn new(callable: &Bound<'_, PyAny>) -> PyResult<Self> {
        let rate_hz = match callable.getattr_opt("rate_hz")? {
            Some(rate) => rate.extract()?,
            None => 500,
        };
        if rate_hz == 0 || !STEPS_HZ.is_multiple_of(rate_hz) {
            return Err(PyValueError::new_err(format!("rate_hz: {rate_hz}; must divide {STEPS_HZ}")));
        }
        // A law with a memory forgets an earlier flight.
        if let Some(reset) = callable.getattr_opt("reset")? {
            reset.call0()?;
        }
        Ok(Self { callable: callable.clone().unbind(), rate_hz, raised: None })
    }
}

impl ControlLaw for OwnLaw {
    fn rate_hz(&self) -> u32 {
        self.rate_hz
    }

    fn step(&mut self, input: &Input) -> Result<Vector4<f64>, String> {
        let forces = Python::attach(|py| -> PyResult<Vector4<f64>> {
            py.check_signals()?;
            let given = self.callable.bind(py).call1((LawInput(*input),))?;
            let forces = Quantity::<4>::read("motor forces of the law", &given)?;
            if forces.crafts.is_some() {
                return Err(PyValueError::new_err("motor forces of the law: many rows; give shape (4,)"));
            }
            let row = forces.row(0);
            if row.iter().all(|force| force.is_finite()) {
                Ok(Vector4::from(row))
            } else {
                Err(refused(format!("motor forces of the law: {row:?}; must be finite")))
            }
        });
        forces.map_err(|error| {
            let reason = error.to_string();
            self.raised = Some(error);
            reason
        })
    }
}

/// A law that gives up when it is told.
pub(crate) struct Interruptible<'a> {
    pub(crate) law: &'a mut dyn ControlLaw,
    pub(crate) cancelled: &'a Cancelled,
}

impl ControlLaw for Interruptible<'_> {
    fn rate_hz(&self) -> u32 {
        self.law.rate_hz()
    }

    fn step(&mut self, input: &Input) -> Result<Vector4<f64>, String> {
        if self.cancelled.is_said() {
            return Err("cancelled".to_owned());
        }
        self.law.step(input)
    }
}
