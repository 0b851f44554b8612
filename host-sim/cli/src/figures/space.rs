//! The 3D view: curves and the box of their axes in, an orthographic picture of the box and the curves in it out.

use nalgebra::{Vector2, Vector3};

use super::axis::{self, Range, Scale};
use super::path;
use super::style::{CAP_HEIGHT, CURVE_TOLERANCE, Colour, LABEL, Line, Stroke, TICK};
use super::svg::{Anchor, Sheet};

/// Where the picture goes, user units.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

/// From the box's middle, the viewer is this far from +x towards -y, and this far up, degrees: x runs to the
/// right, y into the page, and the floor is seen from above.
const AZIMUTH_DEG: f64 = -58.0;
const ELEVATION_DEG: f64 = 26.0;

/// Room around the box for tick labels and axis names: left, top, right, bottom.
const ROOM: [f64; 4] = [62.0, 8.0, 30.0, 52.0];

/// An orthographic view at a scale.
struct View {
    right: Vector3<f64>,
    up: Vector3<f64>,
    middle_m: Vector3<f64>,
    at: Vector2<f64>,
    units_per_m: f64,
}

impl View {
    /// The largest view of the box that leaves room around it.
    fn fitting(axes: &[Range; 3], frame: Frame) -> Self {
        let (azimuth, elevation) = (AZIMUTH_DEG.to_radians(), ELEVATION_DEG.to_radians());
        let right = Vector3::new(-azimuth.sin(), azimuth.cos(), 0.0);
        let up = Vector3::new(-elevation.sin() * azimuth.cos(), -elevation.sin() * azimuth.sin(), elevation.cos());
        let extent = Vector3::from(axes.map(Range::extent));
        let width = frame.right - frame.left - ROOM[0] - ROOM[2];
        let height = frame.bottom - frame.top - ROOM[1] - ROOM[3];
        Self {
            units_per_m: (width / right.abs().dot(&extent)).min(height / up.abs().dot(&extent)),
            right,
            up,
            middle_m: Vector3::from(axes.map(|axis| 0.5 * (axis.low + axis.high))),
            at: Vector2::new(
                0.5 * (frame.left + ROOM[0] + frame.right - ROOM[2]),
                0.5 * (frame.top + ROOM[1] + frame.bottom - ROOM[3]),
            ),
        }
    }

    /// A direction on the page, user units per metre along it.
    fn direction(&self, v: &Vector3<f64>) -> Vector2<f64> {
        Vector2::new(self.right.dot(v), -self.up.dot(v)) * self.units_per_m
    }

    fn point(&self, p: &Vector3<f64>) -> [f64; 2] {
        (self.at + self.direction(&(p - self.middle_m))).into()
    }
}

/// Draws the box and the curves, the first curve lowest.
pub(super) fn draw(sheet: &mut Sheet, frame: Frame, axes: &[Range; 3], curves: &[Line<'_>]) {
    let longest = axes.iter().map(|axis| axis.extent()).fold(0.0, f64::max);
    // One step for all three axes: with equal scales, the grid's cells are squares.
    let step = axis::step(longest, 8.0);
    let scales = axes.map(|range| Scale::clear_of_ticks(range, step));
    let (axes, ticks) = (&scales.map(|scale| scale.range), &scales.map(Scale::ticks));
    let view = View::fitting(axes, frame);
    draw_panes(sheet, &view, axes, ticks);
    draw_scales(sheet, &view, axes, ticks);

    let (low, high) = (axes.map(|axis| axis.low), axes.map(|axis| axis.high));
    let mut add = |line: &Line<'_>, stroke: Stroke, flat: bool| {
        for stretch in path::clipped(line.position_m.iter().map(|p| (*p).into()), low, high) {
            let points: Vec<[f64; 2]> = stretch
                .iter()
                .map(|p| view.point(&Vector3::new(p[0], p[1], if flat { low[2] } else { p[2] })))
                .collect();
            sheet.curve(&path::thinned(&points, CURVE_TOLERANCE), stroke);
        }
    };
    if let Some(reference) = curves.last() {
        add(reference, Stroke::solid(Colour::SHADOW, 1.3), true);
    }
    for curve in curves {
        add(curve, curve.stroke, false);
    }
}

