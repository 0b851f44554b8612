//! Table I, cell by cell: trajectories and gains in; IAE as printed, as published, exact, with the core in the loop and
//! with feed-forward out.

use std::collections::BTreeMap;
use std::fmt;

use quatrack::law::{EquilibriumGain as CoreEquilibriumGain, FlatOutputGain as CoreFlatOutputGain};
use quatrack::{Equilibrium, ErrorForm, FeedForward, FlatOutput, Law as CoreLaw, Limits, Rate, gains::paper};
use quatrack_design::design::DesignError;
use quatrack_design::design::synthesis::{
    EquilibriumWeights, FlatWeights, lqr_equilibrium, lqr_flat, lyapunov_equilibrium, lyapunov_flat,
};
use quatrack_design::model::flat::reference_point;
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use serde::Serialize;

use super::published;
use crate::flight::closed_loop::{Flight, REPRODUCED_LOST_M, SAMPLE_PERIOD_S, Solver, fly_continuous, fly_sampled};
use crate::flight::core_loop::CoreLoop;
use crate::flight::law::{EquilibriumGain, Feedback, FlatOutputGain, Law};
use crate::flight::metrics::Metrics;
use crate::flight::reference::{Exact, Sampled};
use crate::integrator::DormandPrince;

use quatrack_plan::plan::paper::PaperTrajectory;

/// Rates at which the core is flown, Hz.
pub const CORE_RATES_HZ: [u32; 3] = [100, 500, 1000];

/// Decay rate of the case that crashes in the paper's text, 1/s.
pub const CRASH_MU: f64 = 1.0;

/// The integrator of the flights with feed-forward, whose errors are as small as an integrator's own.
const TRUTH: Solver = Solver::Adaptive(DormandPrince { tolerance: 1e-13, step_min_s: 1e-7 });

/// The paper's controllers, in the order of its Table I.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum Controller {
    /// Lyapunov design on the flat chain.
    #[serde(rename = "LYAP-F")]
    LyapF,
    /// Lyapunov design at the hover equilibrium.
    #[serde(rename = "LYAP-E")]
    LyapE,
    /// LQR on the flat chain.
    #[serde(rename = "LQR-F")]
    LqrF,
    /// LQR at the hover equilibrium.
    #[serde(rename = "LQR-E")]
    LqrE,
}

impl Controller {
    /// All four.
    pub const ALL: [Self; 4] = [Self::LyapF, Self::LyapE, Self::LqrF, Self::LqrE];
}

impl fmt::Display for Controller {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::LyapF => "LYAP-F",
            Self::LyapE => "LYAP-E",
            Self::LqrF => "LQR-F",
            Self::LqrE => "LQR-E",
        })
    }
}

/// IAE as printed in the paper's Table I, m s, in the order of [`Controller::ALL`].
pub fn printed(course: PaperTrajectory) -> [&'static str; 4] {
    match course {
        PaperTrajectory::Mild => ["4.68", "0.22", "0.31", "0.018"],
        PaperTrajectory::Aggressive => ["5.69", "2.14", "0.83", "0.11"],
    }
}

/// The four gains, in f64.
#[derive(Clone, Copy, Debug)]
pub struct PaperGains {
    lyap_f: FlatOutputGain,
    lyap_e: EquilibriumGain,
    lqr_f: FlatOutputGain,
    lqr_e: EquilibriumGain,
}

/// A gain of either kind.
#[derive(Clone, Copy, Debug)]
enum AnyGain<'a> {
    Equilibrium(&'a EquilibriumGain),
    FlatOutput(&'a FlatOutputGain),
}

impl PaperGains {
    /// The paper's designs, with the decay rate `mu` of the Lyapunov ones.
    ///
    /// # Errors
    /// [`DesignError`] where the design has no solution: `mu` not positive.
    pub fn design(mu: f64) -> Result<Self, DesignError> {
        Ok(Self {
            lyap_f: lyapunov_flat(mu)?.gain,
            lyap_e: lyapunov_equilibrium(mu)?.gain,
            lqr_f: lqr_flat(&FlatWeights::paper())?.gain,
            lqr_e: lqr_equilibrium(&EquilibriumWeights::paper())?.gain,
        })
    }

    /// The gain of an equilibrium controller; nothing for the others.
    pub fn equilibrium(&self, controller: Controller) -> Option<&EquilibriumGain> {
        match self.of(controller) {
            AnyGain::Equilibrium(gain) => Some(gain),
            AnyGain::FlatOutput(_) => None,
        }
    }

    fn of(&self, controller: Controller) -> AnyGain<'_> {
        match controller {
            Controller::LyapF => AnyGain::FlatOutput(&self.lyap_f),
            Controller::LyapE => AnyGain::Equilibrium(&self.lyap_e),
            Controller::LqrF => AnyGain::FlatOutput(&self.lqr_f),
            Controller::LqrE => AnyGain::Equilibrium(&self.lqr_e),
        }
    }
}

