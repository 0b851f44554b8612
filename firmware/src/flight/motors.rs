//! A step down to the motors: body rates, and the law's command or the newest state, in; motor forces out.

use quatrack::RigidState;
use quatrack::link::NoCommand;

use super::{Flight, StepClock};
use crate::control::{Clock as _, ReferenceSource as _};
use crate::craft::BodyRates;

impl Flight {
    /// Carries the command to the motors, or steps the law that goes there straight. The gyroscope's rates count before
    /// those that came with the state.
    #[cold]
    #[inline(never)]
    pub(super) fn step_motors(&mut self, clock: &StepClock, rates: BodyRates) {
        let sent = self.arrived.as_ref().and_then(|arrived| arrived.body_rates_rad_s);
        let rates = match rates {
            BodyRates::Measured(rates) => Some(rates),
            BodyRates::NoGyroscope => sent,
            BodyRates::Failed => None,
        };
        self.answers_forces = true;
        let mode = self.supervisor.mode();
        self.forces.result = match (&self.arrived, rates) {
            _ if !mode.motors_allowed() => Err(NoCommand::Mode(mode)),
            (None, _) => Err(NoCommand::NoReference),
            (_, None) => Err(NoCommand::NoBodyRates),
            (Some(_), Some(rates)) if !self.is_straight => {
                self.answer.result.and_then(|step| self.motors.carry(&step, &rates).map_err(NoCommand::Step))
            }
            (Some(_), _) if !self.playback.is_there() => Err(NoCommand::NoReference),
            (Some(arrived), Some(rates)) => {
                let state = RigidState { state: arrived.state.state, body_rates_rad_s: rates };
                self.motors.step(clock.now(), &state, &mut self.playback)
            }
        };
    }
}
