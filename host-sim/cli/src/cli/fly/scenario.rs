//! The flight of a scenario: its law on its craft; figures, the log as CSV and a picture out.

mod outputs;

use quatrack_design::vehicle::Vehicle;
use quatrack_plan::trajectory::Trajectory as _;
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_plan::trajectory::transform::Transform;
use quatrack_simulation::control_law::ControlLaw;
use quatrack_simulation::flight::reference_check::ReferenceCheck;
use quatrack_simulation::scenario::{Recording, Scenario};
use quatrack_simulation::vehicles;
use serde::Serialize;

use super::{Args, NOTHING, Precision, not_on_board, table, transformed};
use crate::cli::transform::TransformArgs;
use crate::cli::{Failure, output};
pub(in crate::cli) use outputs::Outputs;

/// The schema that the figures' file states.
const SCHEMA: &str = "quatrack/fly/1";

/// The figures of a flight.
#[derive(Serialize)]
pub(in crate::cli) struct Report {
    schema: &'static str,
    law: String,
    /// None for a flight that was lost.
    iae_m_s: Option<f64>,
    max_error_m: f64,
    /// Control steps with a motor at its limit, while it was measured.
    saturated_steps: u64,
    /// Along the mean wind, across it, upwards.
    gust_rms_m_s: Option<[f64; 3]>,
    lost: Option<String>,
    /// What the course itself asks for that no law can follow.
    reference: Option<String>,
}

impl Report {
    /// Exit code 3 for a craft that was lost.
    pub(in crate::cli) fn outcome(self) -> Result<(), Failure> {
        self.lost.map_or(Ok(()), |lost| Err(Failure::lost(format!("{} was lost {lost}", self.law))))
    }
}

impl Args {
    /// Flags of a scenario beside --controller or --gains, which have none.
    pub(super) fn refuse_scenario(&self) -> Result<(), Failure> {
        if self.trajectory.is_empty() {
            return Err(Failure::input("--controller and --gains fly a trajectory: add --trajectory"));
        }
        // A table of gains has a vehicle.
        let vehicle_for_nothing = self.gains.is_none() && self.scenario.vehicle.is_some();
        if self.plot.is_some()
            || self.log.is_some()
            || self.mcap.is_some()
            || self.scenario.any_but_vehicle()
            || vehicle_for_nothing
        {
            return Err(Failure::input(
                "--controller and --gains fly the paper's model: leave out --plot, --log, --mcap and the flags of a scenario, or choose one of \
                 its laws by --law",
            ));
        }
        Ok(())
    }

    /// Flags that a scenario has under other names.
    fn refuse_older(&self) -> Result<(), Failure> {
        let given = [
            ("--trajectory", !self.trajectory.is_empty(), "--course"),
            ("--rate-hz", self.rate_hz.is_some(), "the rate of the law"),
            ("--precision", self.precision != Precision::F32, "that of the law"),
            ("--feed-forward", self.feed_forward, "a law that feeds forward"),
            ("--error-form", self.error_form != super::Form::Heading, "that of the law"),
            ("--mu", self.mu.is_some(), "lyap-e or lyap-f as published"),
            ("--limits", self.limits.is_some(), "those of the vehicle's motors"),
        ];
        match given.into_iter().find(|(_, given, _)| *given) {
            Some((flag, _, instead)) => {
                Err(Failure::input(format!("{flag}: belongs to --controller and --gains; a scenario takes {instead}")))
            }
            None => Ok(()),
        }
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let named = args.scenario.scenario.is_some() || args.scenario.vehicle.is_some();
    if !named && args.gains.is_none() {
        return Err(Failure::input(NOTHING));
    }
    args.refuse_older()?;
    let table = args.gains.as_deref().map(|path| Ok((path, table::source(path)?))).transpose()?;
    let own = table.as_ref().filter(|_| !named).map(|(path, table)| table.own_vehicle(path)).transpose()?;
    let scenario = args.scenario.checked_for(table.is_some(), own.as_ref())?;
    args.out.as_deref().map_or(Ok(()), output::create_dir)?;
    let (figures, recording) = match &table {
        Some((path, table)) => {
            table::in_scenario(path, table, &scenario, &|law, name| fly_law(&scenario, law, name, &args.transform))?
        }
        None => fly_and_print(&scenario, &args.transform)?,
    };
    let outputs = Outputs {
        dir: args.out.as_deref(),
        json: args.json.as_deref(),
        plot: args.plot.as_deref(),
        log: args.log.as_deref(),
        mcap: args.mcap.as_deref(),
    };
    outputs.write(&scenario, figures, &recording)
}

/// The trajectory of a scenario whose course is one, looked at before it is flown.
pub(in crate::cli) struct OwnCourse {
    /// Nothing where the course is another.
    pub(in crate::cli) trajectory: Option<PiecewisePolynomial>,
    /// What the reference itself asks for that no law can follow.
    pub(in crate::cli) note: Option<String>,
}

impl OwnCourse {
    /// Of a scenario, held against the limits of its vehicle.
    pub(in crate::cli) fn of(scenario: &Scenario, transform: &TransformArgs) -> Result<Self, Failure> {
        let Some(name) = scenario.course.trajectory() else { return Ok(Self { trajectory: None, note: None }) };
        let trajectory = transformed(name, transform)?;
        on_board::checked(&trajectory).map_err(|error| not_on_board(name, &error))?;
        let whole_s = trajectory.duration_s();
        let asked_s = scenario.duration_s.filter(|asked_s| *asked_s > whole_s);
        let ends = asked_s
            .map(|asked_s| format!("the course ends after {whole_s:.2} s, before the {asked_s} s that were asked for"));
        let notes: Vec<String> = ends.into_iter().chain(reference_note(&scenario.vehicle, &trajectory)?).collect();
        let note = (!notes.is_empty()).then(|| notes.join("; "));
        Ok(Self { trajectory: Some(trajectory), note })
    }

