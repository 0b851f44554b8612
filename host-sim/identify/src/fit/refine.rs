//! Maximum a posteriori: figures and noise together, by the innovations of Kalman filters, from where regressions begin.
//!
//! Disturbances, moving air and noise of the commands are process noise, whose power and memory are parameters. So a controller that
//! answers a disturbance does not bias the figures, as it does where a balance is fitted by least squares; nor does noise of the
//! commands inflate the inertia, as it does where the output's error is.

use nalgebra::{DMatrix, DVector, Matrix2};

use super::BLOCK_S;
use super::bootstrap::{Block, Dice};
use super::innovations::{Balances, Innovations, KINDS};
use super::layout::{
    DAMPING, DRAG, FORCE_SHIFT, INERTIA, JUMP, LEVER, LIFT, MOMENT, NOISE, NOISE_COUNT, NOISE_Z, POSE_SHIFT, SHARED,
    VOLTAGE_POWER, units,
};
use super::normal_equations::Believed;
use super::prior::{Base, Prior};
use super::problem::{Prepared, Thrusts};
use crate::filter::{mean, median};
use crate::flight::RATE_HZ;

/// Share of a parameter's unit by which it is moved for a difference.
const DIFFERENCE: f64 = 0.02;
const ROUNDS: usize = 40;
/// Gain of the logarithm at which it is enough: a parameter that is off by a tenth of its deviation costs 0.005.
const ENOUGH: f64 = 0.03;

/// The estimate with the innovations that intervals are made of.
pub(super) struct Refined {
    /// The shared ones, then the logarithm of each flight's thrust per mass.
    pub(super) values: DVector<f64>,
    pub(super) priors: Vec<Prior>,
    pub(super) units: Vec<f64>,
    /// In units of the shared parameters.
    pub(super) blocks: Vec<Block>,
    /// By how much each flight's thrust goes with the shared parameters, a unit each.
    full_slopes: DMatrix<f64>,
}

/// Start values of the parameters and their priors.
pub(super) struct Start {
    pub(super) values: DVector<f64>,
    pub(super) priors: Vec<Prior>,
    /// Parameters that keep their values.
    pub(super) fixed: Vec<usize>,
}

struct State {
    thrusts: Vec<Thrusts>,
    full: Vec<f64>,
    kinds: Vec<Innovations>,
}

fn state(balances: &Balances<'_>, values: &DVector<f64>) -> Option<State> {
    let thrusts = balances.thrusts(values);
    let full = balances.full(values, &thrusts);
    let kinds = (0..KINDS).map(|kind| balances.innovations(kind, values, &thrusts, &full)).collect::<Option<_>>()?;
    Some(State { thrusts, full, kinds })
}

/// Whether a balance depends on a parameter. By way of the thrust that carries the craft all depend on the drag along z.
fn depends(kind: usize, j: usize) -> bool {
    let own = |axis: usize| {
        [MOMENT[axis], DAMPING[axis], DRAG[axis], LEVER[axis]].contains(&j)
            || (NOISE[axis]..NOISE[axis] + NOISE_COUNT).contains(&j)
    };
    match j {
        _ if j <= LIFT || j == JUMP => true,
        _ if INERTIA.contains(&j) => kind < 2,
        POSE_SHIFT => kind < 2,
        FORCE_SHIFT => kind == 2,
        _ if j >= NOISE_Z => kind == 2,
        _ => kind < 2 && own(kind),
    }
}

