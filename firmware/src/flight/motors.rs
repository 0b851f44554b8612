//! A flight down to its motors: body rates beside the newest state in; gated motor forces out.

use quatrack::link::NoCommand;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::Looked;
use quatrack::{Leash, Measured, MotorForces, Output, Target, Tick};

use crate::craft::BodyRates;
use crate::drivers::battery::CellVoltage;
use crate::laws::{Follow, Laws};
use crate::playback::Playback;
use crate::vehicle::STOPPED;

/// The battery, the body rates that came with the state, and the forces of the last step.
pub struct ToMotors {
    battery: CellVoltage,
    /// Body rates that came with the newest state, rad/s.
    sent_rad_s: Option<Vector3<f32>>,
    /// The forces that pass, N.
    passed_n: MotorForces,
    /// The last step had body rates, or should have had: forces answer the state.
    answers_by_forces: bool,
    /// The board has a gyroscope, in order or not.
    has_gyroscope: bool,
}

impl ToMotors {
    /// Motors off.
    pub(super) const fn new() -> Self {
        Self {
            battery: CellVoltage::NOMINAL,
            sent_rad_s: None,
            passed_n: STOPPED,
            answers_by_forces: false,
            has_gyroscope: false,
        }
    }

    /// The voltage by which forces become duties.
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

    /// Takes the body rates that came with a state.
    #[inline]
    pub(super) fn accept(&mut self, body_rates_rad_s: Option<Vector3<f32>>) {
        self.sent_rad_s = body_rates_rad_s;
    }

    /// Looks at whether there are body rates, or should be: forces then answer the state, or why there are none.
    #[inline]
    pub(super) fn look_at(&mut self, rates: BodyRates) {
        self.has_gyroscope |= rates != BodyRates::NoGyroscope;
        self.answers_by_forces = self.are_driven();
    }

    /// The body rates of a step: the gyroscope's count before those that came with the state. One that has failed gives no
    /// numbers, and neither do those of a state that is too old.
    #[inline]
    pub(super) fn body_rates(&self, rates: BodyRates, is_fresh: bool) -> Option<Vector3<f32>> {
        const NONE: Vector3<f32> = Vector3::new(f32::NAN, f32::NAN, f32::NAN);
        match rates {
            BodyRates::Measured(rates) => Some(rates),
            BodyRates::NoGyroscope if is_fresh => self.sent_rad_s,
            BodyRates::NoGyroscope => self.sent_rad_s.map(|_| NONE),
            BodyRates::Failed => Some(NONE),
        }
    }

    /// Takes the word that the board has a gyroscope.
    pub fn set_gyroscope(&mut self) {
        self.has_gyroscope = true;
    }

    /// Whether steps end in motor forces.
    #[inline]
    pub(super) const fn are_driven(&self) -> bool {
        self.has_gyroscope || self.sent_rad_s.is_some()
    }

    /// There are motors.
    #[inline]
    pub(super) const fn can_level(&self) -> bool {
        true
    }

    /// A step, down to the motors if there are body rates or should be.
    #[inline]
    pub(super) fn step(
        &mut self,
        laws: &mut Laws,
        playback: &mut Playback,
        leash: &Leash,
        tick: Tick,
        looked: &Looked<'_>,
        has_body_rates: bool,
    ) -> Result<Output, NoCommand> {
        let follow = laws.follow();
        if !has_body_rates && (self.answers_by_forces || follow != Follow::References) {
            return Err(NoCommand::NoBodyRates);
        }
        let measured = Measured::new(looked.state);
        let measured = if has_body_rates { measured.with_body_rates(looked.body_rates_rad_s) } else { measured };
        let output = match follow {
            // Looked at where it lies: to move a reference out costs as many instructions as the product with a gain.
            Follow::References => match &mut playback.reference(tick) {
                Ok(reference) => {
                    leash.hold(reference, looked.state);
                    laws.step(measured, Target::new(reference).at(playback.progress()))
                }
                Err(error) => return Err(NoCommand::Reference(*error)),
            },
            Follow::Samples => {
                let (sample, heading) = playback.sample(tick).map_err(NoCommand::Reference)?;
                laws.step(measured, Target::with_sample(&sample, heading))
            }
            Follow::Both => {
                let mut reference = playback.reference(tick).map_err(NoCommand::Reference)?;
                leash.hold(&mut reference, looked.state);
                let (sample, heading) = playback.sample(tick).map_err(NoCommand::Reference)?;
                let target = Target::new(&reference).at(playback.progress());
                laws.step(measured, target.and_sample(&sample, heading))
            }
        };
        let output = output.map_err(NoCommand::Step)?;
        if self.answers_by_forces {
            laws.carry(&output, measured).map(Output::Forces).map_err(NoCommand::Step)
        } else {
            Ok(output)
        }
    }

    /// Passes the output of the step.
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
