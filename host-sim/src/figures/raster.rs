//! A scene in, its pixels out, smoothed at every edge.
//!
//! Each pixel's share of a line or an area is taken from the distance of its centre to the edge, which is exact for
//! straight edges along an axis and within a few percent for all others. A curve takes each pixel once, by the nearest
//! of its segments: overlapping segments do not darken their joints.

use super::scene::{Anchor, Colour, Item, Scene, Stroke, Text};
use super::text::{self, FontUnusable};

/// Rows of RGB, three bytes a pixel, from the top left.
pub(super) struct Pixels {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) rgb: Vec<u8>,
}

/// The scene at `scale` pixels per logical pixel.
pub(super) fn draw(scene: &Scene, scale: u32) -> Result<Pixels, FontUnusable> {
    let [width, height] = scene.size.map(|length| (length * scale) as usize);
    let mut sheet = Sheet {
        pixels: Pixels { width, height, rgb: vec![255; 3 * width * height] },
        coverage: vec![0.0; width * height],
    };
    let scale = f64::from(scale);
    for item in &scene.items {
        match item {
            Item::Line { from, to, stroke } => sheet.stroke(&[*from, *to], stroke, scale),
            Item::Curve { points, stroke } => sheet.stroke(points, stroke, scale),
            Item::Area { corners, colour } => sheet.fill(corners, *colour, scale),
            Item::Text(text) => sheet.write(text, scale)?,
        }
    }
    Ok(sheet.pixels)
}

struct Sheet {
    pixels: Pixels,
    /// Share of each pixel that the item being drawn covers; all 0 between items.
    coverage: Vec<f32>,
}

/// Half-open ranges of columns and rows.
#[derive(Clone, Copy)]
struct Window {
    columns: [usize; 2],
    rows: [usize; 2],
}

