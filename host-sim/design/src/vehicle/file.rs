//! The contents of a vehicle file, in any format that serde reads; a [`Vehicle`] whose figures are in range out, and back.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::check::{body_rate, check, lag, one_body, positive, thrust_max, torque_per_thrust};
use super::flown::{AirFigures, BatteryFigures, FlightFigures, ForceFigures, MotorFigures, PropellerFigures};
use super::identified::{Identified, sound};
use super::{Motors, Vehicle, VehicleError};
use crate::model::GRAVITY_M_S2;

/// Longest name, bytes: fits the names that tables carry.
const LONGEST_NAME: usize = 64;

/// The figures of a vehicle as a file states them, not yet looked at; `Vehicle::try_from` does that.
///
/// Its entries are described in `gains/vehicles` of the repository, where each built-in figure has its source beside it:
/// `name`; `body` with `mass_kg` and `inertia_kg_m2`, by rows; `motors` with `arm_m`, `thrust_min_n`, `thrust_max_n`,
/// `torque_per_thrust_m`, `lag_s` and `published_lag_s`; `limits` with `body_rates_rad_s`; and its figures in flight,
/// each where somebody has measured it: `air`, `motors.flown`, `motors.force`, `propeller`, `battery`, with the keys of
/// [`super::FlightFigures`]; and `identified`, the intervals of figures identified from its flights.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleFile {
    name: String,
    body: BodyEntry,
    motors: MotorsEntry,
    limits: LimitsEntry,
    air: Option<AirFigures>,
    propeller: Option<PropellerFigures>,
    battery: Option<BatteryFigures>,
    #[serde(default)]
    identified: Identified,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct BodyEntry {
    mass_kg: f64,
    inertia_kg_m2: [[f64; 3]; 3],
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct MotorsEntry {
    arm_m: f64,
    thrust_min_n: f64,
    thrust_max_n: f64,
    torque_per_thrust_m: f64,
    lag_s: f64,
    published_lag_s: [f64; 2],
    flown: Option<MotorFigures>,
    force: Option<ForceFigures>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct LimitsEntry {
    body_rates_rad_s: [f64; 3],
}

impl From<&Vehicle> for VehicleFile {
    /// The figures as a file states them: read again, they are the same vehicle to the bit.
    fn from(vehicle: &Vehicle) -> Self {
        let Motors { arm_m, thrust_min_n, thrust_max_n, torque_per_thrust_m, lag_s, published_lag_s } = vehicle.motors;
        let FlightFigures { air, motors: flown, force, propeller, battery } = vehicle.flown;
        let inertia = &vehicle.inertia_kg_m2;
        Self {
            name: vehicle.name.clone(),
            body: BodyEntry {
                mass_kg: vehicle.mass_kg,
                inertia_kg_m2: [0, 1, 2].map(|i| [0, 1, 2].map(|j| inertia[(i, j)])),
            },
            motors: MotorsEntry {
                arm_m,
                thrust_min_n,
                thrust_max_n,
                torque_per_thrust_m,
                lag_s,
                published_lag_s,
                flown,
                force,
            },
            limits: LimitsEntry { body_rates_rad_s: vehicle.body_rates_max_rad_s.into() },
            air,
            propeller,
            battery,
            identified: vehicle.identified.clone(),
        }
    }
}

impl TryFrom<VehicleFile> for Vehicle {
    type Error = VehicleError;

    /// # Errors
    /// [`VehicleError`] for a name that no table can carry or a figure out of range.
    fn try_from(file: VehicleFile) -> Result<Self, VehicleError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-._".contains(c);
        if file.name.is_empty() || file.name.len() > LONGEST_NAME || !file.name.chars().all(plain) {
            // Printed text stays on one line.
            let name = file.name.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
            return Err(VehicleError::Name { name, longest: LONGEST_NAME });
        }
        positive("body.mass_kg", file.body.mass_kg)?;
        let (inertia_kg_m2, inverse_inertia) = inertia(&file.body.inertia_kg_m2)?;
        positive("motors.arm_m", file.motors.arm_m)?;
        let moments = inertia_kg_m2.symmetric_eigenvalues();
        let lengths_m = (file.motors.arm_m, file.motors.torque_per_thrust_m);
        one_body(file.body.mass_kg, [moments.min(), moments.max()], lengths_m, file.motors.thrust_max_n)?;
        // Before what is held against them.
        let motors = motors(&file.motors, 0.25 * file.body.mass_kg * GRAVITY_M_S2)?;
        let flown = FlightFigures {
            air: file.air,
            motors: file.motors.flown,
            force: file.motors.force,
            propeller: file.propeller,
            battery: file.battery,
        };
        flown.check(file.motors.arm_m, file.motors.thrust_max_n)?;
        sound(&file.identified)?;
        let rates = file.limits.body_rates_rad_s;
        rates.iter().try_for_each(|rate| body_rate("limits.body_rates_rad_s", *rate))?;
        Ok(Self {
            motors,
            name: file.name,
            mass_kg: file.body.mass_kg,
            inertia_kg_m2,
            inverse_inertia,
            body_rates_max_rad_s: Vector3::from(rates),
            flown,
            identified: file.identified,
        })
    }
}

/// Symmetric, and that of a body: no principal moment above the sum of the two others. With its inverse.
fn inertia(rows: &[[f64; 3]; 3]) -> Result<(Matrix3<f64>, Matrix3<f64>), VehicleError> {
    let field = "body.inertia_kg_m2";
    let matrix = Matrix3::from_fn(|i, j| rows[i][j]);
    for i in 0..3 {
        positive(field, matrix[(i, i)])?;
        for j in 0..i {
            let (value, mirrored) = (matrix[(i, j)], matrix[(j, i)]);
            check(value == mirrored, field, value, format!("symmetric: the entry across the diagonal is {mirrored}"))?;
        }
    }
    let moments = matrix.symmetric_eigenvalues();
    let (least, most) = (moments.min(), moments.max());
    let singular = || VehicleError::Value {
        field: field.to_owned(),
        value: least,
        must: "positive definite; this is its least principal moment".to_owned(),
    };
    let inverse = matrix.cholesky().ok_or_else(singular)?.inverse();
    // The sum of all three is the trace. A flat body reaches equality, up to rounding.
    let others = matrix.trace() - most;
    check(
        most <= others * (1.0 + 1e-9),
        field,
        most,
        format!("that of a body: this is its largest principal moment, the two others come to {others:e}"),
    )?;
    Ok((matrix, inverse))
}

fn motors(entry: &MotorsEntry, hover_n: f64) -> Result<Motors, VehicleError> {
    let MotorsEntry { arm_m, thrust_min_n, thrust_max_n, torque_per_thrust_m, lag_s, published_lag_s, .. } = *entry;
    torque_per_thrust("motors.torque_per_thrust_m", torque_per_thrust_m, arm_m)?;
    check(
        (0.0..hover_n).contains(&thrust_min_n),
        "motors.thrust_min_n",
        thrust_min_n,
        format!("from 0 to below {hover_n:.6} N, a quarter of the weight"),
    )?;
    thrust_max("motors.thrust_max_n", thrust_max_n, hover_n)?;
    lag("motors.lag_s", lag_s)?;
    let [shortest, longest] = published_lag_s;
    lag("motors.published_lag_s", shortest)?;
    lag("motors.published_lag_s", longest)?;
    let must = format!("the shortest, then the longest; the shortest is {shortest}");
    check(shortest <= longest, "motors.published_lag_s", longest, must)?;
    Ok(Motors { arm_m, thrust_min_n, thrust_max_n, torque_per_thrust_m, lag_s, published_lag_s })
}
