//! Orders of the link beside arming in: how often it steps, which law, tables and limits; those in force out.

use quatrack::Rate;
#[cfg(feature = "motors")]
use quatrack::body_rate::BandwidthError;
use quatrack::command::LimitsError;
use quatrack::gains::table::AcceptedTable;
use quatrack::link::{LawChoice, LimitsSetting};

use super::Flight;
use crate::laws::{FADE_STEPS, Refused};
use crate::rates::{DECIMATION, LOCK_STEP, TICK_RATE_HZ};

impl Flight {
    /// Ticks of the loop for one step, or [`LOCK_STEP`].
    pub fn decimation(&self) -> u32 {
        self.decimation
    }

    /// Sets the ticks for one step. Gain tables for another rate are dropped, that of the cascade in the image too.
    pub fn set_decimation(&mut self, decimation: u32) {
        self.decimation = decimation;
        self.laws.set_rate(step_rate(decimation));
    }

    /// The law in force.
    pub fn law(&self) -> LawChoice {
        self.laws.choice()
    }

    /// Chooses a law, from the next step on; in flight over [`FADE_STEPS`].
    ///
    /// # Errors
    /// As [`crate::laws::Laws::select`].
    #[cold]
    pub fn select(&mut self, law: LawChoice) -> Result<(), Refused> {
        self.laws.select(law, self.fade_steps())
    }

    /// The rate of the steps that gain tables must be certified at, if there are any for it. In lock-step the states are
    /// taken to come at the rate of [`DECIMATION`].
    pub fn table_rate(&self) -> Option<Rate> {
        self.laws.rate()
    }

    /// Puts an accepted gain table to use, from the next step on; in flight over [`FADE_STEPS`] where it takes the place
    /// of the one that is flown.
    ///
    /// # Errors
    /// As [`crate::laws::Laws::load`].
    #[cold]
    pub fn load(&mut self, table: &AcceptedTable<'_>) -> Result<(), Refused> {
        self.laws.load(table, self.fade_steps())
    }

    /// On the ground there is nothing to jump.
    fn fade_steps(&self) -> u16 {
        if self.mode().motors_allowed() { FADE_STEPS } else { 0 }
    }

    /// Bandwidth of the body-rate loop, rad/s.
    #[cfg(feature = "motors")]
    pub fn bandwidth_rad_s(&self) -> [f32; 3] {
        self.laws.actuations.bandwidth_rad_s()
    }

    /// Sets it.
    ///
    /// # Errors
    /// As [`quatrack::BodyRateLoop::new`]; the old setting stays.
    #[cfg(feature = "motors")]
    pub fn set_bandwidth(&mut self, bandwidth_rad_s: [f32; 3]) -> Result<(), BandwidthError> {
        self.laws.actuations.set_bandwidth(bandwidth_rad_s)
    }

    /// The limits in force.
    pub fn limits(&self) -> LimitsSetting {
        let limits = self.laws.limits();
        LimitsSetting {
            thrust_min_m_s2: limits.thrust_min_m_s2(),
            thrust_max_m_s2: limits.thrust_max_m_s2(),
            body_rates_max_rad_s: limits.body_rates_max_rad_s().into(),
        }
    }

    /// Sets the limits.
    ///
    /// # Errors
    /// As [`quatrack::Limits::new`]; the ones in force stay.
    #[cold]
    pub fn set_limits(&mut self, limits: LimitsSetting) -> Result<(), LimitsError> {
        self.laws.set_limits(limits.check()?);
        Ok(())
    }
}

/// The rate of the steps at so many ticks each, if it is a whole number of Hz.
pub(super) fn step_rate(decimation: u32) -> Option<Rate> {
    let ticks = if decimation == LOCK_STEP { DECIMATION } else { decimation };
    if TICK_RATE_HZ.is_multiple_of(ticks) { Rate::from_hz(TICK_RATE_HZ.checked_div(ticks)?) } else { None }
}
