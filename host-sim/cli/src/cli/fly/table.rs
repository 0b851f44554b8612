//! The flight of a gain table: its file in; the core flies it as a board does that has loaded it.

mod motors;

use std::path::Path;

use quatrack::gains::table::{AcceptError, GainTable, TableKind};
use quatrack::{Limits, Rate, Settings, Trajectory};
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::flight::reference::{Exact, Reference};
use quatrack_simulation::gains::{Design, OnBoardTrajectory};

use super::{Args, DescribedFlight, Precision, fly_law, load};
use crate::cli::limits::LimitsChoice;
use crate::cli::{Failure, gains};

/// Flies the table of a file at its own rate; another one that is asked for is refused.
pub(super) fn fly(args: &Args, path: &Path, rate: Option<Rate>) -> Result<DescribedFlight, Failure> {
    if args.precision == Precision::F64 {
        return Err(Failure::input("--precision f64: a table is flown by the f32 core; leave --precision out"));
    }
    let bytes = bytes(path)?;
    let table = GainTable::from_bytes(&bytes).map_err(|error| refused(path, &error))?;
    let (kind, head) = (table.kind(), *table.head());
    if kind == TableKind::ActuatorAware {
        return motors::fly(args, path, &table, rate, &load(args)?);
    }
    let rate = rate.unwrap_or(head.rate);
    let accepted = table.accept_for(&head.vehicle, rate).map_err(|error| not_accepted(path, &error))?;
    let mut trajectory = load(args)?;
    if kind == TableKind::AlongTrajectory {
        trajectory = stored(&args.trajectory).unwrap_or(trajectory);
        let pieces = on_board::pieces(&trajectory);
        if !Trajectory::new(&pieces).is_ok_and(|flown| accepted.is_for(&flown)) {
            let reason = format!("its gains are for another trajectory than --trajectory {}", args.trajectory);
            return Err(refused(path, &reason));
        }
    }
    let settings = Settings {
        limits: Limits::NONE,
        actuation: None,
        feed_forward: args.feed_forward(),
        error_form: args.error_form(),
        player_rate: rate,
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
