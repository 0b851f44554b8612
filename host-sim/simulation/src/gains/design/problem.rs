//! The problem of a design: a linearisation, a method that is defined for it, and the method's numbers.

use quatrack_design::certify::RegionBounds;
use quatrack_design::certify::cascade::{CascadeAir, CascadeBounds};
use quatrack_design::design::actuator_aware::ActuatorAwareWeights;
use quatrack_design::design::cascade::CascadeWeights;
use quatrack_design::design::integral::IntegralWeights;
use quatrack_design::design::synthesis::{EquilibriumWeights, FlatWeights};
use serde::Serialize;

use crate::gains::OnBoardTrajectory;

/// A linearisation with a method that is defined for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Problem {
    /// The hover model (E-LTI), error `[x y z q1 q2 q3 vx vy vz]`, inputs `[T p q r]`.
    Equilibrium(Method<EquilibriumWeights>),
    /// The flat chain (F-LTI), `[r v a q3]`, inputs `[a j q3']`.
    FlatOutput(Method<FlatWeights>),
    /// The hover model with the sums of the position error, under held commands.
    Integral {
        /// Diagonals of Q and R, and of the integrals.
        weights: IntegralWeights,
    },
    /// The hover model of the vehicle down to its motors, under held commands.
    ActuatorAware {
        /// Lag of the motors that it is designed for, s.
        motor_lag_s: f64,
        /// Weights of a sum over the samples.
        weights: ActuatorAwareWeights,
        /// Where the gain must be stable, too.
        region: RegionBounds,
    },
    /// The same without an integral, factored into nested loops with observers, in air.
    Cascade {
        /// Lag of the motors that it is designed for, s.
        motor_lag_s: f64,
        /// Weights of a sum over the samples.
        weights: CascadeWeights,
        /// The air that is told.
        air: CascadeAir,
        /// Where the loop must be stable, too.
        region: CascadeBounds,
        /// Which bounds of the region are intervals of the vehicle's file.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        region_from: Vec<IdentifiedBound>,
    },
    /// The error of the hover model about each point of a trajectory, under held commands: gains over time.
    Along {
        /// Diagonals of Q and R.
        weights: EquilibriumWeights,
        /// The trajectory.
        trajectory: OnBoardTrajectory,
        /// Control steps from one knot to the next.
        steps_per_knot: u16,
    },
}

/// A bound of a region that is an interval of the vehicle's file, and no statement of the design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IdentifiedBound {
    /// The region's key.
    pub key: &'static str,
    /// The figure, under the name that `quatrack identify` gives it, in the unit of its name.
    pub figure: &'static str,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Where the interval is from.
    pub source: String,
}

/// The method by which the gain is computed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Method<W> {
    /// Every pole in continuous time at real part -mu.
    Lyapunov {
        /// mu, 1/s.
        mu_1_s: f64,
    },
    /// Least `int x' Q x + u' R u dt` in continuous time.
    Lqr {
        /// Diagonals of Q and R.
        weights: W,
    },
    /// The same cost under commands held for a control period.
    SampledLqr {
        /// Diagonals of Q and R.
        weights: W,
        /// Whole samples by which commands act late.
        delay_samples: usize,
    },
}

impl Problem {
    /// Linearisation and method, as they are written in the file.
    pub fn named(&self) -> (&'static str, &'static str) {
        match self {
            Self::Equilibrium(method) => ("equilibrium", method.named()),
            Self::FlatOutput(method) => ("flat-output", method.named()),
            Self::Integral { .. } => ("equilibrium", "lqi"),
            Self::ActuatorAware { .. } => ("equilibrium", "actuator-aware"),
            Self::Cascade { .. } => ("equilibrium", "cascade"),
            Self::Along { .. } => ("equilibrium", "along"),
        }
    }

    /// The lag of the motors that a design for their forces reckons with, s.
    pub fn motor_lag_s(&self) -> Option<f64> {
        match self {
            Self::ActuatorAware { motor_lag_s, .. } | Self::Cascade { motor_lag_s, .. } => Some(*motor_lag_s),
            _ => None,
        }
    }

    /// Of gains over time the trajectory's checksum and the control steps from one knot to the next.
    pub fn schedule(&self) -> Option<(u32, u16)> {
        match self {
            Self::Along { trajectory, steps_per_knot, .. } => Some((trajectory.checksum(), *steps_per_knot)),
            _ => None,
        }
    }

    /// mu of a Lyapunov design, 1/s.
    pub fn mu_1_s(&self) -> Option<f64> {
        match self {
            Self::Equilibrium(Method::Lyapunov { mu_1_s }) | Self::FlatOutput(Method::Lyapunov { mu_1_s }) => {
                Some(*mu_1_s)
            }
            _ => None,
        }
    }
}

impl<W> Method<W> {
    fn named(&self) -> &'static str {
        match self {
            Self::Lyapunov { .. } => "lyapunov",
            Self::Lqr { .. } => "lqr",
            Self::SampledLqr { .. } => "sampled-lqr",
        }
    }
}
