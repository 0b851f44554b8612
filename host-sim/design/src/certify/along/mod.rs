//! Gains over time: a reference, and a design along it; a certificate of the gains as they are flown out.
//!
//! The gains are those of the table, rounded and interpolated as on board. Their certificate has two parts:
//!
//! - of the loop as it moves, exactly to first order in the error: `V = e' P_k e`, with P of the design's Riccati equation,
//!   falls at every control step and behind the last one, where the hover's P covers all time that follows;
//! - of the loop with the gain of each knot, frozen: spectral radius, disk margins of each channel and of all at once,
//!   largest delay and largest lag. The table states the worst of the knots.
//!
//! Frozen loops off hover hang together in all four channels. The margin of all at once is therefore taken from an upper
//! bound of mu that is quick and not tight ([`super::AllChannels::alpha_at_most`] tells how far it may be off), and
//! delay and lag are tried at four even parts of the limit found so far instead of in small steps.

mod decrease;
mod flown;
mod frozen;

pub use decrease::{MovingDecrease, moving_decrease};

use super::certificate::{AlongFigures, Certificate, SampledLoopFigures, WORSE, pairs};
use super::decrease::Decrease;
use super::{CertifyError, LagModel};
use crate::design::along::GainsAlong;
use crate::model::flat::ReferencePoint;
use flown::{flown, rounding};
use frozen::Frozen;

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
