//! Maximum a posteriori below the corner: thrust by command and voltage, the torque balance, lag and delay together, from a start near by.
//! For flights whose noise is not that of the filters' model, as on a real craft: see [`super::refine`].
//!
//! The residual of the balances is process noise: its power, and its correlation time, are estimated from the flights
//! themselves, and weigh the data against the priors. The balance of torques is taken relative to the torque that is
//! commanded, since a long lag would make both small.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, DVector};

use super::BLOCK_S;
use super::bootstrap::{Block, Dice};
use super::drag::Regression;
use super::lag_curve::{LagPoint, most_explained};
use super::layout::{ASYMMETRY, COMMAND_POWER, DAMPING, DELAY, DRAG_Z, INERTIA, LAG, LIFT, MOMENT, VOLTAGE_POWER};
use super::normal_equations::Believed;
use super::prior::{Base, Prior};
use super::problem::{Drive, Driven, Prepared};
use crate::filter::mean;
use crate::flight::RATE_HZ;

/// Parameters before those of each flight: the first of the layout.
const SHARED: usize = DAMPING[1] + 1;

/// Every third point: 33 Hz still holds all that lies below the corner.
const STRIDE: usize = 3;
/// Torque about x, about y, thrust.
const KINDS: usize = 3;

/// By how much less the balances weigh than their noise alone would let them: a power of command and voltage is not all that a
/// battery and a motor do.
const MISTRUST: [f64; KINDS] = [1.0, 1.0, 2.0];

/// The estimate with the residuals that intervals are made of.
pub(super) struct Refined {
    pub(super) values: DVector<f64>,
    pub(super) priors: Vec<Prior>,
    pub(super) units: Vec<f64>,
    /// In units of the parameters.
    pub(super) blocks: Vec<Block>,
}

/// Start values of the parameters and their priors.
pub(super) struct Start {
    pub(super) values: DVector<f64>,
    pub(super) priors: Vec<Prior>,
    /// Parameters that keep their values.
    pub(super) fixed: Vec<usize>,
}

/// From the best lag of the curve, the vehicle's own powers, and the thrust that carries the craft.
pub(super) fn start(
    sections: &[Prepared],
    base: &Base,
    flights: usize,
    curve: &[LagPoint],
    drags: &[Regression; 2],
    fixed: Vec<usize>,
) -> Start {
    let best = most_explained(curve);
    let lag_s = best.lag_s.min(0.12);
    let drive = Drive { rise_s: lag_s, fall_s: lag_s, delay_s: base.delay_s, jump_s: 0.0, powers: base.powers };
    let full: Vec<f64> = (0..flights)
        .map(|flight| {
            let (mut felt, mut given) = (0.0, 0.0);
            for one in sections.iter().filter(|one| one.flight == flight) {
                let driven = one.drive(&drive);
                felt += one.inner.clone().map(|i| one.force[2][i]).sum::<f64>();
                given += one.inner.clone().map(|i| driven.mean[i]).sum::<f64>();
            }
            (felt / given.max(1e-9)).max(1e-3)
        })
        .collect();
    let arm_n_m = 0.25 * base.mass_kg * mean(&full) * base.half_arm_m;
    let drag = 0.5 * (drags[0].values[0] + drags[1].values[0]).clamp(0.0, 2.0);
    let damping = base.damping_scale();
    let mut values = vec![lag_s.ln(), 0.0, base.delay_s, base.powers[0], base.powers[1], drag, 0.0];
    let mut priors = vec![
        Prior::gauss(base.lag_s.ln(), 0.7),
        Prior::gauss(0.0, 0.4),
        Prior::cauchy(base.delay_s, 1e-3),
        Prior::cauchy(base.powers[0], 0.05),
        Prior::gauss(base.powers[1], 0.3),
        Prior::gauss(drag, 0.3),
        Prior::gauss(0.0, 0.15),
    ];
    for axis in 0..2 {
        let inertia =
            (arm_n_m * best.inertia[axis]).clamp(0.2 * base.inertia_kg_m2[axis], 5.0 * base.inertia_kg_m2[axis]);
        values.extend([inertia.ln(), arm_n_m * best.moment[axis], 0.15 * damping]);
        priors.extend([
            Prior::gauss(base.inertia_kg_m2[axis].ln(), 0.7),
            Prior::gauss(0.0, 0.5 * base.half_arm_m * base.mass_kg),
            Prior::gauss(0.15 * damping, 0.35 * damping),
        ]);
    }
    let middle = mean(&full.iter().map(|full| full.ln()).collect::<Vec<_>>());
    for full in &full {
        values.push(full.ln());
        priors.push(Prior::gauss(middle, 1.0));
    }
    Start { values: DVector::from_vec(values), priors, fixed }
}

