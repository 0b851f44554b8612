//! Tables to fly: those in the image and an uploaded one in; gains as flown, scaled within their certificate,
//! out.

use quatrack::gains::table::{AcceptError, CascadeTable, GainTable, margin_behind};
use quatrack::gains::{ConstantGain, Decoupled, Scales, paper};
use quatrack::{
    Actuation, Air, Cascade, CascadeGains, CascadeLimits, Controller, FeedForward, Law, Limits, Measured, Memory,
    Output as LawOutput, Settings, StepError, Target,
};

use crate::builtin::{self, STATED_FROM_S};
use crate::craft::{Craft, RATE};
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

/// Within which the stiffness of a cascade may be scaled.
const STIFFNESS: [f32; 2] = [0.5, 1.3];

impl Table {
    /// A table in the image, or the uploaded one, for a craft.
    ///
    /// # Errors
    /// [`Refusal`].
    #[inline(never)]
    pub fn choose(number: u8, craft: &Craft, tuning: &Tuning, brought: Brought<'_>) -> Result<Self, Refusal> {
        let id = TableId::numbered(number).ok_or(Refusal::Unknown)?;
        let (gain, (margin, lag_max_s)) = match id {
            TableId::Cascade => return Self::cascade(craft, tuning, brought.own),
            TableId::LyapE => (ConstantGain::Equilibrium(paper::LYAP_E), builtin::LYAP_E),
            TableId::LqrE => (ConstantGain::Equilibrium(paper::LQR_E), builtin::LQR_E),
            TableId::LyapF => (ConstantGain::FlatOutput(paper::LYAP_F), builtin::LYAP_F),
            TableId::LqrF => (ConstantGain::FlatOutput(paper::LQR_F), builtin::LQR_F),
            TableId::Uploaded => return Self::uploaded(brought.sent.ok_or(Refusal::NothingUploaded)?, craft, tuning),
        };
        let margin = margin_behind(margin, lag_max_s, craft.motor_lag_s)?;
        Ok(Self::constant(id, &gain, craft.actuation, margin, Limits::NONE, tuning))
    }

    /// The craft's own: the gains that are certified for the stated lag, flown with it; with none stated those for the published
    /// lags, flown with that of their design. Of a craft of the owner's its table, with the lag of its design.
    ///
    /// # Errors
    /// [`Refusal::MotorLag`] for a stated lag that none is certified for, [`Refusal::Unknown`] where the craft has none.
    #[inline(never)]
    pub fn cascade(craft: &Craft, tuning: &Tuning, own: Option<&CascadeTable>) -> Result<Self, Refusal> {
        let lag_s = match (own, craft.stated_lag_s) {
            (Some(own), _) => return Self::holding_lag(own, craft, tuning),
            (None, None) => return Self::for_published_lags(craft, tuning, None),
            (None, Some(lag_s)) => lag_s,
        };
        let (cascades, _) = builtin::CASCADES.get(craft.index).ok_or(Refusal::Unknown)?;
        let holds = |cascade: &&builtin::Cascade| lag_s <= cascade.stated_to_s;
        let found = cascades.iter().find(holds).filter(|_| lag_s >= STATED_FROM_S).ok_or(Refusal::MotorLag)?;
        Self::of_cascade(&found.gains, if found.as_stated { lag_s } else { found.lag_s }, craft, tuning)
    }

    /// The craft's own for the motor lags that are published of it.
    ///
    /// # Errors
    /// [`Refusal::Unknown`] where there is none.
    #[inline(never)]
    pub fn for_published_lags(craft: &Craft, tuning: &Tuning, own: Option<&CascadeTable>) -> Result<Self, Refusal> {
        if let Some(own) = own {
            return Self::of_cascade(&own.gains, own.motor_lag_s, craft, tuning);
        }
        let (_, unstated) = builtin::CASCADES.get(craft.index).ok_or(Refusal::Unknown)?;
        Self::of_cascade(&unstated.gains, unstated.lag_s, craft, tuning)
    }

    /// Gains of a cascade on a craft whose motors are taken to have a lag.
    pub(crate) const fn of_cascade(
        gains: &CascadeGains,
        lag_s: f32,
        craft: &Craft,
        tuning: &Tuning,
    ) -> Result<Self, Refusal> {
        let Ok(airframe) = craft.airframe().with_motor_lag(lag_s) else { return Err(Refusal::MotorLag) };
        let Ok(cascade) = Cascade::new(gains, &airframe, RATE, &tuning.limits, &tuning.air) else {
            return Err(Refusal::MotorLag);
        };
        let [least, most] = STIFFNESS;
        let asked = tuning.scales.position;
        let stiffness = if asked >= most {
            most
        } else if asked >= least {
            asked
        } else {
            least
        };
        let cascade = cascade.with_stiffness(stiffness);
        Ok(Self {
            id: TableId::Cascade,
            actuation: *cascade.actuation(),
            gain: Gain::Cascade(cascade, gains.scaled(stiffness)),
            scales: STIFFNESS,
            limits: Limits::NONE,
        })
    }

    #[inline(never)]
    fn uploaded(table: &GainTable<'static>, craft: &Craft, tuning: &Tuning) -> Result<Self, Refusal> {
        let accepted = table.accept_for(&craft.vehicle, RATE)?;
        if let Some(cascade) = accepted.cascade() {
            // With its own air where the owner has not stated another than the craft's.
            let air = if tuning.air == craft.air { cascade.air } else { tuning.air };
            let found = Self::holding_lag(cascade, craft, &Tuning { air, ..*tuning })?;
            return Ok(Self { id: TableId::Uploaded, ..found });
        }
        let gain = table.gain().ok_or(Refusal::Law)?;
        let margin = accepted.margin_behind(craft.motor_lag_s)?;
        let actuation = accepted.actuation(&craft.actuation);
        Ok(Self::constant(TableId::Uploaded, gain, actuation, margin, accepted.limits(), tuning))
    }

    /// A cascade that was brought, where it is certified for the craft's motors.
    fn holding_lag(table: &CascadeTable, craft: &Craft, tuning: &Tuning) -> Result<Self, Refusal> {
        if !table.certified.holds_lag(craft.motor_lag_s) {
            return Err(Refusal::MotorLag);
        }
        Self::of_cascade(&table.gains, table.motor_lag_s, craft, tuning)
    }

    /// Of a gain whose feedback is scaled as far as its margin allows.
    fn constant(
        id: TableId,
        gain: &ConstantGain,
        actuation: Actuation,
        margin: f32,
        limits: Limits,
        tuning: &Tuning,
    ) -> Self {
        let gain = Gain::Constant(gain.scaled(&tuning.scales.within(margin)));
        Self { id, gain, actuation, scales: [1.0 / margin, margin], limits }
    }

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

impl From<AcceptError> for Refusal {
    fn from(error: AcceptError) -> Self {
        match error {
            AcceptError::MotorLag { .. } => Self::MotorLag,
            _ => Self::Vehicle,
        }
    }
}
