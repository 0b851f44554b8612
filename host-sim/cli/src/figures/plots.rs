//! Plots of quantities over time or frequency, two stacked to the left and one to the right, in the style of the others.

use super::axis::{self, Range, Scale};
use super::compose;
use super::flight::{Quantity, Trace};
use super::panels::Panel;
use super::space::Frame;
use super::style::{CAP_HEIGHT, LABEL, TICK, TITLE};
use super::svg::{Anchor, Sheet};
use super::{FigureError, LARGEST};

const HEIGHT: f64 = 600.0;
const LEFT: Frame = Frame { left: 86.0, top: 84.0, right: 580.0, bottom: 540.0 };
const RIGHT: Frame = Frame { left: 680.0, top: 84.0, right: 1172.0, bottom: 540.0 };
/// Between the two to the left, with a row for a legend, user units.
const GAP: f64 = 42.0;
/// Free at either end of an axis, as a share of its extent.
const PADDING: f64 = 0.06;

/// A plot: lines over one axis.
#[derive(Clone, Debug)]
pub struct Plot<'a> {
    /// The axis, with its unit.
    pub axis: &'a str,
    /// Whether it has a decade between ticks.
    pub decades: bool,
    /// Where the values are; increasing, and above zero on decades.
    pub at: &'a [f64],
    /// The values, of which each trace has one for each place.
    pub quantity: Quantity<'a>,
}

/// Three of them.
#[derive(Clone, Debug)]
pub struct PlotsFigure<'a> {
    /// Printed above.
    pub title: &'a str,
    /// To the left, from the top, over the axis of the second.
    pub stacked: [Plot<'a>; 2],
    /// To the right.
    pub beside: Plot<'a>,
}

impl PlotsFigure<'_> {
    /// As an SVG document of 1200 x 600 user units.
    ///
    /// # Errors
    /// [`FigureError`] if the data do not make a figure.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        let mut sheet = Sheet::new([compose::WIDTH, HEIGHT], self.title);
        let [upper, lower] = &self.stacked;
        let height = 0.5 * (LEFT.bottom - LEFT.top - GAP);
        upper.draw(&mut sheet, Frame { bottom: LEFT.top + height, ..LEFT }, false)?;
        lower.draw(&mut sheet, Frame { top: LEFT.bottom - height, ..LEFT }, true)?;
        self.beside.draw(&mut sheet, RIGHT, true)?;
        let size = compose::fitting(self.title, TITLE)?;
        sheet.text(self.title, [0.5 * compose::WIDTH, 32.0], size, Anchor::Middle);
        Ok(sheet.into_document())
    }
}

impl Plot<'_> {
    fn draw(&self, sheet: &mut Sheet, frame: Frame, with_axis: bool) -> Result<(), FigureError> {
        self.validate()?;
        let place = |at: f64| if self.decades { at.log10() } else { at };
        let (Some(first), Some(last)) = (self.at.first(), self.at.last()) else { return Ok(()) };
        let range = Range { low: place(*first), high: place(*last) };
        let along = Scale { range, step: if self.decades { 1.0 } else { axis::step(range.extent(), 8.0) } };
        let quantity = &self.quantity;
        let values = Range::of(quantity.traces.iter().flat_map(|trace| trace.values.iter().copied()));
        let range = values.unwrap_or(Range { low: 0.0, high: 0.0 });
        let range = range.widened(PADDING * range.extent()).at_least(quantity.shortest);
        let value = Scale::clear_of_ticks(range, axis::step(range.extent(), 6.0));
        let panel = Panel { frame, time_s: along, value };
        panel.draw_grid(sheet, with_axis && !self.decades);
        if with_axis && self.decades {
            for (decade, _) in along.ticks() {
                let at = [panel.column(decade), frame.bottom + 10.0 + CAP_HEIGHT * TICK];
                sheet.text(&format!("{}", 10_f64.powi(decade.round() as i32)), at, TICK, Anchor::Middle);
            }
        }
        for (Trace { values, .. }, stroke) in quantity.strokes() {
            panel.draw_samples(sheet, self.at.iter().zip(values).map(|(at, value)| [place(*at), *value]), stroke);
        }
        panel.draw_outline(sheet);
        quantity.legend(sheet, None, frame.right, frame.top - 9.0)?;
        sheet.text_upwards(quantity.name, [frame.left - 56.0, 0.5 * (frame.top + frame.bottom)], LABEL);
        if with_axis {
            let middle = 0.5 * (frame.left + frame.right);
            sheet.text(self.axis, [middle, frame.bottom + 40.0], LABEL, Anchor::Middle);
        }
        Ok(())
    }

    fn validate(&self) -> Result<(), FigureError> {
        let mut before = if self.decades { 0.0 } else { f64::NEG_INFINITY };
        for (index, &value) in self.at.iter().enumerate() {
            if !(value > before && value.abs() <= LARGEST) {
                return Err(FigureError::Time { label: self.axis.to_owned(), index, value });
            }
            before = value;
        }
        match self.quantity.traces.iter().find(|trace| trace.values.len() != self.at.len() || trace.values.len() < 2) {
            Some(trace) => Err(FigureError::Samples {
                label: trace.label.to_owned(),
                times: self.at.len(),
                positions: trace.values.len(),
            }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot<'a>(at: &'a [f64], values: Vec<f64>, decades: bool) -> Plot<'a> {
        let traces = vec![Trace { label: "one", values, limit: false }];
        Plot { axis: "frequency (rad/s)", decades, at, quantity: Quantity { name: "gain", shortest: 1.0, traces } }
    }

    #[test]
    fn decades_are_evenly_apart_and_labelled_by_their_values() {
        let at = [0.1, 1.0, 10.0, 100.0];
        let one = plot(&at, vec![1.0, 2.0, 3.0, 4.0], true);
        let figure =
            PlotsFigure { title: "t", stacked: [one.clone(), one.clone()], beside: plot(&at, vec![0.0; 4], false) };
        let svg = figure.to_svg().unwrap();
        for (label, x) in [("0.1", 86.0), ("1", 250.67), ("10", 415.33), ("100", 580.0)] {
            let tick = format!("<text x=\"{x}\" y=\"558.73\"");
            let found = svg.lines().find(|line| line.starts_with(&tick)).unwrap_or_else(|| panic!("{label}: {svg}"));
            assert!(found.ends_with(&format!(">{label}</text>")), "{found}");
        }
    }

    #[test]
    fn values_without_their_places_are_refused() {
        let short = plot(&[1.0, 2.0], vec![1.0], false);
        let refused = short.validate();
        assert!(matches!(refused, Err(FigureError::Samples { times: 2, positions: 1, .. })), "{refused:?}");
        let zero = plot(&[0.0, 2.0], vec![1.0, 2.0], true);
        assert!(matches!(zero.validate(), Err(FigureError::Time { index: 0, .. })), "no decade holds 0");
    }
}