struct Residuals {
    /// By section; rows of one kind after those of another.
    rows: Vec<[Vec<f64>; KINDS]>,
}

struct Problem<'a> {
    sections: &'a [Prepared],
    base: &'a Base,
    /// Of the torque balance, with the mean taken off: angular acceleration, velocity across, rates, product of rates.
    regressors: Vec<[[Vec<f64>; 4]; 2]>,
}

fn drive_of(values: &DVector<f64>) -> Drive {
    let (lag_s, half) = (values[LAG].exp(), 0.5 * values[ASYMMETRY]);
    Drive {
        rise_s: lag_s * half.exp(),
        fall_s: lag_s * (-half).exp(),
        delay_s: values[DELAY],
        jump_s: 0.0,
        powers: [values[COMMAND_POWER], values[VOLTAGE_POWER]],
    }
}

impl<'a> Problem<'a> {
    fn new(sections: &'a [Prepared], base: &'a Base) -> Self {
        let thinned =
            |one: &Prepared, signal: &[f64]| -> Vec<f64> { one.centred(signal).into_iter().step_by(STRIDE).collect() };
        let regressors = sections
            .iter()
            .map(|one| {
                [0, 1].map(|axis| {
                    [&one.angular[axis], &one.velocity[1 - axis], &one.rates[axis], &one.products[axis]]
                        .map(|signal| thinned(one, signal))
                })
            })
            .collect();
        Self { sections, base, regressors }
    }

    fn driven(&self, values: &DVector<f64>) -> Vec<Driven> {
        let drive = drive_of(values);
        self.sections.iter().map(|one| one.drive(&drive)).collect()
    }

    fn residuals(&self, values: &DVector<f64>, driven: &[Driven]) -> Residuals {
        let mut rows: Vec<[Vec<f64>; KINDS]> = Vec::with_capacity(self.sections.len());
        let (mut square, mut count) = ([0.0; 2], 0);
        let inertia = [values[INERTIA[0]].exp(), values[INERTIA[1]].exp(), self.base.inertia_kg_m2[2]];
        for ((one, driven), regressors) in self.sections.iter().zip(driven).zip(&self.regressors) {
            let full = values[SHARED + one.flight].exp();
            let arm_n_m = 0.25 * self.base.mass_kg * full * self.base.half_arm_m;
            let torque = |axis: usize| -> (Vec<f64>, f64) {
                let mixture: Vec<f64> = one.centred(&driven.mixture[axis]).into_iter().step_by(STRIDE).collect();
                let [angular, across, rates, product] = &regressors[axis];
                let moment = if axis == 0 { -values[MOMENT[0]] } else { values[MOMENT[1]] };
                let gyroscopic = if axis == 0 { inertia[2] - inertia[1] } else { inertia[0] - inertia[2] };
                let rest = (0..mixture.len())
                    .map(|i| {
                        arm_n_m * mixture[i]
                            - inertia[axis] * angular[i]
                            - moment * across[i]
                            - values[DAMPING[axis]] * rates[i]
                            - gyroscopic * product[i]
                    })
                    .collect();
                (rest, mixture.iter().map(|m| (arm_n_m * m).powi(2)).sum())
            };
            let ((x, x_square), (y, y_square)) = (torque(0), torque(1));
            square[0] += x_square;
            square[1] += y_square;
            count += x.len();
            let thrust = one
                .inner
                .clone()
                .step_by(STRIDE)
                .map(|i| {
                    one.force[2][i] - full * driven.mean[i] + values[DRAG_Z] * one.velocity[2][i]
                        - values[LIFT] * one.across[i]
                })
                .collect();
            rows.push([x, y, thrust]);
        }
        let scale = square.map(|square| (square / count.max(1) as f64).sqrt().max(1e-300));
        for rows in &mut rows {
            for axis in 0..2 {
                rows[axis].iter_mut().for_each(|r| *r /= scale[axis]);
            }
        }
        Residuals { rows }
    }
}

