//! The flight: states, orders and ticks in; gated commands, motor forces and answers out. The control interrupt owns all
//! of it.

#[cfg(not(feature = "motors"))]
#[path = "flight/commands_only.rs"]
pub(crate) mod motors;
#[cfg(feature = "motors")]
pub(crate) mod motors;

#[cfg(feature = "motors")]
use quatrack::body_rate::BandwidthError;
use quatrack::command::LimitsError;
use quatrack::gains::table::AcceptedTable;
use quatrack::link::{
    CommandOut, ForcesOut, FromBoard, GainStore, LawChoice, LimitsSetting, NoCommand, RigidStateIn, StateIn,
};
use quatrack::mixer::MotorLimited;
use quatrack::supervisor::{
    ArmError, Asked, Circumstances, Config, Fault, Guard, Mode, MonitorConfig, Order, Preflight, Reason,
    ReferenceReport, Sample,
};
use quatrack::{Command, Leash, Limits, MotorForces, Output, Rate, RigidState, State, Tick};

use crate::craft::BodyRates;
use crate::laws::{FADE_STEPS, Laws, Refused};
use crate::playback::{self, Playback};
use crate::vehicle::{AIRFRAME, BODY_RATES_MAX_RAD_S, START_MAX_M, STOPPED};

pub use self::motors::ToMotors;
pub use crate::rates::{DECIMATION, LOCK_STEP, TICK_RATE, TICK_RATE_HZ};

/// Bounds of a flight unless they are set otherwise: 50 ms without a state, half a second without a frame.
pub const CONFIG: Config = Config::STANDARD;

/// The monitor's limits. After the link is lost the gyroscope carries the attitude on for as long as a descent from a few
/// metres takes.
pub const MONITOR: MonitorConfig = MonitorConfig { attitude_ticks: 15_000, ..MonitorConfig::STANDARD };

/// The newest state and when it came.
struct Arrived {
    state: StateIn,
    at: Tick,
    answered: bool,
}

/// A step and its result.
struct Answer {
    tick: Tick,
    state_tick: Tick,
    result: Result<Output, NoCommand>,
}

/// Memory for uploads, too large for the stack at start-up; all zeros, so that a static costs no flash.
pub struct Store {
    trajectories: playback::Store,
    gains: GainStore,
}

impl Store {
    /// Nothing.
    pub const fn new() -> Self {
        Self { trajectories: playback::Store::new(), gains: GainStore::unassigned() }
    }
}

impl Default for Store {
    fn default() -> Self {
        Self::new()
    }
}

/// Everything between the link and the motors. The fields that every step looks at come first, within the reach of a load.
#[repr(C)]
pub struct Flight {
    guard: Guard,
    arrived: Option<Arrived>,
    heard_at: Option<Tick>,
    decimation: u32,
    /// The result of the last check of the reference.
    reference: ReferenceReport,
    limited: MotorLimited,
    fault: Option<Fault>,
    /// The bounds of a flight.
    pub config: Config,
    /// Farthest error that the laws of references act on.
    pub leash: Leash,
    /// Battery, body rates and forces of the motors.
    pub motors: ToMotors,
    /// The command that passes.
    passed: Command,
    /// The last step and its result, kept in place: it is as large as a command may be.
    answer: Answer,
    is_answer_new: bool,
    steps: u32,
    steps_failed: u32,
    laws: Laws,
    /// The reference's source.
    pub playback: Playback,
}

impl Flight {
    /// Disarmed, nothing to follow; faulted where the board restarted because of a fault.
    #[cold]
    pub fn new(store: &'static mut Store, fault: Option<Fault>) -> Self {
        let limits = Limits::of(&AIRFRAME, BODY_RATES_MAX_RAD_S);
        Self {
            laws: Laws::new(&mut store.gains, limits, step_rate(DECIMATION)),
            arrived: None,
            heard_at: None,
            playback: Playback::new(&mut store.trajectories),
            config: CONFIG,
            leash: Leash::STANDARD,
            guard: fault.map_or(Guard::new(), Guard::faulted),
            decimation: DECIMATION,
            reference: ReferenceReport::Sound,
            limited: MotorLimited::NOTHING,
            fault,
            motors: ToMotors::new(),
            passed: Command::ZERO,
            answer: Answer { tick: 0, state_tick: 0, result: Err(NoCommand::NoReference) },
            is_answer_new: false,
            steps: 0,
            steps_failed: 0,
        }
    }

    /// Takes the word that a frame was accepted.
    pub fn hear(&mut self, now: Tick) {
        self.heard_at = Some(now);
    }

    /// Whether no frame has come for longer than a flight tolerates; not before the first one.
    pub fn is_link_silent(&self, now: Tick) -> bool {
        age(self.heard_at, now).is_some_and(|ticks| ticks > self.config.link_silence_max_ticks)
    }

    /// Takes a state. In lock-step it is to be stepped on at once.
    pub fn accept(&mut self, state: StateIn, now: Tick) {
        self.motors.accept(None);
        self.arrived = Some(Arrived { state, at: now, answered: false });
    }

    /// The same with body rates.
    pub fn accept_rigid(&mut self, state: RigidStateIn, now: Tick) {
        let RigidStateIn { tick, state: RigidState { state, body_rates_rad_s } } = state;
        self.accept(StateIn { tick, state }, now);
        self.motors.accept(Some(body_rates_rad_s));
    }

    /// Whether a state waits for its step.
    pub fn is_waiting(&self) -> bool {
        self.arrived.as_ref().is_some_and(|arrived| !arrived.answered)
    }

