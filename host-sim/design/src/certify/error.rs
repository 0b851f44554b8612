//! Why there is no certificate, in one line each.

use thiserror::Error;

use crate::analysis::MatrixError;
use crate::design::DesignError;

/// A gain that cannot be certified.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CertifyError {
    /// A matrix that cannot be worked with.
    #[error(transparent)]
    Matrix(#[from] MatrixError),
    /// An equation without a solution.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// An entry of the gain is too large for an f32.
    #[error("K[{row},{column}] is {value:e}; as an f32 it would be infinite")]
    NotSinglePrecision {
        /// Row of the entry, from 0.
        row: usize,
        /// Column of the entry, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The loop is not stable at its own rate.
    #[error(
        "the loop is unstable at {rate_hz} Hz: its spectral radius is {spectral_radius:.6}; \
         raise the rate or lower the gain"
    )]
    Unstable {
        /// Control rate, Hz.
        rate_hz: f64,
        /// Largest modulus of the poles per sample.
        spectral_radius: f64,
    },
    /// The loop along a trajectory is not stable with the gain at one of its knots.
    #[error(
        "the loop is unstable at knot {knot}, {time_s:.3} s: frozen there, its spectral radius is {spectral_radius:.6}; \
         raise the rate, lower the gain or fly slower"
    )]
    UnstableAtKnot {
        /// The knot's number, from 0.
        knot: usize,
        /// The time, s.
        time_s: f64,
        /// Largest modulus of the poles per sample.
        spectral_radius: f64,
    },
    /// Gains over time that are none: no knots, or no P for each control step.
    #[error("gains over time: {knots} knots and {p} matrices P do not make one table; take both from one design")]
    Schedule {
        /// Knots.
        knots: usize,
        /// Matrices P.
        p: usize,
    },
    /// The rate loop of the lag model has no positive gain.
    #[error("the rate gain is {gain_1_s} 1/s; it must be a positive number")]
    RateGain {
        /// The given gain, 1/s.
        gain_1_s: f64,
    },
    /// A rate at which no search ends in time.
    #[error("the control period is {period_s} s; certificates are made for periods from 1e-5 s to 10 s")]
    Period {
        /// The given period, s.
        period_s: f64,
    },
    /// A known delay of more samples than make sense.
    #[error("the known delay is {delay_samples} samples; certificates are made for up to 100")]
    DelaySamples {
        /// The given delay.
        delay_samples: usize,
    },
    /// A region without a point.
    #[error("the region is empty; give at least one lag, mass, inertia and delay")]
    EmptyRegion,
}