/// Steps of a difference, and units of the parameters.
fn units(base: &Base, flights: usize) -> Vec<f64> {
    let damping = 0.1 * base.damping_scale();
    let mut units = vec![0.1, 0.1, 1e-3, 0.05, 0.05, 0.1, 0.02];
    units.extend([0.05, 3e-3 * base.half_arm_m.max(0.01), damping, 0.05, 3e-3 * base.half_arm_m.max(0.01), damping]);
    units.extend(std::iter::repeat_n(0.01, flights));
    units
}

/// From a start to where the posterior is highest.
pub(super) fn refine(sections: &[Prepared], base: &Base, start: Start) -> Refined {
    let problem = Problem::new(sections, base);
    let Start { mut values, priors, fixed } = start;
    let units = units(base, values.len() - SHARED);
    let mut driven = problem.driven(&values);
    let mut residuals = problem.residuals(&values, &driven);
    // How many points remember each other.
    let mut memory = [5.0; KINDS];
    let mut blocks = Vec::new();
    for round in 0..4 {
        for _ in 0..if round == 0 { 12 } else { 6 } {
            let variance = variances(&residuals);
            let weights: [f64; KINDS] = std::array::from_fn(|k| 1.0 / (variance[k] * memory[k]));
            let (matrix, slope) = total(&problem, &values, &driven, &residuals, &units, &fixed, &weights).0;
            let believed = Believed { values: &values, priors: &priors, units: &units, fixed: &fixed };
            let step = believed.step(&matrix, &slope, 0.0);
            let cost = |values: &DVector<f64>, residuals: &Residuals| cost(values, residuals, &priors, &memory);
            let before = cost(&values, &residuals);
            let mut scale = 1.0;
            let mut moved = false;
            while scale > 1e-3 {
                let trial = &values + &step * scale;
                let trial_driven = problem.driven(&trial);
                let trial_residuals = problem.residuals(&trial, &trial_driven);
                if cost(&trial, &trial_residuals) < before {
                    moved = before - cost(&trial, &trial_residuals) > 1e-3;
                    (values, driven, residuals) = (trial, trial_driven, trial_residuals);
                    break;
                }
                scale *= 0.4;
            }
            if !moved {
                break;
            }
        }
        let variance = variances(&residuals);
        let weights: [f64; KINDS] = std::array::from_fn(|k| 1.0 / variance[k]);
        let (_, by_kind) = total(&problem, &values, &driven, &residuals, &units, &fixed, &weights);
        memory = std::array::from_fn(|k| MISTRUST[k] * remembered(&by_kind[k]));
        blocks = merged(by_kind, &memory);
    }
    Refined { values, priors, units, blocks }
}

fn variances(residuals: &Residuals) -> [f64; KINDS] {
    std::array::from_fn(|k| {
        let (sum, count) = residuals.rows.iter().fold((0.0, 0), |(sum, count), rows| {
            (sum + rows[k].iter().map(|r| r * r).sum::<f64>(), count + rows[k].len())
        });
        (sum / f64::from(count.max(1) as u32)).max(1e-12)
    })
}

/// Minus the logarithm of the posterior, at the powers of the noises that fit best.
fn cost(values: &DVector<f64>, residuals: &Residuals, priors: &[Prior], memory: &[f64; KINDS]) -> f64 {
    let variance = variances(residuals);
    let count: usize = residuals.rows.iter().map(|rows| rows[0].len()).sum();
    let data: f64 = (0..KINDS).map(|k| 0.5 * count as f64 / memory[k] * variance[k].ln()).sum();
    data + priors.iter().zip(values.iter()).map(|(prior, value)| prior.cost(*value)).sum::<f64>()
}

type Normal = (DMatrix<f64>, DVector<f64>);

