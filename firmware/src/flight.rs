//! The flight: states, orders and ticks in; gated commands, motor forces and answers out. What the control interrupt owns.

use quatrack::command::LimitsError;
use quatrack::gains::paper;
use quatrack::link::{
    CommandOut, ForcesOut, FromBoard, LawChoice, LimitsSetting, NoCommand, RigidStateIn, StateIn, Table,
};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{ArmError, Conditions, Config, Fault, Mode, StepReport, Supervisor, Verdict};
use quatrack::{Command, Equilibrium, Limits, MotorForces, Rate, RigidState, State, Tick, Tracker};

use crate::control::{self, Clock, CommandSink, StateSource};
use crate::craft::BodyRates;
use crate::drivers::battery::CellVoltage;
use crate::motor_control::{MotorControl, STOPPED};
use crate::playback::{Playback, Store};

mod motors;

/// Ticks of the loop a second.
pub const TICK_RATE_HZ: u32 = 1000;

/// The same as a rate.
pub const TICK_RATE: Rate = match Rate::from_hz(TICK_RATE_HZ) {
    Some(rate) => rate,
    None => panic!("the core does not tick at this rate"),
};

/// Ticks for one control step unless it is set otherwise: 500 Hz.
pub const DECIMATION: u32 = 2;

/// Decimation at which the steps are taken when states come, on the clock of the states: lock-step with a simulation.
pub const LOCK_STEP: u32 = 0;

/// Bounds of a flight unless they are set otherwise: 50 ms without a state, half a second without a frame.
pub const CONFIG: Config = Config { state_age_max_ticks: 50, link_silence_max_ticks: 500, overruns_tolerated: 2 };

/// Crazyflie 2.1: four motors from 0.012818 to 0.12 N at 0.029 kg, and what its rate loop follows.
const LIMITS: LimitsSetting =
    LimitsSetting { thrust_min_m_s2: 1.768, thrust_max_m_s2: 16.55, body_rates_max_rad_s: [20.0, 20.0, 10.0] };

/// What passes: the command of a law that gives one, and the forces of the motors where body rates are known.
struct Passed {
    command: Command,
    forces_n: MotorForces,
}

impl Passed {
    /// Motors off.
    const NOTHING: Self = Self { command: Command::ZERO, forces_n: STOPPED };
}

impl CommandSink for Passed {
    #[inline]
    fn put(&mut self, command: &Command) {
        self.command = *command;
    }
}

/// The newest state and when it came.
struct Arrived {
    state: StateIn,
    body_rates_rad_s: Option<Vector3<f32>>,
    at: Tick,
    answered: bool,
}

impl Arrived {
    #[inline]
    fn has_body_rates(&self) -> bool {
        self.body_rates_rad_s.is_some()
    }
}

/// The newest state, for the step.
struct Newest<'a>(Option<&'a Arrived>);

impl StateSource for Newest<'_> {
    #[inline]
    fn newest(&self) -> Option<&State> {
        self.0.map(|arrived| &arrived.state.state)
    }
}

/// The clock of a step: the board's own, or that of the states in lock-step.
struct StepClock(Tick);

impl Clock for StepClock {
    #[inline]
    fn now(&self) -> Tick {
        self.0
    }
}

/// Everything between the link and the motors.
pub struct Flight {
    law: LawChoice,
    /// The actuator-aware law is flown, not the one above.
    is_straight: bool,
    limits: LimitsSetting,
    checked_limits: Limits,
    tracker: Tracker<'static>,
    arrived: Option<Arrived>,
    heard_at: Option<Tick>,
    /// What is followed.
    pub playback: Playback,
    /// The bounds of a flight.
    pub config: Config,
    /// What the motors' duties are reckoned with.
    pub battery: CellVoltage,
    /// What carries the law to the motors.
    pub motors: MotorControl,
    supervisor: Supervisor,
    decimation: u32,
    last_report: StepReport,
    fault: Option<Fault>,
    passed: Passed,
    /// The last step and its result, kept in place: it is as large as a command may be.
    answer: CommandOut,
    /// The same for the motors, and whether it is that which answers.
    forces: ForcesOut,
    answers_forces: bool,
    is_answer_new: bool,
    steps: u32,
    steps_failed: u32,
}

