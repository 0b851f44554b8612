//! Gains over time: a reference, and a design along it; a certificate of the gains as they are flown out.
//!
//! The gains are those of the table, rounded and interpolated as on board. What is promised of them has two parts:
//!
//! - of the loop as it moves, exactly to first order in the error: `V = e' P_k e`, with P of the design's Riccati equation,
//!   falls at every control step and behind the last one, where the hover's P covers all time that follows;
//! - of the loop as it stands at each knot, frozen: spectral radius, disk margins of each channel and of all at once,
//!   largest delay and largest lag. What is stated is the worst of the knots.
//!
//! Frozen loops off hover hang together in all four channels. The margin of all at once is therefore taken from an upper
//! bound of mu that is quick and not tight ([`super::AllChannels::alpha_at_most`] tells how far it may be off), and delay and
//! lag are tried at four even parts of the limit found so far instead of in small steps.

mod decrease;
mod frozen;

use nalgebra::SMatrix;
use serde::Serialize;

pub use decrease::{MovingDecrease, moving_decrease};

use super::certificate::{Certificate, Rounding, SampledLoopFigures, pairs};
use super::decrease::Decrease;
use super::{CertifyError, LagModel};
use crate::design::along::GainsAlong;
use crate::design::codegen::rounded_along;
use crate::model::flat::ReferencePoint;
use frozen::Frozen;

/// A figure counts as worse than another beyond this ratio: of equals the first one is named, on every processor the same.
const WORSE: f64 = 1.0 + 1e-9;

/// What is particular to gains over time. The figures beside it are the worst of the knots.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AlongFigures {
    /// Knots.
    pub knots: usize,
    /// Time between two of them, s.
    pub spacing_s: f64,
    /// Control steps at which the decrease was checked, with that of the hover behind the last knot.
    pub steps: usize,
    /// What is left of V after the step that takes off least, as a share.
    pub largest_ratio: f64,
    /// When that step is, s.
    pub largest_ratio_at_s: f64,
    /// Largest distance of the interpolated gain from the optimal one at any control step, over the norm of that.
    pub interpolation_error: f64,
    /// Spectral radius of the loop frozen at each knot.
    pub spectral_radii: Vec<f64>,
    /// The knot with the least margin of all channels at once.
    pub least_margin_at_knot: usize,
}

/// Certifies gains over time, rounded to f32 and interpolated as on board, along a reference that is at rest behind its
/// last knot.
///
/// `motors_in_rate_loop`: as for [`super::certify`].
///
/// # Errors
/// As [`super::certify`]; [`CertifyError::UnstableAtKnot`], [`CertifyError::Schedule`]. A decrease that does not hold is no
/// error, it shows in the certificate.
pub fn certify_along(
    reference: impl Fn(f64) -> ReferencePoint,
    designed: &GainsAlong,
    motors_in_rate_loop: Option<f64>,
) -> Result<Certificate, CertifyError> {
    if let Some(gain_1_s) = motors_in_rate_loop.filter(|gain| !(gain.is_finite() && *gain > 0.0)) {
        return Err(CertifyError::RateGain { gain_1_s });
    }
    let flown = flown(designed)?;
    let moving = moving_decrease(&reference, designed)?;
    let knots = frozen::knots(&reference, designed, &flown)?;
    let slower = |held: &Frozen, knot: &Frozen| knot.spectral_radius > held.spectral_radius * WORSE;
    let worst = knots.iter().reduce(|held, knot| if slower(held, knot) { knot } else { held });
    let Some((worst, last)) = worst.zip(knots.last()) else {
        return Err(CertifyError::Schedule { knots: 0, p: designed.p.len() });
    };
    let (margins, least_margin_at_knot) = frozen::margins(&knots)?;
    let models = [
        Some(LagModel::FirstOrder),
        motors_in_rate_loop.map(|gain| LagModel::MotorsInRateLoop { rate_gain_1_s: gain }),
    ];
    let limits = frozen::limits(&knots, last, models)?;
    let [delay, lag, in_rate_loop] = limits;
    Ok(Certificate {
        rate_hz: 1.0 / designed.period_s,
        delay_samples: 0,
        rounding: rounding(designed, &flown),
        continuous: None,
        sampled: SampledLoopFigures {
            poles: pairs(&worst.poles),
            spectral_radius: worst.spectral_radius,
            decrease: Decrease {
                holds: moving.holds,
                p_smallest_over_largest: moving.p_smallest_over_largest,
                decrease_smallest_over_largest: 1.0 - moving.largest_ratio,
                rounding: moving.rounding,
            },
            margins,
        },
        delay,
        lag,
        motors_in_rate_loop: motors_in_rate_loop.map(|_| in_rate_loop),
        along: Some(AlongFigures {
            knots: knots.len(),
            spacing_s: designed.spacing_s,
            steps: moving.steps,
            largest_ratio: moving.largest_ratio,
            largest_ratio_at_s: moving.largest_ratio_at_s,
            interpolation_error: designed.interpolation_error,
            spectral_radii: knots.iter().map(|knot: &Frozen| knot.spectral_radius).collect(),
            least_margin_at_knot,
        }),
    })
}

/// The gains in the table, in the digits of an f64.
fn flown(designed: &GainsAlong) -> Result<Vec<SMatrix<f64, 4, 9>>, CertifyError> {
    let flown: Vec<SMatrix<f64, 4, 9>> = rounded_along(designed)
        .iter()
        .map(|rows| SMatrix::from_fn(|row, column| f64::from(rows[row][column])))
        .collect();
    for (flown, designed) in flown.iter().zip(&designed.gains) {
        if let Some(at) = flown.iter().position(|entry| !entry.is_finite()) {
            let (row, column) = (at % 4, at / 4);
            return Err(CertifyError::NotSinglePrecision { row, column, value: designed[(row, column)] });
        }
    }
    Ok(flown)
}

fn rounding(designed: &GainsAlong, flown: &[SMatrix<f64, 4, 9>]) -> Rounding {
    let entries = designed.gains.iter().zip(flown).flat_map(|(designed, flown)| designed.iter().zip(flown.iter()));
    entries.filter(|(designed, _)| **designed != 0.0).fold(
        Rounding { largest_absolute: 0.0, largest_relative: 0.0 },
        |held, (designed, flown)| {
            let difference = (designed - flown).abs();
            Rounding {
                largest_absolute: held.largest_absolute.max(difference),
                largest_relative: held.largest_relative.max(difference / designed.abs()),
            }
        },
    )
}
