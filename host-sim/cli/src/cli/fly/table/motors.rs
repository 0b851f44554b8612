//! The flight of an actuator-aware table: on the rigid plant of its vehicle, with motors of the lag that it reckons with.

use std::path::Path;

use quatrack::Rate;
use quatrack::gains::table::{GainTable, TableKind};
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::trajectory::fifth_order::FlatTrajectory as _;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::flight::motor_laws::{CraftLaw, fly as fly_motors};
use quatrack_simulation::flight::motor_loop::{RATE, STEPS_A_SAMPLE, state_on};
use quatrack_simulation::flight::reference::Exact;
use quatrack_simulation::flight::reference_check::ReferenceCheck;
use quatrack_simulation::flight::rigid_loop::Conditions;
use quatrack_simulation::plant::Craft;
use quatrack_simulation::vehicles;

use super::super::{Args, DescribedFlight};
use super::{not_accepted, refused, source};
use crate::cli::Failure;

pub(super) fn fly(
    args: &Args,
    path: &Path,
    table: &GainTable<'_>,
    own: Option<Vehicle>,
    rate: Option<Rate>,
    trajectory: &PiecewisePolynomial,
) -> Result<DescribedFlight, Failure> {
    if args.limits.is_some() {
        return Err(refused(path, &"its limits are those of its vehicle's motors; leave --limits out"));
    }
    let head = *table.head();
    if head.rate != RATE {
        return Err(refused(path, &format!("for {} Hz; the rigid plant is flown at {} Hz", head.rate.hz(), RATE.hz())));
    }
    let vehicle = own.map_or_else(|| source(path)?.own_vehicle(path), Ok)?;
    let accepted =
        table.accept_for(&head.vehicle, rate.unwrap_or(head.rate)).map_err(|error| not_accepted(path, &error))?;
    let law = CraftLaw::of_table(&vehicle, accepted).map_err(|error| refused(path, &error))?;
    let lag_s = table.lag().map_or_else(|| vehicle.motors().lag_s, |lag| f64::from(lag.lag_s()));
    let mut craft = Craft::new(&vehicle);
    craft.motors = craft.motors.with_lag(lag_s, lag_s);
    let start = state_on(&trajectory.at(0.0), law.airframe())
        .map_err(|error| Failure::input(format!("{}: {error}", args.trajectory)))?;
    let duration_s = trajectory.duration_s();
    let conditions = Conditions { duration_s, steps_a_sample: STEPS_A_SAMPLE, delay_s: 0.0, noise: None };
    let flight = fly_motors(&law, &craft, &start, trajectory, &conditions);
    Ok(DescribedFlight {
        law: format!("{} ({})", head.name, TableKind::ActuatorAware),
        clock: format!("f32 core, {} Hz hold, rigid craft with {:.1} ms of motor lag", head.rate.hz(), 1e3 * lag_s),
        limits: format!("of the motors, {}", head.vehicle.name),
        duration_s,
        reference: ReferenceCheck::of(trajectory, &vehicles::limits(&vehicle).map_err(Failure::input)?).line(),
        flight: flight.in_the_model(vehicle.mass_kg(), &Exact(trajectory)),
    })
}
