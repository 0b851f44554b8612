//! The loop with the gain of each knot, frozen: the gains as flown in; the worst margins and limits of the knots out.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use nalgebra::{DMatrix, SMatrix};
use num_complex::Complex64;

use crate::analysis::eigenvalues;
use crate::certify::certificate::WORSE;
use crate::certify::limits::{self, Disturbance};
use crate::certify::linear_loop::LinearLoop;
use crate::certify::margins::{Disk, sampled_grid};
use crate::certify::sampled_loop::SampledLoop;
use crate::certify::structured::{quick_upper_bound, spectral_radius};
use crate::certify::sweep::refined_peak;
use crate::certify::{
    AllChannels, CertifyError, ChannelMargins, Controller, DiskMargin, LagModel, LoopMargins, Plant, StabilityLimit,
    Timing,
};
use crate::design::along::{GainsAlong, error_dynamics};
use crate::model::flat::ReferencePoint;

/// Body rates and thrust.
const CHANNELS: usize = 4;
/// Knots whose peak on the grid comes this close to the highest are refined, too.
const CONTENDER: f64 = 0.95;
/// At how many even parts of a limit a loop is tried.
const PARTS: u32 = 4;
/// Bisections of the part in which a loop becomes unstable.
const BISECTIONS: i32 = 30;

/// The loop at a knot.
pub(super) struct Frozen {
    given: LinearLoop,
    timing: Timing,
    names: Vec<String>,
    pub(super) poles: Vec<Complex64>,
    pub(super) spectral_radius: f64,
}

/// Calls a function for each of `count` indices on every processor; the results in their order.
fn each<T: Send>(count: usize, function: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return done;
            }
            done.push((index, function(index)));
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from).min(count);
    let mut all = thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let mut all = work();
        for other in others {
            // A panic of another thread goes on in this one.
            all.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        all
    });
    all.sort_by_key(|(index, _)| *index);
    all.into_iter().map(|(_, result)| result).collect()
}

/// The loops at all knots, each stable.
pub(super) fn knots(
    reference: &impl Fn(f64) -> ReferencePoint,
    designed: &GainsAlong,
    flown: &[SMatrix<f64, 4, 9>],
) -> Result<Vec<Frozen>, CertifyError> {
    let timing = Timing { period_s: designed.period_s, delay_samples: 0 };
    let at_knot = |(knot, gain): (usize, &SMatrix<f64, 4, 9>)| {
        let time_s = knot as f64 * designed.spacing_s;
        // The last knot's gain is flown behind it, at rest.
        let looked_at_s = if knot + 1 == flown.len() { time_s + designed.spacing_s } else { time_s };
        let (a, b) = error_dynamics(&reference(looked_at_s));
        let plant = Plant { a, b, ..Plant::equilibrium() };
        let controller = Controller::memoryless(DMatrix::from_column_slice(4, 9, gain.as_slice()));
        plant.require_fitting(&controller)?;
        let given = LinearLoop::new(&plant, &controller);
        let poles = eigenvalues(&SampledLoop::in_f64(&given, &timing, 0.0, |_| false)?.closed_loop())?;
        let spectral_radius = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
        // Written so that NaN is refused.
        if spectral_radius < 1.0 {
            Ok(Frozen { given, timing, names: plant.input_names().to_vec(), poles, spectral_radius })
        } else {
            Err(CertifyError::UnstableAtKnot { knot, time_s, spectral_radius })
        }
    };
    flown.iter().enumerate().map(at_knot).collect()
}

/// The function that is swept over frequency.
#[derive(Clone, Copy)]
enum Measure {
    /// `|S_ii - 1/2|`.
    Balanced(usize),
    /// `|S_ii|`.
    Sensitivity(usize),
    /// A bound of `mu(S - I/2)` from above.
    All,
}

impl Measure {
    fn every() -> impl Iterator<Item = Self> {
        (0..CHANNELS).map(Self::Balanced).chain((0..CHANNELS).map(Self::Sensitivity)).chain([Self::All])
    }

    fn of(self, s: &DMatrix<Complex64>) -> Option<f64> {
        match self {
            Self::Balanced(i) => Some((s[(i, i)] - 0.5).norm()),
            Self::Sensitivity(i) => Some(s[(i, i)].norm()),
            Self::All => quick_upper_bound(&half(s)),
        }
    }
}

/// `S - I/2`.
fn half(s: &DMatrix<Complex64>) -> DMatrix<Complex64> {
    let mut half = s.clone();
    for i in 0..s.nrows() {
        half[(i, i)] -= 0.5;
    }
    half
}

/// A knot's sensitivity, and every measure of it at the points of a grid.
struct Swept {
    held: SampledLoop,
    points_rad_s: Vec<f64>,
    measures: Vec<Vec<f64>>,
}

