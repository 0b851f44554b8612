//! Tables to fly: those in the image and an uploaded one in; gains as flown, scaled within what their certificate allows,
//! out.

use quatrack::gains::table::{AcceptError, GainTable, margin_behind};
use quatrack::gains::{ConstantGain, Decoupled, Scales, paper};
use quatrack::law::ActuatorAwareGain;
use quatrack::{
    Actuation, ControllerError, FeedForward, Law, Limits, Measured, Memory, Output as LawOutput, Settings, StepError,
    Target,
};

use crate::builtin;
use crate::craft::{Craft, RATE};
use crate::shared::GAINS;

/// Which table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum TableId {
    /// The craft's own actuator-aware one, for the motor lag that is stated or else for any that is published of it.
    ActuatorAware = 0,
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
    /// By its number.
    pub const fn numbered(number: u8) -> Option<Self> {
        match number {
            0 => Some(Self::ActuatorAware),
            1 => Some(Self::LyapE),
            2 => Some(Self::LqrE),
            3 => Some(Self::LyapF),
            4 => Some(Self::LqrF),
            5 => Some(Self::Uploaded),
            _ => None,
        }
    }
}

/// A table as it is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// Which.
    pub id: TableId,
    /// Its gain.
    pub gain: ConstantGain,
    /// The craft's way to its motors, as the table reckons with it.
    pub actuation: Actuation,
    /// The loop stays stable with each of its channels weakened or strengthened by this factor, all at once.
    pub margin: f32,
    /// What it may command; what its own head says, or nothing.
    pub limits: Limits,
}

/// Why a table is not flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Refusal {
    /// There is no such table.
    Unknown = 1,
    /// Nothing has been sent yet, or what was sent was refused.
    NothingUploaded = 2,
    /// Its certificate ends at a shorter motor lag than this craft's.
    MotorLag = 3,
    /// What was sent is no sound table with a certificate.
    Table = 4,
    /// It is for another vehicle or control rate.
    Vehicle = 5,
    /// It is for a law that is not flown here.
    Law = 6,
}

impl Table {
    /// A table in the image, or the uploaded one, for a craft.
    ///
    /// # Errors
    /// [`Refusal`].
    #[inline(never)]
    pub fn choose(number: u8, craft: &Craft, uploaded: Option<&GainTable<'static>>) -> Result<Self, Refusal> {
        let id = TableId::numbered(number).ok_or(Refusal::Unknown)?;
        let (gain, (margin, lag_max_s)) = match id {
            TableId::ActuatorAware => return Self::actuator_aware(craft),
            TableId::LyapE => (ConstantGain::Equilibrium(paper::LYAP_E), builtin::LYAP_E),
            TableId::LqrE => (ConstantGain::Equilibrium(paper::LQR_E), builtin::LQR_E),
            TableId::LyapF => (ConstantGain::FlatOutput(paper::LYAP_F), builtin::LYAP_F),
            TableId::LqrF => (ConstantGain::FlatOutput(paper::LQR_F), builtin::LQR_F),
            TableId::Uploaded => return Self::uploaded(uploaded.ok_or(Refusal::NothingUploaded)?, craft),
        };
        let margin = margin_behind(margin, lag_max_s, craft.motor_lag_s)?;
        Ok(Self { id, gain, actuation: craft.actuation, margin, limits: Limits::NONE })
    }

    /// The craft's own: the gain that is certified for the stated lag, flown with it; with none stated the one for any
    /// published lag, flown with that of its design.
    ///
    /// # Errors
    /// [`Refusal::MotorLag`] for a stated lag that none is certified for, [`Refusal::Unknown`] where the craft has none.
    #[inline(never)]
    pub fn actuator_aware(craft: &Craft) -> Result<Self, Refusal> {
        let Some(lag_s) = craft.stated_lag_s else { return Self::for_any_published_lag(craft) };
        let designs = builtin::ACTUATOR_AWARE.get(craft.index).ok_or(Refusal::Unknown)?;
        let holds = |design: &&builtin::Design| {
            let [shortest_s, longest_s] = design.stated_s;
            lag_s >= shortest_s && lag_s <= longest_s
        };
        let design = designs.iter().find(holds).ok_or(Refusal::MotorLag)?;
        Self::designed(design, craft, lag_s, design.margin)
    }

