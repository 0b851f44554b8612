//! Figures in the manner of the paper's Figures 2 to 5: a reference and the flights that track it, or one flight with
//! its motors' forces and the wind, in; SVG or PNG out.
//!
//! To the left the flight in space, to the right x, y and z over time; the reference dashed, flights solid. Plain data
//! in, bytes out, the same bytes for the same data: nothing here knows controllers or writes files.

mod axis;
mod chart;
mod compose;
mod flight;
mod panels;
mod path;
mod plots;
mod render;
mod space;
mod style;
mod svg;

use nalgebra::Vector3;

pub use chart::ChartFigure;
pub use flight::{FlightFigure, Marks, Quantity, Trace};
pub use plots::{Plot, PlotsFigure};
pub use render::png;

/// Coordinates and times up to this size can be told apart on an axis and labelled.
const LARGEST: f64 = 1e6;

/// One line of a figure: where it was when.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'a> {
    /// For the legend.
    pub label: &'a str,
    /// Times of the samples, s; increasing.
    pub time_s: &'a [f64],
    /// Positions at those times, world frame, m.
    pub position_m: &'a [Vector3<f64>],
}

/// The contents of the figure.
#[derive(Clone, Debug)]
pub struct TrackingFigure<'a> {
    /// Printed above the figure.
    pub title: &'a str,
    /// Drawn dashed; the axes are fitted to it, to flights that end near it, and to others as far as they stay near it.
    pub reference: Curve<'a>,
    /// From 1 to 4. A sample that is not finite breaks a flight's line; a flight that strays far from the reference and does
    /// not come back is drawn up to the edge of the axes, and a note below the figure says so.
    pub flights: Vec<Curve<'a>>,
}

/// Why there is no figure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FigureError {
    /// No flight, or more than there are colours.
    #[error("{0} flights: a figure shows from 1 to 4")]
    Flights(usize),
    /// Times and positions do not belong together.
    #[error("{label}: {times} times for {positions} positions; there must be as many, and at least 2")]
    Samples {
        /// The curve's label.
        label: String,
        /// The number of times.
        times: usize,
        /// The number of positions.
        positions: usize,
    },
    /// A time that does not follow the one before it, or is out of reach.
    #[error("{label}: time {index} (from 0) is {value} s; times must increase and stay within +-1e6 s")]
    Time {
        /// The curve's label.
        label: String,
        /// The sample's number, from 0.
        index: usize,
        /// Its time, s.
        value: f64,
    },
    /// A sample of the reference that no axis can be fitted to.
    #[error("{label}: position {index} (from 0) has the coordinate {value} m; a reference must stay within +-1e6 m")]
    Reference {
        /// The reference's label.
        label: String,
        /// The sample's number, from 0.
        index: usize,
        /// The first such coordinate, m.
        value: f64,
    },
    /// The renderer refused the figure's own SVG: a fault of the program.
    #[error("the figure could not be rendered: {0}; please report this with the trajectory that was drawn")]
    Rendering(String),
}

impl TrackingFigure<'_> {
    /// The figure as an SVG document of 1200 x 560 user units.
    ///
    /// # Errors
    /// [`FigureError`] if the data do not make a figure.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        self.validate()?;
        compose::document(self)
    }

    fn validate(&self) -> Result<(), FigureError> {
        if !(1..=style::Colour::FLIGHTS.len()).contains(&self.flights.len()) {
            return Err(FigureError::Flights(self.flights.len()));
        }
        for curve in self.flights.iter().chain([&self.reference]) {
            curve.validate()?;
        }
        let coordinates =
            self.reference.position_m.iter().enumerate().flat_map(|(i, p)| p.iter().map(move |v| (i, *v)));
        match coordinates.into_iter().find(|(_, v)| !v.is_finite() || v.abs() > LARGEST) {
            Some((index, value)) => {
                Err(FigureError::Reference { label: self.reference.label.to_owned(), index, value })
            }
            None => Ok(()),
        }
    }
}

impl Curve<'_> {
    fn validate(&self) -> Result<(), FigureError> {
        let (times, positions) = (self.time_s.len(), self.position_m.len());
        if times != positions || times < 2 {
            return Err(FigureError::Samples { label: self.label.to_owned(), times, positions });
        }
        let mut before = f64::NEG_INFINITY;
        for (index, &value) in self.time_s.iter().enumerate() {
            if !(value > before && value.abs() <= LARGEST) {
                return Err(FigureError::Time { label: self.label.to_owned(), index, value });
            }
            before = value;
        }
        Ok(())
    }
}
