//! A flight down to its motors: body rates beside the newest state in; gated motor forces out.

use quatrack::link::NoCommand;
use quatrack::nalgebra::Vector3;
use quatrack::{Heading, Measured, MotorForces, MotorReference, Output, State, StepError, Target, Tick};

use crate::craft::BodyRates;
use crate::drivers::battery::CellVoltage;
use crate::laws::Laws;
use crate::playback::Playback;
use crate::vehicle::STOPPED;

/// What is known of the motors, and what comes of a step for them.
pub struct ToMotors {
    battery: CellVoltage,
    /// Body rates that came with the newest state, rad/s.
    sent_rad_s: Option<Vector3<f32>>,
    /// The forces that pass, N.
    passed_n: MotorForces,
    /// The last step had body rates, or should have had: forces answer the state.
    answers_by_forces: bool,
}

impl ToMotors {
    /// Motors off.
    pub(super) const fn new() -> Self {
        Self { battery: CellVoltage::NOMINAL, sent_rad_s: None, passed_n: STOPPED, answers_by_forces: false }
    }

    /// What the duties are reckoned with.
    pub const fn battery(&self) -> CellVoltage {
        self.battery
    }

    /// Takes a reading of it.
    pub fn set_battery(&mut self, battery: CellVoltage) {
        self.battery = battery;
    }

    /// The forces that pass, N.
    pub const fn forces_n(&self) -> &MotorForces {
        &self.passed_n
    }

    /// Takes what came with a state.
    #[inline]
    pub(super) fn accept(&mut self, body_rates_rad_s: Option<Vector3<f32>>) {
        self.sent_rad_s = body_rates_rad_s;
    }

    /// Looks at whether there are body rates, or should be: forces then answer the state, or why there are none.
    #[inline]
    pub(super) fn look_at(&mut self, rates: BodyRates) {
        self.answers_by_forces = self.sent_rad_s.is_some() || rates != BodyRates::NoGyroscope;
    }

    /// A step, down to the motors if there are body rates or should be. The gyroscope's count before those that came with the
    /// state.
    #[inline]
    pub(super) fn step(
        &mut self,
        laws: &mut Laws,
        playback: &mut Playback,
        tick: Tick,
        state: Option<&State>,
        rates: BodyRates,
    ) -> Result<Output, NoCommand> {
        let Some(state) = state else { return Err(NoCommand::NoReference) };
        let rates = match rates {
            BodyRates::Measured(rates) => Some(rates),
            BodyRates::NoGyroscope => self.sent_rad_s,
            BodyRates::Failed => None,
        };
        let follows_samples = laws.follows_samples();
        if rates.is_none() && (self.answers_by_forces || follows_samples || laws.follows_forces()) {
            return Err(NoCommand::NoBodyRates);
        }
        if !playback.is_there() {
            return Err(NoCommand::NoReference);
        }
        let measured = match &rates {
            Some(rates) => Measured::new(state).with_body_rates(rates),
            None => Measured::new(state),
        };
        let output = if follows_samples {
            let sample = playback.sample(tick);
            let heading = Heading::from_angle(sample.flat.heading_rad);
            if laws.is_changing() {
                // The other law takes a reference, down to the forces of the craft that it reckons with.
                let airframe = laws.airframe().ok_or(NoCommand::Step(StepError::NoActuation))?;
                let reference = MotorReference::from_flat(&sample, airframe).map_err(NoCommand::Reference)?;
                let target = Target::with_forces(&reference).and_sample(&sample, heading);
                laws.step(measured, target.at(playback.progress()))
            } else {
                laws.step(measured, Target::with_sample(&sample, heading))
            }
        } else if laws.follows_forces() {
            let airframe = laws.airframe().ok_or(NoCommand::Step(StepError::NoActuation))?;
            let reference = playback.motor_reference(tick, airframe).map_err(NoCommand::Reference)?;
            laws.step(measured, Target::with_forces(&reference).at(playback.progress()))
        } else {
            // Looked at where it lies: to move a reference out costs as many instructions as the product with a gain.
            match &playback.reference(tick) {
                Ok(reference) => laws.step(measured, Target::new(reference).at(playback.progress())),
                Err(error) => return Err(NoCommand::Reference(*error)),
            }
        };
        let output = output.map_err(NoCommand::Step)?;
        if self.answers_by_forces {
            laws.carry(&output, measured).map(Output::Forces).map_err(NoCommand::Step)
        } else {
            Ok(output)
        }
    }

    /// Passes what the step gave.
    #[inline]
    pub(super) fn pass(&mut self, output: &Output) {
        self.passed_n = match output {
            Output::Forces(step) => step.forces_n,
            Output::Command(_) => STOPPED,
        };
    }

    /// Passes nothing.
    #[inline]
    pub(super) fn stop(&mut self) {
        self.passed_n = STOPPED;
    }

    /// Whether the last step's state is answered by forces.
    #[inline]
    pub(super) const fn answers_by_forces(&self) -> bool {
        self.answers_by_forces
    }
}
