//! The figures of its craft that a law is told, and the ranges in which laws take them.

use quatrack::gains::table::CascadeRange;
use quatrack_design::vehicle::Vehicle;

use super::checks::Checks;
use super::error::ScenarioError;
use super::file::Told;
use crate::crazyflie::standard_design;
use crate::gains::Problem;
use crate::vehicles;

/// The lags that the laws take of a built-in vehicle, ms: the shortest is two control periods, the longest the end of the tables'
/// certificates.
const BUILT_IN_LAG_MS: [f64; 2] = [4.0, 126.0];
/// Drag over mass that the core takes, 1/s.
const DRAG_PER_S: [f64; 2] = [0.0, 1.0];
/// Airflow moment that the core takes, N m per m/s.
const MOMENT_N_M_PER_M_S: [f64; 2] = [0.0, 2e-3];

/// The figures of the craft that a law is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToldFigures {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Lag of the motors, s, where it is said.
    pub lag_s: Option<f64>,
    /// Linear drag over mass, 1/s, where it is said.
    pub drag_per_s: Option<f64>,
    /// Airflow moment, N m per m/s, where it is said.
    pub moment_n_m_per_m_s: Option<[f64; 2]>,
}

/// A figure that a law is told and does not take.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("told.{key} = {value}: must be {must}; leave it out for the vehicle's own")]
pub struct ToldError {
    /// Its key in the table `[told]`.
    pub key: &'static str,
    /// As it was told.
    pub value: f64,
    /// Its range, with the unit.
    pub must: String,
}

impl ToldFigures {
    /// The entries of a file for a vehicle, within the ranges that the laws take.
    pub(super) fn checked(told: &Told, checks: &Checks<'_>, vehicle: &Vehicle) -> Result<Self, ScenarioError> {
        let own_kg = vehicle.mass_kg();
        let lag_meaning = "the motors' lag in ms that laws take of this vehicle; leave it out for its own";
        let lag_s = |ms: f64| {
            let range = lag_range_ms(vehicle);
            checks.one("told.lag_ms", Some(ms), 0.0, range, lag_meaning).map(|ms| 1e-3 * ms)
        };
        let drag_meaning = "drag over mass in 1/s that the core takes; leave it out for the vehicle's own";
        let drag = |value| checks.one("told.drag_per_s", Some(value), 0.0, DRAG_PER_S, drag_meaning);
        let moment_meaning = "in N m per m/s, as far as the core takes it; leave it out for the vehicle's own";
        let moment = |value| checks.each("told.moment_n_m_per_m_s", Some(value), MOMENT_N_M_PER_M_S, moment_meaning);
        Ok(Self {
            mass_kg: checks.one(
                "told.mass_kg",
                told.mass_kg,
                own_kg,
                bounds_kg(own_kg),
                "in kg, half to twice the vehicle's",
            )?,
            lag_s: told.lag_ms.map(lag_s).transpose()?,
            drag_per_s: told.drag_per_s.map(drag).transpose()?,
            moment_n_m_per_m_s: told.moment_n_m_per_m_s.map(moment).transpose()?,
        })
    }

    /// Whether these are figures that laws take of a vehicle: those of `[told]`.
    ///
    /// # Errors
    /// [`ToldError`] for the first that is out of its range, in SI.
    pub fn taken_of(&self, vehicle: &Vehicle) -> Result<(), ToldError> {
        let refused = |key, value, [least, most]: [f64; 2], unit: &str| {
            Err(ToldError { key, value, must: format!("from {least} to {most} {unit}") })
        };
        let within = |key, value: f64, range: [f64; 2], unit: &str| {
            if (range[0]..=range[1]).contains(&value) { Ok(()) } else { refused(key, value, range, unit) }
        };
        within("mass_kg", self.mass_kg, bounds_kg(vehicle.mass_kg()), "kg, half to twice the vehicle's")?;
        if let Some(lag_s) = self.lag_s {
            // In thousandths as the range is: the lag of the vehicle itself may be its end.
            let [least, most] = lag_range_ms(vehicle);
            if !(least..=most).contains(&thousandths(1e3 * lag_s)) {
                refused(
                    "lag_s",
                    lag_s,
                    [least / 1e3, most / 1e3],
                    "s, the motors' lag that laws take of this vehicle",
                )?;
            }
        }
        if let Some(drag_per_s) = self.drag_per_s {
            within("drag_per_s", drag_per_s, DRAG_PER_S, "1/s, drag over mass")?;
        }
        for moment_n_m_per_m_s in self.moment_n_m_per_m_s.into_iter().flatten() {
            within("moment_n_m_per_m_s", moment_n_m_per_m_s, MOMENT_N_M_PER_M_S, "N m per m/s")?;
        }
        Ok(())
    }

    /// Whether a table is certified for the figures told of a vehicle.
    ///
    /// # Errors
    /// [`ToldError`] for a lag or a mass outside its range.
    pub(super) fn certified_by(&self, certified: &CascadeRange, vehicle: &Vehicle) -> Result<(), ToldError> {
        self.lag_certified_by(certified)?;
        let own_kg = vehicle.mass_kg();
        if certified.holds_mass(own_kg as f32, self.mass_kg as f32) {
            return Ok(());
        }
        let percent = 100.0 * certified.mass_share;
        let must = format!("within {percent:.0} % of the vehicle's {own_kg} kg, for which its table is certified");
        Err(ToldError { key: "mass_kg", value: self.mass_kg, must })
    }

