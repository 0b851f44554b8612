//! The certificate of a gain as flown: poles, margins, delay and lag, as figures for documents and tables.

use num_complex::Complex64;
use serde::Serialize;

use super::decrease::Decrease;
use super::limits::StabilityLimit;
use super::margins::LoopMargins;
use super::rounding::Rounding;

/// Real parts closer than this share of the largest pole count as equal.
const SAME: f64 = 1e-9;
/// A figure counts as worse than another beyond this ratio: of equals the first one is named, on every processor the same.
pub(super) const WORSE: f64 = 1.0 + 1e-9;

/// The figures of a gain, computed from it as rounded to f32.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// Control rate, Hz.
    pub rate_hz: f64,
    /// Whole samples by which commands are known to act late; margins and limits come on top.
    pub delay_samples: usize,
    /// Distance of the f32 gain from the f64 gain.
    pub rounding: Rounding,
    /// In continuous time; absent for a controller with memory or a known delay, which have no continuous form.
    pub continuous: Option<ContinuousLoop>,
    /// Under commands held for a period.
    pub sampled: SampledLoopFigures,
    /// Largest delay on top of the known one, by channel and for all at once, s.
    pub delay: Vec<StabilityLimit>,
    /// Largest time constant of a first-order actuator, by channel and for all at once, s.
    pub lag: Vec<StabilityLimit>,
    /// Largest time constant of the motors inside a rate loop, by channel and for all at once, s; absent if not asked for.
    pub motors_in_rate_loop: Option<Vec<StabilityLimit>>,
    /// Of gains over time; the figures above are then the worst of their knots.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<AlongFigures>,
}

/// The loop in continuous time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContinuousLoop {
    /// Poles, 1/s, real and imaginary part, sorted by real part.
    pub poles_1_s: Vec<[f64; 2]>,
    /// Largest real part, 1/s.
    pub abscissa_1_s: f64,
    /// Lyapunov function; absent for an unstable loop.
    pub decrease: Option<Decrease>,
    /// Margins; absent for an unstable loop.
    pub margins: Option<LoopMargins>,
}

/// The loop at its rate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampledLoopFigures {
    /// Poles per sample, real and imaginary part, sorted by real part.
    pub poles: Vec<[f64; 2]>,
    /// Largest modulus of the poles.
    pub spectral_radius: f64,
    /// Lyapunov function.
    pub decrease: Decrease,
    /// Margins up to the Nyquist frequency.
    pub margins: LoopMargins,
}

/// The figures of gains over time alone. The figures beside it are the worst of the knots.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AlongFigures {
    /// Knots.
    pub knots: usize,
    /// Time between two of them, s.
    pub spacing_s: f64,
    /// Control steps at which the decrease was checked, with that of the hover behind the last knot.
    pub steps: usize,
    /// The share of V that is left after the step that takes off least.
    pub largest_ratio: f64,
    /// Time of that step, s.
    pub largest_ratio_at_s: f64,
    /// Largest distance of the interpolated gain from the optimal one at any control step, over the norm of that.
    pub interpolation_error: f64,
    /// Spectral radius of the loop frozen at each knot.
    pub spectral_radii: Vec<f64>,
    /// The knot with the least margin of all channels at once.
    pub least_margin_at_knot: usize,
}

/// Sorted by real part, and by imaginary part where the real parts differ by rounding only: the order of poles that
/// several axes share is then the same on every processor.
pub(super) fn pairs(values: &[Complex64]) -> Vec<[f64; 2]> {
    let largest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let mut sorted = values.to_vec();
    sorted.sort_by(|x, y| x.re.total_cmp(&y.re));
    let same = |x: &Complex64, y: &Complex64| (x.re - y.re).abs() <= SAME * largest;
    for group in sorted.chunk_by_mut(same) {
        group.sort_by(|x, y| x.im.total_cmp(&y.im));
    }
    sorted.iter().map(|value| [value.re, value.im]).collect()
}
