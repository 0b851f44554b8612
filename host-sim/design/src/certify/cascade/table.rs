//! The certificate of a table of the cascade: gains, the air that is told and a region in; every figure that a table states out.

mod bounds;

use nalgebra::DMatrix;
use serde::Serialize;

use super::{CascadeCertificate, CascadeChain, CascadeCraft, CascadeVariation};
use crate::analysis::eigenvalues;
use crate::certify::certificate::{SampledLoopFigures, pairs};
use crate::certify::decrease;
use crate::certify::limits::StabilityLimit;
use crate::certify::margins::{AllChannels, ChannelMargins, LoopMargins};
use crate::certify::rounding::{Rounding, single_precision};
use crate::certify::{Certificate, CertifyError, Decrease};
use crate::vehicle::Vehicle;
pub use bounds::{CascadeAir, CascadeBounds};

/// Bisections of a lag limit: to a millionth of its last step.
const BISECTIONS: i32 = 20;
/// Ratio of two lags that are tried.
const LAG_STEP: f64 = 1.05;
/// Longest lag that is tried, s.
const LONGEST_LAG_S: f64 = 1.0;

/// A table of the cascade over its region.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CascadeRegionCertificate {
    /// The region.
    pub bounds: CascadeBounds,
    /// Each chain's least stable point, after the craft has learned its motors' share in some seconds of flight.
    pub seen: [CascadeCertificate; 4],
    /// The same in the seconds before, at the inertia that is told.
    pub unseen: [CascadeCertificate; 4],
}

/// The craft of a table, with gains rounded to f32.
///
/// # Errors
/// [`CertifyError::NotSinglePrecision`].
pub fn cascade_craft(
    vehicle: &Vehicle,
    gains: [f64; 16],
    lag_s: f64,
    air: &CascadeAir,
    period_s: f64,
) -> Result<CascadeCraft, CertifyError> {
    let flown = single_precision(&DMatrix::from_row_slice(1, 16, &gains))?;
    Ok(CascadeCraft {
        moment_n_s: air.moment_n_s.map(|moment| moment / air.share_of_identified),
        told_drag_per_s: air.drag_per_s,
        told_moment_n_s: air.moment_n_s,
        gust: air.gust,
        ..CascadeCraft::new(vehicle, std::array::from_fn(|i| flown[i]), lag_s, period_s)
    })
}

/// Where margins are stated: the craft as told, in the identified air.
pub fn in_identified_air(craft: &CascadeCraft, air: &CascadeAir) -> CascadeVariation {
    CascadeVariation {
        drag_per_s: air.drag_per_s / air.share_of_identified,
        moment_factor: 1.0,
        believed_drag_per_s: air.drag_per_s,
        ..CascadeVariation::none(craft.lag_s)
    }
}

/// Certifies a table: the loop of the craft as told in the identified air.
///
/// # Errors
/// [`CertifyError::Unstable`] for a loop that is not stable there; as [`cascade_craft`].
pub fn certify_cascade(
    vehicle: &Vehicle,
    gains: [f64; 16],
    lag_s: f64,
    air: &CascadeAir,
    period_s: f64,
) -> Result<Certificate, CertifyError> {
    let craft = cascade_craft(vehicle, gains, lag_s, air, period_s)?;
    let at = in_identified_air(&craft, air);
    let rate_hz = 1.0 / period_s;
    let (mut each, mut delay, mut lag) = (Vec::new(), Vec::new(), Vec::new());
    let (mut poles, mut radius, mut held) = (Vec::new(), 0.0_f64, None);
    // The order of thrust, roll, pitch and yaw.
    for (chain, name) in CascadeChain::IN_PARTS {
        let found = chain.spectral_radius(&craft, &at)?;
        radius = if found.is_nan() { f64::INFINITY } else { radius.max(found) };
        if radius >= 1.0 {
            return Err(CertifyError::Unstable { rate_hz, spectral_radius: radius });
        }
        let of_tick = chain.of_tick(&craft, &at);
        poles.extend(eigenvalues(&of_tick)?);
        held = worse(held, decrease::sampled(&of_tick)?);
        let margins = chain.margins(&craft, &at)?;
        each.push(ChannelMargins {
            channel: name.to_owned(),
            balanced: margins.disk,
            sensitivity: margins.sensitivity,
        });
        delay.push(limit(name, margins.delay_s, period_s));
        lag.push(longest_lag(chain, &craft, &at, name)?);
    }
    // Chains know nothing of each other: all at once are as strong as the weakest.
    let weakest = each.iter().map(|margins: &ChannelMargins| margins.balanced);
    let balanced = weakest.reduce(|a, b| if b.alpha < a.alpha { b } else { a }).ok_or(CertifyError::EmptyRegion)?;
    let of_all = |limits: &mut Vec<StabilityLimit>| {
        let least = limits.iter().cloned().reduce(|a, b| if b.stable_to_s < a.stable_to_s { b } else { a });
        limits.extend(least.map(|least| StabilityLimit { channels: "all".to_owned(), ..least }));
    };
    of_all(&mut delay);
    of_all(&mut lag);
    Ok(Certificate {
        rate_hz,
        delay_samples: 0,
        rounding: rounding(&gains, &craft.gains),
        continuous: None,
        sampled: SampledLoopFigures {
            poles: pairs(&poles),
            spectral_radius: radius,
            decrease: held.ok_or(CertifyError::EmptyRegion)?,
            margins: LoopMargins { each, all: AllChannels { balanced, alpha_at_most: balanced.alpha } },
        },
        delay,
        lag,
        motors_in_rate_loop: None,
        along: None,
    })
}

