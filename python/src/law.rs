//! A law of the core with all that it needs, kept together: the core's controller borrows it for a step.

use pyo3::prelude::*;
use pyo3::types::PyString;
use quatrack::gains::ConstantGain;
use quatrack::gains::paper;
use quatrack::gains::table::GainTable as CoreTable;
use quatrack::{
    Actuation, ActuatorAware, ActuatorAwareGain, Cascade, Controller, ErrorForm, FeedForward, Limits, Memory, Rate,
    Settings,
};
use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::scenario::{ToldFigures, actuation_of, actuator_aware_of, cascade_of_table, flown_cascade};
use quatrack_simulation::vehicles;

use crate::error::refused;
use crate::gains::GainTable;
use crate::vehicle;

/// Names of the laws that are made for a vehicle.
pub(crate) const NAMES: [&str; 6] = ["quatrack", "actuator-aware", "lqr-e", "lyap-e", "lqr-f", "lyap-f"];

enum Kept {
    Cascade(Box<Cascade>),
    Constant(Box<ConstantGain>),
    /// With the actuation that it is flown with.
    ActuatorAware(Box<(ActuatorAwareGain, Actuation)>),
    /// With the law of a table of the cascade.
    Table {
        table: Box<CoreTable<'static>>,
        cascade: Option<Box<Cascade>>,
    },
    /// Gains along a trajectory stay in their bytes.
    Along(Vec<u8>),
}

/// A law with its craft.
pub(crate) struct OwnedLaw {
    kept: Kept,
    pub(crate) actuation: Option<Actuation>,
    limits: Limits,
    pub(crate) rate: Rate,
    feed_forward: FeedForward,
    error_form: ErrorForm,
    pub(crate) name: String,
}

/// Settings beside a law.
pub(crate) struct Options<'a, 'py> {
    pub(crate) vehicle: Option<&'a Bound<'py, PyAny>>,
    pub(crate) mass_kg: Option<f64>,
    pub(crate) lag_s: Option<f64>,
    pub(crate) drag_per_s: Option<f64>,
    pub(crate) moment_n_m_per_m_s: Option<[f64; 2]>,
    pub(crate) feed_forward: FeedForward,
    pub(crate) error_form: ErrorForm,
}

impl Options<'_, '_> {
    fn craft(&self) -> PyResult<Option<(Vehicle, ToldFigures)>> {
        let Some(value) = self.vehicle.filter(|value| !value.is_none()) else { return Ok(None) };
        let vehicle = vehicle::argument(value)?;
        let told = vehicle::told(&vehicle, self.mass_kg, self.lag_s, self.drag_per_s, self.moment_n_m_per_m_s)?;
        Ok(Some((vehicle, told)))
    }
}

/// As every law by its name flies here and in simulation.
const RATE: Rate = quatrack_simulation::flight::motor_loop::RATE;

impl OwnedLaw {
    /// By its name, or of a table.
    pub(crate) fn new(law: &Bound<'_, PyAny>, options: &Options<'_, '_>) -> PyResult<Self> {
        if let Ok(table) = law.cast::<GainTable>() {
            return Self::of_table(table.get(), options);
        }
        let Ok(name) = law.cast::<PyString>() else {
            return Err(refused(format!(
                "law: {}; give a name ({}) or a GainTable",
                law.get_type().name()?,
                NAMES.join(", ")
            )));
        };
        Self::named(name.to_str()?, options)
    }

    fn named(name: &str, options: &Options<'_, '_>) -> PyResult<Self> {
        let craft = options.craft()?;
        let needed = || refused(format!("law {name}: it gives motor forces; name a vehicle"));
        let own = |kept, actuation, limits| Self {
            kept,
            actuation,
            limits,
            rate: RATE,
            feed_forward: options.feed_forward,
            error_form: options.error_form,
            name: name.to_owned(),
        };
        match name {
            "quatrack" => {
                let (vehicle, told) = craft.ok_or_else(needed)?;
                let cascade = flown_cascade(&vehicle, &told).map_err(refused)?;
                let actuation = *cascade.actuation();
                return Ok(own(Kept::Cascade(Box::new(cascade)), Some(actuation), Limits::NONE));
            }
            "actuator-aware" => {
                let (vehicle, told) = craft.ok_or_else(needed)?;
                let (gain, lag_s) = actuator_aware_of(&vehicle, &told).map_err(refused)?;
                let actuation = actuation_of(&vehicle, &told, lag_s, RATE).map_err(refused)?;
                return Ok(own(Kept::ActuatorAware(Box::new((gain, actuation))), Some(actuation), Limits::NONE));
            }
            _ => {}
        }
        let gain = match name {
            "lqr-e" => ConstantGain::Equilibrium(paper::LQR_E),
            "lyap-e" => ConstantGain::Equilibrium(paper::LYAP_E),
            "lqr-f" => ConstantGain::FlatOutput(paper::LQR_F),
            "lyap-f" => ConstantGain::FlatOutput(paper::LYAP_F),
            _ => return Err(refused(format!("{name}: no such law; there are {}", NAMES.join(", ")))),
        };
        let (actuation, limits) = match &craft {
            None => (None, Limits::NONE),
            Some((vehicle, told)) => {
                let lag_s = told.lag_s.unwrap_or(vehicle.motors().lag_s);
                let actuation = actuation_of(vehicle, told, lag_s, RATE).map_err(refused)?;
                (Some(actuation), vehicles::limits(vehicle).map_err(refused)?)
            }
        };
        Ok(own(Kept::Constant(Box::new(gain)), actuation, limits))
    }