/// From a start to where the posterior is highest.
pub(super) fn refine(sections: &[Prepared], base: &Base, flights: usize, start: Start) -> Option<Refined> {
    let balances = Balances::new(sections, base, flights);
    let Start { mut values, priors, fixed } = start;
    let units = units(base);
    let mut now = state(&balances, &values)?;
    let cost = |values: &DVector<f64>, state: &State, weights: &[f64; KINDS]| -> f64 {
        state.kinds.iter().zip(weights).map(|(kind, weight)| weight * kind.cost()).sum::<f64>()
            + priors.iter().zip(values.iter()).map(|(prior, value)| prior.cost(*value)).sum::<f64>()
    };
    let mut weights = [1.0; KINDS];
    let mut least = cost(&values, &now, &weights);
    let mut damping = 1e-3;
    let mut weighed = false;
    for _ in 0..ROUNDS {
        let (blocks, _) = blocks(&balances, &values, &now, &units, &fixed, &weights);
        let (matrix, slope) = total(&blocks);
        let mut better = None;
        while damping < 1e6 {
            let believed = Believed { values: &values, priors: &priors, units: &units, fixed: &fixed };
            let step = believed.step(&matrix, &slope, damping);
            let trial = &values + step;
            let there = state(&balances, &trial);
            let there = there.map(|there| (cost(&trial, &there, &weights), there)).filter(|(cost, _)| *cost < least);
            if let Some((cost, there)) = there {
                better = Some((trial, cost, there));
                damping = (damping * 0.2).max(1e-6);
                break;
            }
            damping *= 5.0;
        }
        let gained = better.as_ref().map_or(0.0, |(_, cost, _)| least - cost);
        if let Some((trial, cost, there)) = better {
            (values, least, now) = (trial, cost, there);
        }
        if gained < ENOUGH {
            if weighed {
                break;
            }
            // Innovations should be independent from point to point; as far as they are not, they count for less.
            let (_, memory) = self::blocks(&balances, &values, &now, &units, &fixed, &[1.0; KINDS]);
            weights = memory.map(|memory| 1.0 / memory);
            least = cost(&values, &now, &weights);
            (weighed, damping) = (true, 1e-3);
        }
    }
    let (blocks, _) = blocks(&balances, &values, &now, &units, &fixed, &weights);
    let mut full_slopes = DMatrix::zeros(flights, SHARED);
    for j in (0..=LIFT).chain([JUMP]) {
        let mut there = values.clone();
        there[j] += DIFFERENCE * units[j];
        for (flight, full) in balances.full(&there, &balances.thrusts(&there)).into_iter().enumerate() {
            full_slopes[(flight, j)] = (full - now.full[flight]) / DIFFERENCE;
        }
    }
    let values = DVector::from_iterator(SHARED + flights, values.iter().copied().chain(now.full.iter().copied()));
    Some(Refined { values, priors, units, blocks, full_slopes })
}

/// Shares of normal equations in units of the parameters: Fisher's matrix and the slope of the likelihood, by stretches of time; and by
/// how much more the slopes of each balance vary from stretch to stretch than Fisher's matrix has it.
fn blocks(
    balances: &Balances<'_>,
    values: &DVector<f64>,
    now: &State,
    units: &[f64],
    fixed: &[usize],
    weights: &[f64; KINDS],
) -> (Vec<Block>, [f64; KINDS]) {
    let mut memory = [1.0; KINDS];
    let span = (BLOCK_S * RATE_HZ) as usize;
    let mut blocks = Vec::new();
    let mut starts = Vec::new();
    for (s, one) in balances.sections.iter().enumerate() {
        let rows = now.kinds[0].sections[s].len();
        starts.push(blocks.len());
        for _ in 0..(rows / span).max(1) {
            let (matrix, score) = (DMatrix::zeros(SHARED, SHARED), DVector::zeros(SHARED));
            blocks.push(Block { flight: one.flight, matrix, score });
        }
    }
    let moved = moved(balances, values, now, units, fixed);
    for kind in 0..KINDS {
        let here = &now.kinds[kind];
        let Some(factor) = here.covariance.cholesky() else { continue };
        let whiten = factor.l().try_inverse().unwrap_or_else(Matrix2::identity);
        let active: Vec<(usize, &Innovations)> = moved
            .iter()
            .enumerate()
            .filter_map(|(j, kinds)| kinds.as_ref()?[kind].as_ref().map(|there| (j, there)))
            .collect();
        // Of the covariance, white.
        let spread: Vec<Matrix2<f64>> = active
            .iter()
            .map(|(_, there)| whiten * (there.covariance - here.covariance) * whiten.transpose() / DIFFERENCE)
            .collect();
        let of_spread = DMatrix::from_fn(active.len(), active.len(), |a, b| 0.5 * (spread[a] * spread[b]).trace());
        let (mut slopes, mut fisher) = (vec![Vec::new(); active.len()], vec![0.0; active.len()]);
        for (s, rows) in here.sections.iter().enumerate() {
            let count = (rows.len() / span).max(1);
            let white = |[a, b]: [f64; 2]| [whiten[(0, 0)] * a, whiten[(1, 0)] * a + whiten[(1, 1)] * b];
            // The last block takes the rest.
            let own = (0..count).map(|k| {
                let part = k * span..if k + 1 == count { rows.len() } else { (k + 1) * span };
                let errors: Vec<[f64; 2]> = rows[part.clone()].iter().map(|row| white(*row)).collect();
                let mut lines = DMatrix::<f64>::zeros(2 * errors.len(), active.len());
                let mut score = vec![0.0; active.len()];
                for (a, (_, there)) in active.iter().enumerate() {
                    let (d, mut sum) = (&spread[a], 0.0);
                    let of_points = lines.column_mut(a).data.into_slice_mut().as_chunks_mut::<2>().0;
                    let away = &there.sections[s][part.clone()];
                    for (((line, away), row), e) in of_points.iter_mut().zip(away).zip(&rows[part.clone()]).zip(&errors)
                    {
                        *line = white([(away[0] - row[0]) / DIFFERENCE, (away[1] - row[1]) / DIFFERENCE]);
                        let squared = d[(0, 0)] * e[0] * e[0] + 2.0 * d[(0, 1)] * e[0] * e[1] + d[(1, 1)] * e[1] * e[1];
                        sum += 0.5 * (squared - d.trace()) - line[0] * e[0] - line[1] * e[1];
                    }
                    score[a] = sum;
                }
                (lines.tr_mul(&lines) + &of_spread * errors.len() as f64, score)
            });
            for (k, (matrix, score)) in own.enumerate() {
                let block = &mut blocks[starts[s] + k];
                for (a, (j, _)) in active.iter().enumerate() {
                    slopes[a].push(score[a]);
                    fisher[a] += matrix[(a, a)];
                    block.score[*j] += weights[kind] * score[a];
                    for (b, (l, _)) in active.iter().enumerate().take(a + 1) {
                        block.matrix[(*j, *l)] += weights[kind] * matrix[(a, b)];
                        if a != b {
                            block.matrix[(*l, *j)] += weights[kind] * matrix[(a, b)];
                        }
                    }
                }
            }
        }
        let ratios: Vec<f64> = active
            .iter()
            .enumerate()
            .filter(|(a, (j, _))| *j < NOISE[0] && fisher[*a] > 0.0)
            .map(|(a, _)| {
                let middle = mean(&slopes[a]);
                slopes[a].iter().map(|slope| (slope - middle).powi(2)).sum::<f64>() / fisher[a]
            })
            .collect();
        memory[kind] = median(&ratios).max(1.0);
    }
    (blocks, memory)
}

