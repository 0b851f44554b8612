//! A range of values in, round tick values and their labels out.

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

    /// The part of `self` within `limit`; they overlap wherever this is used.
    pub(super) fn within(self, limit: Self) -> Self {
        Self { low: self.low.max(limit.low), high: self.high.min(limit.high) }
    }

    /// 0 at the low end, 1 at the high end.
    pub(super) fn share(self, value: f64) -> f64 {
        (value - self.low) / self.extent()
    }
}

/// The step of 1, 2, 2.5 or 5 times a power of ten that puts about `count` ticks on `extent`, never more.
pub(super) fn step(extent: f64, count: f64) -> f64 {
    let least = extent / count;
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= least).unwrap_or(10.0 * power)
}

/// Multiples of `step` in `range`, with their labels.
pub(super) fn ticks(range: Range, step: f64) -> Vec<(f64, String)> {
    // A tick that misses the end of the range by a rounding error belongs to it.
    let slack = 1e-9;
    let first = (range.low / step - slack).ceil();
    let last = (range.high / step + slack).floor();
    let count = (last - first).max(-1.0) as usize + usize::from(last >= first);
    (0..count)
        .map(|i| {
            let value = (first + i as f64) * step;
            (value, label(value, step))
        })
        .collect()
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
