//! The picture of a design: loop gain, sensitivity with its disk margin, and steps.

use std::path::Path;

use quatrack_simulation::gains::{Certified, CutLoop, LoopCurves};

use crate::cli::{Failure, output, picture};
use crate::figures::{Plot, PlotsFigure, Quantity, Trace};

/// Decibels below which a gain is not drawn.
const LEAST_DB: f64 = -60.0;

pub(super) fn draw(certified: &Certified, path: &Path, folder: &Path) -> Result<(), Failure> {
    let curves = LoopCurves::of(certified).map_err(|error| Failure::verdict(format!("{}: {error}", path.display())))?;
    output::create_dir(folder)?;
    let name = certified.design.name;
    let title = format!("{name} for {}: {}", certified.design.vehicle.name(), curves.conditions);
    let figure = figure(&title, &curves);
    picture::write_both(folder, name.as_str(), &figure.to_svg().map_err(Failure::verdict)?)
}

fn figure<'a>(title: &'a str, curves: &'a LoopCurves) -> PlotsFigure<'a> {
    let (at, times) = (&curves.frequencies_rad_s[..], &curves.times_s[..]);
    let level = |value: f64, places: &[f64]| vec![value; places.len()];
    let lines = |of: &dyn Fn(&CutLoop) -> Vec<f64>| -> Vec<Trace<'a>> {
        curves.loops.iter().map(|cut| Trace { label: &cut.name, values: of(cut), limit: false }).collect()
    };
    let limit = |label: &'a str, values: Vec<f64>| Trace { label, values, limit: true };
    let decibels = |gain: &f64| {
        let decibels = 20.0 * gain.log10();
        if decibels >= LEAST_DB { decibels } else { f64::NAN }
    };
    let alpha = curves.loops.iter().map(|cut| cut.alpha).fold(f64::INFINITY, f64::min);
    let mut gains = lines(&|cut| cut.gain.iter().map(decibels).collect());
    gains.push(limit("1", level(0.0, at)));
    let mut sensitivities = lines(&|cut| cut.from_half.clone());
    sensitivities.push(limit("one over the disk margin", level(1.0 / alpha, at)));
    let mut steps: Vec<Trace<'a>> =
        curves.steps.iter().map(|step| Trace { label: &step.name, values: step.way.clone(), limit: false }).collect();
    steps.push(limit("reference", level(1.0, times)));
    let frequency = "frequency (rad/s)";
    let plot = |axis, decades, at, name, traces| Plot {
        axis,
        decades,
        at,
        quantity: Quantity { name, shortest: 0.1, traces },
    };
    PlotsFigure {
        title,
        stacked: [
            plot(frequency, true, at, "loop gain (dB)", gains),
            plot(frequency, true, at, "|S - 1/2|", sensitivities),
        ],
        beside: plot("time (s)", false, times, "after a step of 1 m; yaw: 1 rad", steps),
    }
}
