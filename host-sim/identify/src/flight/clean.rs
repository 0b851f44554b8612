//! One stream, times and one or more values a sample, in; the same without codes, outliers and repeats out.

use crate::filter::median;

/// Samples of one stream; every channel is as long as the times.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Stream {
    pub(super) times_s: Vec<f64>,
    pub(super) channels: Vec<Vec<f64>>,
}

/// Counts of the values taken out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Removed {
    pub(super) missing: usize,
    /// At the time of the one before, or earlier.
    pub(super) stamps: usize,
    pub(super) out_of_range: usize,
    pub(super) outliers: usize,
    pub(super) repeats: usize,
    pub(super) of: usize,
}

/// Values that loggers write for missing ones.
const CODES: [f64; 6] = [-999.0, -9999.0, 999_999.0, -999_999.0, 4_294_967_295.0, -2_147_483_648.0];
/// A repeat of more samples than this is a value that rests.
const LONGEST_REPEAT: usize = 2;
/// A gyroscope that shows the same for more samples does not measure.
const LONGEST_REST: usize = 20;
/// Neighbours of a value out of range were interpolated from it.
const SPOILT: usize = 2;

impl Stream {
    /// Median time between two samples, s.
    pub(super) fn period_s(&self) -> f64 {
        median(&self.times_s.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>())
    }

    /// Without samples that are missing, out of range, or stray from the median of five by more than outliers do.
    pub(super) fn cleaned(self, range: [f64; 2], look_for_outliers: bool) -> (Self, Removed) {
        let count = self.times_s.len();
        let mut keep = vec![true; count];
        let mut removed = Removed { of: count, ..Removed::default() };
        let mut latest = f64::NEG_INFINITY;
        for i in 0..count {
            let missing = !self.times_s[i].is_finite()
                || self.channels.iter().any(|channel| !channel[i].is_finite() || CODES.contains(&channel[i]));
            if missing {
                keep[i] = false;
                removed.missing += 1;
            } else if self.times_s[i] <= latest {
                keep[i] = false;
                removed.stamps += 1;
            } else {
                latest = self.times_s[i];
            }
        }
        for i in 0..count {
            let outside = |channel: &Vec<f64>| !(range[0]..=range[1]).contains(&channel[i]);
            if keep[i] && self.channels.iter().any(outside) {
                removed.out_of_range += 1;
                let spoilt = i.saturating_sub(SPOILT)..(i + SPOILT + 1).min(count);
                keep[spoilt].iter_mut().for_each(|keep| *keep = false);
            }
        }
        let mut kept = self.only(&keep);
        if look_for_outliers {
            let keep = kept.without_outliers();
            removed.outliers = keep.iter().filter(|keep| !**keep).count();
            kept = kept.only(&keep);
        }
        let keep = kept.without_repeats();
        removed.repeats = keep.iter().filter(|keep| !**keep).count();
        (kept.only(&keep), removed)
    }

    pub(super) fn only(&self, keep: &[bool]) -> Self {
        let of = |values: &[f64]| values.iter().zip(keep).filter(|(_, keep)| **keep).map(|(value, _)| *value).collect();
        Self { times_s: of(&self.times_s), channels: self.channels.iter().map(|channel| of(channel)).collect() }
    }

    fn without_outliers(&self) -> Vec<bool> {
        let count = self.times_s.len();
        let mut keep = vec![true; count];
        for channel in &self.channels {
            let stray: Vec<f64> = (0..count)
                .map(|i| {
                    let near = &channel[i.saturating_sub(2)..(i + 3).min(count)];
                    (channel[i] - median(near)).abs()
                })
                .collect();
            // Ten times the bound of 98 of 100 samples: a flight's own jumps are part of that.
            let most = (10.0 * crate::filter::quantile(&stray, 0.98)).max(0.3 * spread(channel));
            for (keep, stray) in keep.iter_mut().zip(&stray) {
                *keep &= *stray <= most;
            }
        }
        keep
    }

    /// Without stretches in which nothing changes for longer than a sensor with noise can be: a logger has stood still there. With how
    /// many samples those have.
    pub(super) fn without_frozen(&self) -> (Self, usize) {
        let count = self.times_s.len();
        let same = |i: usize| i > 0 && self.channels.iter().all(|channel| channel[i] == channel[i - 1]);
        let mut keep = vec![true; count];
        let mut i = 0;
        while i < count {
            let end = (i + 1..count).find(|k| !same(*k)).unwrap_or(count);
            if end - i > LONGEST_REST {
                keep[i..end].iter_mut().for_each(|keep| *keep = false);
            }
            i = end;
        }
        (self.only(&keep), keep.iter().filter(|keep| !**keep).count())
    }

    fn without_repeats(&self) -> Vec<bool> {
        let count = self.times_s.len();
        let same = |i: usize| i > 0 && self.channels.iter().all(|channel| channel[i] == channel[i - 1]);
        let mut keep = vec![true; count];
        let mut i = 0;
        while i < count {
            let mut end = i;
            while end < count && same(end) {
                end += 1;
            }
            if end > i && end - i <= LONGEST_REPEAT {
                keep[i..end].iter_mut().for_each(|keep| *keep = false);
            }
            i = end.max(i + 1);
        }
        keep
    }
}

fn spread(values: &[f64]) -> f64 {
    crate::filter::quantile(values, 0.95) - crate::filter::quantile(values, 0.05)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(values: Vec<f64>) -> Stream {
        Stream { times_s: (0..values.len()).map(|i| 0.01 * i as f64).collect(), channels: vec![values] }
    }

    #[test]
    fn codes_outliers_and_repeats_are_taken_out() {
        let mut values: Vec<f64> = (0..1000).map(|i| (0.05 * f64::from(i)).sin()).collect();
        values[100] = f64::NAN;
        values[200] = -9999.0;
        values[300] = 40.0;
        values[400] = values[399];
        let (clean, removed) = stream(values).cleaned([-1e9, 1e9], true);
        assert_eq!((removed.missing, removed.outliers, removed.repeats), (2, 1, 1));
        assert_eq!(clean.times_s.len(), 996);
    }

    #[test]
    fn a_command_out_of_range_takes_its_neighbours_and_a_rest_stays() {
        let mut values: Vec<f64> = (0..100).map(f64::from).collect();
        values[50] = -3e5;
        values[80..].fill(7.0);
        let (clean, removed) = stream(values).cleaned([0.0, 65535.0], false);
        assert_eq!((removed.out_of_range, removed.repeats), (1, 0));
        assert_eq!(clean.times_s.len(), 95);
    }
}
