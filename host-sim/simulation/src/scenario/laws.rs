//! The laws of a scenario by name: ours, the paper's and the rivals.

use std::str::FromStr;

use quatrack::gains::paper as gains;
use quatrack_design::vehicle::Vehicle;
use serde::{Deserialize, Serialize};

use super::cascade_law::CascadeLaw;
use super::core_law::{CoreLaw, Gain};
use super::not_flown::NotFlown;
use super::object_law::ObjectLaw;
use super::told::{ToldError, ToldFigures};
use crate::control_law::ControlLaw;
use crate::crazyflie::StandardError;
use crate::flight::motor_laws::FlightError;
use crate::rivals::{Actuation, CascadedPid, CascadedPidConfig, Lee, LeeConfig, Mellinger, MellingerConfig};

/// A law.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// The cascade of the core.
    #[default]
    Quatrack,
    /// The Crazyflie controller with its default table, through its C interface.
    Crazyflie,
    /// The actuator-aware law without a word of the air.
    ActuatorAware,
    /// The paper's, each behind the body-rate loop of the core.
    LqrE,
    /// Likewise.
    LyapE,
    /// Likewise.
    LqrF,
    /// Likewise.
    LyapF,
    /// Mellinger and Kumar 2011.
    Mellinger,
    /// Lee, Leok and McClamroch 2010.
    Lee,
    /// The cascaded PID.
    Pid,
}

/// Why a law does not fly a vehicle.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawError {
    /// Not one of the names.
    #[error("{name}: no such law; there are {known}")]
    Unknown {
        /// The name that was given.
        name: String,
        /// All there are.
        known: String,
    },
    /// There is no certified table for it.
    #[error(
        "{law} on {vehicle}: the standard cascade has no certificate for it: {error}; mend the vehicle's file, or write a design of its own \
         (docs/own-gains.md) and fly it by --gains"
    )]
    NoTable {
        /// The law.
        law: &'static str,
        /// The vehicle's name.
        vehicle: String,
        /// The reason.
        #[source]
        error: Box<StandardError>,
    },
    /// It does not take a figure that it is told.
    #[error("{law} on {vehicle}: {error}")]
    Told {
        /// The law.
        law: &'static str,
        /// The vehicle's name.
        vehicle: String,
        /// The figure with its range.
        #[source]
        error: ToldError,
    },
    /// The Crazyflie's object does not fly it.
    #[error("{law} on {vehicle}: {reason}")]
    Object {
        /// The law.
        law: &'static str,
        /// The vehicle's name.
        vehicle: String,
        /// The object's words, with the remedy.
        reason: String,
    },
    /// The core flies no such vehicle.
    #[error("{law} on {vehicle}: {error}")]
    Core {
        /// The law.
        law: &'static str,
        /// The vehicle's name.
        vehicle: String,
        /// Why not.
        #[source]
        error: FlightError,
    },
}

impl Law {
    /// All of them: ours, the rivals, and the older ones.
    pub const ALL: [Self; 10] = [
        Self::Quatrack,
        Self::Mellinger,
        Self::Lee,
        Self::Pid,
        Self::Crazyflie,
        Self::ActuatorAware,
        Self::LqrE,
        Self::LyapE,
        Self::LqrF,
        Self::LyapF,
    ];

