//! The paper's controllers: a controller, its design, a trajectory and a rate in; the flight of the paper's model out.

use std::fmt;

use clap::ValueEnum;
use quatrack::{Equilibrium, FlatOutput, Law as CoreLaw, Limits, Rate};
use quatrack_design::design::DesignError;
use quatrack_design::design::codegen::rounded;
use quatrack_design::design::synthesis::{self, EquilibriumWeights, FlatWeights, PAPER_MU};
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::flight::closed_loop::{Flight, HeldCommand, LOST_M, Solver, fly_continuous, fly_sampled};
use quatrack_simulation::flight::core_loop;
use quatrack_simulation::flight::law::{EquilibriumGain, Feedback, FlatOutputGain, Law};
use quatrack_simulation::flight::reference::{Exact, Reference};
use quatrack_simulation::flight::reference_check::ReferenceCheck;
use quatrack_simulation::integrator::Method;

use super::{Args, DescribedFlight, Form, Precision, default_rate, fly_law, load};
use crate::cli::Failure;
use crate::cli::limits::LimitsChoice;

/// The controllers of the paper.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Controller {
    /// Lyapunov design on the flat chain.
    LyapF,
    /// Lyapunov design at the hover equilibrium.
    LyapE,
    /// LQR on the flat chain.
    LqrF,
    /// LQR at the hover equilibrium.
    LqrE,
}

impl fmt::Display for Controller {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LyapF => "LYAP-F",
            Self::LyapE => "LYAP-E",
            Self::LqrF => "LQR-F",
            Self::LqrE => "LQR-E",
        })
    }
}

/// A gain of either law, in f64.
enum Gain {
    Equilibrium(Box<EquilibriumGain>),
    FlatOutput(Box<FlatOutputGain>),
}

pub(super) fn fly_paper(args: &Args, controller: Controller, rate: Option<Rate>) -> Result<DescribedFlight, Failure> {
    let gain = design(args, controller)?;
    let trajectory = load(args)?;
    let limits = args.limits.clone().unwrap_or_else(LimitsChoice::none);
    let reference = ReferenceCheck::of(&trajectory, &limits.limits).line();
    let (flight, clock) = match (args.precision, rate) {
        (Precision::F32, rate) => {
            let rate = rate.map_or_else(default_rate, Ok)?;
            (fly_core(args, &gain, &trajectory, rate, limits.limits)?, format!("f32 core, {} Hz hold", rate.hz()))
        }
        (Precision::F64, Some(rate)) => {
            (fly_f64_sampled(args, &gain, &trajectory, rate, limits.limits), format!("f64, {} Hz hold", rate.hz()))
        }
        (Precision::F64, None) => {
            (fly_f64_continuous(args, &gain, &trajectory, &limits)?, "f64, continuous".to_owned())
        }
    };
    Ok(DescribedFlight {
        law: controller.to_string(),
        clock,
        limits: limits.name,
        duration_s: trajectory.duration_s(),
        flight,
        reference,
    })
}

fn design(args: &Args, controller: Controller) -> Result<Gain, Failure> {
    let mu = args.mu.unwrap_or(PAPER_MU);
    if matches!(controller, Controller::LqrE | Controller::LqrF) && args.mu.is_some() {
        return Err(Failure::input("--mu belongs to the Lyapunov designs; leave it out or choose lyap-e or lyap-f"));
    }
    let gain = match controller {
        Controller::LyapF => synthesis::lyapunov_flat(mu).map(|design| Gain::FlatOutput(design.gain.into())),
        Controller::LyapE => synthesis::lyapunov_equilibrium(mu).map(|design| Gain::Equilibrium(design.gain.into())),
        Controller::LqrF => {
            synthesis::lqr_flat(&FlatWeights::paper()).map(|design| Gain::FlatOutput(design.gain.into()))
        }
        Controller::LqrE => {
            synthesis::lqr_equilibrium(&EquilibriumWeights::paper()).map(|design| Gain::Equilibrium(design.gain.into()))
        }
    };
    gain.map_err(|error| match error {
        DesignError::Inaccurate { equation, .. } => {
            let remedy = "take a decay rate from 0.001 to 1000 1/s";
            Failure::input(format!("--mu {mu}: {equation} was not solved to working precision; {remedy}"))
        }
        error => Failure::input(format!("--mu {mu}: {error}")),
    })
}

fn feedback<'a>(args: &Args, gain: &'a Gain) -> Feedback<'a> {
    let law = match (gain, args.error_form) {
        (Gain::Equilibrium(gain), Form::Paper) => Law::EquilibriumPaper(gain),
        (Gain::Equilibrium(gain), Form::Heading) => Law::EquilibriumHeading(gain),
        (Gain::FlatOutput(gain), _) => Law::FlatOutput(gain),
    };
    Feedback { law, feed_forward: args.feed_forward }
}

fn fly_core(
    args: &Args,
    gain: &Gain,
    trajectory: &PiecewisePolynomial,
    rate: Rate,
    limits: Limits,
) -> Result<Flight, Failure> {
    let (feed_forward, error_form) = (args.feed_forward(), args.error_form());
    let (equilibrium_gain, flat_gain);
    let law: CoreLaw<'_> = match gain {
        Gain::Equilibrium(gain) => {
            equilibrium_gain = quatrack::law::EquilibriumGain::new(rounded(gain)).map_err(Failure::input)?;
            Equilibrium { gain: &equilibrium_gain, error_form, feed_forward }.into()
        }
        Gain::FlatOutput(gain) => {
            flat_gain = quatrack::law::FlatOutputGain::new(rounded(gain)).map_err(Failure::input)?;
            FlatOutput { gain: &flat_gain, feed_forward }.into()
        }
    };
    fly_law(args, law, trajectory, rate, limits)
}

fn fly_f64_sampled(args: &Args, gain: &Gain, trajectory: &PiecewisePolynomial, rate: Rate, limits: Limits) -> Flight {
    let (reference, feedback) = (Exact(trajectory), feedback(args, gain));
    fly_sampled(&reference, rate.hz(), LOST_M, |_, t_s, x| {
        let input = feedback.input(x, &reference.at(t_s));
        let (input, limited) =
            core_loop::saturate(&input, &limits).ok_or_else(|| "the law has no finite command".to_owned())?;
        Ok(HeldCommand { input, limited })
    })
}

/// In continuous time nothing counts steps, so limits would go unreported: they are refused.
fn fly_f64_continuous(
    args: &Args,
    gain: &Gain,
    trajectory: &PiecewisePolynomial,
    limits: &LimitsChoice,
) -> Result<Flight, Failure> {
    if limits.name != "none" {
        return Err(Failure::input(format!(
            "--limits {}: continuous time has no steps to limit; add --rate-hz",
            limits.name
        )));
    }
    let feedback = feedback(args, gain);
    let solver = Solver::Fixed { method: Method::RungeKutta4, substeps: 2 };
    Ok(fly_continuous(&Exact(trajectory), |x, target| feedback.input(x, target), solver, LOST_M))
}