    fn of_table(table: &GainTable, options: &Options<'_, '_>) -> PyResult<Self> {
        let core = table.core()?;
        let head = *core.head();
        let built_in =
            || vehicles::by_name(head.vehicle.name.as_str()).ok().filter(|v| vehicles::id(v) == head.vehicle.id);
        let craft = match options.craft()? {
            Some((vehicle, _)) if vehicles::id(&vehicle) != head.vehicle.id => {
                return Err(refused(format!(
                    "{}: made for {}, not for the figures of {}; make its table anew for these",
                    head.name,
                    head.vehicle,
                    vehicle.name()
                )));
            }
            Some(craft) => Some(craft),
            None => {
                let Options { mass_kg, lag_s, drag_per_s, moment_n_m_per_m_s, .. } = *options;
                let told = |vehicle: Vehicle| {
                    let told = vehicle::told(&vehicle, mass_kg, lag_s, drag_per_s, moment_n_m_per_m_s)?;
                    Ok::<_, PyErr>((vehicle, told))
                };
                built_in().map(told).transpose()?
            }
        };
        let accepted = core.accept_for(&head.vehicle, head.rate).map_err(refused)?;
        let cascade = match (core.cascade(), &craft) {
            (None, _) => None,
            (Some(_), None) => return Err(refused(format!("{}: it gives motor forces; name a vehicle", head.name))),
            (Some(table), Some((vehicle, told))) => {
                Some(Box::new(cascade_of_table(vehicle, told, table).map_err(refused)?))
            }
        };
        let actuation = match &craft {
            None => None,
            _ if cascade.is_some() => cascade.as_ref().map(|cascade| *cascade.actuation()),
            Some((vehicle, told)) => {
                let lag_s = told.lag_s.unwrap_or(vehicle.motors().lag_s);
                Some(accepted.actuation(&actuation_of(vehicle, told, lag_s, head.rate).map_err(refused)?))
            }
        };
        Ok(Self {
            kept: match core.owned() {
                Some(owned) => Kept::Table { table: Box::new(owned), cascade },
                None => Kept::Along(table.bytes.clone()),
            },
            actuation,
            limits: Limits::NONE,
            rate: head.rate,
            feed_forward: options.feed_forward,
            error_form: options.error_form,
            name: head.name.as_str().to_owned(),
        })
    }

    /// The core's controller of it.
    pub(crate) fn with_controller<T>(&self, run: impl FnOnce(&Controller<'_>) -> T) -> PyResult<T> {
        let settings = Settings {
            limits: self.limits,
            actuation: self.actuation.as_ref(),
            cascade: self.cascade(),
            feed_forward: self.feed_forward,
            error_form: self.error_form,
            player_rate: self.rate,
        };
        let parsed;
        let table = match &self.kept {
            Kept::Cascade(cascade) => return Ok(run(&Controller::new(&**cascade, self.limits))),
            Kept::ActuatorAware(flown) => {
                let (gain, actuation) = &**flown;
                return Ok(run(&Controller::new(ActuatorAware::new(gain, actuation), self.limits)));
            }
            Kept::Constant(gain) => {
                let controller = Controller::new(gain.law(self.rate, &settings), self.limits);
                return Ok(run(&self
                    .actuation
                    .as_ref()
                    .map_or(controller, |motors| controller.with_actuation(motors))));
            }
            Kept::Table { table, .. } => &**table,
            Kept::Along(bytes) => {
                parsed = CoreTable::from_bytes(bytes).map_err(refused)?;
                &parsed
            }
        };
        let accepted = table.accept_for(&table.head().vehicle, self.rate).map_err(refused)?;
        Ok(run(&accepted.controller(&settings).map_err(refused)?))
    }

    /// Its memory at the start of a flight: in the air, or on the ground with the motors off.
    pub(crate) fn memory(&self, standing: bool) -> Memory {
        match &self.actuation {
            Some(actuation) if !standing => Memory::hovering(actuation.airframe()),
            _ => Memory::at_rest(),
        }
    }

    /// The cascade, where it is one.
    pub(crate) fn cascade(&self) -> Option<&Cascade> {
        match &self.kept {
            Kept::Cascade(cascade) | Kept::Table { cascade: Some(cascade), .. } => Some(cascade),
            _ => None,
        }
    }
}
