//! Rows of a reference as the core takes them, and references of points of a course.

use pyo3::prelude::*;
use quatrack::nalgebra::Vector3;
use quatrack::{FifthOrderSample, FlatSample};
use quatrack_plan::trajectory::fifth_order::FifthOrder;

use super::Reference;
use crate::arrays::Quantity;
use crate::error::refused_of;
use crate::state::single;

impl Reference {
    /// The number of rows.
    pub(crate) fn len(&self) -> usize {
        self.crafts.unwrap_or(1)
    }

    /// Heading and its derivatives of a row.
    #[inline]
    fn turn(&self, craft: usize) -> [[f32; 1]; 4] {
        self.heading.each_ref().map(|rows| single(rows.row(craft)))
    }

    /// One row, to the jerk, as the core takes it.
    #[inline]
    pub(crate) fn flat(&self, craft: usize) -> FlatSample {
        let [position, velocity, acceleration, jerk] = &self.position;
        let of = |rows: &Quantity<3>| Vector3::from(single(rows.row(craft)));
        let [[heading_rad], [heading_rate_rad_s], ..] = self.turn(craft);
        FlatSample {
            position_m: of(position),
            velocity_m_s: of(velocity),
            acceleration_m_s2: of(acceleration),
            jerk_m_s3: of(jerk),
            heading_rad,
            heading_rate_rad_s,
        }
    }

    /// One row with all that is known of it.
    #[inline]
    pub(crate) fn sample(&self, craft: usize) -> FifthOrderSample {
        let [.., [heading_acceleration_rad_s2], [heading_jerk_rad_s3]] = self.turn(craft);
        let [snap, crackle] = match &self.beyond {
            Some(beyond) => beyond.each_ref().map(|rows| single(rows.row(craft))),
            None => [[0.0; 3]; 2],
        };
        FifthOrderSample {
            flat: self.flat(craft),
            snap_m_s4: Vector3::from(snap),
            crackle_m_s5: Vector3::from(crackle),
            heading_acceleration_rad_s2,
            heading_jerk_rad_s3,
        }
    }

    /// Of points of a course.
    pub(crate) fn of_points(crafts: Option<usize>, points: &[FifthOrder]) -> Self {
        let order = |k: usize| Quantity::of_rows(crafts, points.iter().map(|point| point.position[k].into()));
        let turn = |k: usize| Quantity::of_rows(crafts, points.iter().map(|point| [point.heading[k]]));
        Self {
            crafts,
            position: [0, 1, 2, 3].map(order),
            beyond: Some([4, 5].map(order)),
            heading: [0, 1, 2, 3].map(turn),
            progress: None,
        }
    }

    /// The core's references.
    pub(super) fn mapped(&self) -> PyResult<Vec<quatrack::Reference>> {
        let of = |craft| self.crafts.map(|_| craft);
        (0..self.len())
            .map(|craft| {
                quatrack::Reference::from_flat(&self.flat(craft)).map_err(|error| refused_of(of(craft), error))
            })
            .collect()
    }
}