    /// Whether steps are taken when states come.
    pub fn is_lock_step(&self) -> bool {
        self.decimation == LOCK_STEP
    }

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
    /// As [`Laws::select`].
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
    /// As [`Laws::load`].
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
    /// As [`Limits::new`]; the ones in force stay.
    #[cold]
    pub fn set_limits(&mut self, limits: LimitsSetting) -> Result<(), LimitsError> {
        self.laws.set_limits(limits.check()?);
        Ok(())
    }

    /// Takes an arm request. In lock-step, where no motor turns, only faults and the link are looked at.
    ///
    /// # Errors
    /// [`ArmError`]: why the craft is not to take off.
    #[cold]
    pub fn arm(&mut self, now: Tick) -> Result<(), ArmError> {
        // Asked again in flight, nothing changes.
        if self.mode().motors_allowed() {
            return Ok(());
        }
        self.laws.choose_default(self.motors.are_driven());
        let link_silence_ticks = age(self.heard_at, now);
        let Config { link_silence_max_ticks, state_age_max_ticks, .. } = self.config;
        let preflight = Preflight {
            fault: self.fault,
            link_silence_ticks,
            tolerated_ticks: [link_silence_max_ticks, state_age_max_ticks],
            state: self.fresh_state(now).copied(),
            reference_m: self.playback.begins_at_m(),
            start_max_m: START_MAX_M,
            law: self.laws.covers(self.motors.are_driven()),
            lag_s: AIRFRAME.figures().motor_lag_s,
            mass_kg: AIRFRAME.figures().mass_kg,
            rate_hz: step_rate(self.decimation).map_or(0, Rate::hz),
            limits: *self.laws.limits(),
            battery_v: self.motors.battery().volts(),
        };
        if self.is_lock_step() { preflight.check_link() } else { preflight.check() }?;
        self.laws.begin();
        (self.reference, self.limited) = (ReferenceReport::Sound, MotorLimited::NOTHING);
        self.guard.arm(now);
        Ok(())
    }

    /// Takes a disarm request.
    pub fn disarm(&mut self) {
        self.guard.disarm(0);
        self.stop();
    }

    /// The supervisor's mode.
    pub fn mode(&self) -> Mode {
        self.guard.mode()
    }

    /// The newest state, if it is not too old.
    #[inline]
    fn fresh_state(&self, now: Tick) -> Option<&State> {
        let arrived = self.arrived.as_ref()?;
        let is_fresh = now.wrapping_sub(arrived.at) <= self.config.state_age_max_ticks;
        is_fresh.then_some(&arrived.state.state)
    }

    /// The command that passes; zero under a law that gives none.
    pub fn command(&self) -> &Command {
        &self.passed
    }

    /// The motor forces that pass, N.
    pub fn forces_n(&self) -> &MotorForces {
        self.motors.forces_n()
    }

    /// Those that motors are to be driven to: none in lock-step, where it is not this craft that flies.
    #[inline]
    pub fn driven_forces_n(&self) -> &MotorForces {
        if self.is_lock_step() { &STOPPED } else { self.motors.forces_n() }
    }

    /// Whether the next step is to be given the craft's own body rates.
    #[inline]
    pub fn takes_body_rates(&self) -> bool {
        !self.is_lock_step() && self.guard.mode().motors_allowed()
    }

    /// The answer to the last state, once.
    pub fn take_message(&mut self) -> Option<FromBoard> {
        let is_new = core::mem::take(&mut self.is_answer_new);
        is_new.then(|| self.message())
    }

    fn message(&self) -> FromBoard {
        let Answer { tick, state_tick, result } = &self.answer;
        let (tick, state_tick) = (*tick, *state_tick);
        match result {
            Ok(Output::Command(step)) => FromBoard::Command(CommandOut { tick, state_tick, result: Ok(*step) }),
            Ok(Output::Forces(step)) => FromBoard::Forces(ForcesOut { tick, state_tick, result: Ok(*step) }),
            Err(reason) if self.motors.answers_by_forces() => {
                FromBoard::Forces(ForcesOut { tick, state_tick, result: Err(*reason) })
            }
            Err(reason) => FromBoard::Command(CommandOut { tick, state_tick, result: Err(*reason) }),
        }
    }

    /// The same, if it is a command.
    pub fn take_answer(&mut self) -> Option<CommandOut> {
        match self.take_message()? {
            FromBoard::Command(command) => Some(command),
            _ => None,
        }
    }

    /// Steps taken, and those without a command.
    pub fn steps(&self) -> (u32, u32) {
        (self.steps, self.steps_failed)
    }

    /// Takes a fault: zero from here on, until a restart.
    #[cold]
    pub fn fail(&mut self, fault: Fault, now: Tick) {
        self.fault = Some(fault);
        self.guard.fail(fault, now);
        self.stop();
    }

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
        let stepped = motors.step(laws, (playback, leash), tick, &looked, body_rates.is_some());
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

    /// Nothing passes.
    #[inline]
    fn stop(&mut self) {
        self.passed = Command::ZERO;
        self.motors.stop();
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

/// The rate of the steps at so many ticks each, if it is a whole number of Hz.
fn step_rate(decimation: u32) -> Option<Rate> {
    let ticks = if decimation == LOCK_STEP { DECIMATION } else { decimation };
    if TICK_RATE_HZ.is_multiple_of(ticks) { Rate::from_hz(TICK_RATE_HZ.checked_div(ticks)?) } else { None }
}

/// Ticks since something happened.
#[inline]
fn age(since: Option<Tick>, now: Tick) -> Option<Tick> {
    since.map(|since| now.wrapping_sub(since))
}
