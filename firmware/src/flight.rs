//! The flight: states, orders and ticks in; gated commands, motor forces and answers out. What the control interrupt owns.

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
use quatrack::supervisor::{ArmError, Conditions, Config, Fault, Mode, StepReport, Supervisor, Verdict};
use quatrack::{Command, Limits, MotorForces, Output, Rate, RigidState, Tick};

use crate::craft::BodyRates;
use crate::laws::{FADE_STEPS, Laws, Refused};
use crate::playback::{self, Playback};
use crate::vehicle::{AIRFRAME, BODY_RATES_MAX_RAD_S, STOPPED};

pub use self::motors::ToMotors;
#[cfg(feature = "motors")]
pub use crate::laws::table;
pub use crate::rates::{DECIMATION, LOCK_STEP, TICK_RATE, TICK_RATE_HZ};

/// Bounds of a flight unless they are set otherwise: 50 ms without a state, half a second without a frame.
pub const CONFIG: Config = Config { state_age_max_ticks: 50, link_silence_max_ticks: 500, overruns_tolerated: 2 };

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

/// What is uploaded, too large for the stack on which everything begins; all zeros, so that a static costs no flash.
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

/// Everything between the link and the motors.
pub struct Flight {
    laws: Laws,
    arrived: Option<Arrived>,
    heard_at: Option<Tick>,
    /// What is followed.
    pub playback: Playback,
    /// The bounds of a flight.
    pub config: Config,
    /// What is known of the motors.
    pub motors: ToMotors,
    supervisor: Supervisor,
    decimation: u32,
    last_report: StepReport,
    fault: Option<Fault>,
    /// The command that passes.
    passed: Command,
    /// The last step and its result, kept in place: it is as large as a command may be.
    answer: Answer,
    is_answer_new: bool,
    steps: u32,
    steps_failed: u32,
}

impl Flight {
    /// Disarmed, nothing to follow; faulted where the board restarted because of a fault.
    #[cold]
    pub fn new(store: &'static mut Store, fault: Option<Fault>) -> Self {
        let limits = Limits::of(&AIRFRAME, BODY_RATES_MAX_RAD_S);
        let mut supervisor = Supervisor::new();
        let step = StepReport::NoReference;
        let at_start = Conditions { link_silence_ticks: None, state_age_ticks: None, step, overrun: false, fault };
        supervisor.tick(&CONFIG, &at_start);
        Self {
            laws: Laws::new(&mut store.gains, limits, step_rate(DECIMATION)),
            arrived: None,
            heard_at: None,
            playback: Playback::new(&mut store.trajectories),
            config: CONFIG,
            supervisor,
            decimation: DECIMATION,
            last_report: StepReport::NoReference,
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

    /// Sets the ticks for one step. Gain tables for another rate are dropped, that for motor forces in the image too.
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
    /// As [`quatrack::BodyRateLoop::new`]; what was set stays.
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

    /// Takes an arm request.
    ///
    /// # Errors
    /// As [`Supervisor::arm`].
    #[cold]
    pub fn arm(&mut self, now: Tick) -> Result<(), ArmError> {
        self.last_report = StepReport::NoReference;
        // Asked again in flight, nothing changes.
        if !self.mode().motors_allowed() {
            self.laws.begin();
        }
        self.supervisor.arm(&self.config, age(self.heard_at, now))
    }

    /// Takes a disarm request.
    pub fn disarm(&mut self) {
        self.supervisor.disarm();
        self.stop();
    }

    /// The supervisor's mode.
    pub fn mode(&self) -> Mode {
        self.supervisor.mode()
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
        !self.is_lock_step() && self.supervisor.mode().motors_allowed()
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
        self.supervise(now, StepReport::Failed, false);
        self.stop();
    }

    /// One control step at a tick of the board: step, supervise, gate, and answer the state if it is new.
    #[inline]
    pub fn step(&mut self, now: Tick, overrun: bool, rates: BodyRates) {
        self.steps = self.steps.wrapping_add(1);
        let state_tick = self.arrived.as_ref().map_or(now, |arrived| arrived.state.tick);
        let tick = if self.is_lock_step() { state_tick } else { now };
        self.motors.look_at(rates);
        self.answer.result = if self.supervisor.mode().motors_allowed() {
            let state = self.arrived.as_ref().map(|arrived| &arrived.state.state);
            self.motors.step(&mut self.laws, &mut self.playback, tick, state, rates)
        } else {
            Err(NoCommand::Mode(self.supervisor.mode()))
        };
        let report = match &self.answer.result {
            Ok(_) => StepReport::Command,
            Err(NoCommand::NoReference | NoCommand::Mode(_)) => StepReport::NoReference,
            Err(NoCommand::Reference(_) | NoCommand::Step(_) | NoCommand::NoBodyRates) => StepReport::Failed,
        };
        let verdict = self.supervise(now, report, overrun);
        match &self.answer.result {
            Ok(output) if verdict.mode.command_passes() => {
                self.passed = output.command().map_or(Command::ZERO, |step| step.command);
                self.motors.pass(output);
            }
            _ => self.stand_still(verdict.mode),
        }
        (self.answer.tick, self.answer.state_tick) = (now, state_tick);
        if let Some(arrived) = &mut self.arrived {
            self.is_answer_new |= !arrived.answered;
            arrived.answered = true;
        }
    }

    #[cold]
    fn stand_still(&mut self, mode: Mode) {
        if self.answer.result.is_ok() {
            self.answer.result = Err(NoCommand::Mode(mode));
        }
        self.steps_failed = self.steps_failed.wrapping_add(1);
        self.stop();
    }

    /// Nothing passes.
    #[inline]
    fn stop(&mut self) {
        self.passed = Command::ZERO;
        self.motors.stop();
    }

    /// A tick without a step: looks at the ages, and stops the motors where they are too high.
    pub fn watch(&mut self, now: Tick, overrun: bool) {
        if !self.supervise(now, self.last_report, overrun).mode.command_passes() {
            self.stop();
        }
    }

    #[inline]
    fn supervise(&mut self, now: Tick, step: StepReport, overrun: bool) -> Verdict {
        self.last_report = step;
        let conditions = Conditions {
            link_silence_ticks: age(self.heard_at, now),
            state_age_ticks: age(self.arrived.as_ref().map(|arrived| arrived.at), now),
            step,
            overrun,
            fault: self.fault,
        };
        self.supervisor.tick(&self.config, &conditions)
    }
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
