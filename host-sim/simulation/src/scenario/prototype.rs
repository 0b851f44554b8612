//! A law that is designed once for many flights: a campaign flies copies of it, and solves no equation twice.

use quatrack_design::vehicle::Vehicle;

use super::laws::{Designed, Law, LawError};
use super::told::ToldFigures;
use super::track::Track;
use crate::control_law::ControlLaw;

/// A law at the start of a flight, and the parts that it shares with others.
#[derive(Clone)]
pub struct Prototype {
    law: Law,
    vehicle: Vehicle,
    told: ToldFigures,
    designed: Designed,
}

impl Prototype {
    /// Designed for a vehicle of which something is told.
    ///
    /// # Errors
    /// As [`Law::start`].
    pub fn new(law: Law, vehicle: &Vehicle, told: &ToldFigures) -> Result<Self, LawError> {
        let designed = law.designed(vehicle, told)?;
        Ok(Self { law, designed, vehicle: vehicle.clone(), told: *told })
    }

    /// With the setpoints of a track, evaluated once for all flights along it.
    pub fn along(mut self, track: &Track) -> Self {
        match &mut self.designed {
            Designed::Cascade(law) => law.share(track),
            Designed::Core(law) => law.share(track),
            Designed::Nothing(_) => {}
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
        Ok(match &self.designed {
            Designed::Cascade(law) => law.clone(),
            Designed::Core(law) => law.clone(),
            Designed::Nothing(_) => self.law.start(&self.vehicle, &self.told)?,
        })
    }
}
