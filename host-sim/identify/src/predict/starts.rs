//! Mean errors over many starts: by a craft's figures, and where everything stays as it is.

use super::craft::{BEFORE, BETWEEN, Craft, HORIZON, Habits, State};
use super::errors::{Course, Errors};
use crate::fit::Fit;
use crate::flight::Flight;

/// Mean errors of predictions by the figures, and the number of starts; without angular acceleration where not `turning`.
pub(super) fn errors(flights: &[Flight], fit: &Fit, habits: &Habits, between: usize, turning: bool) -> (Course, usize) {
    let (mut course, mut starts) = (vec![Errors::default(); HORIZON], 0);
    for (flight, own) in flights.iter().zip(&fit.flights) {
        let craft = Craft::of(fit, own);
        for section in flight.sections.iter().filter(|section| section.len() > BEFORE + HORIZON + 1) {
            let track = craft.track(section, habits);
            for start in (BEFORE..section.len() - HORIZON - 1).step_by(between) {
                for (k, state) in craft.ahead(&track, start, habits, turning).iter().enumerate() {
                    course[k].add(&Errors::of(section, start + k + 1, &own.gyro_bias_rad_s, state));
                }
                starts += 1;
            }
        }
    }
    (course.iter().map(|errors| errors.over(starts)).collect(), starts)
}

/// Mean errors where everything stays as it is at the start.
pub(super) fn unchanged(flights: &[Flight], fit: &Fit) -> Course {
    let (mut course, mut starts) = (vec![Errors::default(); HORIZON], 0);
    for (flight, own) in flights.iter().zip(&fit.flights) {
        for section in flight.sections.iter().filter(|section| section.len() > BEFORE + HORIZON + 1) {
            for start in (BEFORE..section.len() - HORIZON - 1).step_by(BETWEEN) {
                let state = State {
                    position: section.position[start],
                    velocity: section.velocity[start],
                    attitude: section.attitude[start],
                    rates: section.gyro[start] - own.gyro_bias_rad_s,
                };
                for (k, errors) in course.iter_mut().enumerate() {
                    errors.add(&Errors::of(section, start + k + 1, &own.gyro_bias_rad_s, &state));
                }
                starts += 1;
            }
        }
    }
    course.iter().map(|errors| errors.over(starts)).collect()
}
