//! Refitting: a piecewise polynomial in; one of at most so many pieces of degree 7, continuous up to jerk, out.
//!
//! Between two knots a piece takes position, velocity, acceleration and jerk of the source at both: eight conditions on
//! eight coefficients (two-point Hermite interpolation; Stoer and Bulirsch, Introduction to Numerical Analysis, 2.1.5).
//! Neighbours therefore meet up to the third derivative wherever the knots are, start and end stay unchanged, and
//! where a source that is itself continuous up to jerk has no breakpoint between two knots, the piece is the source's
//! own. Where the source jumps, a knot takes the mean of both sides. Heading is fitted like a coordinate.
//!
//! The knots are chosen among the source's breakpoints and equal parts of its pieces. Dynamic programming finds those
//! whose largest error is least, and among them those with the least sum of squares; a radian of heading counts as a
//! metre.

use std::num::NonZeroUsize;

use super::Trajectory;
use super::polynomial::{COEFFICIENTS, Coordinate, Piece, PiecewisePolynomial, PolynomialError};

/// About how many parts the source is cut into to look for knots. The work grows with the square.
const PARTS: usize = 320;

/// Most parts of one piece. On the paper's flights 8 fit a tenth closer than 2 do.
const PARTS_A_PIECE_MAX: usize = 8;

/// Where the error is looked at in each part, of its length.
const PROBES: [f64; 4] = [0.125, 0.375, 0.625, 0.875];

/// Value, first, second and third derivative of each coordinate.
type Jets = [[f64; 4]; 4];

/// A trajectory of at most `pieces_max` pieces close to `source`; the source itself where it has no more. Durations of
/// fitted pieces are numbers that `f32` holds, so that storing them moves no knot; the end may move by 6e-8 of the last
/// piece.
///
/// # Errors
/// [`PolynomialError`] if the source is so large or so short that a coefficient overflows.
pub fn refit(source: &PiecewisePolynomial, pieces_max: NonZeroUsize) -> Result<PiecewisePolynomial, PolynomialError> {
    if source.pieces().len() <= pieces_max.get() {
        return Ok(source.clone());
    }
    let parts = Parts::of(source, pieces_max.get());
    let knots = parts.best_knots(pieces_max.get());
    let mut start_s = 0.0;
    let pieces = knots.windows(2).map(|knots| {
        let duration_s = f64::from((parts.times_s[knots[1]] - start_s) as f32);
        start_s += duration_s;
        let mut coefficients = parts.unit_time_piece(knots[0], knots[1], duration_s);
        for polynomial in &mut coefficients {
            let mut unit = 1.0;
            for coefficient in polynomial {
                *coefficient /= unit;
                unit *= duration_s;
            }
        }
        Piece { duration_s, coefficients }
    });
    PiecewisePolynomial::new(pieces.collect())
}

/// The source, cut into parts between which knots may lie.
struct Parts {
    /// Ends of the parts: one more than there are.
    times_s: Vec<f64>,
    /// The source there; at a breakpoint the mean of its two sides.
    jets: Vec<Jets>,
    /// The source within each part, at [`PROBES`].
    probes: Vec<[[f64; 4]; PROBES.len()]>,
}

