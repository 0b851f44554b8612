//! Runs of a campaign in; their rows, run by run and law by law, flown side by side where the flights are along one
//! course, out.

use std::ops::Range;

use quatrack_simulation::control_law::ControlLaw;
use quatrack_simulation::plant::PlantGroup;
use quatrack_simulation::scenario::course::Flown;
use quatrack_simulation::scenario::flight::Setpoints;
use quatrack_simulation::scenario::{CourseChoice, Law, LawError, Prototype, Scenario, Side, Tally, Track};

use crate::definition::{Campaign, Run};
use crate::row::{Outcome, Row};

/// Laws that were designed, and courses that were evaluated, for the flights before: most flights of a campaign share them.
#[derive(Default)]
pub struct Crew {
    course: Option<Course>,
    laws: Vec<Prototype>,
}

struct Course {
    choice: CourseChoice,
    duration_s: Option<f64>,
    setpoints: Setpoints,
    flown: Flown,
    track: Track,
}

/// A flight that can be flown.
struct Ready<'a> {
    /// Its place among the rows.
    place: usize,
    scenario: &'a Scenario,
    law: Box<dyn ControlLaw>,
}

impl Crew {
    /// The rows of some runs, run by run and law by law.
    pub fn fly(&mut self, campaign: &Campaign, runs: Range<u64>) -> Vec<Row> {
        let drawn: Vec<Run> = runs.clone().map(|run| campaign.run(run)).collect();
        let laws = campaign.laws();
        let mut rows: Vec<Row> = Vec::with_capacity(drawn.len() * laws.len());
        for (run, drawn) in runs.zip(&drawn) {
            rows.extend(laws.iter().map(|law| blank(run, *law, drawn, campaign)));
        }
        for (number, law) in laws.iter().enumerate() {
            let most = if law.flies_alone() { 1 } else { PlantGroup::MOST };
            let mut ready: Vec<Ready<'_>> = Vec::new();
            for (index, drawn) in drawn.iter().enumerate() {
                let place = index * laws.len() + number;
                let Ok(scenario) = &drawn.scenario else { continue };
                // Flights side by side are along one course.
                if ready.len() == most || !ready.is_empty() && !self.is_along(scenario) {
                    self.fly_ready(&mut ready, &mut rows);
                }
                self.along(scenario, campaign);
                match self.law(*law, scenario) {
                    Ok(law) => ready.push(Ready { place, scenario, law }),
                    Err(error) => rows[place].reason = one_line(&error.to_string()),
                }
            }
            self.fly_ready(&mut ready, &mut rows);
        }
        rows
    }

    fn is_along(&self, scenario: &Scenario) -> bool {
        self.course.as_ref().is_some_and(|course| {
            course.choice == scenario.course
                && course.duration_s == scenario.duration_s
                && course.setpoints == scenario.setpoints
        })
    }

    fn along(&mut self, scenario: &Scenario, campaign: &Campaign) {
        if !self.is_along(scenario) {
            let flown = scenario.flown(campaign.trajectory().cloned());
            let track = Track::of(&flown, scenario.setpoints);
            let (choice, duration_s, setpoints) = (scenario.course.clone(), scenario.duration_s, scenario.setpoints);
            self.course = Some(Course { choice, duration_s, setpoints, flown, track });
            self.laws.clear();
        }
    }

    fn law(&mut self, law: Law, scenario: &Scenario) -> Result<Box<dyn ControlLaw>, LawError> {
        let (vehicle, told) = (&scenario.vehicle, &scenario.told);
        if let Some(known) = self.laws.iter().find(|known| known.is_for(law, vehicle, told)) {
            return known.start();
        }
        let mut made = Prototype::new(law, vehicle, told)?;
        if let Some(course) = &self.course {
            made = made.along(&course.track);
        }
        let started = made.start();
        self.laws.retain(|known| known.law() != law);
        self.laws.push(made);
        started
    }

    fn fly_ready(&self, ready: &mut Vec<Ready<'_>>, rows: &mut [Row]) {
        let Some(Course { flown, track, .. }) = &self.course else { return };
        let places: Vec<usize> = ready.iter().map(|ready| ready.place).collect();
        let mut sides: Vec<Side<'_>> =
            ready.drain(..).map(|Ready { scenario, law, .. }| Side { scenario, flown, track, law }).collect();
        for (place, outcome) in places.into_iter().zip(Scenario::fly_together(&mut sides)) {
            let row = &mut rows[place];
            match outcome {
                Ok(tally) => put(row, tally),
                Err(error) => row.reason = one_line(&error.to_string()),
            }
        }
    }
}

/// Before it is flown.
fn blank(run: u64, law: Law, drawn: &Run, campaign: &Campaign) -> Row {
    Row {
        run,
        law,
        seed: drawn.seed,
        outcome: Outcome::Refused,
        iae_m_s: None,
        max_error_m: None,
        saturated_steps: None,
        lost_s: None,
        reason: drawn.scenario.as_ref().err().map_or_else(String::new, |error| one_line(&campaign.reason(error))),
        drawn: drawn.drawn.clone(),
    }
}

fn put(row: &mut Row, tally: Tally) {
    row.outcome = if tally.lost.is_some() { Outcome::Lost } else { Outcome::Flown };
    row.iae_m_s = tally.iae_m_s;
    row.max_error_m = Some(tally.max_error_m);
    row.saturated_steps = Some(tally.saturated_steps);
    row.lost_s = tally.lost.as_ref().map(|lost| lost.time_s);
    row.reason = tally.lost.map_or_else(String::new, |lost| one_line(&lost.reason));
}

/// A row is one line.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::Asked;

    /// Steady plants take the short way, those with a delay, a battery or gusts the long one, and a filter looks at every step.
    #[test]
    fn a_flight_beside_others_has_the_bits_that_it_has_alone() {
        let conditions = [
            "",
            "[air]\ndrag_per_s = [0.4, 0.4, 0.4]\nwind_m_s = [1.0, 0.5, 0.0]\n[errors]\nlag_rise_ms = 30.0\nlag_fall_ms = 47.0\n",
            "[air]\ndrag_per_s = [0.4, 0.4, 0.4]\ngust_rms_m_s = 0.5\n[errors]\ndelay_ms = 3.3\n[noise]\nposition_m = 0.001\n",
            "estimator = \"kalman\"\n[noise]\ngyro_rad_s = 0.02\n",
        ];
        let dir = tempfile::tempdir().unwrap();
        for condition in conditions {
            let text = format!(
                "vehicle = \"crazyflie-2.1-brushless\"\ncourse = \"eight\"\nduration_s = 0.5\n\
                 laws = [\"quatrack\", \"actuator-aware\", \"lqr-f\", \"mellinger\"]\n{condition}[vary]\n\
                 errors.mass_factor = {{ uniform = [0.9, 1.1] }}\nerrors.inertia_factor = {{ uniform = [0.8, 1.2] }}\n"
            );
            let path = dir.path().join("s.toml");
            std::fs::write(&path, text).unwrap();
            let campaign = Campaign::read(&path, &Asked::default(), &|name| Err(name.to_owned())).unwrap();
            let together = Crew::default().fly(&campaign, 0..5);
            let alone: Vec<Row> = (0..5).flat_map(|run| Crew::default().fly(&campaign, run..run + 1)).collect();
            assert!(together.iter().any(|row| row.outcome == Outcome::Flown), "{condition}");
            assert_eq!(Row::to_csv(&together), Row::to_csv(&alone), "{condition}");
        }
    }
}