    /// The line below the figures; empty where there is nothing to say.
    pub(in crate::cli) fn line(&self) -> String {
        self.note.as_ref().map_or_else(String::new, |note| format!("note: {note}\n"))
    }
}

/// What a trajectory asks for that no law can follow on a vehicle.
pub(in crate::cli) fn reference_note(
    vehicle: &Vehicle,
    trajectory: &PiecewisePolynomial,
) -> Result<Option<String>, Failure> {
    let limits = vehicles::limits(vehicle).map_err(Failure::input)?;
    Ok(ReferenceCheck::of(trajectory, &limits).line())
}

/// Flies a scenario with its law and prints the figures.
pub(in crate::cli) fn fly_and_print(
    scenario: &Scenario,
    transform: &TransformArgs,
) -> Result<(Report, Recording), Failure> {
    let mut law = scenario.law.start(&scenario.vehicle, &scenario.told).map_err(Failure::input)?;
    fly_law(scenario, law.as_mut(), scenario.law.name(), transform)
}

fn fly_law(
    scenario: &Scenario,
    law: &mut dyn ControlLaw,
    name: &str,
    transform: &TransformArgs,
) -> Result<(Report, Recording), Failure> {
    if scenario.course.trajectory().is_none() && transform.transform()? != Transform::default() {
        return Err(Failure::input(
            "--time-scale, --reverse, --start and their like belong to a trajectory: give one by --course",
        ));
    }
    let OwnCourse { trajectory, note } = OwnCourse::of(scenario, transform)?;
    let recording = scenario.record(law, &scenario.flown(trajectory)).map_err(Failure::input)?;
    let figures = Report { reference: note, ..figures(name, &recording) };
    output::print(&text(scenario, &figures))?;
    Ok((figures, recording))
}

fn figures(law: &str, recording: &Recording) -> Report {
    let flight = &recording.flight;
    let lost = flight.lost.as_ref().map(|lost| format!("at {:.2} s: {}", lost.time_s, lost.reason));
    Report {
        schema: SCHEMA,
        law: law.to_owned(),
        iae_m_s: flight.iae_m_s(),
        max_error_m: flight.max_error_m(),
        saturated_steps: flight.saturated_steps,
        gust_rms_m_s: recording.gust_rms_m_s.map(Into::into),
        lost,
        reference: None,
    }
}

fn text(scenario: &Scenario, figures: &Report) -> String {
    let iae = figures.iae_m_s.map_or_else(|| "none: the flight was lost".to_owned(), |iae| format!("{iae:.6} m s"));
    let gusts = figures.gust_rms_m_s.map_or_else(
        || "none".to_owned(),
        |[along, across, up]| format!("{along:.3}, {across:.3}, {up:.3} m/s along the wind, across, up"),
    );
    let note = figures.reference.as_ref().map_or_else(String::new, |note| format!("  note: {note}\n"));
    format!(
        "{} on {scenario}, seed {}\n\
         \x20 IAE over samples of 10 ms  {iae}\n\
         \x20 largest position error     {:.6} m\n\
         \x20 saturated steps            {}\n\
         \x20 realised gusts, RMS        {gusts}\n\
         \x20 lost                       {}\n{note}",
        figures.law,
        scenario.seed,
        figures.max_error_m,
        figures.saturated_steps,
        figures.lost.as_deref().unwrap_or("no"),
    )
}
