//! Shares of the likelihood's normal equations: figures in; Fisher's matrix and the slope by blocks of time out.

use nalgebra::{DMatrix, DVector, Matrix2};

use super::BLOCK_S;
use super::bootstrap::Block;
use super::innovations::{Balances, Innovations, KINDS};
use super::layout::{
    DAMPING, DRAG, FORCE_SHIFT, INERTIA, JUMP, LEVER, LIFT, MOMENT, NOISE, NOISE_COUNT, NOISE_Z, POSE_SHIFT, SHARED,
    VOLTAGE_POWER,
};
use super::problem::Thrusts;
use crate::filter::{mean, median};
use crate::flight::RATE_HZ;

/// Share of a parameter's unit by which it is moved for a difference.
pub(super) const DIFFERENCE: f64 = 0.02;

/// Innovations of all balances at some values.
pub(super) struct State {
    thrusts: Vec<Thrusts>,
    pub(super) full: Vec<f64>,
    pub(super) kinds: Vec<Innovations>,
}

/// None where no filter settles.
pub(super) fn state(balances: &Balances<'_>, values: &DVector<f64>) -> Option<State> {
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

/// Shares of normal equations in units of the parameters: Fisher's matrix and the slope of the likelihood, by stretches of time; and by
/// how much more the slopes of each balance vary from stretch to stretch than Fisher's matrix has it.
pub(super) fn blocks(
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
        let changes = active.iter().map(|(_, there)| (there.covariance - here.covariance) / DIFFERENCE);
        let whitened = Whitened::of(whiten, changes);
        let (mut slopes, mut fisher) = (vec![Vec::new(); active.len()], vec![0.0; active.len()]);
        for (s, rows) in here.sections.iter().enumerate() {
            let count = (rows.len() / span).max(1);
            for k in 0..count {
                // The last one takes the rest.
                let part = k * span..if k + 1 == count { rows.len() } else { (k + 1) * span };
                let moved: Vec<&[[f64; 2]]> =
                    active.iter().map(|(_, there)| &there.sections[s][part.clone()]).collect();
                let (matrix, score) = whitened.share(&rows[part], &moved);
                let block = &mut blocks[starts[s] + k];
                for (a, (j, _)) in active.iter().enumerate() {
                    slopes[a].push(score[a]);
                    fisher[a] += matrix[(a, a)];
                    block.score[*j] += weights[kind] * score[a];
                    for (b, (l, _)) in active.iter().enumerate() {
                        block.matrix[(*j, *l)] += weights[kind] * matrix[(a, b)];
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

/// Of one balance: the root of the innovations' inverse covariance, and how their covariance, white, goes with each parameter.
struct Whitened {
    root: Matrix2<f64>,
    spread: Vec<Matrix2<f64>>,
    /// Fisher's information of one point by the covariance alone.
    of_spread: DMatrix<f64>,
}

impl Whitened {
    fn of(root: Matrix2<f64>, changes: impl Iterator<Item = Matrix2<f64>>) -> Self {
        let spread: Vec<Matrix2<f64>> = changes.map(|change| root * change * root.transpose()).collect();
        let of_spread = DMatrix::from_fn(spread.len(), spread.len(), |a, b| 0.5 * (spread[a] * spread[b]).trace());
        Self { root, spread, of_spread }
    }

    /// Lower triangular.
    fn white(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        [self.root[(0, 0)] * a, self.root[(1, 0)] * a + self.root[(1, 1)] * b]
    }

    /// Fisher's matrix and the likelihood's slope of a block: its innovations, and those with each parameter moved by a difference.
    fn share(&self, rows: &[[f64; 2]], moved: &[&[[f64; 2]]]) -> (DMatrix<f64>, Vec<f64>) {
        let errors: Vec<[f64; 2]> = rows.iter().map(|row| self.white(*row)).collect();
        let mut lines = DMatrix::<f64>::zeros(2 * rows.len(), moved.len());
        let mut score = Vec::with_capacity(moved.len());
        for ((mut column, moved), d) in lines.column_iter_mut().zip(moved).zip(&self.spread) {
            let mut slope = 0.0;
            for (i, ((there, row), e)) in moved.iter().zip(rows).zip(&errors).enumerate() {
                let line = self.white([(there[0] - row[0]) / DIFFERENCE, (there[1] - row[1]) / DIFFERENCE]);
                (column[2 * i], column[2 * i + 1]) = (line[0], line[1]);
                let squared = d[(0, 0)] * e[0] * e[0] + 2.0 * d[(0, 1)] * e[0] * e[1] + d[(1, 1)] * e[1] * e[1];
                slope += 0.5 * (squared - d.trace()) - line[0] * e[0] - line[1] * e[1];
            }
            score.push(slope);
        }
        let mut matrix = &self.of_spread * rows.len() as f64;
        for a in 0..moved.len() {
            for b in 0..=a {
                matrix[(a, b)] += lines.column(a).dot(&lines.column(b));
            }
        }
        matrix.fill_upper_triangle_with_lower_triangle();
        (matrix, score)
    }
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

/// Sums of the blocks' shares.
pub(super) fn total(blocks: &[Block]) -> (DMatrix<f64>, DVector<f64>) {
    blocks.iter().fold((DMatrix::zeros(SHARED, SHARED), DVector::zeros(SHARED)), |(matrix, slope), block| {
        (matrix + &block.matrix, slope + &block.score)
    })
}
