//! Flights through the controller's C interface, in rows: a vehicle in; every course under every case out.
//!
//! The cascade flies with nothing stated where it is certified so, and with the motors' lag stated: every course
//! with a noisy gyroscope, and a figure eight with exact measurements with one thing wrong at a time. The paper's tables fly at
//! the lags that they tolerate, the two that hold no position over the ground on smooth courses alone.

use std::fmt;

use nalgebra::Vector3;
use quatrack_design::vehicle::Vehicle;
use serde::Serialize;

use super::course::{Course, CourseError};
use super::firmware::{Sensors, Tune};
use super::flight::{Case, FlightErrors, fly};
use super::setpoints::Setpoints;
use crate::flight::robustness;

/// Standard deviation of a gyroscope reading, rad/s: 1 degree a second and a bit.
const GYRO_NOISE_RAD_S: f64 = 0.02;

/// True lags of the motors, s.
const LAGS_S: [f64; 3] = [0.020, 0.063, 0.126];

/// The shortest lag at which the cascade is certified with nothing stated, s.
const UNSTATED_FROM_S: f64 = 0.050;

/// One flight.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The vehicle.
    pub vehicle: String,
    /// The table asked for.
    pub table: &'static str,
    /// The lag that its owner has stated, ms, if any.
    pub stated_ms: Option<f64>,
    /// The course.
    pub course: &'static str,
    /// The deviation of the case.
    pub case: &'static str,
    /// The motors' true lag, ms.
    pub lag_ms: f64,
    /// Its errors.
    #[serde(flatten)]
    pub flown: FlightErrors,
}

/// All flights of a vehicle.
#[derive(Clone, Debug, Serialize)]
pub struct CrazyflieReport {
    /// How far the paper's trajectories are from the pieces that are flown, m: mild, aggressive.
    pub fit_error_m: [f64; 2],
    /// The flights.
    pub rows: Vec<Row>,
}

