//! The peak of a function of frequency: a grid first, then golden sections around its largest values.

use num_complex::Complex64;

/// Points a decade.
const DENSITY: f64 = 40.0;
/// Points closer than this share are one.
const NEIGHBOURS: f64 = 1e-5;
/// Golden sections: each shrinks the bracket to 62 %.
const SECTIONS: usize = 60;
/// A refined peak counts only where it is higher by this share: flat functions peak at a grid point then, on every
/// processor the same one.
const WORTHWHILE: f64 = 1e-11;
/// Local maxima this close to the highest are refined, too.
const CONTENDER: f64 = 0.9;

/// Frequencies from `low` to `high`, denser around `resonances`; sorted.
pub(super) fn grid(low: f64, high: f64, resonances: &[Complex64]) -> Vec<f64> {
    let decades = (high / low).log10().max(0.1);
    let count = (decades * DENSITY).ceil() as usize + 2;
    let mut points: Vec<f64> =
        (0..=count).map(|k| low * (high / low).powf(k as f64 / count as f64)).map(|point| point.min(high)).collect();
    // A weakly damped pole peaks over a width of its real part.
    for pole in resonances {
        points.extend((-4..=4).map(|k| pole.im.abs() + 0.5 * f64::from(k) * pole.re.abs()));
    }
    points.retain(|point| *point >= low && *point <= high);
    points.sort_by(f64::total_cmp);
    // Next to each other two points differ by rounding alone, and neither looks like the side of a peak.
    points.dedup_by(|later, earlier| *later - *earlier <= NEIGHBOURS * *earlier);
    points
}

/// Highest value and where it is, over the points and refined between them; nothing if the function fails everywhere.
pub(super) fn peak(points: &[f64], function: impl Fn(f64) -> Option<f64>) -> Option<(f64, f64)> {
    let values: Vec<f64> = points.iter().map(|point| function(*point).unwrap_or(f64::NEG_INFINITY)).collect();
    refined_peak(points, &values, function)
}

/// The same where the values at the points are known.
pub(super) fn refined_peak(
    points: &[f64],
    values: &[f64],
    function: impl Fn(f64) -> Option<f64>,
) -> Option<(f64, f64)> {
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut best: Option<(f64, f64)> = None;
    for (i, value) in values.iter().enumerate() {
        let left = i.saturating_sub(1);
        let right = (i + 1).min(values.len() - 1);
        if *value < CONTENDER * highest || *value < values[left] || *value < values[right] {
            continue;
        }
        let refined = golden(points[left], points[right], &function);
        for (height, point) in [(*value, points[i])].into_iter().chain(refined) {
            if best.is_none_or(|held| height > held.0 * (1.0 + WORTHWHILE)) {
                best = Some((height, point));
            }
        }
    }
    best.filter(|held| held.0.is_finite())
}

/// Highest value between two points, where the function has one maximum there.
fn golden(low: f64, high: f64, function: &impl Fn(f64) -> Option<f64>) -> Option<(f64, f64)> {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (low, high);
    let (mut x, mut y) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut at_x, mut at_y) = (function(x)?, function(y)?);
    for _ in 0..SECTIONS {
        if at_x > at_y {
            (high, y, at_y) = (y, x, at_x);
            x = high - ratio * (high - low);
            at_x = function(x)?;
        } else {
            (low, x, at_x) = (x, y, at_y);
            y = low + ratio * (high - low);
            at_y = function(y)?;
        }
    }
    Some(if at_x > at_y { (at_x, x) } else { (at_y, y) })
}