    /// As in files, on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quatrack => "quatrack",
            Self::Crazyflie => "crazyflie",
            Self::ActuatorAware => "actuator-aware",
            Self::LqrE => "lqr-e",
            Self::LyapE => "lyap-e",
            Self::LqrF => "lqr-f",
            Self::LyapF => "lyap-f",
            Self::Mellinger => "mellinger",
            Self::Lee => "lee",
            Self::Pid => "pid",
        }
    }

    /// Whether there is one of it in a process, so that two of its flights cannot go on at once in one thread.
    pub fn flies_alone(self) -> bool {
        self == Self::Crazyflie
    }

    /// At the start of a flight of a vehicle of which it is told something.
    ///
    /// # Errors
    /// [`LawError`] but for [`LawError::Unknown`].
    pub fn start(self, vehicle: &Vehicle, told: &ToldFigures) -> Result<Box<dyn ControlLaw>, LawError> {
        let actuation = Actuation::of(vehicle);
        Ok(match self.designed(vehicle, told)? {
            Designed::Cascade(law) => law,
            Designed::Core(law) => law,
            Designed::Nothing(Undesigned::Crazyflie) => {
                Box::new(ObjectLaw::start(vehicle, told).map_err(|error| self.refused(vehicle, error))?)
            }
            Designed::Nothing(Undesigned::Mellinger) => {
                Box::new(Mellinger::new(MellingerConfig::firmware(told.mass_kg, &actuation), actuation))
            }
            Designed::Nothing(Undesigned::Lee) => Box::new(Lee::new(LeeConfig::firmware(told.mass_kg), actuation)),
            Designed::Nothing(Undesigned::Pid) => {
                Box::new(CascadedPid::new(CascadedPidConfig::firmware(vehicle, told.mass_kg), actuation))
            }
        })
    }

    /// The law with all that is designed for a vehicle, before it flies.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub(super) fn designed(self, vehicle: &Vehicle, told: &ToldFigures) -> Result<Designed, LawError> {
        let core = |law: CoreLaw| Designed::Core(law.into());
        let paper = |gain| CoreLaw::paper(vehicle, told, gain).map(core).map_err(NotFlown::from);
        let designed = match self {
            Self::Quatrack => CascadeLaw::new(vehicle, told).map(|law| Designed::Cascade(law.into())),
            Self::ActuatorAware => CoreLaw::actuator_aware(vehicle, told).map(core).map_err(NotFlown::from),
            Self::LyapE => paper(Gain::Equilibrium(&gains::LYAP_E)),
            Self::LqrE => paper(Gain::Equilibrium(&gains::LQR_E)),
            Self::LyapF => paper(Gain::FlatOutput(&gains::LYAP_F)),
            Self::LqrF => paper(Gain::FlatOutput(&gains::LQR_F)),
            Self::Crazyflie => Ok(Designed::Nothing(Undesigned::Crazyflie)),
            Self::Mellinger => Ok(Designed::Nothing(Undesigned::Mellinger)),
            Self::Lee => Ok(Designed::Nothing(Undesigned::Lee)),
            Self::Pid => Ok(Designed::Nothing(Undesigned::Pid)),
        };
        designed.map_err(|error| self.refused(vehicle, error))
    }

    fn refused(self, vehicle: &Vehicle, error: NotFlown) -> LawError {
        let (law, vehicle) = (self.name(), vehicle.name().to_owned());
        match error {
            NotFlown::Core(error) => LawError::Core { law, vehicle, error },
            NotFlown::Standard(error) => LawError::NoTable { law, vehicle, error: error.into() },
            NotFlown::Told(error) => LawError::Told { law, vehicle, error },
            NotFlown::Object(reason) => LawError::Object { law, vehicle, reason },
        }
    }
}

/// A law before a flight.
#[derive(Clone)]
pub(super) enum Designed {
    Cascade(Box<CascadeLaw>),
    Core(Box<CoreLaw>),
    /// Made anew for each flight.
    Nothing(Undesigned),
}

/// Laws whose gains are figures of a firmware, not the result of a design.
#[derive(Clone, Copy)]
pub(super) enum Undesigned {
    Crazyflie,
    Mellinger,
    Lee,
    Pid,
}

impl FromStr for Law {
    type Err = LawError;

    fn from_str(text: &str) -> Result<Self, LawError> {
        let known = || Self::ALL.map(Self::name).join(", ");
        let found = Self::ALL.into_iter().find(|law| law.name() == text);
        found.ok_or_else(|| LawError::Unknown { name: text.to_owned(), known: known() })
    }
}
