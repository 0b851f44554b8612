//! Past the paper: its designs and three more, flown by the `f32` core under a hold, with and without the reference's
//! input; trajectories in, IAE by method, rate and feed-forward out.

use std::collections::BTreeMap;
use std::fmt;
use std::thread;

use quatrack::gains::paper;
use quatrack::gains::table::KNOTS_MAX;
use quatrack::law::{EquilibriumGain, FlatOutputGain, GainSchedule, IntegralGain, Knot};
use quatrack::{AlongTrajectory, Equilibrium, FeedForward, FlatOutput, IntegralAction, Law, Limits, Piece, Rate};
use quatrack_design::design::DesignError;
use quatrack_design::design::along::gains_along;
use quatrack_design::design::codegen::{rounded, rounded_along};
use quatrack_design::design::integral::{IntegralWeights, sampled_lqi};
use quatrack_design::design::sampled::{Sampling, sampled_equilibrium, sampled_flat, shaped};
use quatrack_design::design::synthesis::{EquilibriumWeights, FlatWeights};
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::trajectory::Trajectory as _;
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use serde::Serialize;

use crate::flight::closed_loop::{REPRODUCED_LOST_M, fly_sampled};
use crate::flight::core_loop::CoreLoop;
use crate::flight::metrics::Metrics;
use crate::flight::reference::{Exact, Reference as _};

/// Rates at which the core is flown, and for which the sampled designs are made, Hz. At the slowest one a hold is
/// longer than the paper's LQR-E bears.
pub const RATES_HZ: [u32; 3] = [25, 100, 500];

/// Weight of each integral in LQI-E, beside the paper's weights of the errors: half of the position's.
const INTEGRAL_WEIGHT: f64 = 50.0;

/// How a gain is designed, and with it the law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum Method {
    /// The paper's Lyapunov design on the flat chain.
    #[serde(rename = "LYAP-F")]
    LyapF,
    /// The paper's Lyapunov design at hover.
    #[serde(rename = "LYAP-E")]
    LyapE,
    /// The paper's LQR on the flat chain.
    #[serde(rename = "LQR-F")]
    LqrF,
    /// The paper's LQR at hover.
    #[serde(rename = "LQR-E")]
    LqrE,
    /// LQR-F for the rate.
    #[serde(rename = "sampled LQR-F")]
    SampledLqrF,
    /// LQR-E for the rate.
    #[serde(rename = "sampled LQR-E")]
    SampledLqrE,
    /// Sampled LQR-E with the integral of the position error.
    #[serde(rename = "sampled LQI-E")]
    SampledLqiE,
    /// Time-varying LQR along the trajectory, for the rate.
    #[serde(rename = "LQR along")]
    LqrAlong,
}

impl Method {
    /// All of them: the paper's, then those past it.
    pub const ALL: [Self; 8] = [
        Self::LyapF,
        Self::LyapE,
        Self::LqrF,
        Self::LqrE,
        Self::SampledLqrF,
        Self::SampledLqrE,
        Self::SampledLqiE,
        Self::LqrAlong,
    ];

    /// Whether the law takes the reference's input as one, and it can therefore be that of another time.
    pub(super) fn takes_input(self) -> bool {
        !matches!(self, Self::LyapF | Self::LqrF | Self::SampledLqrF)
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::LyapF => "LYAP-F",
            Self::LyapE => "LYAP-E",
            Self::LqrF => "LQR-F",
            Self::LqrE => "LQR-E",
            Self::SampledLqrF => "sampled LQR-F",
            Self::SampledLqrE => "sampled LQR-E",
            Self::SampledLqiE => "sampled LQI-E",
            Self::LqrAlong => "LQR along",
        })
    }
}

/// IAE of one method at one rate, m s; nothing where a flight was lost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Feedback alone.
    pub feedback: Option<f64>,
    /// With the reference's input at the time of the step.
    pub feed_forward: Option<f64>,
    /// With the reference's input half a period later; nothing for the flat output laws.
    pub half_period_ahead: Option<f64>,
}

/// Figures by method and rate.
pub type ByMethod = BTreeMap<Method, BTreeMap<u32, Figures>>;

/// All of them by course.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Extensions {
    figures: BTreeMap<PaperTrajectory, ByMethod>,
}

impl Extensions {
    /// Designs and flies everything, the two courses side by side.
    ///
    /// # Errors
    /// [`DesignError`] where a gain cannot be designed.
    pub fn fly(mild: &PiecewisePolynomial, aggressive: &PiecewisePolynomial) -> Result<Self, DesignError> {
        let (mild, aggressive) = thread::scope(|scope| {
            let beside = scope.spawn(|| fly_course(mild));
            let aggressive = fly_course(aggressive);
            // A panic of the other thread goes on in this one.
            (beside.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), aggressive)
        });
        Ok(Self { figures: [(PaperTrajectory::Mild, mild?), (PaperTrajectory::Aggressive, aggressive?)].into() })
    }

    /// The figures of one method.
    pub fn figures(&self, course: PaperTrajectory, method: Method, rate_hz: u32) -> Option<&Figures> {
        self.figures.get(&course)?.get(&method)?.get(&rate_hz)
    }

    /// By course.
    pub(super) fn courses(&self) -> impl Iterator<Item = (PaperTrajectory, &ByMethod)> {
        self.figures.iter().map(|(course, methods)| (*course, methods))
    }
}

