//! Free times: waypoints and bounds in, the times at which to pass them in the least time out.
//!
//! In time of its own, `tau = t / T`, the control points of derivative `k` are those of a curve of fixed length in time over
//! `T^k`. With `S = T^2` and `w <= sqrt(S)`, a rotated cone, all bounds on speed (`|P1| <= speed_max w`), acceleration, tilt and
//! thrust (`|P2| <= acceleration_max S` and so on) are convex in the points, `S` and `w` together: for given shares of the
//! waypoints one cone program finds the least time, without a search. The body rate takes `|P3| <= rate zeta w`, with `w` of
//! the step before. The shares move along: where a waypoint is met is linear in its share, by the curve's velocity of the step
//! before, within a trust region that shrinks whenever the time does not (sequential convex programming).

use nalgebra::Vector3;
use quatrack_design::model::GRAVITY_M_S2;

use super::program::{Affine, Constraint, Program};
use super::{Bounds, Budget, Corridor, socp};
use crate::trajectory::bspline::{BSpline, UniformBasis};

/// Most steps of the shares.
const MOST_STEPS: usize = 40;
/// A step that gains less than this part of the time ends the search once the trust region is small.
const GAIN: f64 = 1e-4;
/// Largest change of a share, as part of the shorter segment beside it: at first, and where the search ends.
const TRUST: [f64; 2] = [0.4, 0.01];

/// The flight whose time is to be the least.
pub(super) struct Free<'a> {
    /// Where and how closely, from start to end, which are met at rest.
    pub(super) places: &'a [(Vector3<f64>, f64)],
    pub(super) bounds: &'a Bounds,
    /// Boxes around the whole of it.
    pub(super) corridors: &'a [Corridor],
    pub(super) degree: usize,
    pub(super) spans: usize,
}

/// A curve in a time, with the shares at which waypoints are passed.
struct Found {
    duration_s: f64,
    shares: Vec<f64>,
    curve: BSpline,
}

