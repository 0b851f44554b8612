//! Flights of scenarios: scenarios, their courses and their laws in; flights, alone with their rows or several side by
//! side with their figures, out.

use quatrack_design::model::GRAVITY_M_S2;

use super::Scenario;
use crate::control_law::ControlLaw;
use crate::flight::motor_loop;
use crate::flight::rigid_loop::RigidFlight;
use crate::plant::{Plant, PlantError, RigidState, Truth};
use crate::scenario::course::Flown;
use crate::scenario::error::StartError;
use crate::scenario::file::Estimator as EstimateFrom;
use crate::scenario::filtered::{Estimation, Filtered};
use crate::scenario::flight::{self, Flying};
use crate::scenario::kept::{Errors, Rows, Tally};
use crate::scenario::recording::Recording;
use crate::scenario::sensors::Sensors;
use crate::scenario::track::Track;

/// One of several flights side by side.
pub struct Side<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The course.
    pub flown: &'a Flown,
    /// The same, evaluated.
    pub track: &'a Track,
    /// The law, at its start.
    pub law: Box<dyn ControlLaw>,
}

impl Scenario {
    /// The true craft at a state, with the wind that blows in this scenario.
    pub(in crate::scenario) fn plant(&self, start: &RigidState) -> Result<Plant, PlantError> {
        Plant::new(&self.vehicle, &self.environment, &self.truth, start, self.seed)
    }

    /// Flies a law along the course of [`Self::flown`]. The same scenario and law give the same flight to the bit.
    ///
    /// # Errors
    /// [`StartError`] where the course cannot be flown from its start, or figures that were changed since have no sense.
    pub fn fly(&self, law: &mut dyn ControlLaw, flown: &Flown) -> Result<RigidFlight, StartError> {
        Ok(self.record(law, flown)?.flight)
    }

    /// The same, with surroundings and estimates.
    ///
    /// # Errors
    /// As [`Self::fly`].
    pub fn record(&self, law: &mut dyn ControlLaw, flown: &Flown) -> Result<Recording, StartError> {
        let (mut plant, estimation) = self.started(flown)?;
        let track = Track::of(flown, self.setpoints);
        let mut flying = Flying::new(&track, law, estimation, &plant);
        let mut rows = Rows::default();
        flying.fly(&mut plant, &mut rows);
        let (saturated_steps, lost) = (flying.saturated_steps, flying.lost);
        let flight = RigidFlight { samples: rows.samples, saturated_steps, lost };
        // The row of its loss says nothing alone.
        let is_early = flight.lost.is_some() && flight.samples.len() <= 1;
        let before = if is_early { rows.before } else { Vec::new() };
        Ok(Recording { flight, around: rows.around, gust_rms_m_s: plant.realised_gust_rms_m_s(), before })
    }

    /// The craft at the start of a course, and where its law's estimate comes from.
    fn started(&self, flown: &Flown) -> Result<(Plant, Estimation), StartError> {
        let point = flown.course.at(0.0);
        let moves = point.position[1..].iter().any(|derivative| derivative.norm() > 0.0) || point.heading != [0.0; 4];
        let start = if moves {
            let airframe = motor_loop::airframe(&self.vehicle, self.vehicle.motors().lag_s)?;
            motor_loop::state_on(&point, &airframe)?
        } else {
            RigidState::at_rest(point.position[0], 0.25 * self.truth.mass_kg * GRAVITY_M_S2)
        };
        let truth = self.thrust_factor_end.map(|end| {
            let thrust_factor_per_s = (end - self.truth.thrust_factor) / flown.course.duration_s();
            Truth { thrust_factor_per_s, ..self.truth.clone() }
        });
        self.started_as(truth.as_ref().unwrap_or(&self.truth), &self.start.applied(&start))
    }

    /// The craft at a state, and where its law's estimate comes from.
    pub(in crate::scenario) fn started_at(&self, start: &RigidState) -> Result<(Plant, Estimation), StartError> {
        self.started_as(&self.truth, start)
    }

    fn started_as(&self, truth: &Truth, start: &RigidState) -> Result<(Plant, Estimation), StartError> {
        let sensors = Sensors::new(self.noise, self.gyro_bias_rad_s, self.accelerometer_bias_m_s2, self.seed);
        let estimation = match self.estimator {
            EstimateFrom::Exact => Estimation::Exact(sensors.into()),
            EstimateFrom::Kalman => {
                Estimation::Filtered(Filtered::start(&self.filter, sensors, self.noise.position_m, start)?.into())
            }
        };
        let plant = Plant::new(&self.vehicle, &self.environment, truth, start, self.seed)?;
        Ok((plant, estimation))
    }

    /// Flies up to four scenarios, each with a law of its own along a track, side by side: every flight has the bits that it has
    /// alone.
    ///
    /// # Errors
    /// For each its own [`StartError`], as [`Self::fly`].
    pub fn fly_together(flights: &mut [Side<'_>]) -> Vec<Result<Tally, StartError>> {
        let mut outcomes: Vec<Option<StartError>> = Vec::new();
        let (mut plants, mut flying) = (Vec::new(), Vec::new());
        for Side { scenario, flown, track, law } in flights.iter_mut() {
            let started = scenario.started(flown);
            outcomes.push(started.as_ref().err().cloned());
            if let Ok((plant, estimation)) = started {
                flying.push(Flying::new(track, &mut **law, estimation, &plant));
                plants.push(plant);
            }
        }
        let mut kept = vec![Errors::default(); flying.len()];
        let alike = flying.windows(2).all(|pair| pair[0].stride() == pair[1].stride());
        if flying.len() > 1 && alike {
            flight::together(plants, &mut flying, &mut kept);
        } else {
            for ((flying, plant), kept) in flying.iter_mut().zip(&mut plants).zip(&mut kept) {
                flying.fly(plant, kept);
            }
        }
        let mut flown = flying.into_iter().zip(&kept);
        let tally = |(flying, kept): (Flying<'_>, &Errors)| Tally::of(kept, flying.saturated_steps, flying.lost);
        outcomes
            .into_iter()
            .filter_map(|error| error.map_or_else(|| flown.next().map(tally).map(Ok), |error| Some(Err(error))))
            .collect()
    }
}
