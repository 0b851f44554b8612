//! The layout of a figure: checked data in, a document with title, legend, 3D view, panels and notes out.

use nalgebra::Vector3;

use super::axis::Range;
use super::render::width_em;
use super::space::Frame;
use super::style::{CAP_HEIGHT, Colour, LEGEND, Line, NOTE, Stroke, TITLE};
use super::svg::{Anchor, Sheet};
use super::{Curve, FigureError, LARGEST, TrackingFigure, panels, space};

pub(super) const WIDTH: f64 = 1200.0;
const HEIGHT: f64 = 560.0;
/// Free at the left and right of title, legend and notes.
const MARGIN: f64 = 24.0;

const SPACE: Frame = Frame { left: 10.0, top: 78.0, right: 600.0, bottom: 540.0 };
const PANELS: Frame = Frame { left: 680.0, top: 84.0, right: 1172.0, bottom: 490.0 };

/// Flights may widen an axis beyond the reference by this share of the reference's longest extent, at either end.
const STRAY_SHARE: f64 = 0.5;
/// Axes are at least this long, m: below, a figure would show rounding errors.
const SHORTEST_M: f64 = 0.1;
/// An edge of the 3D box is at least this share of its longest, so that a flat flight still has a box around it.
pub(super) const FLATTEST: f64 = 0.25;
/// Free at either end of an axis, as a share of its extent.
const PADDING: f64 = 0.06;

/// The figure as SVG; its data have been checked.
pub(super) fn document(figure: &TrackingFigure<'_>) -> Result<String, FigureError> {
    let mut sheet = Sheet::new([WIDTH, HEIGHT], figure.title);
    let lines = lines(figure);
    let axes = axes(figure);
    let longest = axes.iter().map(|axis| axis.extent()).fold(0.0, f64::max);
    space::draw(&mut sheet, SPACE, &axes.map(|axis| axis.at_least(FLATTEST * longest)), &lines);

    let time_s = &figure.reference.time_s;
    // Checked: there are at least two times, and they increase.
    let time_s = Range { low: time_s[0], high: time_s[time_s.len() - 1] };
    panels::draw(&mut sheet, PANELS, time_s, &axes, &lines);

    let title_size = fitting(figure.title, TITLE)?;
    sheet.text(figure.title, [0.5 * WIDTH, 32.0], title_size, Anchor::Middle);
    legend(&mut sheet, &lines)?;
    notes(&mut sheet, figure, &axes, [0.5 * WIDTH, 550.0])?;
    Ok(sheet.into_document())
}

/// What the axes do not show of the flights, in a line around a place.
pub(super) fn notes(
    sheet: &mut Sheet,
    figure: &TrackingFigure<'_>,
    axes: &[Range; 3],
    place: [f64; 2],
) -> Result<(), FigureError> {
    let notes: Vec<String> = figure.flights.iter().filter_map(|flight| note(flight, axes)).collect();
    if !notes.is_empty() {
        // An em space: SVG runs ordinary ones together.
        let text = notes.join("\u{2003}");
        sheet.text(&text, place, fitting(&text, NOTE)?, Anchor::Middle);
    }
    Ok(())
}

/// Curves in the order of drawing: flights from wide to narrow, then the reference on top, so that all can be seen
/// where they coincide.
pub(super) fn lines<'a>(figure: &TrackingFigure<'a>) -> Vec<Line<'a>> {
    const WIDTHS: [f64; 4] = [3.4, 1.9, 1.5, 1.2];
    let line = |curve: &Curve<'a>, stroke| Line {
        label: curve.label,
        time_s: curve.time_s,
        position_m: curve.position_m,
        stroke,
    };
    let mut lines: Vec<Line<'a>> = (figure.flights.iter().zip(Colour::FLIGHTS).zip(WIDTHS))
        .map(|((flight, colour), width)| line(flight, Stroke::solid(colour, width)))
        .collect();
    let dashed = Stroke { colour: Colour::REFERENCE, width: 1.1, dash: Some([4.5, 5.5]) };
    lines.push(line(&figure.reference, dashed));
    lines
}

/// How far from a reference that rests the axes reach at most, m.
const STRAY_FROM_REST_M: f64 = 1.0;

