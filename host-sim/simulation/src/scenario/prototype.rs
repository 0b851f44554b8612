//! A law that is designed once for many flights: a campaign flies copies of it, and solves no equation twice.

use quatrack_design::vehicle::Vehicle;

use super::cascade_law::CascadeLaw;
use super::core_law::{CoreLaw, Gain};
use super::laws::{Law, LawError};
use super::told::ToldFigures;
use super::track::Track;
use crate::control_law::ControlLaw;
use crate::flight::motor_laws::FlightError;
use quatrack::gains::paper as gains;

/// A law at the start of a flight, and the parts that it shares with others.
#[derive(Clone)]
pub struct Prototype {
    law: Law,
    vehicle: Vehicle,
    told: ToldFigures,
    made: Made,
}

#[derive(Clone)]
enum Made {
    Cascade(Box<CascadeLaw>),
    Core(Box<CoreLaw>),
    /// Made anew each time: there is nothing to design.
    Anew,
}

impl Prototype {
    /// Designed for a vehicle of which something is told.
    ///
    /// # Errors
    /// As [`Law::start`].
    pub fn new(law: Law, vehicle: &Vehicle, told: &ToldFigures) -> Result<Self, LawError> {
        let refused = |error| LawError::Core { law: law.name(), vehicle: vehicle.name().to_owned(), error };
        let core = |made: Result<CoreLaw, FlightError>| made.map(|law| Made::Core(law.into())).map_err(refused);
        let paper = |gain| core(CoreLaw::paper(vehicle, told, gain));
        let made = match law {
            Law::Quatrack => CascadeLaw::new(vehicle, told)
                .map(|law| Made::Cascade(law.into()))
                .map_err(|error| LawError::of_cascade(vehicle, error)),
            Law::ActuatorAware => core(CoreLaw::actuator_aware(vehicle, told)),
            Law::LyapE => paper(Gain::Equilibrium(&gains::LYAP_E)),
            Law::LqrE => paper(Gain::Equilibrium(&gains::LQR_E)),
            Law::LyapF => paper(Gain::FlatOutput(&gains::LYAP_F)),
            Law::LqrF => paper(Gain::FlatOutput(&gains::LQR_F)),
            Law::Crazyflie | Law::Mellinger | Law::Lee | Law::Pid => Ok(Made::Anew),
        }?;
        let (vehicle, told) = (vehicle.clone(), *told);
        Ok(Self { law, made, vehicle, told })
    }

    /// With the setpoints of a track, evaluated once for all flights along it.
    pub fn along(mut self, track: &Track) -> Self {
        match &mut self.made {
            Made::Cascade(law) => law.share(track),
            Made::Core(law) => law.share(track),
            Made::Anew => {}
        }
        self
    }

    /// The law.
    pub fn law(&self) -> Law {
        self.law
    }

    /// Whether it is this law for the same vehicle and figures.
    pub fn is_for(&self, law: Law, vehicle: &Vehicle, told: &ToldFigures) -> bool {
        self.law == law && self.told == *told && self.vehicle == *vehicle
    }

    /// At the start of a flight.
    ///
    /// # Errors
    /// As [`Law::start`].
    pub fn start(&self) -> Result<Box<dyn ControlLaw>, LawError> {
        Ok(match &self.made {
            Made::Cascade(law) => law.clone(),
            Made::Core(law) => law.clone(),
            Made::Anew => self.law.start(&self.vehicle, &self.told)?,
        })
    }
}
