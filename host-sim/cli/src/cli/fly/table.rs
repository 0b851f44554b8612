//! The flight of a gain table: its file in; the core flies it as a board does that has loaded it.

mod motors;

use std::path::Path;

use quatrack::gains::table::{AcceptError, GainTable, ScheduleTable, TableHead, TableKind};
use quatrack::{FlightLaw, Rate, Trajectory};
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::flight::reference::{Exact, Reference};
use quatrack_simulation::gains::{Course, Design};

use super::{Args, Flown, Precision, fly_law, load};
use crate::cli::limits::LimitsChoice;
use crate::cli::{Failure, gains};

/// Flies the table of a file at its own rate; another one that is asked for is refused.
pub(super) fn fly(args: &Args, path: &Path, rate: Option<Rate>) -> Result<Flown, Failure> {
    if args.precision == Precision::F64 {
        return Err(Failure::input("--precision f64: a table is flown by the f32 core; leave --precision out"));
    }
    let bytes = bytes(path)?;
    let kind = TableKind::of(&bytes).map_err(|error| refused(path, &error))?;
    let trajectory = load(args)?;
    if kind == TableKind::AlongTrajectory {
        let table = ScheduleTable::from_bytes(&bytes).map_err(|error| refused(path, &error))?;
        let head = *table.head();
        let rate = rate.unwrap_or(head.rate);
        let accepted = table.accept_for(&head.vehicle, rate).map_err(|error| not_accepted(path, &error))?;
        let trajectory = stored(&args.trajectory).unwrap_or(trajectory);
        let pieces = on_board::pieces(&trajectory);
        if !Trajectory::new(&pieces).is_ok_and(|flown| accepted.is_for(&flown)) {
            let reason = format!("its gains are for another trajectory than --trajectory {}", args.trajectory);
            return Err(refused(path, &reason));
        }
        return flown(args, &head, kind, &trajectory, accepted.law(rate, args.feed_forward()).into());
    }
    if kind == TableKind::ActuatorAware {
        return motors::fly(args, path, &bytes, rate, &trajectory);
    }
    let table = GainTable::from_bytes(&bytes).map_err(|error| refused(path, &error))?;
    let head = *table.head();
    let rate = rate.unwrap_or(head.rate);
    let accepted = table.accept_for(&head.vehicle, rate).map_err(|error| not_accepted(path, &error))?;
    flown(args, &head, kind, &trajectory, accepted.law(args.feed_forward(), args.error_form()))
}

/// The paper's trajectories as they stand on board: gains over time belong to their bits, and those of one that is planned
/// anew depend on the processor.
fn stored(name: &str) -> Option<PiecewisePolynomial> {
    matches!(name, "mild" | "aggressive")
        .then(|| Course::named(name, Path::new("")).ok())
        .flatten()
        .map(|course| course.trajectory().clone())
}

fn flown(
    args: &Args,
    head: &TableHead,
    kind: TableKind,
    trajectory: &PiecewisePolynomial,
    law: FlightLaw<'_>,
) -> Result<Flown, Failure> {
    let limits = args
        .limits
        .clone()
        .unwrap_or_else(|| LimitsChoice { name: format!("of the table, {}", head.vehicle.name), limits: head.limits });
    Ok(Flown {
        law: format!("{} ({kind})", head.name),
        clock: format!("f32 core, {} Hz hold", head.rate.hz()),
        limits: limits.name,
        duration_s: Exact(trajectory).duration_s(),
        flight: fly_law(args, law, trajectory, head.rate, limits.limits)?,
    })
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

/// A binary table, or the table of a design.
fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    if path.extension().is_some_and(|extension| extension == "toml") {
        let certified =
            Design::from_file(path).and_then(|design| design.certify()).map_err(|error| gains::failed(path, &error))?;
        return certified
            .to_bytes()
            .ok_or_else(|| refused(path, &"no law on board remembers its last commands; set delay_samples = 0"));
    }
    std::fs::read(path).map_err(|error| refused(path, &format!("cannot be read ({error})")))
}
