//! A flight of a scenario in; its files, each where one was asked for, out: log, picture, figures.

use std::path::Path;

use quatrack_simulation::scenario::{Recording, Scenario};

use super::Report;
use crate::cli::fly::picture;
use crate::cli::{Failure, output};

/// The files of a flight.
pub(in crate::cli) struct Outputs<'a> {
    /// The log's folder, which is there.
    pub(in crate::cli) dir: Option<&'a Path>,
    /// The figures.
    pub(in crate::cli) json: Option<&'a Path>,
    /// The picture.
    pub(in crate::cli) plot: Option<&'a Path>,
    /// A log as a craft records it, CSV.
    pub(in crate::cli) log: Option<&'a Path>,
    /// The flight for Foxglove and PlotJuggler.
    pub(in crate::cli) mcap: Option<&'a Path>,
}

/// A flight as an MCAP file, in a command that was built with it.
#[cfg(feature = "mcap")]
fn mcap_file(scenario: &Scenario, law: &str, recording: &Recording) -> Result<Vec<u8>, Failure> {
    let half_arm_m = scenario.vehicle.motors().half_arm_m();
    quatrack_campaign::mcap::file(recording, law, half_arm_m).map_err(Failure::verdict)
}

#[cfg(not(feature = "mcap"))]
fn mcap_file(_: &Scenario, _: &str, _: &Recording) -> Result<Vec<u8>, Failure> {
    Err(Failure::input("--mcap: this command was built without it; build it by cargo build --release --features mcap"))
}

impl Outputs<'_> {
    /// Writes the files asked for; exit code 3 for a craft that was lost.
    pub(in crate::cli) fn write(
        &self,
        scenario: &Scenario,
        figures: Report,
        recording: &Recording,
    ) -> Result<(), Failure> {
        if let Some(dir) = self.dir {
            let path = dir.join("flight.csv");
            output::write(&path, recording.to_csv().as_bytes())?;
            output::print(&format!("wrote {}\n", path.display()))?;
        }
        if let Some(path) = self.log {
            output::write(path, recording.to_log(scenario.vehicle.motors().thrust_max_n).as_bytes())?;
            output::print(&format!("wrote {}\n", path.display()))?;
        }
        if let Some(path) = self.plot {
            let rows = recording.shown();
            if rows.len() > 1 {
                picture::write(path, &scenario.to_string(), &figures.law, &rows)?;
            } else {
                output::print("no picture: the craft was lost at its start\n")?;
            }
        }
        if let Some(path) = self.mcap {
            output::write(path, &mcap_file(scenario, &figures.law, recording)?)?;
            output::print(&format!("wrote {}\n", path.display()))?;
        }
        if let Some(path) = self.json {
            output::write_json(path, &figures)?;
            output::print(&format!("wrote {}\n", path.display()))?;
        }
        figures.outcome()
    }
}