/// Normal equations in units of the parameters, of all, and by kind and block.
fn total(
    problem: &Problem<'_>,
    values: &DVector<f64>,
    driven: &[Driven],
    residuals: &Residuals,
    units: &[f64],
    fixed: &[usize],
    weights: &[f64; KINDS],
) -> (Normal, [Vec<Block>; KINDS]) {
    let count = values.len();
    let changed: Vec<Option<Residuals>> = (0..count)
        .map(|j| {
            if fixed.contains(&j) {
                return None;
            }
            let mut there = values.clone();
            there[j] += 0.02 * units[j];
            let redriven = (j <= VOLTAGE_POWER).then(|| problem.driven(&there));
            Some(problem.residuals(&there, redriven.as_deref().unwrap_or(driven)))
        })
        .collect();
    let (mut matrix, mut slope) = (DMatrix::zeros(count, count), DVector::zeros(count));
    let mut by_kind: [Vec<Block>; KINDS] = std::array::from_fn(|_| Vec::new());
    let span = ((BLOCK_S * RATE_HZ) as usize / STRIDE).max(1);
    for (s, one) in problem.sections.iter().enumerate() {
        for k in 0..KINDS {
            let rows = &residuals.rows[s][k];
            let active: Vec<usize> =
                (0..count).filter(|j| changed[*j].as_ref().is_some_and(|there| there.rows[s][k] != *rows)).collect();
            let mut from = 0;
            while from < rows.len() {
                // The last block takes a rest that is too short for one of its own.
                let to = if from + 2 * span > rows.len() { rows.len() } else { from + span };
                let mut own =
                    Block { flight: one.flight, matrix: DMatrix::zeros(count, count), score: DVector::zeros(count) };
                let mut line = vec![0.0; active.len()];
                for (i, row) in rows.iter().enumerate().take(to).skip(from) {
                    for (line, j) in line.iter_mut().zip(&active) {
                        *line = changed[*j].as_ref().map_or(0.0, |there| (there.rows[s][k][i] - row) / 0.02);
                    }
                    for (a, j) in active.iter().enumerate() {
                        own.score[*j] -= weights[k] * line[a] * row;
                        for (b, l) in active.iter().enumerate().take(a + 1) {
                            own.matrix[(*j, *l)] += weights[k] * line[a] * line[b];
                        }
                    }
                }
                own.matrix.fill_upper_triangle_with_lower_triangle();
                matrix += &own.matrix;
                slope += &own.score;
                by_kind[k].push(own);
                from = to;
            }
        }
    }
    ((matrix, slope), by_kind)
}

/// How much more the blocks' slopes vary than they would if every point were news.
fn remembered(blocks: &[Block]) -> f64 {
    let count = blocks.first().map_or(0, |block| block.score.len());
    let mut ratios = Vec::new();
    for j in 0..count {
        let matrix: f64 = blocks.iter().map(|block| block.matrix[(j, j)]).sum();
        let mean = blocks.iter().map(|block| block.score[j]).sum::<f64>() / blocks.len().max(1) as f64;
        let varies: f64 = blocks.iter().map(|block| (block.score[j] - mean).powi(2)).sum();
        if matrix > 0.0 {
            ratios.push(varies / matrix);
        }
    }
    mean(&ratios).max(1.5)
}

fn merged(by_kind: [Vec<Block>; KINDS], memory: &[f64; KINDS]) -> Vec<Block> {
    let mut merged: Vec<Block> = Vec::new();
    for (k, blocks) in by_kind.into_iter().enumerate() {
        for (b, mut block) in blocks.into_iter().enumerate() {
            block.matrix /= memory[k];
            block.score /= memory[k];
            match merged.get_mut(b) {
                Some(sum) if k > 0 => {
                    sum.matrix += &block.matrix;
                    sum.score += &block.score;
                }
                _ => merged.push(block),
            }
        }
    }
    merged
}

impl Refined {
    /// Estimates again, from blocks that are drawn and priors whose centres are: one a draw.
    pub(super) fn drawn(&self, fixed: &[usize], dice: &mut Dice, weights: &[f64]) -> DVector<f64> {
        let believed = Believed { values: &self.values, priors: &self.priors, units: &self.units, fixed };
        let mut moved = believed.drawn(&self.blocks, weights, dice);
        let count = moved.len();
        // The thrust of a flight that was not drawn goes with that of those that were.
        let flights =
            self.blocks.iter().zip(weights).filter(|(_, weight)| **weight > 0.0).map(|(block, _)| block.flight);
        let seen: BTreeSet<usize> = flights.collect();
        let middle = seen.iter().map(|flight| moved[SHARED + flight]).sum::<f64>() / seen.len().max(1) as f64;
        for flight in (0..count - SHARED).filter(|flight| !seen.contains(flight)) {
            moved[SHARED + flight] = middle;
        }
        DVector::from_fn(count, |j, _| self.values[j] + moved[j] * self.units[j])
    }
}
