//! A table of the cascade: gains, the motor lag and the air that they are flown with, and their certified range.

use super::certificate::{Margins, Vehicle};
use super::error::{CascadeFigure, TableError};
use super::wire::read_entries;
use super::{ENTRY_MAX, TableHead};
use crate::airframe::Airframe;
use crate::cascade::{Air, AirError, Cascade, CascadeGains, CascadeLimits};
use crate::clock::Rate;
use crate::motor_lag::{MotorLag, MotorLagError};

/// Bytes between the head and the gains: lag, ranges, air, and whether it learns.
pub(super) const FIELDS_BYTES: usize = 16 * 4 + 1;

/// Bytes behind the head.
pub(super) const BYTES: usize = FIELDS_BYTES + 4 * CascadeGains::COUNT;

/// Gains of a [`Cascade`] with their motor lag and air: from a file, or generated into the core
/// ([`mod@crate::gains::cascade`]).
///
/// ```
/// use quatrack::cascade::{CascadeLimits, Air};
/// use quatrack::gains::cascade::BRUSHLESS_50_MS;
/// use quatrack::{Airframe, Rate};
///
/// let rate = Rate::from_hz(500).ok_or("no rate")?;
/// let table = BRUSHLESS_50_MS.table; // where no lag is stated
/// let cascade = table.flown(&Airframe::CRAZYFLIE_2_1_BRUSHLESS, rate, &CascadeLimits::STANDARD, &table.air)?;
/// assert_eq!(cascade.airframe().figures().motor_lag_s, 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CascadeTable {
    /// Gains of the four chains.
    pub gains: CascadeGains,
    /// The lag of the motors that the gains were designed for and the force prediction is flown with, s.
    pub motor_lag_s: f32,
    /// The air that is flown with where its owner states none.
    pub air: Air,
    /// The region in which the loop is stable.
    pub certified: CascadeRange,
}

/// A table in the core, with its certificate's figures for the craft as told in the identified air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuiltInCascade {
    /// The vehicle that it is for.
    pub vehicle: Vehicle,
    /// The table.
    pub table: CascadeTable,
    /// Disk margins, the least of the four chains.
    pub margins: Margins,
    /// The largest delay that stays stable, s.
    pub delay_max_s: f32,
    /// The longest lag of the motors that stays stable, s.
    pub motor_lag_max_s: f32,
}

/// Crafts, links and air that a table of the cascade is certified for, all at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CascadeRange {
    /// Shortest and longest lag of the motors, s.
    pub motor_lag_s: [f32; 2],
    /// How much heavier or lighter than told the craft may be, as a share.
    pub mass_share: f32,
    /// The same of its inertia.
    pub inertia_share: f32,
    /// Least and most force of a motor over its command.
    pub force_share: [f32; 2],
    /// Longest delay of commands, s.
    pub delay_s: f32,
    /// Most drag, 1/s.
    pub drag_per_s: f32,
    /// Most moment of the air about x and y, N s.
    pub moment_n_s: [f32; 2],
}

impl CascadeRange {
    /// Whether motors of a lag (s) are among them.
    pub fn holds_lag(&self, motor_lag_s: f32) -> bool {
        let [shortest, longest] = self.motor_lag_s;
        motor_lag_s >= shortest && motor_lag_s <= longest
    }

    /// Whether a craft of the design's mass `own_kg` may be stated to weigh `stated_kg`.
    pub fn holds_mass(&self, own_kg: f32, stated_kg: f32) -> bool {
        let difference = stated_kg - own_kg;
        let most = self.mass_share * own_kg;
        difference >= -most && difference <= most
    }

    /// Whether air is, as it is or as it is told.
    pub fn holds_air(&self, drag_per_s: f32, moment_n_s: [f32; 2]) -> bool {
        let ([x, y], [most_x, most_y]) = (moment_n_s, self.moment_n_s);
        drag_per_s >= 0.0 && drag_per_s <= self.drag_per_s && x >= 0.0 && x <= most_x && y >= 0.0 && y <= most_y
    }
}

impl CascadeTable {
    /// The law on a craft, told of this air: for control steps at the rate that the gains were designed for.
    ///
    /// # Errors
    /// [`MotorLagError`] for a table whose lag is shorter than two control periods.
    pub const fn flown(
        &self,
        airframe: &Airframe,
        rate: Rate,
        limits: &CascadeLimits,
        air: &Air,
    ) -> Result<Cascade, MotorLagError> {
        let lag = match MotorLag::new(self.motor_lag_s, rate) {
            Ok(lag) => lag,
            Err(error) => return Err(error),
        };
        Cascade::new(&self.gains, &airframe.reckoning_with(&lag), rate, limits, air)
    }

