//! Tables to fly: those in the image and an uploaded one in; gains as flown, scaled within their certificate,
//! out.

mod choice;

use quatrack::gains::table::{CascadeTable, GainTable};
use quatrack::gains::{ConstantGain, Decoupled, Scales};
use quatrack::{
    Actuation, Air, Cascade, CascadeGains, CascadeLimits, Controller, FeedForward, Law, Limits, Measured, Memory,
    Output as LawOutput, Settings, StepError, Target,
};

use crate::craft::RATE;
use crate::shared::GAINS;

/// The tables that are not in the image.
#[derive(Clone, Copy, Default)]
pub struct Brought<'a> {
    /// The one that was sent last.
    pub sent: Option<&'a GainTable<'static>>,
    /// That of a craft of the owner's.
    pub own: Option<&'a CascadeTable>,
}

/// The number of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum TableId {
    /// The craft's own cascade, for the motor lag that is stated or else for those that are published of it.
    Cascade = 0,
    /// (LYAP-E) of the paper.
    LyapE = 1,
    /// (LQR-E) of the paper.
    LqrE = 2,
    /// (LYAP-F) of the paper.
    LyapF = 3,
    /// (LQR-F) of the paper.
    LqrF = 4,
    /// The one that was sent last.
    Uploaded = 5,
}

impl TableId {
    /// The table of a number.
    pub const fn numbered(number: u8) -> Option<Self> {
        match number {
            0 => Some(Self::Cascade),
            1 => Some(Self::LyapE),
            2 => Some(Self::LqrE),
            3 => Some(Self::LyapF),
            4 => Some(Self::LqrF),
            5 => Some(Self::Uploaded),
            _ => None,
        }
    }
}

/// The settings of a table that the owner may change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Factors on the feedback; of the cascade the first is its stiffness in position.
    pub scales: Scales,
    /// The air that the cascade is told.
    pub air: Air,
    /// On its way to a place that is far off.
    pub limits: CascadeLimits,
}

/// A table as it is flown.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// The table.
    pub id: TableId,
    /// Its gain.
    pub gain: Gain,
    /// The craft's way to its motors, as the table reckons with it.
    pub actuation: Actuation,
    /// Within which its feedback may be scaled: of the paper's laws the loop stays stable with each of its channels weakened or
    /// strengthened as much, all at once.
    pub scales: [f32; 2],
    /// Limits of its commands; those of its own head, or nothing.
    pub limits: Limits,
}

/// A gain with its law.
#[allow(clippy::large_enum_variant, reason = "there is no heap to put the larger one on")]
#[derive(Clone, Copy, Debug)]
pub enum Gain {
    /// In nested loops, with the gains that it was made of.
    Cascade(Cascade, CascadeGains),
    /// Any of the others.
    Constant(ConstantGain),
}

/// Why a table is not flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Refusal {
    /// There is no such table.
    Unknown = 1,
    /// Nothing has been sent yet, or the last upload was refused.
    NothingUploaded = 2,
    /// Its certificate ends at a shorter motor lag than this craft's.
    MotorLag = 3,
    /// The upload is no sound table with a certificate.
    Table = 4,
    /// It is for another vehicle or control rate.
    Vehicle = 5,
    /// It is for a law that is not flown here.
    Law = 6,
}

impl Table {
    /// Whether its law gives motor forces, and looks beyond the jerk for that.
    #[inline(always)]
    pub const fn gives_forces(&self) -> bool {
        matches!(self.gain, Gain::Cascade(..))
    }

    /// The cascade, if it is one.
    #[inline(always)]
    pub const fn as_cascade(&self) -> Option<&Cascade> {
        match &self.gain {
            Gain::Cascade(cascade, _) => Some(cascade),
            Gain::Constant(_) => None,
        }
    }

    /// A step of the table's controller within limits, but for the observers after it ([`Controller::observe`]).
    ///
    /// # Errors
    /// As [`Controller::step`].
    #[inline(always)]
    pub fn step(
        &self,
        (limits, feed_forward): (Limits, FeedForward),
        memory: &mut Memory,
        measured: Measured<'_>,
        target: Target<'_>,
    ) -> Result<LawOutput, StepError> {
        match &self.gain {
            Gain::Cascade(cascade, _) => {
                Controller::new(cascade, Limits::NONE).step_unobserved(memory, measured, target)
            }
            Gain::Constant(gain) => gain.step(RATE, &self.settings(limits, feed_forward), memory, measured, target),
        }
    }

    /// Its law.
    pub fn law(&self, feed_forward: FeedForward) -> Law<'_> {
        match &self.gain {
            Gain::Cascade(cascade, _) => Law::Cascade(cascade),
            Gain::Constant(gain) => gain.law(RATE, &self.settings(Limits::NONE, feed_forward)),
        }
    }

    #[inline(always)]
    const fn settings(&self, limits: Limits, feed_forward: FeedForward) -> Settings<'_> {
        Settings { actuation: Some(&self.actuation), feed_forward, ..Settings::new(limits, RATE) }
    }

    /// The entries that make up the gain where it decouples as designs at hover do: thrust from height, roll from y,
    /// pitch from x, yaw from heading. [`crate::shared::Gains`] names them.
    pub fn shown(&self) -> [f32; GAINS] {
        match &self.gain {
            Gain::Cascade(_, gains) => {
                let [z, vz, fz, y, vy, roll, p, fr, x, vx, pitch, q, fp, yaw, r, fy] = gains.numbers();
                [z, vz, fz, 0.0, y, vy, roll, p, fr, 0.0, x, vx, pitch, q, fp, 0.0, yaw, r, fy]
            }
            Gain::Constant(gain) => {
                let Decoupled { thrust: [z, vz, iz], roll, pitch, yaw } = gain.decoupled();
                let ([y, vy, roll, iy], [x, vx, pitch, ix]) = (roll, pitch);
                [z, vz, 0.0, iz, y, vy, roll, 0.0, 0.0, iy, x, vx, pitch, 0.0, 0.0, ix, yaw, 0.0, 0.0]
            }
        }
    }
}
