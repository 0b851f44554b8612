//! Quantities over one axis, panel below panel: a curve, or the residual of a flight.

use super::flight::{Marks, Quantity, draw_quantities};
use super::space::Frame;
use super::style::TITLE;
use super::svg::{Anchor, Sheet};
use super::{FigureError, LARGEST, compose};

const HEIGHT: f64 = 720.0;
const PANELS: Frame = Frame { left: 100.0, top: 84.0, right: 1172.0, bottom: 662.0 };

/// The data of a chart.
#[derive(Clone, Debug)]
pub struct ChartFigure<'a> {
    /// Printed above the figure.
    pub title: &'a str,
    /// Name of the axis, with its unit.
    pub axis_name: &'a str,
    /// Places on the axis; increasing.
    pub places: &'a [f64],
    /// Upright lines in every panel.
    pub marks: Option<Marks<'a>>,
    /// Panels from top to bottom; each trace has one value for each place.
    pub quantities: Vec<Quantity<'a>>,
}

impl ChartFigure<'_> {
    /// As an SVG document of 1200 x 720 user units.
    ///
    /// # Errors
    /// [`FigureError`] if the data do not make a figure.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        self.validate()?;
        let mut sheet = Sheet::new([compose::WIDTH, HEIGHT], self.title);
        draw_quantities(&mut sheet, PANELS, self.axis_name, self.places, self.marks.as_ref(), &self.quantities)?;
        let size = compose::fitting(self.title, TITLE)?;
        sheet.text(self.title, [0.5 * compose::WIDTH, 32.0], size, Anchor::Middle);
        Ok(sheet.into_document())
    }

    fn validate(&self) -> Result<(), FigureError> {
        let times = self.places.len();
        let mut before = f64::NEG_INFINITY;
        for (index, value) in self.places.iter().copied().enumerate() {
            if !(value > before && value.abs() <= LARGEST) {
                return Err(FigureError::Time { label: self.axis_name.to_owned(), index, value });
            }
            before = value;
        }
        for trace in self.quantities.iter().flat_map(|quantity| &quantity.traces) {
            if trace.values.len() != times || times < 2 {
                return Err(FigureError::Samples {
                    label: trace.label.to_owned(),
                    times,
                    positions: trace.values.len(),
                });
            }
        }
        Ok(())
    }
}