fn fly_course(trajectory: &PiecewisePolynomial) -> Result<ByMethod, DesignError> {
    let pieces = on_board::pieces(trajectory);
    let mut methods = ByMethod::new();
    for rate_hz in RATES_HZ {
        let designs = Designs::new(trajectory, &pieces, rate_hz)?;
        for method in Method::ALL {
            let fly =
                |feed_forward, ahead| fly(trajectory, &pieces, rate_hz, designs.law(method, feed_forward)?, ahead);
            let figures = Figures {
                feedback: fly(FeedForward::Without, false),
                feed_forward: fly(FeedForward::With, false),
                half_period_ahead: method.takes_input().then(|| fly(FeedForward::With, true)).flatten(),
            };
            methods.entry(method).or_default().insert(rate_hz, figures);
        }
    }
    Ok(methods)
}

/// Nothing where the core refuses trajectory or rate, which it does for neither of the paper's, or the flight is lost.
fn fly(trajectory: &PiecewisePolynomial, pieces: &[Piece], rate_hz: u32, law: Law<'_>, ahead: bool) -> Option<f64> {
    let rate = Rate::from_hz(rate_hz)?;
    let mut core = if ahead {
        CoreLoop::with_input_ahead(pieces, rate, law, Limits::NONE).ok()??
    } else {
        CoreLoop::new(pieces, rate, law, Limits::NONE).ok()?
    };
    Metrics::of(&fly_sampled(&Exact(trajectory), rate_hz, REPRODUCED_LOST_M, |tick, _, x| core.step(tick, x))).iae_m_s
}

/// The designs past the paper for one rate and one trajectory, as the core flies them.
struct Designs {
    rate: Option<Rate>,
    lqr_f: Option<FlatOutputGain>,
    lqr_e: Option<EquilibriumGain>,
    lqi_e: Option<IntegralGain>,
    along: Vec<Knot>,
    steps_per_knot: u16,
    trajectory: u32,
}

impl Designs {
    fn new(trajectory: &PiecewisePolynomial, pieces: &[Piece], rate_hz: u32) -> Result<Self, DesignError> {
        let sampling = Sampling::at_rate(rate_hz);
        let weights = EquilibriumWeights::paper();
        let lqr_f = sampled_flat(&FlatWeights::paper(), &sampling)?.gain;
        let lqr_e = sampled_equilibrium(&weights, &sampling)?.gain;
        let with_integral = IntegralWeights { equilibrium: weights, integral: [INTEGRAL_WEIGHT; 3] };
        let lqi_e = sampled_lqi(&with_integral, &sampling)?.gain;
        // As many knots as a table holds.
        let steps = (trajectory.duration_s() * f64::from(rate_hz)).ceil() as usize;
        let steps_per_knot = steps.div_ceil(KNOTS_MAX - 1);
        let reference = Exact(trajectory);
        let along = gains_along(|t_s| reference.at(t_s), trajectory.duration_s(), &weights, &sampling, steps_per_knot)?;
        Ok(Self {
            rate: Rate::from_hz(rate_hz),
            lqr_f: shaped(&lqr_f).and_then(|gain| FlatOutputGain::new(rounded(&gain)).ok()),
            lqr_e: shaped(&lqr_e).and_then(|gain| EquilibriumGain::new(rounded(&gain)).ok()),
            lqi_e: shaped(&lqi_e).and_then(|gain| IntegralGain::new(rounded(&gain)).ok()),
            along: rounded_along(&along).iter().map(GainSchedule::knot).collect(),
            steps_per_knot: u16::try_from(steps_per_knot).unwrap_or(u16::MAX),
            trajectory: quatrack::Trajectory::new(pieces).map_or(0, |trajectory| trajectory.checksum()),
        })
    }

    /// The law of a method, errors in the heading frame.
    fn law(&self, method: Method, feed_forward: FeedForward) -> Option<Law<'_>> {
        fn equilibrium(gain: &EquilibriumGain, feed_forward: FeedForward) -> Law<'_> {
            Equilibrium { feed_forward, ..Equilibrium::new(gain) }.into()
        }
        let rate = self.rate?;
        Some(match method {
            Method::LyapF => FlatOutput { gain: &paper::LYAP_F, feed_forward }.into(),
            Method::LyapE => equilibrium(&paper::LYAP_E, feed_forward),
            Method::LqrF => FlatOutput { gain: &paper::LQR_F, feed_forward }.into(),
            Method::LqrE => equilibrium(&paper::LQR_E, feed_forward),
            Method::SampledLqrF => FlatOutput { gain: self.lqr_f.as_ref()?, feed_forward }.into(),
            Method::SampledLqrE => equilibrium(self.lqr_e.as_ref()?, feed_forward),
            Method::SampledLqiE => IntegralAction::new(self.lqi_e.as_ref()?, rate, feed_forward).into(),
            Method::LqrAlong => {
                let schedule = GainSchedule::new(&self.along, self.steps_per_knot, self.trajectory).ok()?;
                AlongTrajectory::new(schedule, rate, rate, feed_forward).into()
            }
        })
    }
}
