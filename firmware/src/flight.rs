//! The flight: states, orders and ticks in; gated commands, motor forces and answers out. The control interrupt owns all
//! of it.

mod answers;
#[cfg(not(feature = "motors"))]
#[path = "flight/commands_only.rs"]
pub(crate) mod motors;
#[cfg(feature = "motors")]
pub(crate) mod motors;
mod settings;
mod step;

use quatrack::link::{GainStore, NoCommand, RigidStateIn, StateIn};
use quatrack::mixer::MotorLimited;
use quatrack::supervisor::{ArmError, Config, Fault, Guard, Mode, MonitorConfig, Preflight, ReferenceReport};
use quatrack::{Command, Leash, Limits, Rate, RigidState, State, Tick};

use self::answers::Answer;
pub use self::motors::ToMotors;
use self::settings::step_rate;
use crate::laws::Laws;
use crate::playback::{self, Playback};
use crate::vehicle::{AIRFRAME, BODY_RATES_MAX_RAD_S, START_MAX_M};

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

    /// Whether the next step is to be given the craft's own body rates.
    #[inline]
    pub fn takes_body_rates(&self) -> bool {
        !self.is_lock_step() && self.guard.mode().motors_allowed()
    }

    /// Takes a fault: zero from here on, until a restart.
    #[cold]
    pub fn fail(&mut self, fault: Fault, now: Tick) {
        self.fault = Some(fault);
        self.guard.fail(fault, now);
        self.stop();
    }

    /// Nothing passes.
    #[inline]
    fn stop(&mut self) {
        self.passed = Command::ZERO;
        self.motors.stop();
    }
}

/// Ticks since something happened.
#[inline]
fn age(since: Option<Tick>, now: Tick) -> Option<Tick> {
    since.map(|since| now.wrapping_sub(since))
}