    /// Whether a table is certified for the lag that is told.
    ///
    /// # Errors
    /// [`ToldError`].
    pub(super) fn lag_certified_by(&self, certified: &CascadeRange) -> Result<(), ToldError> {
        match self.lag_s {
            Some(lag_s) if !certified.holds_lag(lag_s as f32) => {
                let [least, most] = certified.motor_lag_s.map(|lag_s| thousandths(1e3 * f64::from(lag_s)));
                let must = format!("from {least} to {most} ms, for which its table is certified");
                Err(ToldError { key: "lag_ms", value: thousandths(1e3 * lag_s), must })
            }
            _ => Ok(()),
        }
    }
}

/// The masses that the laws take of a vehicle, kg.
fn bounds_kg(own_kg: f64) -> [f64; 2] {
    [0.5 * own_kg, 2.0 * own_kg]
}

/// The lags that the laws take of a vehicle, ms: of one that is not built in, the region of the table that `quatrack gains craft` makes.
pub(super) fn lag_range_ms(vehicle: &Vehicle) -> [f64; 2] {
    if vehicles::is_built_in(vehicle) {
        return BUILT_IN_LAG_MS;
    }
    match standard_design(vehicle).map(|design| design.problem) {
        Ok(Problem::Cascade { region, .. }) => region.lag_s.map(|lag_s| thousandths(1e3 * lag_s)),
        // The laws that need a table say why there is none.
        _ => BUILT_IN_LAG_MS,
    }
}

/// As it is printed.
pub(super) fn thousandths(value: f64) -> f64 {
    (1e3 * value).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::motor_loop::RATE;
    use quatrack::Air;

    #[test]
    fn ranges_are_those_of_the_core() {
        assert_eq!(DRAG_PER_S[1] as f32, Air::DRAG_MAX_PER_S);
        assert_eq!(MOMENT_N_M_PER_M_S[1] as f32, Air::MOMENT_MAX_N_S);
        assert!(Air { drag_per_s: DRAG_PER_S[1] as f32, ..Air::NONE }.checked().is_ok());
        let moment_n_s = [MOMENT_N_M_PER_M_S[1] as f32; 2];
        assert!(Air { moment_n_s, ..Air::NONE }.checked().is_ok());
    }

    #[test]
    fn figures_are_taken_to_the_ends_of_their_ranges() {
        let vehicle = vehicles::by_name("crazyflie-2.1").unwrap();
        let own = ToldFigures { mass_kg: vehicle.mass_kg(), lag_s: None, drag_per_s: None, moment_n_m_per_m_s: None };
        for told in [
            ToldFigures { lag_s: Some(0.126), drag_per_s: Some(1.0), moment_n_m_per_m_s: Some([2e-3, 0.0]), ..own },
            ToldFigures { lag_s: Some(0.004), mass_kg: 2.0 * own.mass_kg, ..own },
        ] {
            assert_eq!(told.taken_of(&vehicle), Ok(()));
        }
        for (told, key) in [
            (ToldFigures { lag_s: Some(0.127), ..own }, "lag_s"),
            (ToldFigures { lag_s: Some(f64::NAN), ..own }, "lag_s"),
            (ToldFigures { mass_kg: 0.3, ..own }, "mass_kg"),
            (ToldFigures { drag_per_s: Some(1.1), ..own }, "drag_per_s"),
            (ToldFigures { moment_n_m_per_m_s: Some([0.0, 3e-3]), ..own }, "moment_n_m_per_m_s"),
        ] {
            assert_eq!(told.taken_of(&vehicle).map_err(|error| error.key), Err(key));
        }
    }

    #[test]
    fn the_lags_of_built_in_vehicles_are_those_of_their_tables() {
        use quatrack::gains::cascade::{BRUSHLESS, CRAZYFLIE_2_1, UPGRADE_KIT};
        for tables in [BRUSHLESS, CRAZYFLIE_2_1, UPGRADE_KIT] {
            let longest_s =
                tables.map(|built_in| built_in.table.certified.motor_lag_s[1]).into_iter().fold(0.0, f32::max);
            assert_eq!(thousandths(1e3 * f64::from(longest_s)), BUILT_IN_LAG_MS[1]);
        }
        assert_eq!(BUILT_IN_LAG_MS[0], 2e3 / f64::from(RATE.hz()));
    }

    #[test]
    fn the_lags_of_a_file_are_those_that_its_table_is_certified_for() {
        assert_eq!(lag_range_ms(&vehicles::by_name("crazyflie-2.1").unwrap()), [4.0, 126.0]);
        let text = include_str!("../../../../gains/vehicles/crazyflie-2.1-legacy.toml");
        let own = vehicles::from_toml(&text.replace("lag_s = 0.126\n", "lag_s = 0.08\n")).unwrap();
        // 0.5 times 0.79 of the file's 80 ms, to all of it.
        assert_eq!(lag_range_ms(&own), [31.6, 80.0]);
    }
}
