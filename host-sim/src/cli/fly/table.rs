//! The flight of a gain table: its file in; the core flies it as a board does that has loaded it.

use std::path::Path;

use quatrack::Rate;
use quatrack::gains::table::{AcceptError, GainTable};
use quatrack_sim::flight::reference::{Exact, Reference};
use quatrack_sim::gains::Design;

use super::{Args, Flown, Precision, fly_law, load};
use crate::cli::limits::LimitsChoice;
use crate::cli::{Failure, gains};

/// Flies the table of a file at its own rate; another one that is asked for is refused.
pub(super) fn fly(args: &Args, path: &Path, rate: Option<Rate>) -> Result<Flown, Failure> {
    let refused = |reason: &dyn std::fmt::Display| Failure::input(format!("{}: {reason}", path.display()));
    if args.precision == Precision::F64 {
        return Err(Failure::input("--precision f64: a table is flown by the f32 core; leave --precision out"));
    }
    let table = read(path)?;
    let head = *table.head();
    let rate = rate.unwrap_or(head.rate);
    let accepted = table.accept_for(&head.vehicle, rate).map_err(|error| match error {
        AcceptError::Rate { table_hz, loop_hz } => {
            refused(&format!("certified at {table_hz} Hz, not at --rate-hz {loop_hz}; leave --rate-hz out"))
        }
        other => refused(&other),
    })?;
    let limits = args
        .limits
        .clone()
        .unwrap_or_else(|| LimitsChoice { name: format!("of the table, {}", head.vehicle.name), limits: head.limits });
    let trajectory = load(args)?;
    let flight = fly_law(args, accepted.law(args.feed_forward(), args.error_form()), &trajectory, rate, limits.limits)?;
    Ok(Flown {
        law: format!("{} ({})", head.name, table.kind()),
        clock: format!("f32 core, {} Hz hold", rate.hz()),
        limits: limits.name,
        duration_s: Exact(&trajectory).duration_s(),
        flight,
    })
}

/// A binary table, or the table of a design.
fn read(path: &Path) -> Result<GainTable, Failure> {
    if path.extension().is_some_and(|extension| extension == "toml") {
        let certified =
            Design::from_file(path).and_then(|design| design.certify()).map_err(|error| gains::failed(path, &error))?;
        return certified.table.ok_or_else(|| {
            Failure::input(format!(
                "{}: no law on board remembers its last commands; set delay_samples = 0",
                path.display()
            ))
        });
    }
    let bytes =
        std::fs::read(path).map_err(|error| Failure::input(format!("{}: cannot be read ({error})", path.display())))?;
    GainTable::from_bytes(&bytes).map_err(|error| Failure::input(format!("{}: {error}", path.display())))
}
