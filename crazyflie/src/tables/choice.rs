//! The number of a table, the craft and the owner's settings in; the table as it is flown, or why it is not, out.

use quatrack::gains::table::{AcceptError, CascadeTable, GainTable, margin_behind};
use quatrack::gains::{ConstantGain, paper};
use quatrack::{Actuation, Cascade, CascadeGains, Limits};

use super::{Brought, Gain, Refusal, Table, TableId, Tuning};
use crate::builtin::{self, STATED_FROM_S};
use crate::craft::{Craft, RATE};

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
}

impl From<AcceptError> for Refusal {
    fn from(error: AcceptError) -> Self {
        match error {
            AcceptError::MotorLag { .. } => Self::MotorLag,
            _ => Self::Vehicle,
        }
    }
}