/// Certifies a table over its region.
///
/// # Errors
/// As [`cascade_craft`]; an unstable point is no error.
pub fn certify_cascade_region(
    vehicle: &Vehicle,
    gains: [f64; 16],
    lag_s: f64,
    air: &CascadeAir,
    bounds: &CascadeBounds,
    period_s: f64,
) -> Result<CascadeRegionCertificate, CertifyError> {
    let craft = CascadeCraft { moment_n_s: bounds.moment_n_s, ..cascade_craft(vehicle, gains, lag_s, air, period_s)? };
    Ok(CascadeRegionCertificate {
        bounds: *bounds,
        seen: bounds.region().certify(&craft)?,
        unseen: bounds.region_unseen().certify(&craft)?,
    })
}

impl CascadeChain {
    /// The chains by the part of the forces that closes them.
    const IN_PARTS: [(Self, &'static str); 4] =
        [(Self::Z, "thrust_n"), (Self::Y, "roll_n"), (Self::X, "pitch_n"), (Self::Yaw, "yaw_n")];
}

fn limit(name: &str, stable_to_s: f64, resolution_s: f64) -> StabilityLimit {
    StabilityLimit { channels: name.to_owned(), stable_to_s, resolution_s: Some(resolution_s) }
}

/// The longest lag of the motors with which a chain is stable that predicts with its own.
fn longest_lag(
    chain: CascadeChain,
    craft: &CascadeCraft,
    at: &CascadeVariation,
    name: &str,
) -> Result<StabilityLimit, CertifyError> {
    let stable =
        |lag_s: f64| Ok::<_, CertifyError>(chain.spectral_radius(craft, &CascadeVariation { lag_s, ..*at })? < 1.0);
    let (mut low_s, mut high_s) = (at.lag_s, at.lag_s * LAG_STEP);
    while stable(high_s)? {
        if high_s >= LONGEST_LAG_S {
            return Ok(StabilityLimit { channels: name.to_owned(), stable_to_s: high_s, resolution_s: None });
        }
        (low_s, high_s) = (high_s, high_s * LAG_STEP);
    }
    let resolution_s = (high_s - low_s) * f64::from(-BISECTIONS).exp2();
    for _ in 0..BISECTIONS {
        let middle_s = 0.5 * (low_s + high_s);
        if stable(middle_s)? { low_s = middle_s } else { high_s = middle_s }
    }
    Ok(limit(name, low_s, resolution_s))
}

/// The lesser of two proofs.
fn worse(held: Option<Decrease>, found: Decrease) -> Option<Decrease> {
    Some(match held {
        Some(held)
            if !held.holds
                || (found.holds && held.decrease_smallest_over_largest <= found.decrease_smallest_over_largest) =>
        {
            held
        }
        _ => found,
    })
}

fn rounding(designed: &[f64; 16], flown: &[f64; 16]) -> Rounding {
    let differences = designed.iter().zip(flown).map(|(designed, flown)| ((designed - flown).abs(), designed.abs()));
    differences.fold(Rounding { largest_absolute: 0.0, largest_relative: 0.0 }, |found, (difference, size)| Rounding {
        largest_absolute: found.largest_absolute.max(difference),
        largest_relative: found.largest_relative.max(difference / size),
    })
}
