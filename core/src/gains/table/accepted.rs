//! A table that this board flies: an accepted one in, a controller out.

#[cfg(feature = "cascade")]
use super::cascade::CascadeTable;
use super::gains::{Content, Gains};
use super::{AcceptError, TableHead, TableKind};
use crate::actuation::Actuation;
use crate::clock::Rate;
use crate::command::Limits;
use crate::control::{Controller, ControllerError, Law, Settings};
use crate::law::{AlongTrajectory, GainSchedule, Knot};
use crate::motor_lag::MotorLag;
use crate::trajectory::Trajectory;

/// The proof that a table is for this board's vehicle and rate, made by [`super::GainTable::accept_for`] alone; the table
/// itself is borrowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AcceptedTable<'t> {
    content: &'t Content,
    knots: &'t [Knot],
}

impl<'t> AcceptedTable<'t> {
    pub(crate) const fn of(content: &'t Content, knots: &'t [Knot]) -> Self {
        Self { content, knots }
    }

    /// Its law, within the tighter of the table's and the board's limits: a controller.
    ///
    /// # Errors
    /// [`ControllerError`] where a table of the cascade is not given its own
    /// [`CascadeTable::flown`](crate::gains::table::CascadeTable::flown).
    #[inline]
    pub fn controller(&self, settings: &Settings<'t>) -> Result<Controller<'t>, ControllerError> {
        let limits = settings.limits.within(&self.content.head.limits);
        let controller = Controller::new(self.law(settings)?, limits);
        Ok(match settings.actuation {
            Some(actuation) => controller.with_actuation(actuation),
            None => controller,
        })
    }

    /// Its law.
    ///
    /// # Errors
    /// As [`Self::controller`].
    #[inline]
    pub fn law(&self, settings: &Settings<'t>) -> Result<Law<'t>, ControllerError> {
        let rate = self.content.head.rate;
        match &self.content.gains {
            Gains::Constant(gain) => Ok(gain.law(rate, settings)),
            #[cfg(feature = "cascade")]
            Gains::Cascade { lag, .. } => {
                let Some(cascade) = settings.cascade else { return Err(ControllerError::NoCascade) };
                if cascade.actuation().lag() != lag {
                    let (table_s, actuation_s) = (lag.lag_s(), cascade.actuation().lag().lag_s());
                    return Err(ControllerError::MotorLag { table_s, actuation_s });
                }
                Ok(cascade.into())
            }
            Gains::Along { steps_per_knot, trajectory } => {
                let schedule = GainSchedule::of_checked(self.knots, *steps_per_knot, *trajectory);
                Ok(AlongTrajectory::new(schedule, rate, settings.player_rate, settings.feed_forward).into())
            }
        }
    }

    /// The board's way to its motors as the table reckons with it: that of its own motor lag where it has one.
    pub fn actuation(&self, board: &Actuation) -> Actuation {
        self.lag().map_or(*board, |lag| board.reckoning_with(lag))
    }

    /// The factor by which each channel of the feedback may be off behind motors of a lag (s) and a body-rate loop that fits
    /// it: half of the certified one that the lag leaves, on its way to the longest lag that is stable.
    ///
    /// # Errors
    /// [`AcceptError::MotorLag`] for a lag that is longer than certified: the table is not to be flown there.
    pub fn margin_behind(&self, motor_lag_s: f32) -> Result<f32, AcceptError> {
        let certificate = &self.content.head.certificate;
        margin_behind(certificate.all_channels.gain_factor, certificate.motor_lag_max_s, motor_lag_s)
    }

    /// Whether gains along a trajectory are for this one; on another the law flies the last knot's gain throughout. Others are
    /// for any.
    pub fn is_for(&self, trajectory: &Trajectory<'_>) -> bool {
        match &self.content.gains {
            Gains::Along { trajectory: of, .. } => *of == trajectory.checksum(),
            _ => true,
        }
    }

    /// The law that it is for.
    pub const fn kind(&self) -> TableKind {
        self.content.gains.kind()
    }

    /// Its head: all but the gains.
    pub const fn head(&self) -> &'t TableHead {
        &self.content.head
    }

    /// The rate of control steps that it is certified at.
    pub const fn rate(&self) -> Rate {
        self.content.head.rate
    }

    /// Its limits of commands.
    pub const fn limits(&self) -> Limits {
        self.content.head.limits
    }

    /// The motor lag that it was designed for, if it reckons with one.
    pub const fn lag(&self) -> Option<&'t MotorLag> {
        match &self.content.gains {
            #[cfg(feature = "cascade")]
            Gains::Cascade { lag, .. } => Some(lag),
            _ => None,
        }
    }

    /// The cascade's fields, if that is its kind: [`CascadeTable::flown`] makes the law of it, which
    /// [`Self::controller`] takes in its settings.
    #[cfg(feature = "cascade")]
    pub const fn cascade(&self) -> Option<&'t CascadeTable> {
        match &self.content.gains {
            Gains::Cascade { table, .. } => Some(table),
            _ => None,
        }
    }

    #[cfg(feature = "link")]
    pub(crate) const fn parts(&self) -> (&'t Content, &'t [Knot]) {
        (self.content, self.knots)
    }
}

/// The certified gain margin of all channels, reduced for motors that lag behind a body-rate loop that fits them:
/// half of the rest on the lag's way to the longest that is stable.
///
/// # Errors
/// [`AcceptError::MotorLag`] for a lag beyond that.
pub fn margin_behind(gain_factor: f32, lag_max_s: f32, motor_lag_s: f32) -> Result<f32, AcceptError> {
    let left = 1.0 - motor_lag_s / lag_max_s;
    if left >= 0.0 {
        Ok(1.0 + 0.5 * left * (gain_factor - 1.0))
    } else {
        Err(AcceptError::MotorLag { lag_max_s, motor_lag_s })
    }
}
