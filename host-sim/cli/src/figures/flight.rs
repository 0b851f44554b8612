//! One flight and its quantities over time: its path in space to the left, any quantities over time to the right.

use super::axis::{self, Range, Scale};
use super::panels::Panel;
use super::render::width_em;
use super::space::{self, Frame};
use super::style::{CAP_HEIGHT, Colour, LABEL, Stroke, TICK, TITLE};
use super::svg::{Anchor, Sheet};
use super::{FigureError, TrackingFigure, compose};

const HEIGHT: f64 = 820.0;
const SPACE: Frame = Frame { left: 10.0, top: 78.0, right: 600.0, bottom: 800.0 };
const PANELS: Frame = Frame { left: 680.0, top: 96.0, right: 1172.0, bottom: 762.0 };
/// Between panels, with a row for a legend, user units.
const GAP: f64 = 36.0;
/// Free at either end of an axis, as a share of its extent.
const PADDING: f64 = 0.06;

const LIMIT: Stroke = Stroke { colour: Colour::REFERENCE, width: 1.1, dash: Some([4.5, 5.5]) };

/// A line of a panel.
#[derive(Clone, Debug)]
pub struct Trace<'a> {
    /// For the panel's legend; traces that follow each other under one label share a row of it.
    pub label: &'a str,
    /// One value for each time of the flight.
    pub values: Vec<f64>,
    /// Drawn dashed and black: a limit, or what the others are held against.
    pub limit: bool,
}

/// Places on the axis that upright lines mark, dashed as a limit is.
#[derive(Clone, Debug)]
pub struct Marks<'a> {
    /// For the panels' legends.
    pub label: &'a str,
    /// Within the axis.
    pub places: Vec<f64>,
}

/// A panel.
#[derive(Clone, Debug)]
pub struct Quantity<'a> {
    /// Its name, with its unit.
    pub name: &'a str,
    /// The axis is at least this long.
    pub shortest: f64,
    /// Its lines, at most four that are no limits.
    pub traces: Vec<Trace<'a>>,
}

/// The contents of the figure.
#[derive(Clone, Debug)]
pub struct FlightFigure<'a> {
    /// The flight in space and its reference.
    pub tracking: TrackingFigure<'a>,
    /// Panels over the times of the reference, from top to bottom.
    pub quantities: Vec<Quantity<'a>>,
}

impl FlightFigure<'_> {
    /// As an SVG document of 1200 x 820 user units.
    ///
    /// # Errors
    /// [`FigureError`] if the data do not make a figure.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        let figure = &self.tracking;
        figure.validate()?;
        let mut sheet = Sheet::new([compose::WIDTH, HEIGHT], figure.title);
        let (lines, axes) = (compose::lines(figure), compose::axes(figure));
        let longest = axes.iter().map(|axis| axis.extent()).fold(0.0, f64::max);
        space::draw(&mut sheet, SPACE, &axes.map(|axis| axis.at_least(compose::FLATTEST * longest)), &lines);
        self.draw_panels(&mut sheet)?;
        let size = compose::fitting(figure.title, TITLE)?;
        sheet.text(figure.title, [0.5 * compose::WIDTH, 32.0], size, Anchor::Middle);
        compose::legend(&mut sheet, &lines)?;
        compose::notes(&mut sheet, figure, &axes, [0.5 * (SPACE.left + SPACE.right), HEIGHT - 8.0])?;
        Ok(sheet.into_document())
    }

    fn draw_panels(&self, sheet: &mut Sheet) -> Result<(), FigureError> {
        draw_quantities(sheet, PANELS, "time (s)", self.tracking.reference.time_s, None, &self.quantities)
    }
}

/// Draws panels over one axis, from top to bottom of a frame; there are at least two places on the axis, and they increase.
pub(super) fn draw_quantities(
    sheet: &mut Sheet,
    frame: Frame,
    axis_name: &str,
    places: &[f64],
    marks: Option<&Marks<'_>>,
    quantities: &[Quantity<'_>],
) -> Result<(), FigureError> {
    let range = Range { low: places[0], high: places[places.len() - 1] };
    let time_s = Scale { range, step: axis::step(range.extent(), 8.0) };
    let count = quantities.len();
    let height = (frame.bottom - frame.top - (count.max(1) - 1) as f64 * GAP) / count.max(1) as f64;
    for (i, quantity) in quantities.iter().enumerate() {
        let top = frame.top + i as f64 * (height + GAP);
        let values = Range::of(quantity.traces.iter().flat_map(|trace| trace.values.iter().copied()));
        let range = values.unwrap_or(Range { low: 0.0, high: 0.0 });
        let range = range.widened(PADDING * range.extent()).at_least(quantity.shortest);
        let value = Scale::clear_of_ticks(range, axis::step(range.extent(), 5.0));
        let panel = Panel { frame: Frame { top, bottom: top + height, ..frame }, time_s, value };
        panel.draw_grid(sheet, i + 1 == count);
        for (trace, stroke) in quantity.strokes() {
            panel.draw_samples(sheet, places.iter().zip(&trace.values).map(|(t, v)| [*t, *v]), stroke);
        }
        for place in marks.iter().flat_map(|marks| &marks.places) {
            panel.draw_samples(sheet, [value.range.low, value.range.high].map(|v| [*place, v]).into_iter(), LIMIT);
        }
        panel.draw_outline(sheet);
        quantity.legend(sheet, marks, frame.right, top - 9.0)?;
        sheet.text_upwards(quantity.name, [frame.left - 50.0, top + 0.5 * height], LABEL);
    }
    let middle = 0.5 * (frame.left + frame.right);
    sheet.text(axis_name, [middle, frame.bottom + 40.0], LABEL, Anchor::Middle);
    Ok(())
}

impl Quantity<'_> {
    /// Limits lowest.
    pub(super) fn strokes(&self) -> Vec<(&Trace<'_>, Stroke)> {
        let limits = self.traces.iter().filter(|trace| trace.limit).map(|trace| (trace, LIMIT));
        let others = self.traces.iter().filter(|trace| !trace.limit).zip(Colour::FLIGHTS);
        limits.chain(others.map(|(trace, colour)| (trace, Stroke::solid(colour, 1.5)))).collect()
    }

    /// Above the panel, from the right.
    pub(super) fn legend(
        &self,
        sheet: &mut Sheet,
        marks: Option<&Marks<'_>>,
        right: f64,
        row: f64,
    ) -> Result<(), FigureError> {
        const SAMPLE: f64 = 22.0;
        let marks = marks.map(|marks| (marks.label, LIMIT));
        let traces = self.strokes().into_iter().map(|(trace, stroke)| (trace.label, stroke));
        let mut rows: Vec<(&str, Stroke)> = marks.into_iter().chain(traces).collect();
        rows.dedup_by(|(next, _), (before, _)| next == before);
        let mut x = right;
        for (label, stroke) in rows.into_iter().rev() {
            sheet.text(label, [x, row], TICK, Anchor::End);
            x -= width_em(label)? * TICK + 6.0;
            let y = row - 0.5 * CAP_HEIGHT * TICK;
            sheet.line([x - SAMPLE, y], [x, y], stroke);
            x -= SAMPLE + 16.0;
        }
        Ok(())
    }
}
