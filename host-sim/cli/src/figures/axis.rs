//! Ranges of values in; scales with round ticks clear of their ends, and the ticks' labels, out.

/// Closed range of values on an axis; `low < high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Range {
    /// The smallest range that holds all finite `values`; `None` if there are none.
    pub(super) fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        values.into_iter().filter(|v| v.is_finite()).fold(None, |range: Option<Self>, v| match range {
            None => Some(Self { low: v, high: v }),
            Some(range) => Some(Self { low: range.low.min(v), high: range.high.max(v) }),
        })
    }

    pub(super) fn extent(self) -> f64 {
        self.high - self.low
    }

    /// Grown by `margin` at either end.
    pub(super) fn widened(self, margin: f64) -> Self {
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// Grown about its middle to an extent of at least `least`.
    pub(super) fn at_least(self, least: f64) -> Self {
        self.widened(0.5 * (least - self.extent()).max(0.0))
    }

    /// Grown to hold `other`.
    pub(super) fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// 0 at the low end, 1 at the high end.
    pub(super) fn share(self, value: f64) -> f64 {
        (value - self.low) / self.extent()
    }
}

/// A range and the step of the ticks on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) range: Range,
    pub(super) step: f64,
}

impl Scale {
    /// `range` with its ends at least a twentieth of it beyond the outermost ticks: a label at the very end of an axis
    /// would run over its corner.
    pub(super) fn clear_of_ticks(range: Range, step: f64) -> Self {
        let clearance = 0.05 * range.extent();
        let lowest = (range.low / step - SLACK).ceil() * step;
        let highest = (range.high / step + SLACK).floor() * step;
        // Without a tick in the range, `highest` lies below it and `lowest` above: no end moves.
        let range = Range { low: range.low.min(lowest - clearance), high: range.high.max(highest + clearance) };
        Self { range, step }
    }

    /// Multiples of the step in the range, with their labels.
    pub(super) fn ticks(self) -> Vec<(f64, String)> {
        let first = (self.range.low / self.step - SLACK).ceil();
        let last = (self.range.high / self.step + SLACK).floor();
        let count = (last - first).max(-1.0) as usize + usize::from(last >= first);
        (0..count)
            .map(|i| {
                let value = (first + i as f64) * self.step;
                (value, label(value, self.step))
            })
            .collect()
    }
}

/// A tick that misses the end of a range by a rounding error, in steps, belongs to it.
const SLACK: f64 = 1e-9;

/// The step of 1, 2, 2.5 or 5 times a power of ten that puts about `count` ticks on `extent`, never more.
pub(super) fn step(extent: f64, count: f64) -> f64 {
    let least = extent / count;
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= least).unwrap_or(10.0 * power)
}

/// `value` with as many decimals as tell multiples of `step` apart, and a true minus sign.
fn label(value: f64, step: f64) -> String {
    let decimals = (0..12).find(|d| ((step * 10_f64.powi(*d)).fract() - 0.5).abs() > 0.5 - 1e-6).unwrap_or(12) as usize;
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().any(|b| (b'1'..=b'9').contains(&b)) => format!("\u{2212}{digits}"),
        Some(digits) => digits.to_owned(),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_stand_clear_of_the_ends() {
        for k in 0..2000 {
            let low = -0.01 * f64::from(k % 97);
            let range = Range { low, high: low + 0.1 + 0.003 * f64::from(k) };
            for count in [5.0, 8.0] {
                let scale = Scale::clear_of_ticks(range, step(range.extent(), count));
                assert!(scale.range.low <= range.low && scale.range.high >= range.high, "{range:?}");
                assert!(scale.range.extent() < 1.11 * range.extent(), "a twentieth at either end: {range:?}");
                let ticks = scale.ticks();
                assert!(!ticks.is_empty(), "{range:?}");
                for (value, label) in ticks {
                    // A twentieth of the range as it was, in the range as it is: 0.05 / 1.1.
                    assert!((0.045..=0.955).contains(&scale.range.share(value)), "{label} in {range:?}");
                }
            }
        }
    }

    #[test]
    fn a_range_between_two_ticks_stays() {
        let range = Range { low: 0.1, high: 0.9 };
        assert_eq!(Scale::clear_of_ticks(range, 1.0), Scale { range, step: 1.0 });
        assert!(Scale { range, step: 1.0 }.ticks().is_empty());
    }
}
