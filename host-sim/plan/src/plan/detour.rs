//! Detours: a curve in, whether it is many times as long as the straight lines through its waypoints, and which waypoint
//! makes it so, out.

use super::leg::NoCurve;
use super::{BSpline, Bounds, Budget, Plan};
use crate::trajectory::Trajectory as _;

/// A curve longer than this many times its polyline has loops that nobody asked for.
const LONGEST: f64 = 2.5;

/// Most waypoints that are left out in turn.
const MOST_TRIALS: usize = 40;

/// A curve that takes a detour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detour {
    /// Length of the curve over that of the straight lines.
    pub times: f64,
    /// The waypoint, from 1 in its file, without which the curve is shortest; none where there is none but the ends.
    pub waypoint: Option<usize>,
}

/// Length of the curve, m.
fn length_m(curve: &BSpline) -> f64 {
    const INTERVALS: u32 = 3000;
    let step_s = curve.duration_s() / f64::from(INTERVALS);
    (0..INTERVALS).map(|k| curve.derivative(1, (f64::from(k) + 0.5) * step_s).norm() * step_s).sum()
}

/// The detour of a curve, if it takes one.
pub(super) fn of(plan: &Plan, curve: &BSpline, budget: &Budget<'_>) -> Option<Detour> {
    let polyline_m: f64 = plan.waypoints.windows(2).map(|pair| (pair[1].position_m - pair[0].position_m).norm()).sum();
    let flown_m = length_m(curve);
    // A pause has no length; a millimetre on the spot is no detour.
    if flown_m <= LONGEST * polyline_m || flown_m < 1e-3 {
        return None;
    }
    // Without bounds each trial is one system of equations.
    let mut trial = Plan { bounds: Bounds::default(), corridors: Vec::new(), ..plan.clone() };
    let inner = plan.waypoints.len().saturating_sub(2);
    let mut shortest: Option<(f64, usize)> = None;
    for index in 1..=inner.min(MOST_TRIALS) {
        trial.waypoints.clone_from(&plan.waypoints);
        trial.waypoints.remove(index);
        match trial.curve_within(budget) {
            Ok(without) => {
                let length = length_m(&without);
                if shortest.is_none_or(|(least, _)| length < least) {
                    shortest = Some((length, index));
                }
            }
            Err(NoCurve::OutOfTime) => break,
            Err(_) => {}
        }
    }
    let waypoint = shortest.map(|(_, index)| plan.first_number + index);
    Some(Detour { times: flown_m / polyline_m.max(1e-9), waypoint })
}