type Named = (&'static str, Course);

/// With a noisy gyroscope.
fn noisy(lag_s: f64) -> Case {
    Case { sensors: Sensors { gyro_noise_rad_s: GYRO_NOISE_RAD_S, estimate_steps: 1 }, ..Case::of_lag(lag_s) }
}

/// With a noisy gyroscope and one more deviation each.
fn noisy_variations(lag_s: f64) -> [(&'static str, Case); 4] {
    let case = noisy(lag_s);
    [
        ("mass +10 %", Case { mass_factor: 1.1, ..case }),
        ("mass -10 %", Case { mass_factor: 0.9, ..case }),
        ("estimate at 100 Hz", Case { sensors: Sensors { estimate_steps: 10, ..case.sensors }, ..case }),
        ("full-state packets", Case { setpoints: Setpoints::FullState, ..case }),
    ]
}

/// With exact measurements, one thing wrong at a time.
fn exact_variations(lag_s: f64) -> [(&'static str, Case); 9] {
    let case = Case::of_lag(lag_s);
    [
        ("exact", case),
        ("exact, mass +10 %", Case { mass_factor: 1.1, ..case }),
        ("exact, mass -10 %", Case { mass_factor: 0.9, ..case }),
        ("exact, lag x 1.5", Case { lag_s: 1.5 * lag_s, ..case }),
        ("exact, lag x 0.5", Case { lag_s: 0.5 * lag_s, ..case }),
        ("exact, 4 ms late", Case { late_steps: 4, ..case }),
        ("exact, 10 ms late", Case { late_steps: 10, ..case }),
        ("exact, inertia +30 %", Case { inertia_factor: 1.3, ..case }),
        ("all noisy", Case { noise: Some(robustness::NOISE), ..case }),
    ]
}

/// The courses, with the figure eights at the end.
fn courses() -> Result<[Named; 8], CourseError> {
    let up = Vector3::z();
    Ok([
        ("hover", Course::Hover(up)),
        ("step of 1 m", Course::Step(up, up + Vector3::x())),
        ("take-off, hover, landing", Course::Hop(0.014, 1.0)),
        ("mild", Course::mild()?),
        ("aggressive", Course::aggressive()?),
        ("figure 8, 0.85 m/s", Course::FigureEight(0.601)),
        ("figure 8, 2.1 m/s", Course::FigureEight(robustness::RATE_RAD_S)),
        ("figure 8, 3.1 m/s", Course::FigureEight(robustness::FAST_RATE_RAD_S)),
    ])
}

impl CrazyflieReport {
    /// Flies everything.
    ///
    /// # Errors
    /// [`CourseError`] where the paper's trajectories cannot be planned.
    pub fn of(vehicle: &Vehicle) -> Result<Self, CourseError> {
        let courses = courses()?;
        let [_, _, hop, mild, aggressive, slow, figure, fast] = &courses;
        let fit_error_m = [&mild.1, &aggressive.1].map(Course::fit_error_m);
        let mut flights = Flights { vehicle, rows: Vec::new() };
        for lag_s in LAGS_S {
            let (unstated, stated) = (("cascade", 0, 0.0), ("cascade", 0, lag_s));
            for table in [unstated, stated] {
                if table == unstated && lag_s < UNSTATED_FROM_S {
                    flights.add(table, figure, "uncertified", &noisy(lag_s));
                    continue;
                }
                for course in &courses {
                    flights.add(table, course, "nominal", &noisy(lag_s));
                }
                for (name, case) in &noisy_variations(lag_s) {
                    flights.add(table, figure, name, case);
                }
            }
            for course in [slow, fast] {
                flights.add(stated, course, "exact", &Case::of_lag(lag_s));
            }
            for (name, case) in &exact_variations(lag_s) {
                flights.add(stated, figure, name, case);
            }
        }
        for (name, number, lag_s) in [("lyap-e", 1, 0.063), ("lyap-e", 1, 0.020), ("lqr-e", 2, 0.020)] {
            for course in &courses {
                flights.add((name, number, lag_s), course, "nominal", &noisy(lag_s));
            }
        }
        for (name, number) in [("lyap-f", 3), ("lqr-f", 4)] {
            for course in [hop, mild, aggressive, slow] {
                flights.add((name, number, 0.020), course, "nominal", &noisy(0.020));
            }
        }
        Ok(Self { fit_error_m, rows: flights.rows })
    }
}

/// The flights of one vehicle.
struct Flights<'a> {
    vehicle: &'a Vehicle,
    rows: Vec<Row>,
}

impl Flights<'_> {
    /// Flies a table by its name, its number and the lag that is stated, s, or 0.
    fn add(&mut self, table: (&'static str, u8, f64), course: &Named, name: &'static str, case: &Case) {
        let (table, number, motor_lag_s) = table;
        let flown = fly(self.vehicle, &course.1, &Tune::new(number, motor_lag_s).in_vacuum(), case);
        self.rows.push(Row {
            vehicle: self.vehicle.name().to_owned(),
            table,
            stated_ms: Some(motor_lag_s * 1e3).filter(|lag_ms| *lag_ms > 0.0),
            course: course.0,
            case: name,
            lag_ms: case.lag_s * 1e3,
            flown,
        });
    }
}

impl fmt::Display for CrazyflieReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(first) = self.rows.first() else { return Ok(()) };
        writeln!(
            f,
            "{}: setpoints at 100 Hz, gyroscope noise {GYRO_NOISE_RAD_S} rad/s unless exact, plant with lag",
            first.vehicle
        )?;
        let [mild, aggressive] = self.fit_error_m.map(|error_m| error_m * 1e6);
        writeln!(
            f,
            "The paper's trajectories in 31 pieces of degree 7: off by {mild:.0} and {aggressive:.0} um at most\n"
        )?;
        writeln!(
            f,
            "{:<16}{:>10}  {:<26}{:<22}{:>8}{:>12}{:>12}",
            "table", "stated, ms", "course", "case", "lag, ms", "IAE, m s", "largest, m"
        )?;
        for Row { table, stated_ms, course, case, lag_ms, flown, .. } in &self.rows {
            let iae = flown.iae.map_or_else(|| "lost".to_owned(), |iae| format!("{iae:.5}"));
            let stated = stated_ms.map_or_else(|| "-".to_owned(), |lag_ms| format!("{lag_ms:.0}"));
            writeln!(
                f,
                "{table:<16}{stated:>10}  {course:<26}{case:<22}{lag_ms:>8.0}{iae:>12}{:>12.4}",
                flown.max_error_m
            )?;
        }
        Ok(())
    }
}
