//! Samples of a curve in, the parts to draw out: the stretches inside the axes, with no more points than show.

/// The stretches of the line through `samples` that lie in the box `low..=high`. A sample that is not finite breaks the
/// line.
pub(super) fn clipped<const N: usize>(
    samples: impl Iterator<Item = [f64; N]>,
    low: [f64; N],
    high: [f64; N],
) -> Vec<Vec<[f64; N]>> {
    let mut stretches: Vec<Vec<[f64; N]>> = Vec::new();
    // The last sample, and whether the last stretch ends on it.
    let mut previous: Option<([f64; N], bool)> = None;
    for sample in samples {
        if sample.iter().any(|v| !v.is_finite()) {
            previous = None;
            continue;
        }
        let mut reaches = false;
        if let Some((from, joined)) = previous
            && let Some([enter, leave]) = segment_in_box(from, sample, low, high)
        {
            let at = |share: f64| std::array::from_fn(|i| from[i] + share * (sample[i] - from[i]));
            match stretches.last_mut() {
                Some(stretch) if joined => stretch.push(at(leave)),
                _ => stretches.push(vec![at(enter), at(leave)]),
            }
            reaches = leave == 1.0;
        }
        previous = Some((sample, reaches));
    }
    stretches
}

/// The shares of the way from `from` to `to` at which it enters and leaves the box (Liang and Barsky).
fn segment_in_box<const N: usize>(from: [f64; N], to: [f64; N], low: [f64; N], high: [f64; N]) -> Option<[f64; 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for i in 0..N {
        let way = to[i] - from[i];
        if way == 0.0 {
            if from[i] < low[i] || from[i] > high[i] {
                return None;
            }
            continue;
        }
        let (a, b) = ((low[i] - from[i]) / way, (high[i] - from[i]) / way);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter <= leave).then_some([enter, leave])
}

/// `points` without those that move the line by less than `tolerance`; the ends stay.
///
/// From each kept point, the directions that pass within `tolerance` of all points since form a cone; the first point
/// outside it, or one that turns back, makes its predecessor a kept point. One pass, for any curve.
pub(super) fn thinned(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let [first, rest @ .., last] = points else { return points.to_vec() };
    let mut kept = vec![*first];
    let (mut anchor, mut before) = (*first, *first);
    let mut cone: Option<Cone> = None;
    for point in rest.iter().chain([last]) {
        cone = match cone {
            None => Cone::around(anchor, *point, tolerance),
            Some(current) => current.narrowed(anchor, *point, tolerance).or_else(|| {
                kept.push(before);
                anchor = before;
                Cone::around(anchor, *point, tolerance)
            }),
        };
        before = *point;
    }
    kept.push(*last);
    kept
}

/// Directions from a kept point, as angles from `middle`, and how far the line has come from it.
#[derive(Clone, Copy)]
struct Cone {
    middle: f64,
    low: f64,
    high: f64,
    reach: f64,
}

impl Cone {
    /// All directions from `anchor` that pass within `tolerance` of `point`; `None` for a point so near that it says
    /// nothing about a direction.
    fn around(anchor: [f64; 2], point: [f64; 2], tolerance: f64) -> Option<Self> {
        let (dx, dy) = (point[0] - anchor[0], point[1] - anchor[1]);
        let distance = dx.hypot(dy);
        let half = (tolerance / distance).asin();
        (distance > tolerance).then(|| Self { middle: dy.atan2(dx), low: -half, high: half, reach: distance })
    }

    /// The directions that also pass `point`; `None` if it turns back or its own direction is not among them.
    fn narrowed(self, anchor: [f64; 2], point: [f64; 2], tolerance: f64) -> Option<Self> {
        let other = Self::around(anchor, point, tolerance)?;
        let turn = std::f64::consts::TAU;
        let angle = other.middle - self.middle;
        let angle = angle - turn * (angle / turn).round();
        let onwards = other.reach + tolerance >= self.reach;
        (onwards && self.low <= angle && angle <= self.high).then(|| Self {
            middle: self.middle,
            low: self.low.max(angle + other.low),
            high: self.high.min(angle + other.high),
            reach: self.reach.max(other.reach),
        })
    }
}
