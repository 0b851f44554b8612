//! The loop of one knot in; its margins, and whether it is stable, out.

use super::{CHANNELS, Frozen, Measure, each, half};
use crate::analysis::eigenvalues;
use crate::certify::certificate::WORSE;
use crate::certify::limits::{self, Disturbance};
use crate::certify::margins::{Disk, sampled_grid};
use crate::certify::sampled_loop::SampledLoop;
use crate::certify::structured::spectral_radius;
use crate::certify::sweep::refined_peak;
use crate::certify::{
    AllChannels, CertifyError, ChannelMargins, DiskMargin, LagModel, LoopMargins, StabilityLimit, Timing,
};

/// Knots whose peak on the grid comes this close to the highest are refined, too.
const CONTENDER: f64 = 0.95;
/// At how many even parts of a limit a loop is tried.
const PARTS: u32 = 4;
/// Bisections of the part in which a loop becomes unstable.
const BISECTIONS: i32 = 30;

/// A knot's sensitivity, and every measure of it at the points of a grid.
struct Swept {
    held: SampledLoop,
    points_rad_s: Vec<f64>,
    measures: Vec<Vec<f64>>,
}

/// The least margins of all knots, and the knot with the least of all channels at once.
pub(in crate::certify::along) fn margins(knots: &[Frozen]) -> Result<(LoopMargins, usize), CertifyError> {
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
pub(in crate::certify::along) fn limits(
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