impl Free<'_> {
    /// Times of all places, s, from 0; `None` if no time does, or the time is up before any is found.
    pub(super) fn times_s(&self, budget: &Budget<'_>) -> Option<Vec<f64>> {
        let start_s = self.first_guess_s();
        let total: f64 = start_s.iter().sum();
        let mut passed = 0.0;
        let shares: Vec<f64> = start_s[..start_s.len() - 1]
            .iter()
            .map(|segment_s| {
                passed += segment_s;
                passed / total
            })
            .collect();
        // Twice: the body rate's bound is that of the time before.
        let mut best = self.solve(&shares, total, None, budget)?;
        best = self.solve(&shares, best.duration_s, None, budget).unwrap_or(best);
        let mut trust = if shares.is_empty() { 0.0 } else { TRUST[0] };
        for step in 0..MOST_STEPS {
            if trust < TRUST[1] || budget.is_over() {
                break;
            }
            budget.say(&format!("times: {:.2} s after {step} steps", best.duration_s));
            let moved = self.solve(&best.shares, best.duration_s, Some((&best.curve, trust)), budget);
            let next = moved.and_then(|moved| self.solve(&moved.shares, best.duration_s, None, budget));
            match next {
                Some(next) if next.duration_s < best.duration_s * (1.0 - GAIN) => best = next,
                _ => trust *= 0.4,
            }
        }
        let inner = best.shares.iter().map(|share| share * best.duration_s);
        Some(std::iter::once(0.0).chain(inner).chain([best.duration_s]).collect())
    }

    /// Times of segments flown from rest to rest each, on the straight line, s: of about the right proportions.
    fn first_guess_s(&self) -> Vec<f64> {
        let bounds = self.bounds;
        let of_tilt = bounds.tilt_max_rad.map(|tilt_rad| GRAVITY_M_S2 * tilt_rad.tan());
        let of_thrust = bounds.thrust_max_m_s2.map(|thrust| (thrust.powi(2) - GRAVITY_M_S2.powi(2)).max(0.0).sqrt());
        let acceleration = [bounds.acceleration_max_m_s2, of_tilt, of_thrust];
        let acceleration = acceleration.into_iter().flatten().fold(10.0, f64::min).max(1e-3);
        let speed = bounds.speed_max_m_s.unwrap_or(f64::INFINITY);
        let longest = self.places.windows(2).map(|pair| (pair[1].0 - pair[0].0).norm()).fold(1e-3, f64::max);
        self.places
            .windows(2)
            .map(|pair| {
                // Places on top of each other take some time, too.
                let length = (pair[1].0 - pair[0].0).norm().max(1e-2 * longest);
                (length / speed).max((2.0 * length / acceleration).sqrt())
            })
            .collect()
    }

    /// The least time with these shares; with a curve, also the shares within a trust region around it.
    fn solve(
        &self,
        shares: &[f64],
        unit_s: f64,
        moving: Option<(&BSpline, f64)>,
        budget: &Budget<'_>,
    ) -> Option<Found> {
        let basis = UniformBasis::new(self.degree, self.spans, unit_s).ok()?;
        let n = basis.control_points();
        let zetas = if self.bounds.body_rate_max_rad_s.is_some() { basis.spans() } else { 0 };
        let (square, root) = (3 * n + zetas, 3 * n + zetas + 1);
        let first_share = root + 1;
        let moved = if moving.is_some() { shares.len() } else { 0 };
        let mut constraints = self.bounds_in_unit_time(&basis, square, root);
        self.ends_and_corridors(&basis, &mut constraints);
        for (i, (share, (position_m, tolerance_m))) in shares.iter().zip(&self.places[1..]).enumerate() {
            let t_s = share * unit_s;
            let (first, weights) = basis.derivative_at(0, t_s);
            let velocity = moving.map(|(curve, _)| {
                // That of the curve found in another unit of time, per share.
                let duration_s = curve_duration_s(curve);
                curve.derivative(1, share * duration_s) * duration_s
            });
            let miss: Vec<Affine> = (0..3)
                .map(|axis| {
                    let terms = weights.iter().enumerate().map(|(k, weight)| (axis * n + first + k, *weight)).collect();
                    let flown = Affine { terms, constant: -position_m[axis] };
                    match velocity {
                        Some(velocity) => flown.plus_variable(first_share + i, velocity[axis]),
                        None => flown,
                    }
                })
                .collect();
            if *tolerance_m == 0.0 {
                constraints.extend(miss.into_iter().map(Constraint::Zero));
            } else {
                constraints.push(Constraint::Cone(Affine::constant(*tolerance_m), miss));
            }
            if let Some((_, trust)) = moving {
                let before = if i == 0 { 0.0 } else { shares[i - 1] };
                let after = shares.get(i + 1).copied().unwrap_or(1.0);
                let room = trust * (share - before).min(after - share);
                for sign in [1.0, -1.0] {
                    let bound = Affine::constant(room).plus_variable(first_share + i, sign);
                    constraints.push(Constraint::NonNegative(bound));
                }
            }
        }
        let mut linear = vec![0.0; first_share + moved];
        linear[square] = 1.0;
        let program = Program { variables: linear.len(), quadratic: Vec::new(), linear, constraints };
        let socp::Outcome::Solved(values) = socp::solve(&program, socp::Accuracy::THREE_DIGITS, budget) else {
            return None;
        };
        let points = (0..n).map(|j| Vector3::new(values[j], values[n + j], values[2 * n + j])).collect();
        Some(Found {
            duration_s: unit_s * values[square].max(1e-12).sqrt(),
            shares: shares
                .iter()
                .zip(&values[first_share..])
                .map(|(share, by)| share + by)
                .chain(
                    // Without moving there are no such variables.
                    if moved == 0 { shares.to_vec() } else { Vec::new() },
                )
                .collect(),
            curve: BSpline::new(self.degree, unit_s, points).ok()?,
        })
    }

    /// The bounds of a curve that takes `unit_s`, flown in `sqrt(square)` times that.
    fn bounds_in_unit_time(&self, basis: &UniformBasis, square: usize, root: usize) -> Vec<Constraint> {
        let bounds = self.bounds;
        let n = basis.control_points();
        let point = |weights: &[Vec<f64>], j: usize, axis: usize| Affine {
            terms: weights[j].iter().enumerate().map(|(i, weight)| (axis * n + j + i, *weight)).collect(),
            constant: 0.0,
        };
        let vector =
            |weights: &[Vec<f64>], j: usize| -> Vec<Affine> { (0..3).map(|axis| point(weights, j, axis)).collect() };
        let times_square = |factor: f64| Affine::default().plus_variable(square, factor);
        let mut constraints = Vec::new();
        // w^2 <= S.
        let half_sum = Affine::constant(1.0).plus_variable(square, 1.0);
        let half_difference = Affine::constant(-1.0).plus_variable(square, 1.0);
        constraints.push(Constraint::Cone(half_sum, vec![Affine::default().plus_variable(root, 2.0), half_difference]));
        constraints.push(Constraint::NonNegative(Affine::default().plus_variable(root, 1.0)));
        if let Some(bound) = bounds.speed_max_m_s {
            let weights = basis.derivative_weights(1);
            let heads = (0..weights.len()).map(|j| (j, Affine::default().plus_variable(root, bound)));
            constraints.extend(heads.map(|(j, head)| Constraint::Cone(head, vector(&weights, j))));
        }
        let weights = basis.derivative_weights(2);
        for j in 0..weights.len() {
            let acceleration = vector(&weights, j);
            let lift = acceleration[2].clone().plus_variable(square, GRAVITY_M_S2);
            if let Some(bound) = bounds.acceleration_max_m_s2 {
                constraints.push(Constraint::Cone(times_square(bound), acceleration.clone()));
            }
            if let Some(tilt_rad) = bounds.tilt_max_rad {
                constraints.push(Constraint::Cone(lift.clone().scaled(tilt_rad.tan()), acceleration[..2].to_vec()));
            }
            if let Some(bound) = bounds.thrust_max_m_s2 {
                let thrust = vec![acceleration[0].clone(), acceleration[1].clone(), lift.clone()];
                constraints.push(Constraint::Cone(times_square(bound), thrust));
            }
            if let Some(bound) = bounds.thrust_min_m_s2 {
                constraints.push(Constraint::NonNegative(lift.plus_variable(square, -bound)));
            }
        }
        if let Some(bound) = bounds.body_rate_max_rad_s {
            let jerk = basis.derivative_weights(3);
            for span in 0..basis.spans() {
                let zeta = 3 * n + span;
                constraints.push(Constraint::NonNegative(Affine::default().plus_variable(zeta, 1.0)));
                for j in span..=span + basis.degree() - 2 {
                    let lift = point(&weights, j, 2).plus_variable(square, GRAVITY_M_S2);
                    constraints.push(Constraint::NonNegative(lift.plus_variable(zeta, -1.0)));
                }
                for j in span..=span + basis.degree() - 3 {
                    let head = Affine::default().plus_variable(zeta, bound);
                    constraints.push(Constraint::Cone(head, vector(&jerk, j)));
                }
            }
        }
        constraints
    }

    fn ends_and_corridors(&self, basis: &UniformBasis, constraints: &mut Vec<Constraint>) {
        let n = basis.control_points();
        let (Some(start), Some(end)) = (self.places.first(), self.places.last()) else { return };
        for axis in 0..3 {
            for i in 0..4 {
                for (j, place) in [(i, start), (n - 1 - i, end)] {
                    let coordinate = Affine::constant(-place.0[axis]);
                    constraints.push(Constraint::Zero(coordinate.plus_variable(axis * n + j, 1.0)));
                }
            }
            for corridor in self.corridors {
                for j in 4..n.saturating_sub(4) {
                    let above = Affine::constant(-corridor.min_m[axis]).plus_variable(axis * n + j, 1.0);
                    let below = Affine::constant(corridor.max_m[axis]).plus_variable(axis * n + j, -1.0);
                    constraints.extend([above, below].map(Constraint::NonNegative));
                }
            }
        }
    }
}

fn curve_duration_s(curve: &BSpline) -> f64 {
    use crate::trajectory::Trajectory as _;
    curve.duration_s()
}
