//! Parameters of the board: an id in, the value in force out; a value in, put in force or refused.

use quatrack::Leash;
use quatrack::link::{Parameter, ParameterId, Refusal};

use super::{Session, Shared, Vitals, disarmed};
use crate::drivers::battery::CellVoltage;
use crate::kept::Keep;
use crate::rates::TICK_RATE_HZ;

/// Longest decimation: one step a second.
const DECIMATION_MAX: u32 = TICK_RATE_HZ;

/// Longest age and silence that can be set, ticks: ten seconds.
const AGE_MAX_TICKS: u32 = 10 * TICK_RATE_HZ;

impl<K: Keep> Session<K> {
    pub(super) fn parameter(&self, id: ParameterId, flight: &mut impl Shared) -> Parameter {
        flight.with(|flight| match id {
            ParameterId::Decimation => Parameter::Decimation(flight.decimation()),
            ParameterId::Limits => Parameter::Limits(flight.limits()),
            ParameterId::StateAgeMaxTicks => Parameter::StateAgeMaxTicks(flight.config.state_age_max_ticks),
            ParameterId::LinkSilenceMaxTicks => Parameter::LinkSilenceMaxTicks(flight.config.link_silence_max_ticks),
            ParameterId::OverrunsTolerated => Parameter::OverrunsTolerated(flight.config.overruns_tolerated),
            ParameterId::TelemetryPeriodTicks => Parameter::TelemetryPeriodTicks(self.telemetry_period_ticks),
            ParameterId::UploadsRefused => Parameter::UploadsRefused(self.uploads_refused),
            ParameterId::BatteryVoltage => Parameter::BatteryVoltage(flight.motors.battery().volts()),
            ParameterId::BodyRateBandwidth => Parameter::BodyRateBandwidth(flight.bandwidth_rad_s()),
            ParameterId::Leash => Parameter::Leash(flight.leash.length_m),
        })
    }

    pub(super) fn set(
        &mut self,
        parameter: Parameter,
        flight: &mut impl Shared,
        vitals: &impl Vitals,
    ) -> Result<(), Refusal> {
        if !matches!(parameter, Parameter::TelemetryPeriodTicks(_) | Parameter::BatteryVoltage(_)) {
            disarmed(flight)?;
        }
        let within = |value: u32, max: u32| if value <= max { Ok(value) } else { Err(Refusal::OutOfRange) };
        match parameter {
            Parameter::Decimation(ticks) => {
                let decimation = within(ticks, DECIMATION_MAX)?;
                flight.with(|flight| flight.set_decimation(decimation));
                self.committed = None;
                vitals.set_decimation(decimation);
            }
            Parameter::Limits(limits) => {
                flight.with(|flight| flight.set_limits(limits)).map_err(Refusal::Limits)?;
            }
            Parameter::StateAgeMaxTicks(ticks) => {
                let ticks = within(ticks, AGE_MAX_TICKS)?;
                flight.with(|flight| flight.config.state_age_max_ticks = ticks);
            }
            Parameter::LinkSilenceMaxTicks(ticks) => {
                let ticks = within(ticks, AGE_MAX_TICKS)?;
                flight.with(|flight| flight.config.link_silence_max_ticks = ticks);
            }
            Parameter::OverrunsTolerated(count) => {
                flight.with(|flight| flight.config.overruns_tolerated = count);
            }
            Parameter::TelemetryPeriodTicks(ticks) => self.telemetry_period_ticks = ticks,
            Parameter::UploadsRefused(_) => return Err(Refusal::ReadOnly),
            Parameter::BatteryVoltage(voltage_v) => {
                let battery = CellVoltage::new(voltage_v).map_err(|_| Refusal::OutOfRange)?;
                flight.with(|flight| flight.motors.set_battery(battery));
            }
            Parameter::BodyRateBandwidth(bandwidth_rad_s) => {
                let set = flight.with(|flight| flight.set_bandwidth(bandwidth_rad_s));
                set.map_err(|_| Refusal::OutOfRange)?;
            }
            Parameter::Leash(length_m) if length_m >= Leash::SHORTEST_M => {
                flight.with(|flight| flight.leash = Leash { length_m });
            }
            Parameter::Leash(_) => return Err(Refusal::OutOfRange),
        }
        Ok(())
    }
}
