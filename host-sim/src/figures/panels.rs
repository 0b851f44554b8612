//! The three panels beside the 3D view: curves and axes in, x, y and z over time out.

use super::axis::{self, Range};
use super::path;
use super::scene::{Anchor, Colour, Item, Scene, Stroke};
use super::space::Frame;
use super::style::{CURVE_TOLERANCE, LABEL, Line, TICK};
use super::text::CAP_HEIGHT;

/// Between panels, logical pixels.
const GAP: f64 = 18.0;

/// Draws three panels of equal height in `frame`, which holds the plots themselves; labels go to its left and below.
pub(super) fn draw(scene: &mut Scene, frame: Frame, time_s: Range, axes: &[Range; 3], curves: &[Line<'_>]) {
    let height = (frame.bottom - frame.top - 2.0 * GAP) / 3.0;
    for (i, range) in axes.iter().enumerate() {
        let top = frame.top + i as f64 * (height + GAP);
        let panel = Panel { frame: Frame { top, bottom: top + height, ..frame }, time_s, range: *range };
        panel.draw_grid(scene, i == 2);
        for curve in curves {
            panel.draw_curve(scene, curve, i);
        }
        panel.draw_outline(scene);
        scene.text_upwards(["x (m)", "y (m)", "z (m)"][i], [frame.left - 50.0, top + 0.5 * height], LABEL);
    }
    let middle = 0.5 * (frame.left + frame.right);
    scene.text("time (s)", [middle, frame.bottom + 40.0], LABEL, Anchor::Middle);
}

struct Panel {
    frame: Frame,
    time_s: Range,
    range: Range,
}

impl Panel {
    fn column(&self, time_s: f64) -> f64 {
        self.frame.left + self.time_s.share(time_s) * (self.frame.right - self.frame.left)
    }

    fn row(&self, value_m: f64) -> f64 {
        self.frame.bottom - self.range.share(value_m) * (self.frame.bottom - self.frame.top)
    }

    fn draw_grid(&self, scene: &mut Scene, with_time_labels: bool) {
        let (grid, tick) = (Stroke::solid(Colour::GRID, 0.8), Stroke::solid(Colour::FRAME, 1.0));
        let Frame { left, top, right, bottom } = self.frame;
        for (value, label) in axis::ticks(self.time_s, axis::step(self.time_s.extent(), 8.0)) {
            let x = self.column(value);
            scene.line([x, top], [x, bottom], grid);
            scene.line([x, bottom], [x, bottom + 5.0], tick);
            if with_time_labels {
                scene.text(label, [x, bottom + 10.0 + CAP_HEIGHT * TICK], TICK, Anchor::Middle);
            }
        }
        for (value, label) in axis::ticks(self.range, axis::step(self.range.extent(), 5.0)) {
            let y = self.row(value);
            scene.line([left, y], [right, y], grid);
            scene.line([left - 5.0, y], [left, y], tick);
            scene.text(label, [left - 9.0, y + 0.5 * CAP_HEIGHT * TICK], TICK, Anchor::End);
        }
    }

    fn draw_curve(&self, scene: &mut Scene, curve: &Line<'_>, coordinate: usize) {
        let samples = curve.time_s.iter().zip(curve.position_m).map(|(t, p)| [*t, p[coordinate]]);
        let (low, high) = ([self.time_s.low, self.range.low], [self.time_s.high, self.range.high]);
        for stretch in path::clipped(samples, low, high) {
            let points: Vec<[f64; 2]> = stretch.iter().map(|[t, v]| [self.column(*t), self.row(*v)]).collect();
            scene.items.push(Item::Curve { points: path::thinned(&points, CURVE_TOLERANCE), stroke: curve.stroke });
        }
    }

    fn draw_outline(&self, scene: &mut Scene) {
        let Frame { left, top, right, bottom } = self.frame;
        let frame = Stroke::solid(Colour::FRAME, 1.0);
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
        for (i, corner) in corners.into_iter().enumerate() {
            scene.line(corner, corners[(i + 1) % 4], frame);
        }
    }
}
