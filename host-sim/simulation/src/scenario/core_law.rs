//! The core's controller as a law: the paper's laws behind its body-rate loop, and the actuator-aware one, at 500 Hz for any
//! vehicle.

use std::sync::Arc;

use nalgebra::{Vector3, Vector4};
use pulp::{Arch, Simd, WithSimd};
use quatrack::airframe::AirframeFigures;
use quatrack::law::{ActuatorAwareGain, EquilibriumGain, FlatOutputGain};
use quatrack::{
    Actuation, ActuatorAware, Airframe, Controller, Equilibrium, FeedForward, FlatOutput, Limits, Memory,
    MotorReference, Output, Rate, ReferenceError, State,
};
use quatrack_design::design::actuator_aware::{ActuatorAwareWeights, actuator_aware};
use quatrack_design::vehicle::Vehicle;

use super::told::ToldFigures;
use super::track::Track;
use crate::control_law::{ControlLaw, Estimate, Input, Setpoint};
use crate::flight::motor_laws::{FlightError, default_lag_s};
use crate::flight::motor_loop::{self, PERIOD_S, RATE};
use crate::vehicles;

/// A law with its gain.
#[derive(Clone)]
pub(super) enum Gain {
    /// Designed for the vehicle.
    ActuatorAware(Box<ActuatorAwareGain>),
    /// The paper's.
    Equilibrium(&'static EquilibriumGain),
    /// Likewise.
    FlatOutput(&'static FlatOutputGain),
}

/// A law of the core on a vehicle's motors, fed forward.
#[derive(Clone)]
pub(super) struct CoreLaw {
    gain: Gain,
    actuation: Actuation,
    limits: Limits,
    memory: Memory,
    beyond_jerk: BeyondJerk,
    arch: Arch,
    /// The reference of every step, where the course is known before.
    shared: Option<Arc<[Result<MotorReference, ReferenceError>]>>,
}

/// Snap and crackle of setpoints that end with the jerk, by differences.
#[derive(Clone, Copy, Default)]
pub(super) struct BeyondJerk {
    newest: Option<Setpoint>,
    snap_m_s4: Option<Vector3<f64>>,
    crackle_m_s5: Vector3<f64>,
}

impl BeyondJerk {
    /// The setpoint with higher derivatives fitted to its jerks; unchanged where it has them.
    pub(super) fn filled(&mut self, setpoint: &Setpoint) -> Setpoint {
        if setpoint.snap_m_s4 != Vector3::zeros() || setpoint.crackle_m_s5 != Vector3::zeros() {
            return *setpoint;
        }
        if let Some(before) = self.newest.filter(|before| before.sent_s < setpoint.sent_s) {
            let period_s = setpoint.sent_s - before.sent_s;
            let snap_m_s4 = (setpoint.jerk_m_s3 - before.jerk_m_s3) / period_s;
            self.crackle_m_s5 = self.snap_m_s4.map_or_else(Vector3::zeros, |snap| (snap_m_s4 - snap) / period_s);
            self.snap_m_s4 = Some(snap_m_s4);
        }
        self.newest = Some(*setpoint);
        // A difference is the derivative in the middle between two setpoints, 10 ms apart.
        let snap_m_s4 = self.snap_m_s4.unwrap_or_default() + self.crackle_m_s5 * 0.005;
        Setpoint { snap_m_s4, crackle_m_s5: self.crackle_m_s5, ..*setpoint }
    }
}

impl CoreLaw {
    /// One of the paper's laws; behind motors of the lag that is told, or the vehicle's.
    pub(super) fn paper(vehicle: &Vehicle, told: &ToldFigures, gain: Gain) -> Result<Self, FlightError> {
        Self::new(vehicle, told, told.lag_s.unwrap_or(vehicle.motors().lag_s), gain)
    }

    /// The actuator-aware law by its standard weights, as the Crazyflie flies it: designed for the lag that is told, or for
    /// that of the default table behind motors of the longest published lag.
    pub(super) fn actuator_aware(vehicle: &Vehicle, told: &ToldFigures) -> Result<Self, FlightError> {
        let (gain, lag_s) = actuator_aware_of(vehicle, told)?;
        Self::new(vehicle, told, lag_s, Gain::ActuatorAware(Box::new(gain)))
    }

    fn new(vehicle: &Vehicle, told: &ToldFigures, lag_s: f64, gain: Gain) -> Result<Self, FlightError> {
        let actuation = actuation_of(vehicle, told, lag_s, RATE)?;
        Ok(Self {
            gain,
            limits: vehicles::limits(vehicle)?,
            memory: Memory::hovering(actuation.airframe()),
            actuation,
            beyond_jerk: BeyondJerk::default(),
            arch: Arch::new(),
            shared: None,
        })
    }

    /// Takes its references along a track from now on, evaluated once for this and its copies.
    pub(super) fn share(&mut self, track: &Track) {
        let mut beyond_jerk = BeyondJerk::default();
        let airframe = self.actuation.airframe();
        let references =
            track.told(RATE.hz()).map(|(time_s, setpoint)| reference(&mut beyond_jerk, airframe, time_s, setpoint));
        self.shared = Some(references.collect());
    }
}

/// The reference of a setpoint at a time.
fn reference(
    beyond_jerk: &mut BeyondJerk,
    airframe: &Airframe,
    time_s: f64,
    setpoint: &Setpoint,
) -> Result<MotorReference, ReferenceError> {
    let point = beyond_jerk.filled(setpoint).carried_to(time_s);
    MotorReference::from_flat(&motor_loop::sample(&point), airframe)
}

/// A vehicle's way to its motors at a control rate, told its mass, with motors of a lag, s.
///
/// # Errors
/// [`FlightError`] where the core refuses a figure.
pub fn actuation_of(vehicle: &Vehicle, told: &ToldFigures, lag_s: f64, rate: Rate) -> Result<Actuation, FlightError> {
    let figures = *motor_loop::airframe(vehicle, lag_s)?.figures();
    let airframe = Airframe::new(AirframeFigures { mass_kg: told.mass_kg as f32, ..figures })?.commanded_at(rate);
    Ok(Actuation::new(&airframe, rate)?)
}

/// The actuator-aware gain by its standard weights, for the lag that is told or that of the default table, and the lag of the
/// motors that it is flown with, s.
///
/// # Errors
/// [`FlightError`] where there is no design, or the core refuses it.
pub fn actuator_aware_of(vehicle: &Vehicle, told: &ToldFigures) -> Result<(ActuatorAwareGain, f64), FlightError> {
    let [_, longest_s] = vehicle.motors().published_lag_s;
    let design_lag_s = told.lag_s.unwrap_or_else(|| default_lag_s(vehicle));
    let design = actuator_aware(vehicle, design_lag_s, &ActuatorAwareWeights::STANDARD, PERIOD_S)?;
    let rows = std::array::from_fn(|i| std::array::from_fn(|j| design.gain[(i, j)] as f32));
    Ok((ActuatorAwareGain::new(rows)?, told.lag_s.unwrap_or(longest_s)))
}

impl ControlLaw for CoreLaw {
    fn rate_hz(&self) -> u32 {
        RATE.hz()
    }

    fn feels(&self) -> bool {
        false
    }

    fn step(&mut self, input: &Input) -> Result<Vector4<f64>, String> {
        let arch = self.arch;
        arch.dispatch(Stepped { law: self, input })
    }
}

/// One step of a law, compiled for the vector instructions of the processor: they write to a register of their own, which saves a
/// quarter of all instructions. No multiply-add is fused.
struct Stepped<'a> {
    law: &'a mut CoreLaw,
    input: &'a Input,
}

impl WithSimd for Stepped<'_> {
    type Output = Result<Vector4<f64>, String>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { law, input } = self;
        let CoreLaw { gain, actuation, limits, memory, beyond_jerk, shared, .. } = law;
        let feed_forward = FeedForward::With;
        let own;
        // Borrowed from where it is: a copy costs as much as a chain of the law.
        let found = match shared.as_ref().and_then(|shared| shared.get(motor_loop::step_at(input.time_s))) {
            Some(found) => found,
            None => {
                own = reference(beyond_jerk, actuation.airframe(), input.time_s, &input.setpoint);
                &own
            }
        };
        let reference = found.as_ref().map_err(ToString::to_string)?;
        let state = rigid_state(&input.estimate);
        let controller = match gain {
            Gain::ActuatorAware(gain) => {
                let controller = Controller::new(ActuatorAware::new(gain, actuation), Limits::NONE);
                // Forces come at once: there is nothing to be carried to the motors.
                return match controller.step(memory, (&state).into(), reference.into()) {
                    Ok(Output::Forces(step)) => Ok(Vector4::from(step.forces_n.map(f64::from))),
                    Ok(Output::Command(_)) => Err("the law gives no forces".to_owned()),
                    Err(error) => Err(error.to_string()),
                };
            }
            Gain::Equilibrium(gain) => Controller::new(Equilibrium { feed_forward, ..Equilibrium::new(gain) }, *limits),
            Gain::FlatOutput(gain) => Controller::new(FlatOutput { gain, feed_forward }, *limits),
        };
        let step = controller.with_actuation(actuation).step_to_motors(memory, (&state).into(), reference.into());
        match step {
            Ok(step) => Ok(Vector4::from(step.forces_n.map(f64::from))),
            Err(error) => Err(error.to_string()),
        }
    }
}

/// An estimate as the core takes it.
#[inline(always)]
pub(super) fn rigid_state(estimate: &Estimate) -> quatrack::RigidState {
    let f32s = |v: &Vector3<f64>| v.map(|value| value as f32);
    let q = estimate.attitude.quaternion();
    let [w, x, y, z] = [q.w, q.i, q.j, q.k].map(|value| value as f32);
    let state = State {
        position_m: f32s(&estimate.position_m),
        attitude: quatrack::Quaternion::new(w, x, y, z),
        velocity_m_s: f32s(&estimate.velocity_m_s),
    };
    quatrack::RigidState { state, body_rates_rad_s: f32s(&estimate.body_rates_rad_s) }
}