impl Flight {
    /// Disarmed, nothing to follow; faulted where the board restarted because of a fault.
    #[cold]
    pub fn new(store: &'static mut Store, fault: Option<Fault>) -> Self {
        let checked_limits = LIMITS.check().unwrap_or(Limits::NONE);
        let mut flight = Self {
            law: LawChoice::new(Table::LqrE),
            is_straight: false,
            limits: LIMITS,
            checked_limits,
            tracker: Tracker::new(Equilibrium::new(&paper::LQR_E), checked_limits),
            arrived: None,
            heard_at: None,
            playback: Playback::new(store),
            config: CONFIG,
            supervisor: Supervisor::new(),
            decimation: DECIMATION,
            last_report: StepReport::NoReference,
            fault,
            battery: CellVoltage::NOMINAL,
            motors: MotorControl::new(),
            passed: Passed::NOTHING,
            answer: CommandOut { tick: 0, state_tick: 0, result: Err(NoCommand::NoReference) },
            forces: ForcesOut { tick: 0, state_tick: 0, result: Err(NoCommand::NoReference) },
            answers_forces: false,
            is_answer_new: false,
            steps: 0,
            steps_failed: 0,
        };
        flight.supervise(0, StepReport::NoReference, false);
        flight
    }

    /// Takes the word that a frame was accepted.
    pub fn hear(&mut self, now: Tick) {
        self.heard_at = Some(now);
    }

    /// Takes a state. In lock-step it is to be stepped on at once.
    pub fn accept(&mut self, state: StateIn, now: Tick) {
        self.arrived = Some(Arrived { state, body_rates_rad_s: None, at: now, answered: false });
    }

