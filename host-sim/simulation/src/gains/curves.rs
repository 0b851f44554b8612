//! The loops of a design as curves: loop gain and sensitivity by frequency, and the answer to a step.

use num_complex::Complex64;
use quatrack_design::certify::cascade::{
    CascadeChain, CascadeCraft, CascadeVariation, cascade_craft, in_identified_air,
};
use quatrack_design::certify::{CertifyError, LoopResponse};

use super::GainsError;
use super::certified::Certified;
use super::design::Problem;
use super::designed::Designed;
use super::kinds::Gains;

/// Frequencies a curve, from the lowest (rad/s) to the Nyquist frequency.
const POINTS: usize = 400;
const LOWEST_RAD_S: f64 = 0.1;
/// Curves that differ by less are one: axes that are alike would hide each other.
const SAME: f64 = 1e-6;
/// Duration of a step's curve, s.
const STEP_S: f64 = 4.0;
/// The accelerometer is looked at once in so many seconds.
const LOOK_S: f64 = 0.01;

/// A design in curves.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopCurves {
    /// The air and the motors of the loop, in words.
    pub conditions: &'static str,
    /// rad/s.
    pub frequencies_rad_s: Vec<f64>,
    /// Times of the steps' curves, s.
    pub times_s: Vec<f64>,
    /// Each cut at one command.
    pub loops: Vec<CutLoop>,
    /// x, y, z and yaw.
    pub steps: Vec<StepResponse>,
}

/// The loop cut at one command, the others closed.
#[derive(Debug, Clone, PartialEq)]
pub struct CutLoop {
    /// The command without its unit, or the chain that it drives; all of them where several have this curve.
    pub name: String,
    /// Size of the open loop's gain.
    pub gain: Vec<f64>,
    /// Distance of the sensitivity from one half: the disk margin is one over its peak.
    pub from_half: Vec<f64>,
    /// The disk margin.
    pub alpha: f64,
}

/// A step of 1 m, or of 1 rad.
#[derive(Debug, Clone, PartialEq)]
pub struct StepResponse {
    /// The axis, or all that have this curve.
    pub name: String,
    /// The way since the step, over the times.
    pub way: Vec<f64>,
}

impl LoopCurves {
    /// The curves of a design: of the cascade in the identified air, of any other in vacuum, behind no actuators but those that the
    /// design itself knows.
    ///
    /// # Errors
    /// [`GainsError::Certify`] where eigenvalues are not found.
    pub fn of(certified: &Certified) -> Result<Self, GainsError> {
        let design = &certified.design;
        let period_s = 1.0 / f64::from(design.rate.hz());
        let highest_rad_s = std::f64::consts::PI / period_s;
        let share = |k: usize| k as f64 / (POINTS - 1) as f64;
        let frequencies_rad_s: Vec<f64> =
            (0..POINTS).map(|k| LOWEST_RAD_S * (highest_rad_s / LOWEST_RAD_S).powf(share(k))).collect();
        let count = (STEP_S / period_s).round() as usize;
        let times_s = (0..count).map(|k| k as f64 * period_s).collect();
        if let (Problem::Cascade { motor_lag_s, air, .. }, Gains::Cascade(gains)) =
            (&design.problem, &certified.designed.gains)
        {
            let craft = cascade_craft(&design.vehicle, **gains, *motor_lag_s, air, period_s)?;
            let at = in_identified_air(&craft, air);
            let (loops, steps) = of_cascade(&craft, &at, &frequencies_rad_s, count)?;
            let conditions = "the loop in the identified air";
            return Ok(Self::merged(conditions, frequencies_rad_s, times_s, (loops, steps)));
        }
        let conditions = match &certified.designed.gains {
            Gains::Along(_) => "the hover behind the last knot, in vacuum",
            Gains::ActuatorAware(_) => "the loop in vacuum, with its motors",
            _ => "the loop in vacuum, its commands obeyed at once",
        };
        let (plant, controller, timing) = certified.designed.hover_loop(design);
        let response = LoopResponse::new(&plant, &controller, &timing)?;
        let sensitivities: Vec<_> =
            frequencies_rad_s.iter().map(|frequency| response.sensitivities(*frequency)).collect();
        let loops = plant.input_names().iter().enumerate().map(|(channel, name)| {
            let at = |of: &dyn Fn(Complex64) -> f64| -> Vec<f64> {
                sensitivities.iter().map(|found| found.as_ref().map_or(f64::NAN, |found| of(found[channel]))).collect()
            };
            let from_half = at(&|s| (s - 0.5).norm());
            let alpha = 1.0 / from_half.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
            CutLoop { name: without_unit(name).to_owned(), gain: at(&|s| (s.inv() - 1.0).norm()), from_half, alpha }
        });
        let loops = loops.collect();
        let (yaw, rad) = yaw_state(&certified.designed);
        let steps = [("x", 0, 1.0), ("y", 1, 1.0), ("z", 2, 1.0), ("yaw", yaw, rad)]
            .map(|(name, state, unit)| {
                let mut start = vec![0.0; state + 1];
                start[state] = -unit;
                let behind = response.from_state(&start, state, count);
                StepResponse { name: name.to_owned(), way: behind.iter().map(|value| 1.0 + value / unit).collect() }
            })
            .into();
        Ok(Self::merged(conditions, frequencies_rad_s, times_s, (loops, steps)))
    }

