//! The style that all parts of a figure share: the font, sizes of type, colours, strokes, and the curves with their
//! strokes.

use nalgebra::Vector3;

/// Family of the embedded face, by its `name` table.
pub(super) const FONT_FAMILY: &str = "IBM Plex Sans";

/// Height of the face's capitals and figures, em (`sCapHeight` 698 of 1000).
pub(super) const CAP_HEIGHT: f64 = 0.698;

/// Em sizes, user units.
pub(super) const TITLE: f64 = 18.0;
pub(super) const LEGEND: f64 = 14.0;
pub(super) const LABEL: f64 = 14.0;
pub(super) const TICK: f64 = 12.5;
pub(super) const NOTE: f64 = 12.5;

/// A curve may leave its samples by this much, user units: a tenth of a pixel of the PNG.
pub(super) const CURVE_TOLERANCE: f64 = 0.05;

/// An opaque sRGB colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Colour(pub(super) [u8; 3]);

impl Colour {
    /// The sheet.
    pub(super) const PAPER: Self = Self([255, 255, 255]);
    /// Texts.
    pub(super) const INK: Self = Self([34, 34, 34]);
    /// The reference.
    pub(super) const REFERENCE: Self = Self([0, 0, 0]);
    /// Axis lines and ticks.
    pub(super) const FRAME: Self = Self([96, 96, 96]);
    pub(super) const GRID: Self = Self([221, 221, 221]);
    /// The three back sides of the 3D box: floor, then walls.
    pub(super) const PANES: [Self; 3] = [Self([238, 240, 242]), Self([247, 248, 249]), Self([244, 245, 247])];
    /// Where the back sides meet.
    pub(super) const PANE_EDGE: Self = Self([190, 192, 196]);
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
    /// User units.
    pub(super) width: f64,
    /// Lengths of a dash and of the gap after it, between the dash's round ends' centres; `None` is solid.
    pub(super) dash: Option<[f64; 2]>,
}

impl Stroke {
    pub(super) const fn solid(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: None }
    }
}

/// A curve and how it is drawn.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) label: &'a str,
    pub(super) time_s: &'a [f64],
    pub(super) position_m: &'a [Vector3<f64>],
    pub(super) stroke: Stroke,
}
