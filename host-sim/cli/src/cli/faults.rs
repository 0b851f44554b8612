//! `quatrack faults`: every kind of fault on three crafts in; the end of each flight, in one table, out.

use std::fmt::Write as _;

use quatrack_simulation::faults::{Crafts, Fault, Row, VEHICLES, fly, kinds};
use serde::Serialize;

use super::{Failure, output};
use crate::pil::emulated::{self, Equipment, Transport};
use crate::pil::interrupt::Interrupt;
use crate::pil::{PilError, faults as on_board, image};

/// Flies the core's cascade under its supervisor through every kind of fault, on three crafts in air, and prints how each
/// flight ends.
///
/// Exit code 1 where anything that is recoverable was lost, or a fault that is not did not end with the motors off.
///
/// Examples:
///   quatrack faults --json faults.json
///   quatrack faults --only gyro --vehicle crazyflie-2.1-brushless
///   quatrack faults --emulator
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// Only faults whose name begins with this.
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Only this craft.
    #[arg(long, value_name = "NAME", value_parser = VEHICLES)]
    vehicle: Option<String>,
    /// Fly the worst twelve that a board sees over its link by the image on an emulated board instead, at a hover.
    #[arg(long, conflicts_with = "vehicle")]
    emulator: bool,
    /// Write the table as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
}

#[derive(Serialize)]
struct Table<'a> {
    schema: &'static str,
    rows: &'a [Row],
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let only = args.only.as_deref().unwrap_or("");
    let is_asked =
        |fault: &Fault| fault.name.starts_with(only) && (!args.emulator || on_board::WORST.contains(&fault.name));
    let faults: Vec<Fault> = kinds().into_iter().filter(is_asked).collect();
    if faults.is_empty() {
        return Err(Failure::input(format!("--only {only}: no fault begins with this; leave it out to see all")));
    }
    let mut rows =
        if args.emulator { by_a_board(&faults).map_err(Failure::input)? } else { by_the_core(&faults, args)? };
    rows.sort_by_key(|row| faults.iter().position(|fault| fault.name == row.fault));
    output::print(&text(&rows))?;
    if let Some(path) = &args.json {
        output::write_json(path, &Table { schema: "quatrack/faults/1", rows: &rows })?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    let wrong: Vec<String> = rows
        .iter()
        .filter(|row| !row.is_as_promised())
        .map(|row| format!("{} on {}", row.fault, row.vehicle))
        .collect();
    if wrong.is_empty() { Ok(()) } else { Err(Failure::verdict(format!("not as it should be: {}", wrong.join("; ")))) }
}

fn by_the_core(faults: &[Fault], args: &Args) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for name in VEHICLES.into_iter().filter(|name| args.vehicle.as_deref().is_none_or(|asked| asked == *name)) {
        let craft = Crafts::by_name(name).ok_or_else(|| Failure::input(format!("{name}: not known")))?;
        for fault in faults {
            rows.push(fly(fault, &craft).map_err(Failure::input)?);
        }
    }
    Ok(rows)
}

/// On one emulated board, one after the other.
fn by_a_board(faults: &[Fault]) -> Result<Vec<Row>, PilError> {
    let interrupt = Interrupt::listen()?;
    let image = image::build(&image::checkout()?, Transport::Pipes.image())?;
    let mut client = emulated::connect(&image, Transport::Pipes, Equipment::default(), interrupt)?;
    faults.iter().map(|fault| on_board::fly(&mut client, fault)).collect()
}

fn text(rows: &[Row]) -> String {
    let mut text = format!(
        "{:<52} {:<26} {:>9} {:>9} {:>8}  {:<9} end state\n",
        "fault", "craft", "seen ms", "off ms", "far m", "came down"
    );
    let ms = |time: Option<u32>| time.map_or_else(|| "-".to_owned(), |ms| ms.to_string());
    for row in rows {
        let down = match (row.crashed, row.recoverable) {
            (true, true) => "LOST",
            (true, false) => "hard",
            (false, _) => "",
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<52} {:<26} {:>9} {:>9} {:>8.2}  {down:<9} {}",
            row.fault,
            row.vehicle,
            ms(row.detected_ms),
            ms(row.motors_off_ms),
            row.farthest_m,
            row.end_state
        );
    }
    text
}
