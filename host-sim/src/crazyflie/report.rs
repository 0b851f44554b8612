//! Flights through the controller's C interface, in rows: a vehicle in; every course under every case out.

use std::fmt;

use serde::Serialize;

use super::course::{Course, CourseError};
use super::firmware::{Sensors, Setpoints, Tune};
use super::flight::{Case, Flown, fly};
use crate::vehicle::Vehicle;

/// Standard deviation of a gyroscope reading, rad/s: 1 degree a second and a bit.
const GYRO_NOISE_RAD_S: f64 = 0.02;

/// True lags of the motors, s.
const LAGS_S: [f64; 3] = [0.020, 0.063, 0.126];

/// One flight.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The vehicle.
    pub vehicle: String,
    /// The table asked for.
    pub table: &'static str,
    /// The course.
    pub course: &'static str,
    /// What is not as it should be.
    pub case: &'static str,
    /// The motors' true lag, ms.
    pub lag_ms: f64,
    /// How it went.
    #[serde(flatten)]
    pub flown: Flown,
}

/// All flights of a vehicle.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// How far the paper's trajectories are from the pieces that are flown, m: mild, aggressive.
    pub fit_error_m: [f64; 2],
    /// The flights.
    pub rows: Vec<Row>,
}

/// A case that is flown on a course: its name, the mass, the estimate's steps, how setpoints come.
type Variation = (&'static str, f64, u32, Setpoints);

const NOMINAL: Variation = ("nominal", 1.0, 1, Setpoints::HighLevel);

/// On every course nothing more than noise; on the figure of 2.1 m/s what else may be wrong.
const VARIATIONS: [Variation; 4] = [
    ("mass+10", 1.1, 1, Setpoints::HighLevel),
    ("mass-10", 0.9, 1, Setpoints::HighLevel),
    ("estimate at 100 Hz", 1.0, 10, Setpoints::HighLevel),
    ("full-state packets", 1.0, 1, Setpoints::FullState),
];

impl Report {
    /// Flies everything.
    ///
    /// # Errors
    /// [`CourseError`] where the paper's trajectories cannot be planned.
    pub fn of(vehicle: &Vehicle) -> Result<Self, CourseError> {
        let (mild, aggressive) = (Course::mild()?, Course::aggressive()?);
        let up = nalgebra::Vector3::z();
        let courses: [(&'static str, Course); 8] = [
            ("hover", Course::Hover(up)),
            ("take-off, hover, landing", Course::Hop(0.014, 1.0)),
            ("step of 1 m", Course::Step(up, up + nalgebra::Vector3::x())),
            ("figure 8, 0.85 m/s", Course::FigureEight(0.601)),
            (FIGURE, Course::FigureEight(1.485)),
            ("figure 8, 3.1 m/s", Course::FigureEight(2.19)),
            ("mild", mild),
            ("aggressive", aggressive),
        ];
        let mut rows = Vec::new();
        let mut add = |table: (&'static str, u8),
                       stated_lag_s: f64,
                       course: &(&'static str, Course),
                       lag_s: f64,
                       v: &Variation| {
            let (case, mass_factor, estimate_steps, setpoints) = *v;
            let sensors = Sensors { gyro_noise_rad_s: GYRO_NOISE_RAD_S, estimate_steps };
            let tune = Tune { table: table.1, motor_lag_s: stated_lag_s };
            let flown = fly(vehicle, &course.1, &tune, &Case { lag_s, mass_factor, sensors, setpoints });
            let vehicle = vehicle.name().to_owned();
            rows.push(Row { vehicle, table: table.0, course: course.0, case, lag_ms: lag_s * 1e3, flown });
        };
        for lag_s in LAGS_S {
            for course in &courses {
                add(("actuator-aware", 0), 0.0, course, lag_s, &NOMINAL);
            }
            for variation in &VARIATIONS {
                add(("actuator-aware", 0), 0.0, &courses[4], lag_s, variation);
            }
        }
        // The paper's tables, as far as the motors' lag lets them.
        for (name, number, lag_s) in [("lyap-e", 1, 0.063), ("lyap-e", 1, 0.020), ("lqr-e", 2, 0.020)] {
            for course in &courses {
                add((name, number), lag_s, course, lag_s, &NOMINAL);
            }
        }
        let fit_error_m = [&courses[6].1, &courses[7].1].map(Course::fit_error_m);
        Ok(Self { fit_error_m, rows })
    }
}

/// The course on which things go wrong.
const FIGURE: &str = "figure 8, 2.1 m/s";

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(first) = self.rows.first() else { return Ok(()) };
        writeln!(
            f,
            "{}: setpoints at 100 Hz, gyroscope noise {GYRO_NOISE_RAD_S} rad/s, plant with lag",
            first.vehicle
        )?;
        let [mild, aggressive] = self.fit_error_m.map(|error_m| error_m * 1e6);
        writeln!(
            f,
            "The paper's trajectories in 31 pieces of degree 7: off by {mild:.0} and {aggressive:.0} um at most\n"
        )?;
        writeln!(
            f,
            "{:<16}{:<26}{:<20}{:>8}{:>12}{:>12}",
            "table", "course", "case", "lag, ms", "IAE, m s", "largest, m"
        )?;
        for Row { table, course, case, lag_ms, flown, .. } in &self.rows {
            let iae = flown.iae.map_or_else(|| "lost".to_owned(), |iae| format!("{iae:.5}"));
            writeln!(f, "{table:<16}{course:<26}{case:<20}{lag_ms:>8.0}{iae:>12}{:>12.4}", flown.max_error_m)?;
        }
        Ok(())
    }
}
