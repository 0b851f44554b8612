//! A tick, with the craft's own body rates, in; the output that passes, or why none does, out.

use quatrack::link::NoCommand;
use quatrack::supervisor::{Asked, Circumstances, Mode, Order, Reason, ReferenceReport, Sample};
use quatrack::{Command, Output, Tick};

use super::{Flight, MONITOR, age};
use crate::craft::BodyRates;
use crate::playback::Playback;
use crate::vehicle::START_MAX_M;

impl Flight {
    /// One control step at a tick of the board: supervise, do as the supervisor orders, and answer the state if it is
    /// new.
    #[inline]
    pub fn step(&mut self, now: Tick, overrun: bool, rates: BodyRates) {
        self.steps = self.steps.wrapping_add(1);
        let state_tick = self.arrived.as_ref().map_or(now, |arrived| arrived.state.tick);
        let tick = if self.is_lock_step() { state_tick } else { now };
        self.answer.result = self.supervised(now, tick, overrun, rates);
        match &self.answer.result {
            Ok(output) => {
                self.limited = output.limited();
                self.passed = output.command().map_or(Command::ZERO, |step| step.command);
                self.motors.pass(output);
            }
            Err(_) => self.stand_still(),
        }
        (self.answer.tick, self.answer.state_tick) = (now, state_tick);
        if let Some(arrived) = &mut self.arrived {
            self.is_answer_new |= !arrived.answered;
            arrived.answered = true;
        }
    }

    /// The output that passes in this step, or the reason why none does.
    #[inline]
    fn supervised(&mut self, now: Tick, tick: Tick, overrun: bool, rates: BodyRates) -> Result<Output, NoCommand> {
        let is_fresh = self.fresh_state(now).is_some();
        self.motors.look_at(rates);
        // Rates that came with a state are as old as it is.
        let body_rates = self.motors.body_rates(rates, is_fresh);
        let around = Circumstances {
            link_silence_ticks: age(self.heard_at, now),
            asked: Asked::Places,
            reference: if self.playback.is_there() { self.reference } else { ReferenceReport::Missing },
            limited: self.limited,
            levels: body_rates.is_some() && self.motors.can_level(),
            starts_near: self.guard.mode() != Mode::Armed || self.starts_near(now),
            battery_v: Some(self.motors.battery().volts()),
            overrun,
            fault: self.fault,
        };
        let sample = Sample {
            now: tick,
            state: if is_fresh { self.arrived.as_ref().map(|arrived| &arrived.state.state) } else { None },
            body_rates_rad_s: body_rates.as_ref(),
            specific_force_m_s2: None,
            thrust_m_s2: self.laws.thrust_m_s2(),
        };
        let Self { guard, laws, playback, motors, leash, reference, .. } = self;
        let looked = match guard.order((&self.config, &MONITOR), &sample, &around) {
            Order::Fly(looked) => looked,
            // The reference is checked meanwhile: once it is sound again the flight goes on.
            Order::Brake(looked, sample, heading) => {
                *reference = looked_at(playback, tick);
                return laws.brake(&looked, sample, heading).map_err(NoCommand::Step);
            }
            Order::Level(levelled) => {
                *reference = looked_at(playback, tick);
                return laws.level(&levelled).map_err(NoCommand::Step);
            }
            Order::Off => return Err(NoCommand::Mode(guard.mode())),
        };
        let stepped = motors.step(laws, playback, leash, tick, &looked, body_rates.is_some());
        let Err(failure) = stepped else { return stepped };
        let instead = match failure {
            NoCommand::Reference(_) => {
                *reference = ReferenceReport::Bad;
                let brake = guard.reference_failed(tick, MONITOR.tick_s, &around);
                brake.and_then(|(looked, sample, heading)| laws.brake(&looked, sample, heading).ok())
            }
            _ => {
                let levelled = guard.step_failed(tick, MONITOR.tick_s, &around);
                levelled.and_then(|levelled| laws.level(&levelled).ok())
            }
        };
        instead.ok_or(failure)
    }

    /// Whether the reference begins near enough to where the craft is.
    #[cold]
    fn starts_near(&mut self, now: Tick) -> bool {
        let begins_at = self.playback.begins_at_m();
        let (Some(begins_at), Some(state)) = (begins_at, self.fresh_state(now)) else { return true };
        let way = begins_at - state.position_m;
        way.dot(&way) <= START_MAX_M * START_MAX_M
    }

    #[cold]
    fn stand_still(&mut self) {
        self.steps_failed = self.steps_failed.wrapping_add(1);
        self.stop();
    }

    /// A tick without a step. In lock-step, where none comes by itself, it looks at the ages, and stops where they are too high.
    pub fn watch(&mut self, now: Tick, overrun: bool) {
        if !(self.is_lock_step() && self.guard.mode().motors_allowed()) {
            return;
        }
        let is_silent = age(self.heard_at, now).is_none_or(|ticks| ticks > self.config.link_silence_max_ticks);
        let is_old = self.guard.mode().is_in_air() && self.fresh_state(now).is_none();
        let reason = match (overrun && self.config.overruns_tolerated == 0, is_silent, is_old) {
            (true, ..) => Reason::Overrun,
            (_, true, _) => Reason::LinkLost,
            (.., true) => Reason::StateLost,
            _ => return,
        };
        self.guard.stop(reason, now);
        self.stop();
    }
}

/// Whether the reference can be flown.
#[cold]
fn looked_at(playback: &mut Playback, tick: Tick) -> ReferenceReport {
    if playback.reference(tick).is_ok() { ReferenceReport::Sound } else { ReferenceReport::Bad }
}
