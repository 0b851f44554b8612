//! Disk margins at the plant's input.
//!
//! In flow independent loops in continuous time or at their rate; out flow margins of each channel and of all at once.
//! With S the sensitivity at the plant's input, a channel tolerates every factor `f = (1 + d/2) / (1 - d/2)`, |d| < alpha,
//! with `alpha = 1 / max |S - 1/2|` (the balanced disk, of equal gain up and down), and every `f = 1 / (1 - d)`,
//! |d| < `1 / max |S|` (the sensitivity disk, which knows that a linear quadratic loop tolerates any gain upwards). All
//! channels at once tolerate a factor each, all different, up to `1 / max mu(S - I/2)`.

use nalgebra::DMatrix;
use num_complex::Complex64;
use serde::Serialize;

use super::CertifyError;
use super::linear_loop::LinearLoop;
use super::plant::Timing;
use super::sampled_loop::SampledLoop;
use super::structured::{structured_bounds, structured_upper_bound};
use super::sweep::{grid, peak};
use crate::analysis::eigenvalues;

/// A disk of factors that leave the loop stable.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DiskMargin {
    /// Radius of the disk of d.
    pub alpha: f64,
    /// Smallest gain factor.
    pub gain_min: f64,
    /// Largest gain factor; absent where there is none.
    pub gain_max: Option<f64>,
    /// Phase either way, rad.
    pub phase_rad: f64,
    /// Where the loop is nearest to instability, rad/s; absent where no gain is too large, or at infinite frequency only.
    pub critical_rad_s: Option<f64>,
}

/// Margins of one channel, the others closed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelMargins {
    /// Name of the channel.
    pub channel: String,
    /// `f = (1 + d/2) / (1 - d/2)`.
    pub balanced: DiskMargin,
    /// `f = 1 / (1 - d)`.
    pub sensitivity: DiskMargin,
}

/// Margins with a factor in every channel at once.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AllChannels {
    /// Guaranteed: from the upper bound of mu.
    pub balanced: DiskMargin,
    /// No larger disk than this is tolerated: from the lower bound of mu.
    pub alpha_at_most: f64,
}

/// Margins at the plant's input.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoopMargins {
    /// Each channel alone.
    pub each: Vec<ChannelMargins>,
    /// All at once.
    pub all: AllChannels,
}

/// A disk that ends this close to an infinite gain factor has none: the factor is not known to any digit.
const UNBOUNDED: f64 = 1e-9;

/// A kind of disk.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Disk {
    Balanced,
    Sensitivity,
}

impl DiskMargin {
    pub(super) fn new(disk: Disk, peak: f64, critical_rad_s: f64) -> Self {
        let alpha = 1.0 / peak;
        let (gain_min, open, phase_rad) = match disk {
            Disk::Balanced => {
                ((1.0 - 0.5 * alpha) / (1.0 + 0.5 * alpha), alpha < 2.0 - UNBOUNDED, 2.0 * (0.5 * alpha).atan())
            }
            Disk::Sensitivity => (1.0 / (1.0 + alpha), alpha < 1.0 - UNBOUNDED, 2.0 * (0.5 * alpha).min(1.0).asin()),
        };
        let gain_max = match disk {
            Disk::Balanced => (1.0 + 0.5 * alpha) / (1.0 - 0.5 * alpha),
            Disk::Sensitivity => 1.0 / (1.0 - alpha),
        };
        Self {
            alpha,
            gain_min: if disk == Disk::Balanced && !open { 0.0 } else { gain_min },
            gain_max: open.then_some(gain_max),
            phase_rad,
            critical_rad_s: (open && critical_rad_s.is_finite()).then_some(critical_rad_s),
        }
    }
}

/// From frequency to sensitivity, the range to look in, and its bound beyond.
struct Sensitivity<'a> {
    at: Box<dyn Fn(f64) -> Option<DMatrix<Complex64>> + 'a>,
    points_rad_s: Vec<f64>,
    /// In continuous time S tends to the identity.
    identity_at_infinity: bool,
}

impl Sensitivity<'_> {
    /// Peak of a measure of S, and its frequency.
    fn peak(&self, measure: impl Fn(&DMatrix<Complex64>) -> Option<f64>, at_infinity: f64) -> Option<(f64, f64)> {
        let found = peak(&self.points_rad_s, |frequency| measure(&(self.at)(frequency)?))?;
        let beyond = self.identity_at_infinity && at_infinity > found.0;
        Some(if beyond { (at_infinity, f64::INFINITY) } else { found })
    }
}

