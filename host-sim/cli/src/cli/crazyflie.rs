//! `quatrack crazyflie`: the controller as the Crazyflie's firmware calls it, flown and counted.

use quatrack_simulation::crazyflie::{CrazyflieReport, knows};
use quatrack_simulation::scenario::{Law, Scenario};

use super::scenario::ScenarioArgs;
use super::transform::TransformArgs;
use super::vehicle::VehicleChoice;
use super::{Failure, fly, output};
use crate::pil::crazyflie::count;
use crate::pil::image;

/// Flies the Crazyflie controller through its C interface on the rigid plant, with the firmware's setpoints, rates and
/// power distribution: position errors of every course and case.
///
/// With --count, builds the object for the firmware inside a checkout, runs it on the emulated Cortex-M4, counts the
/// instructions of every call and compares every bit of its outputs with the host's.
///
/// With --scenario, or a flag of one other than --vehicle, flies the controller's default table on that scenario alone, as
/// `fly` does with the law "crazyflie". A vehicle file that the controller does not know flies so, too, with the table that
/// `gains craft` makes for it. Otherwise the courses are flown in vacuum, by --vehicle or else crazyflie-2.1.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// Count instructions instead of flying.
    #[arg(long, conflicts_with_all = ["vehicle", "scenario"])]
    count: bool,
    /// Write the figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if args.count {
        let counts = image::checkout().and_then(|checkout| count(&checkout)).map_err(Failure::input)?;
        return report(args, "crazyflie-count", &counts);
    }
    let name = args.scenario.vehicle.as_deref().unwrap_or("crazyflie-2.1");
    let VehicleChoice(vehicle) = name.parse().map_err(Failure::input)?;
    if args.scenario.any_but_vehicle() || !knows(&vehicle) {
        if args.scenario.law.is_some_and(|law| law != Law::Crazyflie) {
            return Err(Failure::input(
                "--law: `crazyflie` flies the Crazyflie controller alone; take `fly` for other laws",
            ));
        }
        let scenario = Scenario { law: Law::Crazyflie, ..args.scenario.checked()? };
        let (figures, _) = fly::scenario::fly_and_print(&scenario, &TransformArgs::default())?;
        if let Some(path) = &args.json {
            output::write_json(path, &figures)?;
            output::print(&format!("wrote {}\n", path.display()))?;
        }
        return figures.outcome();
    }
    report(args, "crazyflie", &CrazyflieReport::of(&vehicle).map_err(Failure::input)?)
}

fn report(args: &Args, name: &str, figures: &(impl std::fmt::Display + serde::Serialize)) -> Result<(), Failure> {
    output::print(&figures.to_string())?;
    if let Some(path) = &args.json {
        output::write_json(path, &output::Named::new(name, figures))?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}