impl Parts {
    /// At least `least` parts, if the source has as many pieces.
    fn of(source: &PiecewisePolynomial, least: usize) -> Self {
        let (pieces, boundaries_s) = (source.pieces(), source.boundaries_s());
        let last = pieces.len() - 1;
        let mut times_s = Vec::new();
        let mut jets = Vec::new();
        let parts_a_piece = (PARTS / pieces.len()).clamp(1, PARTS_A_PIECE_MAX);
        // Of a source with very many pieces, evenly some of the breakpoints.
        let parts = PARTS.max(least).min(pieces.len());
        for part in 0..parts {
            let index = part * pieces.len() / parts;
            let piece = &pieces[index];
            for k in 0..parts_a_piece {
                let local_s = piece.duration_s * k as f64 / parts_a_piece as f64;
                times_s.push(boundaries_s[index] + local_s);
                let after = jets_of(piece, local_s);
                let before = match index.checked_sub(1).filter(|_| k == 0) {
                    Some(previous) => jets_of(&pieces[previous], pieces[previous].duration_s),
                    None => after,
                };
                jets.push(mean(&before, &after));
            }
        }
        times_s.push(boundaries_s[last + 1]);
        jets.push(jets_of(&pieces[last], pieces[last].duration_s));
        let probe = |ends: &[f64]| {
            PROBES.map(|share| {
                let sample = source.at(ends[0] + share * (ends[1] - ends[0]));
                let position = sample.position_m;
                [position.x, position.y, position.z, sample.heading_rad]
            })
        };
        let probes = times_s.windows(2).map(probe).collect();
        Self { times_s, jets, probes }
    }

    fn count(&self) -> usize {
        self.probes.len()
    }

    /// The knots from start to end, of at most `pieces` pieces, as indices of part ends.
    fn best_knots(&self, pieces: usize) -> Vec<usize> {
        let even: Vec<usize> = (0..=pieces).map(|k| k * self.count() / pieces).collect();
        let bound = even.windows(2).map(|knots| self.error(knots[0], knots[1], f64::INFINITY)).fold(0.0, f64::max);
        // Entry [to - 1][from]; an error above the worst of even knots is of no use.
        let errors: Vec<Vec<f64>> =
            (1..=self.count()).map(|to| (0..to).map(|from| self.error(from, to, bound)).collect()).collect();
        let (_, worst) = cheapest_path(&errors, pieces, f64::max);
        let squares: Vec<Vec<f64>> = errors
            .iter()
            .map(|row| row.iter().map(|e| if *e <= worst { e * e } else { f64::INFINITY }).collect())
            .collect();
        cheapest_path(&squares, pieces, |sum, square| sum + square).0
    }

    /// Largest distance from the source, m (or rad), of the piece between two part ends; infinite where above `bound`.
    fn error(&self, from: usize, to: usize, bound: f64) -> f64 {
        let (start_s, duration_s) = (self.times_s[from], self.times_s[to] - self.times_s[from]);
        let piece = self.unit_time_piece(from, to, duration_s);
        let mut largest = 0.0_f64;
        for part in from..to {
            let (part_s, length_s) = (self.times_s[part], self.times_s[part + 1] - self.times_s[part]);
            for (share, exact) in PROBES.iter().zip(&self.probes[part]) {
                let u = (part_s + share * length_s - start_s) / duration_s;
                let square: f64 = piece.iter().zip(exact).map(|(c, value)| (horner(c, u) - value).powi(2)).sum();
                let distance = square.sqrt();
                // Written so that NaN fails it.
                if distance <= bound {
                    largest = largest.max(distance);
                } else {
                    return f64::INFINITY;
                }
            }
        }
        largest
    }

    /// The polynomials between two part ends in the time of the piece divided by its duration.
    fn unit_time_piece(&self, from: usize, to: usize, duration_s: f64) -> [[f64; COEFFICIENTS]; 4] {
        std::array::from_fn(|i| hermite(&self.jets[from][i], &self.jets[to][i], duration_s))
    }
}

/// Value and derivatives to jerk of every coordinate at `local_s` within a piece.
fn jets_of(piece: &Piece, local_s: f64) -> Jets {
    Coordinate::ALL.map(|coordinate| std::array::from_fn(|order| piece.derivative(coordinate, order, local_s)))
}

fn mean(a: &Jets, b: &Jets) -> Jets {
    std::array::from_fn(|i| std::array::from_fn(|order| 0.5 * (a[i][order] + b[i][order])))
}

fn horner(coefficients: &[f64; COEFFICIENTS], u: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * u + c)
}

