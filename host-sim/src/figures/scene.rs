//! What a figure consists of before it is SVG or pixels: lines, curves, areas and texts in, a list to draw in order out.
//!
//! Coordinates are logical pixels, x to the right, y down; 1 logical pixel is one SVG user unit.

/// An opaque sRGB colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Colour(pub(super) [u8; 3]);

impl Colour {
    /// Texts, axes.
    pub(super) const INK: Self = Self([34, 34, 34]);
    /// The reference.
    pub(super) const REFERENCE: Self = Self([0, 0, 0]);
    /// Axis lines and ticks.
    pub(super) const FRAME: Self = Self([96, 96, 96]);
    pub(super) const GRID: Self = Self([221, 221, 221]);
    /// The three back sides of the 3D box: floor, then walls.
    pub(super) const PANES: [Self; 3] = [Self([238, 240, 242]), Self([247, 248, 249]), Self([244, 245, 247])];
    /// The reference's shadow on the floor.
    pub(super) const SHADOW: Self = Self([196, 198, 202]);
    /// Flights, in order: blue, vermilion, bluish green and reddish purple of Okabe and Ito's palette, which stay
    /// apart under the common kinds of colour blindness.
    pub(super) const FLIGHTS: [Self; 4] =
        [Self([0, 114, 178]), Self([213, 94, 0]), Self([0, 158, 115]), Self([204, 121, 167])];
}

/// How a line is drawn; ends and corners are round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub(super) colour: Colour,
    /// Logical pixels.
    pub(super) width: f64,
    /// Lengths of a dash and of the gap after it, between the dash's round ends' centres; `None` is solid.
    pub(super) dash: Option<[f64; 2]>,
}

impl Stroke {
    pub(super) const fn solid(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: None }
    }
}

/// Which point of a text its position names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// One line of text in the figure's font.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Text {
    pub(super) content: String,
    /// On the baseline.
    pub(super) at: [f64; 2],
    /// Em size, logical pixels.
    pub(super) size: f64,
    pub(super) anchor: Anchor,
    /// Turned a quarter counter-clockwise: reads upwards.
    pub(super) upwards: bool,
    pub(super) colour: Colour,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    /// Furniture: grid, axes, ticks.
    Line {
        from: [f64; 2],
        to: [f64; 2],
        stroke: Stroke,
    },
    /// Data.
    Curve {
        points: Vec<[f64; 2]>,
        stroke: Stroke,
    },
    /// A filled convex polygon.
    Area {
        corners: Vec<[f64; 2]>,
        colour: Colour,
    },
    Text(Text),
}

/// A white sheet and what is drawn on it, the first item lowest.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    /// Logical pixels.
    pub(super) size: [u32; 2],
    pub(super) title: String,
    pub(super) items: Vec<Item>,
}

impl Scene {
    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke) {
        self.items.push(Item::Line { from, to, stroke });
    }

    pub(super) fn text(&mut self, content: impl Into<String>, at: [f64; 2], size: f64, anchor: Anchor) {
        self.items.push(Item::Text(Text {
            content: content.into(),
            at,
            size,
            anchor,
            upwards: false,
            colour: Colour::INK,
        }));
    }

    pub(super) fn text_upwards(&mut self, content: impl Into<String>, at: [f64; 2], size: f64) {
        let text =
            Text { content: content.into(), at, size, anchor: Anchor::Middle, upwards: true, colour: Colour::INK };
        self.items.push(Item::Text(text));
    }
}