/// One range per coordinate, m: the reference, flights that come back to it, and the parts of the others near it.
pub(super) fn axes(figure: &TrackingFigure<'_>) -> [Range; 3] {
    let range = |curve: &Curve<'_>, i: usize| Range::of(curve.position_m.iter().map(|p: &Vector3<f64>| p[i]));
    let reference: [Range; 3] =
        std::array::from_fn(|i| range(&figure.reference, i).unwrap_or(Range { low: 0.0, high: 0.0 }));
    let longest = reference.iter().map(|axis| axis.extent()).fold(SHORTEST_M, f64::max);
    // A reference that rests has no size to measure a flight by.
    let stray_m = if longest > SHORTEST_M { STRAY_SHARE * longest } else { STRAY_FROM_REST_M };
    std::array::from_fn(|i| {
        let limit = reference[i].widened(stray_m);
        let axis = figure.flights.iter().fold(reference[i], |union, flight| {
            let Some(flown) = range(flight, i) else { return union };
            if comes_back(flight, &figure.reference, stray_m) {
                union.with(flown)
            } else {
                union.with(Range { low: flown.low.max(limit.low), high: flown.high.min(limit.high) })
            }
        });
        axis.widened(PADDING * axis.extent()).at_least(SHORTEST_M)
    })
}

/// Whether a flight is in reach all the way and near the reference at its end.
fn comes_back(flight: &Curve<'_>, reference: &Curve<'_>, near_m: f64) -> bool {
    let in_reach = |p: &Vector3<f64>| p.amax() <= LARGEST;
    let near = match (flight.position_m.last(), reference.position_m.last()) {
        (Some(end), Some(goal)) => (end - goal).amax() <= near_m,
        _ => false,
    };
    near && flight.time_s.last() >= reference.time_s.last() && flight.position_m.iter().all(in_reach)
}

/// Notes on a flight that the axes do not show.
fn note(flight: &Curve<'_>, axes: &[Range; 3]) -> Option<String> {
    let samples = || flight.time_s.iter().zip(flight.position_m);
    let outside = |p: &Vector3<f64>| p.iter().zip(axes).any(|(v, axis)| *v < axis.low || *v > axis.high);
    let left = samples().find(|(_, p)| outside(p));
    let broken = samples().find(|(_, p)| p.iter().any(|v| !v.is_finite()));
    match (left, broken) {
        (Some((t, _)), Some((u, _))) if t < u => {
            Some(format!("{} leaves the axes at {t:.2} s and is not a finite number from {u:.2} s.", flight.label))
        }
        (_, Some((t, _))) => Some(format!("{} is not a finite number at {t:.2} s.", flight.label)),
        (Some((t, _)), None) => Some(format!("{} leaves the axes at {t:.2} s.", flight.label)),
        (None, None) => None,
    }
}

/// By how much the letters of a viewer that lacks the figures' font may be wider: DejaVu Sans, Verdana.
const OTHER_FONT: f64 = 1.2;

/// `size`, or a smaller one that keeps the text on the sheet.
pub(super) fn fitting(content: &str, size: f64) -> Result<f64, FigureError> {
    Ok(size.min((WIDTH - 2.0 * MARGIN) / (OTHER_FONT * width_em(content)?)))
}

/// A row of samples with their labels, centred below the title; the reference first.
pub(super) fn legend(sheet: &mut Sheet, lines: &[Line<'_>]) -> Result<(), FigureError> {
    const SAMPLE: f64 = 36.0;
    const TO_LABEL: f64 = 8.0;
    const BETWEEN: f64 = 32.0;
    const ROW: f64 = 58.0;
    let order = || lines.last().into_iter().chain(&lines[..lines.len() - 1]);
    let mut widths_em = Vec::with_capacity(lines.len());
    for line in order() {
        widths_em.push(width_em(line.label)?);
    }
    let fixed = lines.len() as f64 * (SAMPLE + TO_LABEL) + (lines.len() - 1) as f64 * BETWEEN;
    let total_em: f64 = widths_em.iter().sum();
    let size = LEGEND.min((WIDTH - 2.0 * MARGIN - fixed) / total_em);
    let mut x = 0.5 * (WIDTH - fixed - size * total_em);
    for (line, width_em) in order().zip(widths_em) {
        let y = ROW - 0.5 * CAP_HEIGHT * size;
        sheet.line([x, y], [x + SAMPLE, y], line.stroke);
        sheet.text(line.label, [x + SAMPLE + TO_LABEL, ROW], size, Anchor::Start);
        x += SAMPLE + TO_LABEL + size * width_em + BETWEEN;
    }
    Ok(())
}
