//! `quatrack reproduce`: nothing in; Table I beside ours, Figures 2 to 5 as files, and an exit code out.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use quatrack_design::model::position;
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::plan::{self, Plan, PlanError};
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::flight::closed_loop::Flight;
use quatrack_simulation::reproduction::extensions::Extensions;
use quatrack_simulation::reproduction::report::Reproduction;
use quatrack_simulation::reproduction::table::Controller;

use super::{Failure, output, picture};
use crate::figures::{Curve, TrackingFigure};

/// Reproduces the paper: plans both trajectories from their waypoints, designs all four gains, flies every cell of
/// Table I, and draws Figures 2 to 5.
///
/// "as published" carries the two slips of the published simulation and must round to every printed digit, else the
/// exit code is 1. "exact" is without them. "f32 core" flies the crate that runs on the board, with its commands held.
/// "with feed-forward" adds the reference's own input, in continuous time.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder for the figures, created where it is missing.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Write the table as JSON as well: iae.{mild,aggressive}.CONTROLLER.{paper, as_published, exact, core_f32.HZ,
    /// feed_forward} in m s, and min_z of the flights at mu = 1 in m; with --beyond also beyond.{mild,aggressive}.METHOD.HZ.
    /// {feedback, feed_forward, half_period_ahead} in m s.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
    /// Go past the paper as well: sampled LQR, LQI and time-varying LQR beside the paper's designs, flown by the f32 core at
    /// 25, 100 and 500 Hz with feedback alone ("feedback"), with the reference's input fed forward ("+ input"), and with the
    /// input of half a period later ("+ ahead"), which is that of the middle of the time a command is held.
    #[arg(long)]
    beyond: bool,
}

/// Number of the figure, its title, the course and the controllers that it shows.
const FIGURES: [(u32, &str, PaperTrajectory, [Controller; 2]); 4] = [
    (2, "Lyapunov design, mu = 2, mild trajectory", PaperTrajectory::Mild, [Controller::LyapF, Controller::LyapE]),
    (
        3,
        "Lyapunov design, mu = 2, aggressive trajectory",
        PaperTrajectory::Aggressive,
        [Controller::LyapF, Controller::LyapE],
    ),
    (4, "LQR design, mild trajectory", PaperTrajectory::Mild, [Controller::LqrF, Controller::LqrE]),
    (5, "LQR design, aggressive trajectory", PaperTrajectory::Aggressive, [Controller::LqrF, Controller::LqrE]),
];

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    output::create_dir(&args.out)?;
    let (mild, aggressive) = courses()?;
    let reproduction = Reproduction::fly(&mild, &aggressive).map_err(Failure::verdict)?;
    output::print(&format!("{reproduction}\n"))?;
    let beyond = args.beyond.then(|| Extensions::fly(&mild, &aggressive)).transpose().map_err(Failure::verdict)?;
    if let Some(beyond) = &beyond {
        output::print(&format!("{beyond}\n"))?;
    }
    write_figures(&reproduction, &args.out)?;
    if let Some(path) = &args.json {
        output::write_json(path, &output::Named::new("reproduce", &reproduction.report().with(beyond.as_ref())))?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    if reproduction.is_reproduced() {
        Ok(())
    } else {
        let cells = reproduction.reproduced_cells();
        Err(Failure::verdict(format!("only {cells} of the 8 cells of Table I round to the printed digits")))
    }
}

/// Both trajectories, planned from their waypoints.
fn courses() -> Result<(PiecewisePolynomial, PiecewisePolynomial), Failure> {
    let planned = |plan: Result<Plan, PlanError>| {
        let curve = plan.and_then(|plan| plan.solve()).map_err(Failure::verdict)?;
        PiecewisePolynomial::from_bspline(&curve).map_err(Failure::verdict)
    };
    Ok((planned(plan::paper::mild())?, planned(plan::paper::aggressive())?))
}

/// All flights of Table I.
pub(super) fn fly() -> Result<Reproduction, Failure> {
    let (mild, aggressive) = courses()?;
    Reproduction::fly(&mild, &aggressive).map_err(Failure::verdict)
}

/// Number, title, SVG and PNG of each figure; the latter as it is asked for.
pub(super) fn figures(reproduction: &Reproduction) -> Result<Vec<(u32, &'static str, String)>, Failure> {
    let mut drawn = Vec::new();
    for (number, title, course, controllers) in FIGURES {
        let flights: Vec<&Flight> = controllers
            .iter()
            .filter_map(|controller| Some(&reproduction.outcome(course, *controller)?.published_flight))
            .collect();
        let tracks: Vec<Track> = flights.iter().map(|flight| Track::flown(flight)).collect();
        let Some(reference) = flights.first().map(|flight| Track::reference(flight)) else { continue };
        let labels = controllers.map(|controller| controller.to_string());
        let figure = TrackingFigure {
            title: &format!("Fig. {number}: {title}"),
            reference: reference.curve("reference"),
            flights: tracks.iter().zip(&labels).map(|(track, label)| track.curve(label)).collect(),
        };
        drawn.push((number, title, figure.to_svg().map_err(Failure::verdict)?));
    }
    Ok(drawn)
}

fn write_figures(reproduction: &Reproduction, dir: &Path) -> Result<(), Failure> {
    figures(reproduction)?
        .iter()
        .try_for_each(|(number, _, document)| picture::write_both(dir, &format!("figure{number}"), document))
}

/// A flight's positions over time, as a figure takes them.
struct Track {
    time_s: Vec<f64>,
    position_m: Vec<Vector3<f64>>,
}

impl Track {
    fn flown(flight: &Flight) -> Self {
        Self {
            time_s: flight.samples.iter().map(|s| s.time_s).collect(),
            position_m: flight.samples.iter().map(|s| position(&s.state)).collect(),
        }
    }

    fn reference(flight: &Flight) -> Self {
        Self {
            time_s: flight.samples.iter().map(|s| s.time_s).collect(),
            position_m: flight.samples.iter().map(|s| position(&s.target.state)).collect(),
        }
    }

    fn curve<'a>(&'a self, label: &'a str) -> Curve<'a> {
        Curve { label, time_s: &self.time_s, position_m: &self.position_m }
    }
}
