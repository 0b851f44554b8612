//! The flight of a gain table: its file in; the core flies it as a board does that has loaded it.

use std::path::Path;
use std::str::FromStr as _;

use quatrack::gains::table::{AcceptError, GainTable, TableKind};
use quatrack::{Limits, Rate, Settings, Trajectory};
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::bounded;
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_plan::trajectory::transform::Transform;
use quatrack_simulation::control_law::ControlLaw;
use quatrack_simulation::flight::reference::{Exact, Reference};
use quatrack_simulation::flight::reference_check::ReferenceCheck;
use quatrack_simulation::gains::{Design, OnBoardTrajectory};
use quatrack_simulation::scenario::{Scenario, start_table};
use quatrack_simulation::vehicles;

use super::{Args, DescribedFlight, Precision, fly_law, load};
use crate::cli::limits::LimitsChoice;
use crate::cli::vehicle::VehicleChoice;
use crate::cli::{Failure, gains};

/// Flies the table of a file at its own rate; another one that is asked for is refused.
pub(super) fn fly(args: &Args, path: &Path, rate: Option<Rate>) -> Result<DescribedFlight, Failure> {
    if args.precision == Precision::F64 {
        return Err(Failure::input("--precision f64: a table is flown by the f32 core; leave --precision out"));
    }
    let Source { bytes, vehicle } = source(path)?;
    let table = GainTable::from_bytes(&bytes).map_err(|error| no_table(path, &bytes, &error))?;
    let (kind, head) = (table.kind(), *table.head());
    let vehicle = match &args.scenario.vehicle {
        Some(asked) => Some(VehicleChoice::from_str(asked).map_err(Failure::input)?.0),
        None => vehicle,
    };
    if let Some(vehicle) = vehicle.as_ref().filter(|vehicle| vehicles::id(vehicle) != head.vehicle.id) {
        let reason = format!(
            "made for {}, not for the figures of {} that --vehicle gives; make its table anew for these",
            head.vehicle,
            vehicle.name()
        );
        return Err(refused(path, &reason));
    }
    if kind == TableKind::Cascade {
        return Err(refused(path, &"a table of the cascade flies a scenario: give --course instead of --trajectory"));
    }
    let rate = rate.unwrap_or(head.rate);
    let accepted = table.accept_for(&head.vehicle, rate).map_err(|error| not_accepted(path, &error))?;
    let mut trajectory = load(args)?;
    if kind == TableKind::AlongTrajectory {
        if args.transform.transform()? == Transform::default() {
            trajectory = stored(&args.trajectory).unwrap_or(trajectory);
        }
        let pieces = on_board::pieces(&trajectory);
        if !Trajectory::new(&pieces).is_ok_and(|flown| accepted.is_for(&flown)) {
            let reason = format!("its gains are for another trajectory than --trajectory {}", args.trajectory);
            return Err(refused(path, &reason));
        }
    }
    let settings = Settings {
        feed_forward: args.feed_forward(),
        error_form: args.error_form(),
        ..Settings::new(Limits::NONE, rate)
    };
    let law = accepted.law(&settings).map_err(|error| refused(path, &error))?;
    let limits = args
        .limits
        .clone()
        .unwrap_or_else(|| LimitsChoice { name: format!("of the table, {}", head.vehicle.name), limits: head.limits });
    Ok(DescribedFlight {
        law: format!("{} ({kind})", head.name),
        clock: format!("f32 core, {} Hz hold", head.rate.hz()),
        limits: limits.name,
        duration_s: Exact(&trajectory).duration_s(),
        reference: ReferenceCheck::of(&trajectory, &limits.limits).line(),
        flight: fly_law(args, law, &trajectory, head.rate, limits.limits)?,
    })
}

/// The paper's trajectories as they are stored on board: gains over time belong to their bits, and those of one that is planned
/// anew depend on the processor.
fn stored(name: &str) -> Option<PiecewisePolynomial> {
    matches!(name, "mild" | "aggressive")
        .then(|| OnBoardTrajectory::named(name, Path::new("")).ok())
        .flatten()
        .map(|course| course.trajectory().clone())
}

fn refused(path: &Path, reason: &dyn std::fmt::Display) -> Failure {
    Failure::input(format!("{}: {reason}", path.display()))
}

fn not_accepted(path: &Path, error: &AcceptError) -> Failure {
    match error {
        AcceptError::Rate { table_hz, loop_hz } => {
            refused(path, &format!("certified at {table_hz} Hz, not at --rate-hz {loop_hz}; leave --rate-hz out"))
        }
        other => refused(path, other),
    }
}

/// Flies a table of the cascade as the law of a scenario, on the vehicle that it was made for.
pub(in crate::cli) fn in_scenario<T>(
    path: &Path,
    source: &Source,
    scenario: &Scenario,
    fly: &dyn Fn(&mut dyn ControlLaw, &str) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let table = GainTable::from_bytes(&source.bytes).map_err(|error| no_table(path, &source.bytes, &error))?;
    let started = start_table(&scenario.vehicle, &scenario.told, &table);
    let mut law = started.map_err(|error| refused(path, &error))?;
    fly(law.as_mut(), table.head().name.as_str())
}

/// A file that is no table: text is named as such, with the table beside it.
fn no_table(path: &Path, bytes: &[u8], error: &dyn std::fmt::Display) -> Failure {
    let Ok(text) = std::str::from_utf8(bytes) else { return refused(path, error) };
    let kind = match text.trim_start().chars().next() {
        None => "an empty file",
        Some('{' | '[') => "JSON, a certificate perhaps",
        Some(_) => "text",
    };
    let beside = path.with_extension("bin");
    let remedy = if beside != path && beside.is_file() {
        format!("the table beside it is {}", beside.display())
    } else {
        "give the binary table (.bin) or the design (.toml) that it comes from".to_owned()
    };
    refused(path, &format!("is {kind}, not a binary gain table; {remedy}"))
}

/// A table, and the vehicle of the design that it was made of.
pub(in crate::cli) struct Source {
    bytes: Vec<u8>,
    vehicle: Option<Vehicle>,
}

impl Source {
    /// The vehicle of the design, or the built-in one that the table is for.
    pub(in crate::cli) fn own_vehicle(&self, path: &Path) -> Result<Vehicle, Failure> {
        if let Some(vehicle) = &self.vehicle {
            return Ok(vehicle.clone());
        }
        let table = GainTable::from_bytes(&self.bytes).map_err(|error| no_table(path, &self.bytes, &error))?;
        let head = table.head();
        let mut built_in = vehicles::names().into_iter().filter_map(|name| vehicles::by_name(name).ok());
        built_in.find(|vehicle| vehicles::id(vehicle) == head.vehicle.id).ok_or_else(|| {
            let reason =
                format!("no built-in vehicle is its {}; give --vehicle FILE, or the design (.toml)", head.vehicle);
            refused(path, &reason)
        })
    }
}

/// A binary table, which says of its vehicle no more than its name and figures' checksum; or the table of a design.
pub(in crate::cli) fn source(path: &Path) -> Result<Source, Failure> {
    if path.extension().is_some_and(|extension| extension == "toml") {
        let design = Design::from_file(path).map_err(|error| gains::failed(path, &error))?;
        let certified = design.certify().map_err(|error| gains::failed(path, &error))?;
        let bytes = certified.to_bytes().ok_or_else(|| refused(path, &certified.why_no_table()))?;
        return Ok(Source { bytes, vehicle: Some(design.vehicle) });
    }
    let bytes = bounded::read(path).map_err(|error| refused(path, &format!("cannot be read ({error})")))?;
    Ok(Source { bytes, vehicle: None })
}
