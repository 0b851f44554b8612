//! What the views of a figure share: sizes of type and the curves with their strokes.

use nalgebra::Vector3;

use super::scene::Stroke;

/// Em sizes, logical pixels.
pub(super) const TITLE: f64 = 18.0;
pub(super) const LEGEND: f64 = 14.0;
pub(super) const LABEL: f64 = 14.0;
pub(super) const TICK: f64 = 12.5;
pub(super) const NOTE: f64 = 12.5;

/// A curve may leave its samples by this much, logical pixels: a tenth of a pixel of the PNG.
pub(super) const CURVE_TOLERANCE: f64 = 0.05;

/// A curve and how it is drawn.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) label: &'a str,
    pub(super) time_s: &'a [f64],
    pub(super) position_m: &'a [Vector3<f64>],
    pub(super) stroke: Stroke,
}