    /// The same table as one that can be written: its figures have sense, and its lag belongs to its certificate.
    pub(super) fn checked(&self, head: &TableHead) -> Result<MotorLag, TableError> {
        let figure = |figure: CascadeFigure, value: f32| Err(TableError::Cascade { figure, value });
        match self.air.checked() {
            Ok(_) => {}
            Err(AirError::Drag { per_s }) => return figure(CascadeFigure::ToldDrag, per_s),
            Err(AirError::DragAlong { share }) => return figure(CascadeFigure::ToldDragAlong, share),
            Err(AirError::Moment { n_s }) => return figure(CascadeFigure::ToldMoment, n_s),
            Err(AirError::Gust { share }) => return figure(CascadeFigure::ToldGust, share),
        }
        let CascadeRange { motor_lag_s, mass_share, inertia_share, force_share, delay_s, drag_per_s, moment_n_s } =
            self.certified;
        let ([shortest_s, longest_s], [least, most], [x, y]) = (motor_lag_s, force_share, moment_n_s);
        // Each figure with the least and the most that it may be; NaN is neither.
        let figures = [
            (CascadeFigure::MotorLag, shortest_s, 1e-6, self.motor_lag_s),
            (CascadeFigure::MotorLag, longest_s, self.motor_lag_s, head.certificate.motor_lag_max_s),
            (CascadeFigure::Mass, mass_share, 0.0, 0.9),
            (CascadeFigure::Inertia, inertia_share, 0.0, 0.9),
            (CascadeFigure::ForceShare, least, 0.1, 1.0),
            (CascadeFigure::ForceShare, most, 1.0, 10.0),
            (CascadeFigure::Delay, delay_s, 0.0, head.certificate.delay_max_s),
            (CascadeFigure::Drag, drag_per_s, 0.0, ENTRY_MAX),
            (CascadeFigure::Moment, x, 0.0, 1.0),
            (CascadeFigure::Moment, y, 0.0, 1.0),
        ];
        if let Some((name, value, ..)) =
            figures.iter().find(|(_, value, least, most)| !(value >= least && value <= most))
        {
            return figure(*name, *value);
        }
        MotorLag::new(self.motor_lag_s, head.rate).map_err(|_| TableError::MotorLag { lag_s: self.motor_lag_s })
    }

    /// From the bytes behind the head.
    #[inline(never)]
    pub(super) fn read(rest: &[u8], ended: TableError) -> Result<Self, TableError> {
        let (fields, entries) = rest.split_first_chunk::<FIELDS_BYTES>().ok_or(ended)?;
        let (numbers, learn) = fields.split_first_chunk::<{ FIELDS_BYTES - 1 }>().ok_or(ended)?;
        let mut values = [0.0; 16];
        read_entries(numbers, &mut values);
        let [lag_s, shortest_s, longest_s, mass_share, inertia_share, least, most, delay_s, ..] = values;
        let [.., drag_per_s, moment_x, moment_y, told_drag, along, told_x, told_y, gust] = values;
        let learn = match learn {
            [0] => false,
            [1] => true,
            _ => return Err(TableError::Cascade { figure: CascadeFigure::Learn, value: f32::NAN }),
        };
        let mut gains = [0.0; CascadeGains::COUNT];
        read_entries(entries, &mut gains);
        let gains = CascadeGains::from_numbers(gains).map_err(|error| TableError::Cascade {
            figure: CascadeFigure::Gain { index: error.index },
            value: error.value,
        })?;
        Ok(Self {
            gains,
            motor_lag_s: lag_s,
            air: Air { drag_per_s: told_drag, drag_along_share: along, moment_n_s: [told_x, told_y], gust, learn },
            certified: CascadeRange {
                motor_lag_s: [shortest_s, longest_s],
                mass_share,
                inertia_share,
                force_share: [least, most],
                delay_s,
                drag_per_s,
                moment_n_s: [moment_x, moment_y],
            },
        })
    }

    /// The bytes between the head and the gains.
    pub(super) fn fields(&self) -> [u8; FIELDS_BYTES] {
        let CascadeRange { motor_lag_s, mass_share, inertia_share, force_share, delay_s, drag_per_s, moment_n_s } =
            self.certified;
        let ([shortest_s, longest_s], [least, most], [x, y]) = (motor_lag_s, force_share, moment_n_s);
        let Air { drag_per_s: told_drag, drag_along_share, moment_n_s: [told_x, told_y], gust, learn } = self.air;
        let values = [
            self.motor_lag_s,
            shortest_s,
            longest_s,
            mass_share,
            inertia_share,
            least,
            most,
            delay_s,
            drag_per_s,
            x,
            y,
            told_drag,
            drag_along_share,
            told_x,
            told_y,
            gust,
        ];
        let mut fields = [0; FIELDS_BYTES];
        let (places, _) = fields.as_chunks_mut::<4>();
        places.iter_mut().zip(values).for_each(|(place, value)| *place = value.to_le_bytes());
        if let Some(last) = fields.last_mut() {
            *last = u8::from(learn);
        }
        fields
    }
}