/// One cell of Table I, five times over. IAE in m s; nothing where the flight was lost.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// As printed.
    #[serde(serialize_with = "as_number")]
    pub paper: &'static str,
    /// With the two slips of the published simulation.
    pub as_published: Option<f64>,
    /// Without them.
    pub exact: Option<f64>,
    /// With the f32 core, commands held, by rate in Hz.
    pub core_f32: BTreeMap<u32, Option<f64>>,
    /// With the reference's input fed forward, exact, in continuous time.
    pub feed_forward: Option<f64>,
}

fn as_number<S: serde::Serializer>(printed: &&'static str, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(printed.parse().unwrap_or(f64::NAN))
}

impl Cell {
    /// Whether the figure as published rounds to the printed digits.
    pub fn is_reproduced(&self) -> bool {
        let decimals = self.paper.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        self.as_published.is_some_and(|iae| format!("{iae:.decimals$}") == self.paper)
    }
}

/// The flights of one controller on one course.
pub struct Outcome {
    /// The figures.
    pub cell: Cell,
    /// Steps of the core whose command was cut to the limits, over all rates.
    pub saturated_steps: u64,
    /// The flight as published, for the figures of the paper.
    pub published_flight: Flight,
}

/// Flies one cell.
pub fn fly_cell(
    course: PaperTrajectory,
    trajectory: &PiecewisePolynomial,
    controller: Controller,
    gains: &PaperGains,
) -> Outcome {
    let index = Controller::ALL.iter().position(|c| *c == controller).unwrap_or_default();
    let gain = gains.of(controller);
    let published_flight = fly_published(trajectory, gain);
    let feedback = |feed_forward| Feedback { law: law(gain), feed_forward };
    let sampled = Sampled::new(trajectory, SAMPLE_PERIOD_S, |t, t_s| reference_point(&t.at(t_s)));
    let exact =
        fly_continuous(&sampled, |x, target| feedback(false).input(x, target), Solver::PAPER, REPRODUCED_LOST_M);
    let fed = fly_continuous(&Exact(trajectory), |x, target| feedback(true).input(x, target), TRUTH, REPRODUCED_LOST_M);
    let mut saturated_steps = 0;
    let core_f32 = CORE_RATES_HZ
        .into_iter()
        .map(|rate_hz| {
            let iae = fly_core(trajectory, controller, rate_hz).and_then(|flight| {
                saturated_steps += flight.saturated_steps;
                Metrics::of(&flight).iae_m_s
            });
            (rate_hz, iae)
        })
        .collect();
    let cell = Cell {
        paper: printed(course)[index],
        as_published: Metrics::of(&published_flight).iae_m_s,
        exact: Metrics::of(&exact).iae_m_s,
        core_f32,
        feed_forward: Metrics::of(&fed).iae_m_s,
    };
    Outcome { cell, saturated_steps, published_flight }
}

/// The published flight of a Lyapunov controller at the decay rate that crashes in the paper's text.
pub fn fly_crash(trajectory: &PiecewisePolynomial, controller: Controller) -> Result<Flight, DesignError> {
    Ok(fly_published(trajectory, PaperGains::design(CRASH_MU)?.of(controller)))
}

fn law(gain: AnyGain<'_>) -> Law<'_> {
    match gain {
        AnyGain::Equilibrium(gain) => Law::EquilibriumPaper(gain),
        AnyGain::FlatOutput(gain) => Law::FlatOutput(gain),
    }
}

fn fly_published(trajectory: &PiecewisePolynomial, gain: AnyGain<'_>) -> Flight {
    let reference = Sampled::new(trajectory, SAMPLE_PERIOD_S, published::reference);
    match gain {
        AnyGain::Equilibrium(gain) => fly_continuous(
            &reference,
            |x, target| published::equilibrium_input(gain, x, target),
            Solver::PAPER,
            REPRODUCED_LOST_M,
        ),
        AnyGain::FlatOutput(gain) => fly_continuous(
            &reference,
            |x, target| published::flat_output_input(gain, x, target),
            Solver::PAPER,
            REPRODUCED_LOST_M,
        ),
    }
}

/// The committed tables in the core, by name; errors formed as in the paper.
pub fn core_law(controller: Controller) -> CoreLaw<'static> {
    let equilibrium = |gain: &'static CoreEquilibriumGain| -> CoreLaw<'static> {
        Equilibrium { gain, error_form: ErrorForm::Paper, feed_forward: FeedForward::Without }.into()
    };
    let flat_output = |gain: &'static CoreFlatOutputGain| -> CoreLaw<'static> { FlatOutput::new(gain).into() };
    match controller {
        Controller::LyapF => flat_output(&paper::LYAP_F),
        Controller::LyapE => equilibrium(&paper::LYAP_E),
        Controller::LqrF => flat_output(&paper::LQR_F),
        Controller::LqrE => equilibrium(&paper::LQR_E),
    }
}

/// Nothing where the core refuses the trajectory or the rate, which it does for neither of the paper's.
fn fly_core(trajectory: &PiecewisePolynomial, controller: Controller, rate_hz: u32) -> Option<Flight> {
    let pieces = on_board::pieces(trajectory);
    let mut core = CoreLoop::new(&pieces, Rate::from_hz(rate_hz)?, core_law(controller), Limits::NONE).ok()?;
    Some(fly_sampled(&Exact(trajectory), rate_hz, REPRODUCED_LOST_M, |tick, _, x| core.step(tick, x)))
}