    /// The same with body rates.
    pub fn accept_rigid(&mut self, state: RigidStateIn, now: Tick) {
        let RigidStateIn { tick, state: RigidState { state, body_rates_rad_s } } = state;
        let state = StateIn { tick, state };
        self.arrived = Some(Arrived { state, body_rates_rad_s: Some(body_rates_rad_s), at: now, answered: false });
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

    /// Sets the ticks for one step; whether the law in force can be flown so: the actuator-aware one has its own rate.
    pub fn set_decimation(&mut self, decimation: u32) -> bool {
        let fits = !self.is_straight || is_design_rate(decimation);
        if fits {
            self.decimation = decimation;
        }
        fits
    }

    /// The law in force.
    pub fn law(&self) -> LawChoice {
        if self.is_straight { LawChoice::new(Table::ActuatorAware) } else { self.law }
    }

    /// Chooses a law; whether its table is on board.
    #[cold]
    pub fn select(&mut self, law: LawChoice) -> bool {
        if law.table == Table::ActuatorAware {
            self.is_straight |= is_design_rate(self.decimation);
            return self.is_straight;
        }
        let Some(built_in) = law.built_in() else { return false };
        (self.law, self.tracker, self.is_straight) = (law, Tracker::new(built_in, self.checked_limits), false);
        true
    }

    /// The limits in force.
    pub fn limits(&self) -> LimitsSetting {
        self.limits
    }

    /// Sets the limits.
    ///
    /// # Errors
    /// As [`Limits::new`]; the ones in force stay.
    #[cold]
    pub fn set_limits(&mut self, limits: LimitsSetting) -> Result<(), LimitsError> {
        (self.checked_limits, self.limits) = (limits.check()?, limits);
        if let Some(built_in) = self.law.built_in() {
            self.tracker = Tracker::new(built_in, self.checked_limits);
        }
        Ok(())
    }

    /// Takes an arm request.
    ///
    /// # Errors
    /// As [`Supervisor::arm`].
    #[cold]
    pub fn arm(&mut self, now: Tick) -> Result<(), ArmError> {
        self.last_report = StepReport::NoReference;
        if !self.supervisor.mode().motors_allowed() {
            self.motors.begin();
        }
        self.supervisor.arm(&self.config, age(self.heard_at, now))
    }

    /// Takes a disarm request.
    pub fn disarm(&mut self) {
        self.supervisor.disarm();
        self.passed = Passed::NOTHING;
    }

    /// The supervisor's mode.
    pub fn mode(&self) -> Mode {
        self.supervisor.mode()
    }

    /// The command that passes; zero under a law that gives none.
    pub fn command(&self) -> &Command {
        &self.passed.command
    }

    /// The motor forces that pass, N.
    pub fn forces_n(&self) -> &MotorForces {
        &self.passed.forces_n
    }

    /// Those that motors are to be driven to: none in lock-step, where it is not this craft that flies.
    #[inline]
    pub fn driven_forces_n(&self) -> &MotorForces {
        if self.is_lock_step() { &STOPPED } else { &self.passed.forces_n }
    }

    /// Whether the next step is to be given the craft's own body rates.
    #[inline]
    pub fn takes_body_rates(&self) -> bool {
        !self.is_lock_step() && self.supervisor.mode().motors_allowed()
    }

    /// The answer to the last state, once.
    pub fn take_message(&mut self) -> Option<FromBoard> {
        let is_new = core::mem::take(&mut self.is_answer_new);
        is_new.then(
            || {
                if self.answers_forces { FromBoard::Forces(self.forces) } else { FromBoard::Command(self.answer) }
            },
        )
    }

    /// The same, if it is a command.
    pub fn take_answer(&mut self) -> Option<CommandOut> {
        let is_new = core::mem::take(&mut self.is_answer_new);
        (is_new && !self.answers_forces).then_some(self.answer)
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
        self.passed = Passed::NOTHING;
    }

    /// One control step at a tick of the board: step, supervise, gate, and answer the state if it is new.
    #[inline]
    pub fn step(&mut self, now: Tick, overrun: bool, rates: BodyRates) {
        self.steps = self.steps.wrapping_add(1);
        let state_tick = self.arrived.as_ref().map_or(now, |arrived| arrived.state.tick);
        let clock = StepClock(if self.is_lock_step() { state_tick } else { now });
        let is_allowed = self.supervisor.mode().motors_allowed();
        self.answer.result = if !is_allowed {
            Err(NoCommand::Mode(self.supervisor.mode()))
        } else if self.is_straight {
            Err(if self.arrived.is_some() { NoCommand::NoBodyRates } else { NoCommand::NoReference })
        } else {
            control::step(&clock, &Newest(self.arrived.as_ref()), &mut self.playback, &self.tracker)
        };
        self.answers_forces = false;
        let has_rates = rates != BodyRates::NoGyroscope || self.arrived.as_ref().is_some_and(Arrived::has_body_rates);
        if has_rates {
            self.step_motors(&clock, rates);
            (self.forces.tick, self.forces.state_tick) = (now, state_tick);
        }
        let report = match self.outcome() {
            None => StepReport::Command,
            Some(NoCommand::NoReference | NoCommand::Mode(_)) => StepReport::NoReference,
            Some(NoCommand::Reference(_) | NoCommand::Step(_) | NoCommand::NoBodyRates) => StepReport::Failed,
        };
        let verdict = self.supervise(now, report, overrun);
        if verdict.mode.command_passes() && report == StepReport::Command {
            self.pass();
        } else {
            self.stand_still(verdict.mode);
        }
        (self.answer.tick, self.answer.state_tick) = (now, state_tick);
        if let Some(arrived) = &mut self.arrived {
            self.is_answer_new |= !arrived.answered;
            arrived.answered = true;
        }
    }

    /// Why the step has nothing to pass, if so.
    #[inline]
    fn outcome(&self) -> Option<&NoCommand> {
        if self.answers_forces { self.forces.result.as_ref().err() } else { self.answer.result.as_ref().err() }
    }

    #[inline]
    fn pass(&mut self) {
        match &self.answer.result {
            Ok(step) => self.passed.put(&step.command),
            Err(_) => self.passed.put(&Command::ZERO),
        }
        self.passed.forces_n = match &self.forces.result {
            Ok(step) if self.answers_forces => step.forces_n,
            _ => STOPPED,
        };
    }

    #[cold]
    fn stand_still(&mut self, mode: Mode) {
        if self.answer.result.is_ok() {
            self.answer.result = Err(NoCommand::Mode(mode));
        }
        if self.forces.result.is_ok() {
            self.forces.result = Err(NoCommand::Mode(mode));
        }
        self.steps_failed = self.steps_failed.wrapping_add(1);
        self.passed = Passed::NOTHING;
    }

    /// A tick without a step: looks at the ages, and stops the motors where they are too high.
    pub fn watch(&mut self, now: Tick, overrun: bool) {
        if !self.supervise(now, self.last_report, overrun).mode.command_passes() {
            self.passed = Passed::NOTHING;
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

/// Whether the actuator-aware table is made for the rate: its own, or that of the states, which it is flown at in
/// lock-step.
const fn is_design_rate(decimation: u32) -> bool {
    decimation == DECIMATION || decimation == LOCK_STEP
}

/// Ticks since something happened.
#[inline]
fn age(since: Option<Tick>, now: Tick) -> Option<Tick> {
    since.map(|since| now.wrapping_sub(since))
}
