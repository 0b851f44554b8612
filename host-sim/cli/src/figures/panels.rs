//! The three panels beside the 3D view: curves and axes in, x, y and z over time out.

use super::axis::{self, Range, Scale};
use super::path;
use super::space::Frame;
use super::style::{CAP_HEIGHT, CURVE_TOLERANCE, Colour, LABEL, Line, Stroke, TICK};
use super::svg::{Anchor, Sheet};

/// Between panels, user units.
const GAP: f64 = 18.0;

/// Draws three panels of equal height in `frame`, which holds the plots themselves; labels go to its left and below.
pub(super) fn draw(sheet: &mut Sheet, frame: Frame, time_s: Range, axes: &[Range; 3], curves: &[Line<'_>]) {
    // From end to end of the reference: flights start and end with it.
    let time_s = Scale { range: time_s, step: axis::step(time_s.extent(), 8.0) };
    let height = (frame.bottom - frame.top - 2.0 * GAP) / 3.0;
    for (i, range) in axes.iter().enumerate() {
        let top = frame.top + i as f64 * (height + GAP);
        let value = Scale::clear_of_ticks(*range, axis::step(range.extent(), 5.0));
        let panel = Panel { frame: Frame { top, bottom: top + height, ..frame }, time_s, value };
        panel.draw_grid(sheet, i == 2);
        for curve in curves {
            panel.draw_curve(sheet, curve, i);
        }
        panel.draw_outline(sheet);
        sheet.text_upwards(["x (m)", "y (m)", "z (m)"][i], [frame.left - 50.0, top + 0.5 * height], LABEL);
    }
    let middle = 0.5 * (frame.left + frame.right);
    sheet.text("time (s)", [middle, frame.bottom + 40.0], LABEL, Anchor::Middle);
}

/// One plot over time.
pub(super) struct Panel {
    pub(super) frame: Frame,
    pub(super) time_s: Scale,
    pub(super) value: Scale,
}

impl Panel {
    pub(super) fn column(&self, time_s: f64) -> f64 {
        self.frame.left + self.time_s.range.share(time_s) * (self.frame.right - self.frame.left)
    }

    fn row(&self, value: f64) -> f64 {
        self.frame.bottom - self.value.range.share(value) * (self.frame.bottom - self.frame.top)
    }

    pub(super) fn draw_grid(&self, sheet: &mut Sheet, with_time_labels: bool) {
        let (grid, tick) = (Stroke::solid(Colour::GRID, 0.8), Stroke::solid(Colour::FRAME, 1.0));
        let Frame { left, top, right, bottom } = self.frame;
        for (value, label) in self.time_s.ticks() {
            let x = self.column(value);
            sheet.line([x, top], [x, bottom], grid);
            sheet.line([x, bottom], [x, bottom + 5.0], tick);
            if with_time_labels {
                sheet.text(&label, [x, bottom + 10.0 + CAP_HEIGHT * TICK], TICK, Anchor::Middle);
            }
        }
        for (value, label) in self.value.ticks() {
            let y = self.row(value);
            sheet.line([left, y], [right, y], grid);
            sheet.line([left - 5.0, y], [left, y], tick);
            sheet.text(&label, [left - 9.0, y + 0.5 * CAP_HEIGHT * TICK], TICK, Anchor::End);
        }
    }

    fn draw_curve(&self, sheet: &mut Sheet, curve: &Line<'_>, coordinate: usize) {
        self.draw_samples(
            sheet,
            curve.time_s.iter().zip(curve.position_m).map(|(t, p)| [*t, p[coordinate]]),
            curve.stroke,
        );
    }

    /// Draws a line through times and values.
    pub(super) fn draw_samples(&self, sheet: &mut Sheet, samples: impl Iterator<Item = [f64; 2]>, stroke: Stroke) {
        let (time_s, value) = (self.time_s.range, self.value.range);
        let (low, high) = ([time_s.low, value.low], [time_s.high, value.high]);
        for stretch in path::clipped(samples, low, high) {
            let points: Vec<[f64; 2]> = stretch.iter().map(|[t, v]| [self.column(*t), self.row(*v)]).collect();
            sheet.curve(&path::thinned(&points, CURVE_TOLERANCE), stroke);
        }
    }

    pub(super) fn draw_outline(&self, sheet: &mut Sheet) {
        let Frame { left, top, right, bottom } = self.frame;
        let frame = Stroke::solid(Colour::FRAME, 1.0);
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
        for (i, corner) in corners.into_iter().enumerate() {
            sheet.line(corner, corners[(i + 1) % 4], frame);
        }
    }
}