/// The polynomial of degree 7 over `0 <= u <= 1` with these values and derivatives, per second, at its ends.
fn hermite(start: &[f64; 4], end: &[f64; 4], duration_s: f64) -> [f64; COEFFICIENTS] {
    // Taylor coefficients at u = 0 and at u = 1: derivative k times duration^k / k!.
    let units = [1.0, duration_s, duration_s.powi(2) / 2.0, duration_s.powi(3) / 6.0];
    let [a0, a1, a2, a3]: [f64; 4] = std::array::from_fn(|k| start[k] * units[k]);
    let [b0, b1, b2, b3]: [f64; 4] = std::array::from_fn(|k| end[k] * units[k]);
    // The rest that a0 to a3 leave of b0 to b3, and the inverse of the binomials C(j, k), j = 4..7, k = 0..3.
    let (r0, r1, r2, r3) = (b0 - a0 - a1 - a2 - a3, b1 - a1 - 2.0 * a2 - 3.0 * a3, b2 - a2 - 3.0 * a3, b3 - a3);
    [
        a0,
        a1,
        a2,
        a3,
        35.0 * r0 - 15.0 * r1 + 5.0 * r2 - r3,
        -84.0 * r0 + 39.0 * r1 - 14.0 * r2 + 3.0 * r3,
        70.0 * r0 - 34.0 * r1 + 13.0 * r2 - 3.0 * r3,
        -20.0 * r0 + 10.0 * r1 - 4.0 * r2 + r3,
    ]
}

/// The path from 0 to `costs.len()` in at most `steps` steps forwards whose costs combine to the least, and that least.
/// Entry `[to - 1][from]` is the cost of a step.
fn cheapest_path(costs: &[Vec<f64>], steps: usize, combine: fn(f64, f64) -> f64) -> (Vec<usize>, f64) {
    let end = costs.len();
    // The cost of each place after so many steps, and the place before.
    let mut reached = vec![f64::INFINITY; end + 1];
    reached[0] = 0.0;
    let mut best = (Vec::new(), f64::INFINITY);
    let mut origins: Vec<Vec<usize>> = Vec::new();
    for _ in 0..steps {
        let mut next = vec![f64::INFINITY; end + 1];
        let mut origin = vec![0; end + 1];
        for (to, row) in (1..).zip(costs) {
            for (from, cost) in row.iter().enumerate() {
                let total = combine(reached[from], *cost);
                if total < next[to] {
                    (next[to], origin[to]) = (total, from);
                }
            }
        }
        origins.push(origin);
        if best.0.is_empty() || next[end] < best.1 {
            let mut path = vec![end];
            for origin in origins.iter().rev() {
                path.push(origin[path[path.len() - 1]]);
            }
            path.reverse();
            best = (path, next[end]);
        }
        reached = next;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_conditions_give_back_the_polynomial_they_come_from() {
        // All integers below 2^53, so exact: coefficients 1 to 8, over 1 s.
        let coefficients = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
        let piece = Piece { duration_s: 1.0, coefficients: [coefficients; 4] };
        assert_eq!(hermite(&jets_of(&piece, 0.0)[0], &jets_of(&piece, 1.0)[0], 1.0), coefficients);
    }

    #[test]
    fn the_cheapest_path_is_found_by_either_measure() {
        // Steps to 1, 2 and 3 from 0, 1, 2. Two steps: over 1 the costs are 1 and 5, over 2 they are 4 and 4.
        let costs = [vec![1.0], vec![4.0, 9.0], vec![9.0, 5.0, 4.0]];
        assert_eq!(cheapest_path(&costs, 2, |a, b| a + b), (vec![0, 1, 3], 6.0));
        assert_eq!(cheapest_path(&costs, 2, f64::max), (vec![0, 2, 3], 4.0));
        assert_eq!(cheapest_path(&costs, 1, f64::max), (vec![0, 3], 9.0));
        // A third step would cost more: it is not taken.
        assert_eq!(cheapest_path(&costs, 3, f64::max), (vec![0, 2, 3], 4.0));
    }
}
