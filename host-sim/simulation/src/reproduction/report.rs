//! The whole reproduction: both trajectories in; the table for a person, the table as JSON, and the flights of Figures
//! 2 to 5 out.

use std::collections::BTreeMap;
use std::fmt;
use std::thread;

use quatrack_design::design::DesignError;
use quatrack_design::design::synthesis::PAPER_MU;
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use serde::Serialize;

use super::extensions::Extensions;
use super::table::{CORE_RATES_HZ, CRASH_MU, Controller, Outcome, PaperGains, fly_cell, fly_crash};
use crate::flight::metrics::Metrics;

/// All flights of Table I, and the two at the decay rate that crashes.
pub struct Reproduction {
    duration_s: BTreeMap<PaperTrajectory, f64>,
    outcomes: BTreeMap<PaperTrajectory, BTreeMap<Controller, Outcome>>,
    crash: BTreeMap<Controller, Metrics>,
}

/// The table as it is written to a file.
#[derive(Serialize)]
pub struct ReproductionReport<'a> {
    iae: BTreeMap<PaperTrajectory, BTreeMap<Controller, &'a super::table::Cell>>,
    min_z: BTreeMap<Controller, f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    beyond: Option<&'a Extensions>,
}

impl<'a> ReproductionReport<'a> {
    /// The same with the part past the paper.
    pub fn with(self, beyond: Option<&'a Extensions>) -> Self {
        Self { beyond, ..self }
    }
}

impl Reproduction {
    /// Flies everything, the two courses side by side.
    ///
    /// # Errors
    /// [`DesignError`] where a gain cannot be designed.
    pub fn fly(mild: &PiecewisePolynomial, aggressive: &PiecewisePolynomial) -> Result<Self, DesignError> {
        let gains = PaperGains::design(PAPER_MU)?;
        let fly_course = |course: PaperTrajectory, trajectory: &PiecewisePolynomial| {
            Controller::ALL.map(|controller| (controller, fly_cell(course, trajectory, controller, &gains)))
        };
        let (mild_cells, aggressive_cells) = thread::scope(|scope| {
            let beside = scope.spawn(|| fly_course(PaperTrajectory::Mild, mild));
            let aggressive_cells = fly_course(PaperTrajectory::Aggressive, aggressive);
            // A panic of the other thread goes on in this one.
            let mild_cells = beside.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            (mild_cells, aggressive_cells)
        });
        let mut crash = BTreeMap::new();
        for controller in [Controller::LyapF, Controller::LyapE] {
            crash.insert(controller, Metrics::of(&fly_crash(aggressive, controller)?));
        }
        Ok(Self {
            duration_s: [
                (PaperTrajectory::Mild, mild.duration_s()),
                (PaperTrajectory::Aggressive, aggressive.duration_s()),
            ]
            .into(),
            outcomes: [
                (PaperTrajectory::Mild, mild_cells.into()),
                (PaperTrajectory::Aggressive, aggressive_cells.into()),
            ]
            .into(),
            crash,
        })
    }

    /// The flights of one cell.
    pub fn outcome(&self, course: PaperTrajectory, controller: Controller) -> Option<&Outcome> {
        self.outcomes.get(&course)?.get(&controller)
    }

    /// Cells whose figure as published rounds to the printed digits.
    pub fn reproduced_cells(&self) -> usize {
        self.all().filter(|outcome| outcome.cell.is_reproduced()).count()
    }

    /// Whether Table I came out whole.
    pub fn is_reproduced(&self) -> bool {
        self.all().all(|outcome| outcome.cell.is_reproduced())
    }

    /// The table as it is written to a file.
    pub fn report(&self) -> ReproductionReport<'_> {
        ReproductionReport {
            iae: self
                .outcomes
                .iter()
                .map(|(course, outcomes)| (*course, outcomes.iter().map(|(c, o)| (*c, &o.cell)).collect()))
                .collect(),
            min_z: self.crash.iter().map(|(controller, metrics)| (*controller, metrics.min_z_m)).collect(),
            beyond: None,
        }
    }

    fn all(&self) -> impl Iterator<Item = &Outcome> {
        self.outcomes.values().flat_map(BTreeMap::values)
    }
}

/// An IAE to four digits; below an integrator's own error it says so.
pub fn digits(iae: Option<f64>) -> String {
    const RESOLUTION: f64 = 1e-6;
    match iae {
        None => "lost".to_owned(),
        Some(iae) if iae < RESOLUTION => format!("< {RESOLUTION:.0e}"),
        Some(iae) => {
            let decimals = (3 - iae.log10().floor() as i32).clamp(0, 9) as usize;
            if iae < 1e-3 { format!("{iae:.1e}") } else { format!("{iae:.decimals$}") }
        }
    }
}

impl fmt::Display for Reproduction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Table I: IAE (23) of the position, m s")?;
        for (course, outcomes) in &self.outcomes {
            let title = format!("{course:?}, {:.0} s", self.duration_s.get(course).copied().unwrap_or_default());
            write!(f, "\n{title:<22}")?;
            for controller in outcomes.keys() {
                write!(f, "{controller:>12}")?;
            }
            writeln!(f)?;
            let mut row = |name: &str, value: &dyn Fn(&Outcome) -> String| {
                let values: String = outcomes.values().map(|outcome| format!("{:>12}", value(outcome))).collect();
                writeln!(f, "  {name:<20}{values}")
            };
            row("paper", &|o| o.cell.paper.to_owned())?;
            row("as published", &|o| digits(o.cell.as_published))?;
            row("verdict", &|o| if o.cell.is_reproduced() { "reproduced" } else { "MISSED" }.to_owned())?;
            row("exact", &|o| digits(o.cell.exact))?;
            for rate_hz in CORE_RATES_HZ {
                let name = format!("f32 core, {rate_hz} Hz");
                row(&name, &|o| digits(o.cell.core_f32.get(&rate_hz).copied().flatten()))?;
            }
            row("with feed-forward", &|o| digits(o.cell.feed_forward))?;
        }
        writeln!(f, "\nAggressive with mu = {CRASH_MU}, as published:")?;
        for (controller, metrics) in &self.crash {
            let verdict = if metrics.min_z_m < 0.0 { "below the floor: a crash" } else { "never below the floor" };
            writeln!(
                f,
                "  {controller}: lowest z = {:.3} m at {:.2} s, {verdict}",
                metrics.min_z_m, metrics.min_z_time_s
            )?;
        }
        let saturated: u64 = self.all().map(|outcome| outcome.saturated_steps).sum();
        writeln!(f, "\nsaturated steps: {saturated}")?;
        writeln!(f, "{} of 8 cells round to the printed digits", self.reproduced_cells())
    }
}