/// Low x, high y and the floor are the sides away from the viewer.
fn back(axes: &[Range; 3]) -> [f64; 3] {
    [axes[0].low, axes[1].high, axes[2].low]
}

/// A point of the box: `along` on axis `i`, everything else from `corner`.
fn with(corner: [f64; 3], i: usize, along: f64) -> [f64; 3] {
    let mut point = corner;
    point[i] = along;
    point
}

fn draw_panes(sheet: &mut Sheet, view: &View, axes: &[Range; 3], ticks: &[Vec<(f64, String)>; 3]) {
    let back = back(axes);
    let page = |p: [f64; 3]| view.point(&p.into());
    // Each pane is spanned by two axes and lies at the back end of the third.
    for (pane, (i, j)) in [(0, 1), (1, 2), (0, 2)].into_iter().enumerate() {
        let corner = |a: f64, b: f64| page(with(with(back, i, a), j, b));
        let corners = [
            corner(axes[i].low, axes[j].low),
            corner(axes[i].high, axes[j].low),
            corner(axes[i].high, axes[j].high),
            corner(axes[i].low, axes[j].high),
        ];
        sheet.area(&corners, Colour::PANES[pane]);
    }
    let grid = Stroke::solid(Colour::GRID, 0.8);
    for (i, j) in [(0, 1), (1, 2), (0, 2)] {
        for (along, across) in [(i, j), (j, i)] {
            for (value, _) in &ticks[along] {
                let from = with(with(back, along, *value), across, axes[across].low);
                let to = with(with(back, along, *value), across, axes[across].high);
                sheet.line(page(from), page(to), grid);
            }
        }
    }
    let edge = Stroke::solid(Colour::PANE_EDGE, 0.8);
    for (i, range) in axes.iter().enumerate() {
        sheet.line(page(with(back, i, range.low)), page(with(back, i, range.high)), edge);
    }
}

/// Axis lines, ticks, labels and names: x and y along the near edges of the floor, z up the left edge.
fn draw_scales(sheet: &mut Sheet, view: &View, axes: &[Range; 3], ticks: &[Vec<(f64, String)>; 3]) {
    let back = back(axes);
    let (near_x, near_y) = (axes[0].high, axes[1].low);
    let frame = Stroke::solid(Colour::FRAME, 1.0);
    // Axis, the corner its edge starts from, the direction away from the box.
    let edges = [
        (0, with(back, 1, near_y), -Vector3::y()),
        (1, with(back, 0, near_x), Vector3::x()),
        (2, with(back, 1, near_y), -Vector3::y()),
    ];
    for (i, corner, outwards) in edges {
        let page = |value: f64| Vector2::from(view.point(&with(corner, i, value).into()));
        let (start, end) = (page(axes[i].low), page(axes[i].high));
        sheet.line(start.into(), end.into(), frame);
        let outwards = if i == 2 { -Vector2::x() } else { view.direction(&outwards).normalize() };
        // Tick labels are beside a rising or upright edge and below a flat one.
        let anchor = if i == 1 { Anchor::Start } else { Anchor::End };
        for (value, label) in &ticks[i] {
            let tick = page(*value);
            sheet.line(tick.into(), (tick + 5.0 * outwards).into(), frame);
            let at = tick + 9.0 * outwards + Vector2::y() * CAP_HEIGHT * TICK * if i == 2 { 0.5 } else { 0.75 };
            sheet.text(label, at.into(), TICK, anchor);
        }
        let name = ["x (m)", "y (m)", "z (m)"][i];
        let middle = 0.5 * (start + end);
        if i == 2 {
            // Labels of z run along the direction of the name: a figure is 0.6 em wide.
            let longest = ticks[i].iter().map(|(_, label)| label.chars().count()).max().unwrap_or(0);
            let distance = (15.0 + 0.6 * TICK * longest as f64).max(46.0);
            sheet.text_upwards(name, (middle - distance * Vector2::x()).into(), LABEL);
        } else {
            // Clear of the longest tick labels: those of y run away from the box, in the direction of the name.
            let distance = if i == 0 { 40.0 } else { 50.0 };
            let at = middle + distance * outwards + Vector2::y() * CAP_HEIGHT * LABEL;
            sheet.text(name, at.into(), LABEL, anchor);
        }
    }
}
