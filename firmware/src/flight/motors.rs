//! A flight down to its motors: body rates, and the law's command or the newest state, in; gated motor forces and their
//! answers out.

use quatrack::body_rate::BandwidthError;
use quatrack::link::{ForcesOut, FromBoard, NoCommand};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::Mode;
use quatrack::{MotorForces, RigidState, State, Step, Tick};

use crate::control::ReferenceSource as _;
use crate::craft::BodyRates;
use crate::drivers::battery::CellVoltage;
use crate::motor_control::{MotorControl, STOPPED};
use crate::playback::Playback;

/// What carries the law to the motors, and what comes of it.
pub struct ToMotors {
    control: MotorControl,
    battery: CellVoltage,
    /// The actuator-aware law is flown, straight to the forces.
    is_straight: bool,
    /// Body rates that came with the newest state, rad/s.
    sent_rad_s: Option<Vector3<f32>>,
    /// The forces that pass, N.
    passed_n: MotorForces,
    /// The last step and its result, and whether it is that which answers the state.
    answer: ForcesOut,
    answers: bool,
}

/// What a step is taken on.
pub(super) struct StepInput<'a> {
    /// The board's tick, that of the state, and that of the reference.
    pub(super) now: Tick,
    pub(super) state_tick: Tick,
    pub(super) reference_tick: Tick,
    pub(super) mode: Mode,
    pub(super) rates: BodyRates,
    pub(super) state: Option<&'a State>,
    /// Of the law that gives one.
    pub(super) command: &'a Result<Step, NoCommand>,
}

impl ToMotors {
    /// Motors off.
    pub(super) const fn new() -> Self {
        Self {
            control: MotorControl::new(),
            battery: CellVoltage::NOMINAL,
            is_straight: false,
            sent_rad_s: None,
            passed_n: STOPPED,
            answer: ForcesOut { tick: 0, state_tick: 0, result: Err(NoCommand::NoReference) },
            answers: false,
        }
    }

    /// What the duties are reckoned with.
    pub const fn battery(&self) -> CellVoltage {
        self.battery
    }

    /// Takes a reading of it.
    pub fn set_battery(&mut self, battery: CellVoltage) {
        self.battery = battery;
    }

    /// Bandwidth of the body-rate loop, rad/s.
    pub const fn bandwidth_rad_s(&self) -> [f32; 3] {
        self.control.bandwidth_rad_s()
    }

    /// Sets it.
    ///
    /// # Errors
    /// As [`MotorControl::set_bandwidth`].
    pub fn set_bandwidth(&mut self, bandwidth_rad_s: [f32; 3]) -> Result<(), BandwidthError> {
        self.control.set_bandwidth(bandwidth_rad_s)
    }

    /// The forces that pass, N.
    pub const fn forces_n(&self) -> &MotorForces {
        &self.passed_n
    }

    /// Flies the actuator-aware law from the next step on, if the steps come at its rate; whether it is flown.
    pub(super) fn go_straight(&mut self, is_its_rate: bool) -> bool {
        self.is_straight |= is_its_rate;
        self.is_straight
    }

    /// Flies a law that gives commands.
    pub(super) fn follow_commands(&mut self) {
        self.is_straight = false;
    }

    #[inline]
    pub(super) const fn is_straight(&self) -> bool {
        self.is_straight
    }

    /// Takes what came with a state.
    #[inline]
    pub(super) fn accept(&mut self, body_rates_rad_s: Option<Vector3<f32>>) {
        self.sent_rad_s = body_rates_rad_s;
    }

    /// Before a flight.
    pub(super) fn begin(&mut self) {
        self.control.begin();
    }

    /// Carries the command to the motors, or steps the law that goes there straight, if there are body rates or should be.
    /// The gyroscope's count before those that came with the state.
    #[inline]
    pub(super) fn step(&mut self, input: &StepInput<'_>, playback: &mut Playback) {
        self.answers = self.sent_rad_s.is_some() || input.rates != BodyRates::NoGyroscope;
        if self.answers {
            self.step_on_rates(input, playback);
        }
    }

    #[inline(never)]
    fn step_on_rates(&mut self, input: &StepInput<'_>, playback: &mut Playback) {
        let rates = match input.rates {
            BodyRates::Measured(rates) => Some(rates),
            BodyRates::NoGyroscope => self.sent_rad_s,
            BodyRates::Failed => None,
        };
        let result = match (input.state, rates) {
            _ if !input.mode.motors_allowed() => Err(NoCommand::Mode(input.mode)),
            (None, _) => Err(NoCommand::NoReference),
            (Some(_), None) => Err(NoCommand::NoBodyRates),
            (Some(_), Some(rates)) if !self.is_straight => {
                input.command.and_then(|step| self.control.carry(&step, &rates).map_err(NoCommand::Step))
            }
            (Some(_), _) if !playback.is_there() => Err(NoCommand::NoReference),
            (Some(state), Some(rates)) => {
                let state = RigidState { state: *state, body_rates_rad_s: rates };
                self.control.step(input.reference_tick, &state, playback)
            }
        };
        self.answer = ForcesOut { tick: input.now, state_tick: input.state_tick, result };
    }

    /// Why the step has nothing to pass, if so.
    #[inline]
    pub(super) fn refusal<'a>(&'a self, command: &'a Result<Step, NoCommand>) -> Option<&'a NoCommand> {
        if self.answers { self.answer.result.as_ref().err() } else { command.as_ref().err() }
    }

    /// Passes what the step gave.
    #[inline]
    pub(super) fn pass(&mut self) {
        self.passed_n = match &self.answer.result {
            Ok(step) if self.answers => step.forces_n,
            _ => STOPPED,
        };
    }

    /// Passes nothing.
    #[inline]
    pub(super) fn stop(&mut self) {
        self.passed_n = STOPPED;
    }

    /// Takes back what a step gave in a mode that lets it not pass.
    pub(super) fn withdraw(&mut self, mode: Mode) {
        if self.answer.result.is_ok() {
            self.answer.result = Err(NoCommand::Mode(mode));
        }
    }

    /// The answer, if the state is answered by forces.
    pub(super) fn message(&self) -> Option<FromBoard> {
        self.answers.then_some(FromBoard::Forces(self.answer))
    }
}