type Moved = Option<[Option<Innovations>; KINDS]>;

/// Innovations with each parameter moved by a difference, on two threads.
fn moved(balances: &Balances<'_>, values: &DVector<f64>, now: &State, units: &[f64], fixed: &[usize]) -> Vec<Moved> {
    let one = |j: usize| -> Moved {
        if fixed.contains(&j) {
            return None;
        }
        let mut there = values.clone();
        there[j] += DIFFERENCE * units[j];
        let driven = (j <= VOLTAGE_POWER || j == JUMP).then(|| balances.thrusts(&there));
        let thrusts = driven.as_ref().unwrap_or(&now.thrusts);
        let full = if j <= LIFT || j == JUMP { balances.full(&there, thrusts) } else { now.full.clone() };
        Some(std::array::from_fn(|kind| {
            depends(kind, j).then(|| balances.innovations(kind, &there, thrusts, &full)).flatten()
        }))
    };
    let mut all: Vec<Moved> = (0..SHARED).map(|_| None).collect();
    std::thread::scope(|scope| {
        let mut odd = Vec::new();
        let mut even = Vec::new();
        for (j, place) in all.iter_mut().enumerate() {
            if j % 2 == 0 { even.push((j, place)) } else { odd.push((j, place)) }
        }
        scope.spawn(move || odd.into_iter().for_each(|(j, place)| *place = one(j)));
        even.into_iter().for_each(|(j, place)| *place = one(j));
    });
    all
}

fn total(blocks: &[Block]) -> (DMatrix<f64>, DVector<f64>) {
    blocks.iter().fold((DMatrix::zeros(SHARED, SHARED), DVector::zeros(SHARED)), |(matrix, slope), block| {
        (matrix + &block.matrix, slope + &block.score)
    })
}

impl Refined {
    /// Estimates again, from blocks that are drawn and priors whose centres are: one a draw.
    pub(super) fn drawn(&self, fixed: &[usize], dice: &mut Dice, weights: &[f64]) -> DVector<f64> {
        let believed = Believed { values: &self.values, priors: &self.priors, units: &self.units, fixed };
        let moved = believed.drawn(&self.blocks, weights, dice);
        let full = &self.full_slopes * &moved;
        DVector::from_fn(self.values.len(), |j, _| {
            self.values[j] + if j < SHARED { moved[j] * self.units[j] } else { full[j - SHARED] }
        })
    }
}