    /// With one curve in the place of several that are the same.
    fn merged(conditions: &'static str, frequencies_rad_s: Vec<f64>, times_s: Vec<f64>, curves: Curves) -> Self {
        let (mut loops, mut steps) = (Vec::<CutLoop>::new(), Vec::<StepResponse>::new());
        for cut in curves.0 {
            match loops.iter_mut().find(|held| same(&held.from_half, &cut.from_half) && same(&held.gain, &cut.gain)) {
                Some(held) => held.name += &format!(", {}", cut.name),
                None => loops.push(cut),
            }
        }
        for step in curves.1 {
            match steps.iter_mut().find(|held| same(&held.way, &step.way)) {
                Some(held) => held.name += &format!(", {}", step.name),
                None => steps.push(step),
            }
        }
        Self { conditions, frequencies_rad_s, times_s, loops, steps }
    }
}

/// The quantity of a command called after its unit, too: `p` of `p_rad_s`. A loop gain has none.
fn without_unit(name: &str) -> &str {
    name.split('_').next().unwrap_or(name)
}

/// Equal but for rounding, or no number on both sides.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME * a.abs().max(1.0) || (a.is_nan() && b.is_nan()))
}

/// Which state of the hover loop is the heading, and its size at 1 rad: an angle, or the quaternion's `q3`, half of it.
fn yaw_state(designed: &Designed) -> (usize, f64) {
    match designed.gains {
        Gains::ActuatorAware(_) => (8, 1.0),
        Gains::FlatOutput(_) => (9, 0.5),
        _ => (5, 0.5),
    }
}

type Curves = (Vec<CutLoop>, Vec<StepResponse>);

fn of_cascade(
    craft: &CascadeCraft,
    at: &CascadeVariation,
    frequencies_rad_s: &[f64],
    count: usize,
) -> Result<Curves, CertifyError> {
    let (mut loops, mut steps) = (Vec::new(), Vec::new());
    for (name, chain) in
        [("x", CascadeChain::X), ("y", CascadeChain::Y), ("z", CascadeChain::Z), ("yaw", CascadeChain::Yaw)]
    {
        let cut = chain.cut(craft, at)?;
        let sizes = |of: &dyn Fn(f64) -> Option<f64>| {
            frequencies_rad_s.iter().map(|frequency| of(*frequency).unwrap_or(f64::NAN)).collect()
        };
        loops.push(CutLoop {
            name: name.to_owned(),
            gain: sizes(&|frequency| Some(cut.gain(frequency)?.norm())),
            from_half: sizes(&|frequency| Some((cut.sensitivity(frequency)? - 0.5).norm())),
            alpha: chain.margins(craft, at)?.disk.alpha,
        });
        steps.push(StepResponse { name: name.to_owned(), way: stepped(chain, craft, at, count) });
    }
    Ok((loops, steps))
}

/// From 1 behind its reference, with its first estimates seen and nothing else remembered.
fn stepped(chain: CascadeChain, craft: &CascadeCraft, at: &CascadeVariation, steps: usize) -> Vec<f64> {
    let [without, with] = [false, true].map(|looks| chain.matrix(craft, at, looks));
    let every = (LOOK_S / craft.period_s).round().max(1.0) as usize;
    let mut x = nalgebra::DVector::zeros(with.nrows());
    x[0] = -1.0;
    // The position that the velocity is held to, behind the plant's states.
    match chain {
        CascadeChain::X | CascadeChain::Y => x[5] = -1.0,
        CascadeChain::Z => x[3] = -1.0,
        CascadeChain::Yaw => {}
    }
    (0..steps)
        .map(|step| {
            let way = 1.0 + x[0];
            x = if step.is_multiple_of(every) { &with } else { &without } * &x;
            way
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gains::Design;

    fn certified(name: &str) -> Certified {
        let folder = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../gains"));
        Design::from_file(&folder.join(name).with_extension("toml")).unwrap().certify().unwrap()
    }

    /// The certificate searches the peak, the curve has 400 points: it can only be larger, by its spacing of 2 % in frequency.
    #[test]
    fn the_disk_margins_are_those_of_the_certificate() {
        for name in ["lqr-e", "lyap-e", "lqr-f", "lqi-e", "sampled-lqr-e", "actuator-aware"] {
            let held = certified(name);
            let curves = LoopCurves::of(&held).unwrap();
            let margins = &held.certificate.sampled.margins.each;
            for found in margins {
                let cut = curves
                    .loops
                    .iter()
                    .find(|cut| cut.name.split(", ").any(|name| name == without_unit(&found.channel)));
                let more = cut.map_or(f64::NAN, |cut| cut.alpha) / found.balanced.alpha;
                assert!((1.0 - 1e-6..1.01).contains(&more), "{name}, {}: {more} times", found.channel);
            }
        }
    }

    #[test]
    fn every_step_starts_at_nothing_and_of_a_quick_law_ends_at_its_reference() {
        for name in ["lqr-e", "lqi-e", "actuator-aware"] {
            for step in LoopCurves::of(&certified(name)).unwrap().steps {
                let (first, last) = (step.way[0], step.way[step.way.len() - 1]);
                assert!(first.abs() < 1e-12 && (last - 1.0).abs() < 0.1, "{name}, {}: {first} to {last}", step.name);
            }
        }
    }
}