    /// The craft's own for any motor lag that is published of it.
    ///
    /// # Errors
    /// [`Refusal::Unknown`] where there is none.
    #[inline(never)]
    pub fn for_any_published_lag(craft: &Craft) -> Result<Self, Refusal> {
        let [.., design] = builtin::ACTUATOR_AWARE.get(craft.index).ok_or(Refusal::Unknown)?;
        let (lag_s, margin) = builtin::ANY_LAG.get(craft.index).ok_or(Refusal::Unknown)?;
        Self::designed(design, craft, *lag_s, *margin)
    }

    fn designed(design: &builtin::Design, craft: &Craft, lag_s: f32, margin: f32) -> Result<Self, Refusal> {
        Self::to_motors(TableId::ActuatorAware, design.gain, lag_s, craft, margin)
    }

    /// For motor forces, reckoning with motors of a lag.
    pub(crate) const fn to_motors(
        id: TableId,
        gain: ActuatorAwareGain,
        lag_s: f32,
        craft: &Craft,
        margin: f32,
    ) -> Result<Self, Refusal> {
        let Ok(airframe) = craft.airframe().with_motor_lag(lag_s) else { return Err(Refusal::MotorLag) };
        let gain = ConstantGain::ActuatorAware(gain);
        match Actuation::new(&airframe.commanded_at(RATE), RATE) {
            Ok(actuation) => Ok(Self { id, gain, actuation, margin, limits: Limits::NONE }),
            Err(_) => Err(Refusal::MotorLag),
        }
    }

    #[inline(never)]
    fn uploaded(table: &GainTable<'static>, craft: &Craft) -> Result<Self, Refusal> {
        let accepted = table.accept_for(&craft.vehicle, RATE)?;
        let gain = *table.gain().ok_or(Refusal::Law)?;
        let margin = accepted.margin_behind(craft.motor_lag_s)?;
        let actuation = accepted.actuation(&craft.actuation);
        Ok(Self { id: TableId::Uploaded, gain, actuation, margin, limits: accepted.limits() })
    }

    /// The same with its feedback scaled, as far as its margin allows.
    #[inline(never)]
    pub fn scaled(&self, scales: &Scales) -> Self {
        Self { gain: self.gain.scaled(&scales.within(self.margin)), ..*self }
    }

    /// A step of the table's controller within limits.
    ///
    /// # Errors
    /// As [`quatrack::Controller::step`].
    #[inline(always)]
    pub fn step(
        &self,
        (limits, feed_forward): (Limits, FeedForward),
        memory: &mut Memory,
        measured: Measured<'_>,
        target: Target<'_>,
    ) -> Result<LawOutput, StepError> {
        self.gain.step(RATE, &self.settings(limits, feed_forward), memory, measured, target)
    }

    /// Its law.
    ///
    /// # Errors
    /// None: a table has its actuation.
    pub fn law(&self, feed_forward: FeedForward) -> Result<Law<'_>, ControllerError> {
        self.gain.law(RATE, &self.settings(Limits::NONE, feed_forward))
    }

    #[inline(always)]
    fn settings(&self, limits: Limits, feed_forward: FeedForward) -> Settings<'_> {
        Settings { actuation: Some(&self.actuation), feed_forward, ..Settings::new(limits, RATE) }
    }

    /// The entries that make up the gain where it decouples as designs at hover do: thrust from height, roll from y,
    /// pitch from x, yaw from heading. [`crate::shared::Gains`] has what is where.
    pub fn shown(&self) -> [f32; GAINS] {
        let Decoupled { thrust: [t0, t1, t2, t3], roll, pitch, yaw: [y0, y1, y2] } = self.gain.decoupled();
        let ([r0, r1, r2, r3, r4, r5], [p0, p1, p2, p3, p4, p5]) = (roll, pitch);
        [t0, t1, t2, t3, r0, r1, r2, r3, r4, r5, p0, p1, p2, p3, p4, p5, y0, y1, y2]
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