/// In continuous time, the sums as integrals.
pub(super) fn continuous(loops: &[LinearLoop], names: &[String]) -> Result<Option<LoopMargins>, CertifyError> {
    let mut parts = Vec::new();
    for part in loops.iter().filter(|part| !part.channels.is_empty()) {
        let (a, b, gain) = part.continuous();
        let closed = &a - &b * &gain;
        let poles = eigenvalues(&closed)?;
        let to_complex = |m: &DMatrix<f64>| m.map(|value| Complex64::new(value, 0.0));
        let (closed, b, gain) = (to_complex(&closed), to_complex(&b), to_complex(&gain));
        let m = part.channels.len();
        let at = move |frequency_rad_s: f64| {
            let mut pencil = -closed.clone();
            for i in 0..pencil.nrows() {
                pencil[(i, i)] += Complex64::new(0.0, frequency_rad_s);
            }
            Some(DMatrix::identity(m, m) - &gain * pencil.lu().solve(&b)?)
        };
        let (slowest, fastest) = extremes(poles.iter().map(|pole| pole.norm()));
        parts.push((
            part,
            Sensitivity {
                at: Box::new(at),
                points_rad_s: grid(slowest * 1e-2, fastest * 1e2, &poles),
                identity_at_infinity: true,
            },
        ));
    }
    Ok(combined(&parts, names))
}

/// At the rate, on the unit circle up to the Nyquist frequency.
pub(super) fn sampled(
    loops: &[LinearLoop],
    timing: &Timing,
    names: &[String],
) -> Result<Option<LoopMargins>, CertifyError> {
    let mut parts = Vec::new();
    for part in loops.iter().filter(|part| !part.channels.is_empty()) {
        let held = SampledLoop::new(part, timing, &[])?;
        let period_s = timing.period_s;
        let points_rad_s = sampled_grid(&eigenvalues(&held.closed_loop())?, period_s);
        parts.push((
            part,
            Sensitivity {
                at: Box::new(move |frequency_rad_s| held.sensitivity(frequency_rad_s * period_s)),
                points_rad_s,
                identity_at_infinity: false,
            },
        ));
    }
    Ok(combined(&parts, names))
}

/// Frequencies to look at for poles per sample, rad/s.
pub(super) fn sampled_grid(poles: &[Complex64], period_s: f64) -> Vec<f64> {
    // A pole at 0 has no frequency; the others as if they were continuous.
    let poles: Vec<Complex64> =
        poles.iter().filter(|pole| pole.norm() > 1e-3).map(|pole| pole.ln() / period_s).collect();
    let nyquist_rad_s = std::f64::consts::PI / period_s;
    let (slowest, _) = extremes(poles.iter().map(|pole| pole.norm()));
    grid((slowest * 1e-2).min(1e-2 * nyquist_rad_s), nyquist_rad_s, &poles)
}

/// Smallest and largest of the positive values; 1 where there are none.
fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|value| *value > 0.0 && value.is_finite())
        .fold((f64::INFINITY, 0.0), |(low, high), value| (value.min(low), value.max(high)));
    if high > 0.0 { (low, high) } else { (1.0, 1.0) }
}

/// Margins of all parts: each channel's own, and of all at once those of the weakest part.
fn combined(parts: &[(&LinearLoop, Sensitivity)], names: &[String]) -> Option<LoopMargins> {
    let half = |s: &DMatrix<Complex64>| {
        let mut m = s.clone();
        for i in 0..m.nrows() {
            m[(i, i)] -= 0.5;
        }
        m
    };
    let mut each: Vec<(usize, ChannelMargins)> = Vec::new();
    // Upper bound, frequency, lower bound.
    let mut worst: Option<(f64, f64, f64)> = None;
    for (part, sensitivity) in parts {
        for (i, channel) in part.channels.iter().enumerate() {
            let balanced = sensitivity.peak(|s| Some((s[(i, i)] - 0.5).norm()), 0.5)?;
            let plain = sensitivity.peak(|s| Some(s[(i, i)].norm()), 1.0)?;
            each.push((
                *channel,
                ChannelMargins {
                    channel: names.get(*channel).cloned().unwrap_or_default(),
                    balanced: DiskMargin::new(Disk::Balanced, balanced.0, balanced.1),
                    sensitivity: DiskMargin::new(Disk::Sensitivity, plain.0, plain.1),
                },
            ));
        }
        let upper = sensitivity.peak(|s| structured_upper_bound(&half(s)), 0.5)?;
        // One channel's mu is its modulus; of several the lower bound has its own peak.
        let lower = if part.channels.len() == 1 || upper.1.is_infinite() {
            upper.0
        } else {
            let near: Vec<f64> = [0.98, 1.0, 1.02].iter().map(|factor| upper.1 * factor).collect();
            near.iter()
                .filter_map(|frequency| Some(structured_bounds(&half(&(sensitivity.at)(*frequency)?))?.lower))
                .fold(0.0, f64::max)
        };
        if worst.is_none_or(|held| upper.0 > held.0) {
            worst = Some((upper.0, upper.1, lower.max(worst.map_or(0.0, |held| held.2))));
        }
    }
    each.sort_by_key(|(channel, _)| *channel);
    let (upper, critical_rad_s, lower) = worst?;
    Some(LoopMargins {
        each: each.into_iter().map(|(_, margins)| margins).collect(),
        all: AllChannels {
            balanced: DiskMargin::new(Disk::Balanced, upper, critical_rad_s),
            alpha_at_most: 1.0 / lower,
        },
    })
}