impl Sheet {
    /// The pixels within `margin` of the points' bounding box that lie on the sheet.
    fn window(&self, points: &[[f64; 2]], margin: f64) -> Window {
        let range = |axis: usize, length: usize| {
            let low = points.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min) - margin;
            let high = points.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max) + margin;
            // A float-to-integer cast saturates: what lies off the sheet gives an empty range.
            [(low.floor() as usize).min(length), (high.ceil() as usize).min(length)]
        };
        Window { columns: range(0, self.pixels.width), rows: range(1, self.pixels.height) }
    }

    fn stroke(&mut self, points: &[[f64; 2]], stroke: &Stroke, scale: f64) {
        let points: Vec<[f64; 2]> = points.iter().map(|p| p.map(|v| v * scale)).collect();
        let half_width = 0.5 * stroke.width * scale;
        match stroke.dash {
            None => self.cover_segments(&points, half_width),
            Some(pattern) => {
                for dash in dashes(&points, pattern.map(|length| length * scale)) {
                    self.cover_segments(&dash, half_width);
                }
            }
        }
        let window = self.window(&points, half_width + 1.0);
        self.paint(window, stroke.colour);
    }

    fn cover_segments(&mut self, points: &[[f64; 2]], half_width: f64) {
        for pair in points.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let along = [b[0] - a[0], b[1] - a[1]];
            let length_squared = along[0] * along[0] + along[1] * along[1];
            let inverse = if length_squared > 0.0 { 1.0 / length_squared } else { 0.0 };
            let window = self.window(pair, half_width + 1.0);
            for row in window.rows[0]..window.rows[1] {
                for column in window.columns[0]..window.columns[1] {
                    let to_pixel = [column as f64 + 0.5 - a[0], row as f64 + 0.5 - a[1]];
                    let share = ((to_pixel[0] * along[0] + to_pixel[1] * along[1]) * inverse).clamp(0.0, 1.0);
                    let (dx, dy) = (to_pixel[0] - share * along[0], to_pixel[1] - share * along[1]);
                    let covered = half_width + 0.5 - (dx * dx + dy * dy).sqrt();
                    if covered > 0.0 {
                        // A line thinner than a pixel never covers a whole one.
                        let covered = covered.min(1.0).min(2.0 * half_width) as f32;
                        let pixel = &mut self.coverage[row * self.pixels.width + column];
                        *pixel = pixel.max(covered);
                    }
                }
            }
        }
    }

    fn fill(&mut self, corners: &[[f64; 2]], colour: Colour, scale: f64) {
        let corners: Vec<[f64; 2]> = corners.iter().map(|p| p.map(|v| v * scale)).collect();
        let next = |i: usize| corners[(i + 1) % corners.len()];
        let doubled_area: f64 = (0..corners.len()).map(|i| cross(corners[i], next(i))).sum();
        // Per edge: inward normal and offset, so that the distance inside is n.p + d.
        let edges: Vec<[f64; 3]> = (0..corners.len())
            .filter_map(|i| {
                let (a, b) = (corners[i], next(i));
                let length = (b[0] - a[0]).hypot(b[1] - a[1]).copysign(doubled_area);
                let normal = [(a[1] - b[1]) / length, (b[0] - a[0]) / length];
                (length != 0.0).then(|| [normal[0], normal[1], -(normal[0] * a[0] + normal[1] * a[1])])
            })
            .collect();
        let window = self.window(&corners, 1.0);
        for row in window.rows[0]..window.rows[1] {
            for column in window.columns[0]..window.columns[1] {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let inside = edges.iter().map(|e| e[0] * x + e[1] * y + e[2]).fold(f64::INFINITY, f64::min);
                self.coverage[row * self.pixels.width + column] = (inside + 0.5).clamp(0.0, 1.0) as f32;
            }
        }
        self.paint(window, colour);
    }

    fn write(&mut self, text: &Text, scale: f64) -> Result<(), FontUnusable> {
        let size = text.size * scale;
        let width = text::width_em(&text.content)? * size;
        let before = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        let [x, y] = text.at.map(|v| v * scale);
        let start = if text.upwards { [x, y + before] } else { [x - before, y] };
        let start = start.map(|v| v.round() as i32);
        for (right, down, covered) in text::coverage(&text.content, size)? {
            let (column, row) = if text.upwards {
                (start[0].saturating_add(down), start[1].saturating_sub(right).saturating_sub(1))
            } else {
                (start[0].saturating_add(right), start[1].saturating_add(down))
            };
            let (Ok(column), Ok(row)) = (usize::try_from(column), usize::try_from(row)) else { continue };
            if column < self.pixels.width && row < self.pixels.height {
                blend(&mut self.pixels.rgb[3 * (row * self.pixels.width + column)..][..3], text.colour, covered);
            }
        }
        Ok(())
    }

    /// Lays `colour` over the window by its coverage and clears that.
    fn paint(&mut self, window: Window, colour: Colour) {
        for row in window.rows[0]..window.rows[1] {
            for column in window.columns[0]..window.columns[1] {
                let index = row * self.pixels.width + column;
                let covered = std::mem::take(&mut self.coverage[index]);
                if covered > 0.0 {
                    blend(&mut self.pixels.rgb[3 * index..][..3], colour, covered);
                }
            }
        }
    }
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn blend(pixel: &mut [u8], colour: Colour, covered: f32) {
    for (below, above) in pixel.iter_mut().zip(colour.0) {
        let below_value = f32::from(*below);
        *below = (below_value + (f32::from(above) - below_value) * covered).round() as u8;
    }
}

/// The drawn stretches of a dashed line.
fn dashes(points: &[[f64; 2]], [dash, gap]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let Some(&first) = points.first() else { return Vec::new() };
    let mut drawn = Vec::new();
    let mut current = vec![first];
    let (mut pen_down, mut left) = (true, dash);
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        let mut length = (to[0] - from[0]).hypot(to[1] - from[1]);
        while length > left {
            let share = left / length;
            from = [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
            length -= left;
            if pen_down {
                current.push(from);
                drawn.push(std::mem::take(&mut current));
            } else {
                current = vec![from];
            }
            pen_down = !pen_down;
            left = if pen_down { dash } else { gap };
        }
        left -= length;
        if pen_down {
            current.push(to);
        }
    }
    if pen_down && current.len() > 1 {
        drawn.push(current);
    }
    drawn
}
