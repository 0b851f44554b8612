//! From a law to the motors: a step of one of the paper's laws, or a state and a reference, with body rates in; four motor
//! forces within their range out. The paper's laws go through the body-rate loop and the mixer, the actuator-aware one
//! straight to the forces.

use quatrack::body_rate::BandwidthError;
use quatrack::error::Field;
use quatrack::link::NoCommand;
use quatrack::nalgebra::Vector3;
use quatrack::{
    ActuatorAware, ActuatorMemory, Airframe, BodyRateLoop, MotorForces, MotorLag, MotorLaw, MotorLimited,
    MotorReference, MotorStep, MotorTracker, Rate, ReferenceError, RigidState, StateError, Step, StepError, Tick,
};

use crate::rates::{DECIMATION, TICK_RATE_HZ};

/// The table in the image.
pub mod table {
    include!("../../gains/generated/actuator-aware.rs");
}

/// The craft.
pub const AIRFRAME: Airframe = Airframe::CRAZYFLIE_2_1;

/// Forces that stop the motors.
pub const STOPPED: MotorForces = [0.0; 4];

/// Control steps a second that the actuator-aware table is made for.
const RATE: Rate = match Rate::from_hz(TICK_RATE_HZ / DECIMATION) {
    Some(rate) => rate,
    None => panic!("the core does not step at this rate"),
};

const LAG: MotorLag = match MotorLag::new(AIRFRAME.figures().motor_lag_s, RATE) {
    Ok(lag) => lag,
    Err(_) => panic!("the motors are too fast for this rate"),
};

static ACTUATOR_AWARE: MotorTracker<'static> = MotorTracker::new(
    match ActuatorAware::new(&table::ACTUATOR_AWARE, &AIRFRAME, RATE) {
        Ok(law) => MotorLaw::ActuatorAware(law),
        Err(_) => panic!("the motors are too fast for this rate"),
    },
    &AIRFRAME,
);

/// Where references come from that reach to the motors: a stored trajectory, or a link.
pub trait MotorReferenceSource {
    /// The reference at a tick, for a craft.
    ///
    /// # Errors
    /// [`ReferenceError`] where it cannot be flown.
    fn motor_reference(&mut self, now: Tick, airframe: &Airframe) -> Result<MotorReference, ReferenceError>;
}

/// What carries a law to the motors, and what it remembers of them.
pub struct MotorControl {
    bandwidth_rad_s: [f32; 3],
    body_rates: BodyRateLoop,
    memory: ActuatorMemory,
}

impl MotorControl {
    /// Motors that stand still, and the body-rate loop that fits their lag.
    pub const fn new() -> Self {
        let bandwidth_rad_s = [0.5 / AIRFRAME.figures().motor_lag_s; 3];
        Self { bandwidth_rad_s, body_rates: BodyRateLoop::behind_lag(&AIRFRAME), memory: ActuatorMemory::at_rest() }
    }

    /// Before a flight: the motors have been off.
    pub const fn begin(&mut self) {
        self.memory = ActuatorMemory::at_rest();
    }

    /// Bandwidth of the body-rate loop, rad/s.
    pub const fn bandwidth_rad_s(&self) -> [f32; 3] {
        self.bandwidth_rad_s
    }

    /// Sets it.
    ///
    /// # Errors
    /// As [`BodyRateLoop::new`]; what was set stays.
    #[cold]
    pub fn set_bandwidth(&mut self, bandwidth_rad_s: [f32; 3]) -> Result<(), BandwidthError> {
        (self.body_rates, self.bandwidth_rad_s) = (BodyRateLoop::new(&AIRFRAME, bandwidth_rad_s)?, bandwidth_rad_s);
        Ok(())
    }

    /// Carries what a law of thrust and body rates asks for to the motors.
    ///
    /// # Errors
    /// [`StepError`] for measured body rates that are no numbers, or beyond all that is flown.
    #[inline(never)]
    pub fn carry(&mut self, step: &Step, measured_rad_s: &Vector3<f32>) -> Result<MotorStep, StepError> {
        let wrench = self.body_rates.wrench(&step.command, measured_rad_s);
        let Some((forces_n, limited)) = AIRFRAME.mix(&wrench) else { return Err(refused(measured_rad_s)) };
        // For the actuator-aware law, should it take over; what it had integrated is out of date by then.
        if let Some(memory) = ActuatorMemory::new(LAG.next(&self.memory.forces_n(), &forces_n)) {
            self.memory = memory;
        }
        let limited = MotorLimited::from_bits(limited.bits() | u16::from(step.limited.bits()) << 8);
        Ok(MotorStep { forces_n, limited })
    }

    /// One step of the actuator-aware law.
    ///
    /// # Errors
    /// [`NoCommand`] where the reference or the state cannot be flown on.
    #[inline(never)]
    pub fn step(
        &mut self,
        now: Tick,
        state: &RigidState,
        references: &mut impl MotorReferenceSource,
    ) -> Result<MotorStep, NoCommand> {
        let reference = references.motor_reference(now, &AIRFRAME).map_err(NoCommand::Reference)?;
        ACTUATOR_AWARE.step(&mut self.memory, state, &reference).map_err(NoCommand::Step)
    }
}

impl Default for MotorControl {
    fn default() -> Self {
        Self::new()
    }
}

#[cold]
fn refused(measured_rad_s: &Vector3<f32>) -> StepError {
    match measured_rad_s.iter().find(|rate| !rate.is_finite()) {
        Some(value) => StepError::State(StateError::NonFinite { field: Field::BodyRates, value: *value }),
        None => StepError::Singular,
    }
}