/// The least margins of all knots, and the knot with the least of all channels at once.
pub(super) fn margins(knots: &[Frozen]) -> Result<(LoopMargins, usize), CertifyError> {
    let sweep = |index: usize| -> Result<Swept, CertifyError> {
        let knot = &knots[index];
        let held = SampledLoop::in_f64(&knot.given, &knot.timing, 0.0, |_| false)?;
        let points_rad_s = sampled_grid(&knot.poles, knot.timing.period_s);
        let mut measures = vec![Vec::new(); 2 * CHANNELS + 1];
        for point in &points_rad_s {
            let s = held.sensitivity(point * knot.timing.period_s);
            for (values, measure) in measures.iter_mut().zip(Measure::every()) {
                values.push(s.as_ref().and_then(|s| measure.of(s)).unwrap_or(f64::INFINITY));
            }
        }
        Ok(Swept { held, points_rad_s, measures })
    };
    let swept = each(knots.len(), sweep).into_iter().collect::<Result<Vec<_>, _>>()?;
    let timing = knots.first().map_or(Timing { period_s: 1.0, delay_samples: 0 }, |knot| knot.timing);
    let measures: Vec<Measure> = Measure::every().collect();
    // Height, frequency, knot.
    let peaks = each(measures.len(), |index| {
        let measure = measures[index];
        let highest = |knot: &Swept| knot.measures[index].iter().copied().fold(0.0, f64::max);
        let contender = CONTENDER * swept.iter().map(highest).fold(0.0, f64::max);
        let mut worst = (0.0, 0.0, 0);
        for (number, knot) in swept.iter().enumerate().filter(|(_, knot)| highest(knot) >= contender) {
            let at = |frequency: f64| measure.of(&knot.held.sensitivity(frequency * timing.period_s)?);
            // A peak that is NaN is as bad as it gets.
            let (height, frequency) =
                refined_peak(&knot.points_rad_s, &knot.measures[index], at).unwrap_or((f64::INFINITY, 0.0));
            if height > worst.0 * WORSE {
                worst = (height, frequency, number);
            }
        }
        worst
    });
    let names = knots.first().map(|knot| knot.names.clone()).unwrap_or_default();
    let disk = |disk: Disk, index: usize| DiskMargin::new(disk, peaks[index].0, peaks[index].1);
    let all = peaks[2 * CHANNELS];
    let radius = swept
        .get(all.2)
        .and_then(|knot| spectral_radius(&half(&knot.held.sensitivity(all.1 * timing.period_s)?)))
        .unwrap_or(0.0);
    // No mu is below the spectral radius, nor below any of the diagonal's entries.
    let at_least = peaks.iter().take(CHANNELS).map(|peak| peak.0).fold(radius, f64::max);
    let margins = LoopMargins {
        each: names
            .into_iter()
            .enumerate()
            .map(|(i, channel)| ChannelMargins {
                channel,
                balanced: disk(Disk::Balanced, i),
                sensitivity: disk(Disk::Sensitivity, CHANNELS + i),
            })
            .collect(),
        all: AllChannels { balanced: disk(Disk::Balanced, 2 * CHANNELS), alpha_at_most: 1.0 / at_least },
    };
    Ok((margins, all.2))
}

/// The least limits of all knots: of delay, and of lag by each model. They start from those of the hover behind the last
/// knot, which decouples into chains and is searched in small steps.
pub(super) fn limits(
    knots: &[Frozen],
    last: &Frozen,
    models: [Option<LagModel>; 2],
) -> Result<[Vec<StabilityLimit>; 3], CertifyError> {
    let disturbances = [Some(Disturbance::Delay), models[0].map(Disturbance::Lag), models[1].map(Disturbance::Lag)];
    let of_hover = each(disturbances.len(), |index| {
        disturbances[index].map_or(Ok(Vec::new()), |disturbance| {
            limits::limits(&last.given.independent(), &last.timing, &last.names, disturbance)
        })
    });
    let of_hover = of_hover.into_iter().collect::<Result<Vec<_>, _>>()?;
    // One limit a channel, then all of them at once.
    let sets = CHANNELS + 1;
    let found = each(disturbances.len() * sets, |index| {
        let (kind, set) = (index / sets, index % sets);
        let Some((disturbance, limit)) = disturbances[kind].zip(of_hover[kind].get(set)) else { return Ok(None) };
        let chosen = |channel: usize| set == CHANNELS || set == channel;
        weakest(knots, disturbance, &chosen, limit.clone()).map(Some)
    });
    let mut limits = [Vec::new(), Vec::new(), Vec::new()];
    for (index, limit) in found.into_iter().enumerate() {
        limits[index / sets].extend(limit?);
    }
    Ok(limits)
}

/// Lowers a limit to that of the weakest knot.
fn weakest(
    knots: &[Frozen],
    disturbance: Disturbance,
    chosen: &impl Fn(usize) -> bool,
    mut limit: StabilityLimit,
) -> Result<StabilityLimit, CertifyError> {
    for knot in knots {
        let part_s = limit.stable_to_s / f64::from(PARTS);
        for part in 1..=PARTS {
            let end_s = part_s * f64::from(part);
            if is_stable(knot, disturbance, chosen, end_s)? {
                continue;
            }
            let (mut low_s, mut high_s) = (end_s - part_s, end_s);
            for _ in 0..BISECTIONS {
                let middle_s = 0.5 * (low_s + high_s);
                if is_stable(knot, disturbance, chosen, middle_s)? { low_s = middle_s } else { high_s = middle_s }
            }
            limit.stable_to_s = low_s;
            limit.resolution_s = Some(part_s * f64::from(-BISECTIONS).exp2());
            break;
        }
    }
    Ok(limit)
}

fn is_stable(
    knot: &Frozen,
    disturbance: Disturbance,
    chosen: &impl Fn(usize) -> bool,
    duration_s: f64,
) -> Result<bool, CertifyError> {
    let held = match disturbance {
        Disturbance::Delay => SampledLoop::in_f64(&knot.given, &knot.timing, duration_s, chosen)?,
        // Without a lag there is no actuator, and the knot is stable.
        Disturbance::Lag(_) if duration_s == 0.0 => return Ok(true),
        Disturbance::Lag(model) => {
            let lagging = knot.given.behind_actuators(duration_s, model, chosen);
            SampledLoop::in_f64(&lagging, &knot.timing, 0.0, |_| false)?
        }
    };
    Ok(eigenvalues(&held.closed_loop())?.iter().all(|pole| pole.norm() < 1.0))
}
