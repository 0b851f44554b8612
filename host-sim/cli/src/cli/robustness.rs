//! `quatrack robustness`: a vehicle in; how every law certified for it flies on craft that are not quite it, out.

mod scenario;

use std::fmt::Write as _;

use quatrack_simulation::flight::robustness::{self, CASES, RobustnessReport, Row};
use serde::Serialize;

use super::scenario::ScenarioArgs;
use super::{Failure, output};

/// Flies an eight at 2.1 m/s (and, as the case "fast", 3.1 m/s) with mass, lag or inertia off, with late commands, with noise: by
/// every law that takes the vehicle, in the vehicle's own air where its file knows it; then, in vacuum, by those of the
/// actuator-aware law and of the paper's that are certified for a lag, the f32 core at 500 Hz against a rigid body with lagging
/// motors that saturate. Figures are the position error summed over samples of 10 ms, in m s.
///
/// With --scenario, or a flag of one other than --vehicle, the laws of a scenario fly that: as it is, and with each of these
/// things wrong on top of its own.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    scenario: ScenarioArgs,
    /// Write the table as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<output::File>,
}

#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    certified: RobustnessReport,
    in_air: scenario::Report,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if args.scenario.any_but_vehicle() {
        return scenario::run(&args.scenario, args.json.as_deref());
    }
    let in_air = args.scenario.checked_in_own_air("crazyflie-2.1")?;
    let report = robustness::report(&in_air.vehicle).map_err(Failure::input)?;
    let report = Report { certified: report, in_air: scenario::fly(&in_air, None)? };
    output::print(&format!("{}\nin vacuum, by the certificates:\n{}", report.in_air.text(), table(&report.certified)))?;
    if let Some(path) = &args.json {
        output::write_json(path, &output::Named::of_form("robustness", 2, &report))?;
        output::print(&format!("wrote {}\n", path.display()))?;
    }
    Ok(())
}

fn table(report: &RobustnessReport) -> String {
    let mut columns: Vec<(&str, f64)> = report.rows.iter().map(|row| (row.law, row.lag_ms)).collect();
    columns.dedup();
    let mut text = format!(
        "{}: position error, m s (most, m; steps with a motor at its limit)\n\n{:<12}",
        report.vehicle, "motor lag"
    );
    // Writing to a string does not fail.
    for (_, lag_ms) in &columns {
        let _ = write!(text, "{:>32}", format!("{lag_ms} ms"));
    }
    let _ = write!(text, "\n{:<12}", "");
    for (law, _) in &columns {
        let _ = write!(text, "{law:>32}");
    }
    text.push('\n');
    for case in &CASES {
        let _ = write!(text, "{:<12}", case.name);
        for (law, lag_ms) in &columns {
            let found = report.rows.iter().find(|row| (row.law, row.lag_ms, row.case) == (law, *lag_ms, case.name));
            let _ = write!(text, "{:>32}", found.map_or_else(String::new, cell));
        }
        text.push('\n');
    }
    let _ = writeln!(
        text,
        "\nactuator-aware is designed for the lag above it; actuator-aware-robust is the default table, for {} ms.",
        report.default_lag_ms
    );
    for grounded in &report.not_certified {
        let _ = writeln!(text, "{} at {} ms does not fly: {}.", grounded.law, grounded.lag_ms, grounded.reason);
    }
    text
}

fn cell(row: &Row) -> String {
    let iae = row.iae_m_s.map_or_else(|| "lost".to_owned(), |iae| format!("{iae:.5}"));
    format!("{iae} ({:.4}; {})", row.max_error_m, row.saturated_steps)
}
