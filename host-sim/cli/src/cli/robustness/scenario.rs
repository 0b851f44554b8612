//! A scenario under every case of the robustness flights: laws in; the position error of each out.

use std::fmt::Write as _;
use std::path::Path;

use quatrack_simulation::flight::robustness::CASES;
use quatrack_simulation::scenario::{Law, Scenario};
use serde::Serialize;

use crate::cli::fly::scenario::OwnCourse;
use crate::cli::scenario::ScenarioArgs;
use crate::cli::transform::TransformArgs;
use crate::cli::{Failure, output};

/// The schema that the figures' file states.
const SCHEMA: &str = "quatrack/robustness-scenario/1";

#[derive(Serialize)]
pub(super) struct Report {
    schema: &'static str,
    conditions: String,
    rows: Vec<Row>,
    #[serde(skip)]
    laws: Vec<Law>,
    /// What the course itself asks for that no law can follow, as a line.
    #[serde(skip)]
    note: String,
}

#[derive(Serialize)]
struct Row {
    law: &'static str,
    case: &'static str,
    /// None for a flight that was lost.
    iae_m_s: Option<f64>,
    max_error_m: f64,
    saturated_steps: u64,
    lost: bool,
}

/// Flies a scenario and its cases by --law, or else by every law that takes the vehicle.
pub(super) fn run(args: &ScenarioArgs, json: Option<&Path>) -> Result<(), Failure> {
    let report = fly(&args.checked()?, args.law)?;
    output::print(&report.text())?;
    if let Some(path) = json {
        output::write_json(path, &report)?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}

/// The same for a scenario that has been looked at.
pub(super) fn fly(scenario: &Scenario, law: Option<Law>) -> Result<Report, Failure> {
    let course = OwnCourse::of(scenario, &TransformArgs::default())?;
    let start = |law: Law| law.start(&scenario.vehicle, &scenario.told);
    let laws: Vec<Law> = match law {
        Some(law) => vec![start(law).map(|_| law).map_err(Failure::input)?],
        None => Law::ALL.into_iter().filter(|law| start(*law).is_ok()).collect(),
    };
    let mut rows = Vec::new();
    for case in &CASES {
        let Some(varied) = scenario.varied(case) else { continue };
        let flown = varied.flown(course.trajectory.clone());
        for law in &laws {
            let mut flying = start(*law).map_err(Failure::input)?;
            let flight = varied.fly(flying.as_mut(), &flown).map_err(Failure::input)?;
            rows.push(Row {
                law: law.name(),
                case: case.name,
                iae_m_s: flight.iae_m_s(),
                max_error_m: flight.max_error_m(),
                saturated_steps: flight.saturated_steps,
                lost: flight.lost.is_some(),
            });
        }
    }
    Ok(Report { schema: SCHEMA, conditions: scenario.to_string(), rows, laws, note: course.line() })
}

impl Report {
    /// Its conditions and its table.
    pub(super) fn text(&self) -> String {
        format!("{}: position error, m s\n\n{}{}", self.conditions, table(self, &self.laws), self.note)
    }
}

fn table(report: &Report, laws: &[Law]) -> String {
    let mut text = format!("{:<12}", "");
    // Writing to a string does not fail.
    for law in laws {
        let _ = write!(text, "{:>16}", law.name());
    }
    for rows in report.rows.chunks(laws.len().max(1)) {
        let _ = write!(text, "\n{:<12}", rows[0].case);
        for row in rows {
            let iae = row.iae_m_s.map_or_else(|| "lost".to_owned(), |iae| format!("{iae:.4}"));
            let _ = write!(text, "{iae:>16}");
        }
    }
    text.push('\n');
    text
}
