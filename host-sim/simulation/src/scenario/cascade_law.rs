//! The cascade of the core as a law, at 500 Hz for any vehicle: setpoints to the jerk, estimate and accelerometer in, forces
//! out.

use std::sync::Arc;

use nalgebra::{Vector3, Vector4};
use quatrack::airframe::AirframeFigures;
use quatrack::cascade::{Air, Cascade, CascadeGains, CascadeLimits, JerkFit};
use quatrack::gains::table::CascadeTable;
use quatrack::{Airframe, Controller, FifthOrderSample, Heading, Limits, Measured, Memory, Output, Target};
use quatrack_design::design::cascade::{CascadeWeights, cascade};
use quatrack_design::vehicle::Vehicle;

use super::core_law::rigid_state;
use super::not_flown::NotFlown;
use super::told::ToldFigures;
use super::track::Track;
use crate::control_law::{ControlLaw, Input, Setpoint};
use crate::crazyflie::standard_cascade;
use crate::flight::motor_laws::FlightError;
use crate::flight::motor_loop::{self, PERIOD_S, RATE};
use crate::vehicles;

/// Farthest that two setpoints of one motion are apart, m: 10 ms at 5 m/s.
const JUMP_M: f64 = 0.05;

/// The cascade on a vehicle's motors.
#[derive(Clone)]
pub(super) struct CascadeLaw {
    cascade: Cascade,
    memory: Memory,
    following: Following,
    /// The course as the core takes it at every step, where it is known before.
    shared: Option<Arc<[(FifthOrderSample, Heading)]>>,
}

/// The newest setpoint, and the fit through the jerks of those before.
#[derive(Clone)]
struct Following {
    fit: JerkFit,
    newest: Option<Setpoint>,
}

impl CascadeLaw {
    /// The law of [`flown_cascade`], at a hover.
    pub(super) fn new(vehicle: &Vehicle, told: &ToldFigures) -> Result<Self, NotFlown> {
        flown_cascade(vehicle, told).map(Self::hovering)
    }

    /// The law at a hover.
    fn hovering(cascade: Cascade) -> Self {
        let memory = Memory::hovering(cascade.airframe());
        Self { cascade, memory, following: Following { fit: JerkFit::NONE, newest: None }, shared: None }
    }

    /// Of a table, with its lag, and with its air where none is told.
    pub(super) fn of_table(vehicle: &Vehicle, told: &ToldFigures, table: &CascadeTable) -> Result<Self, FlightError> {
        cascade_of_table(vehicle, told, table).map(Self::hovering)
    }

    /// Takes the setpoints of a track from now on, evaluated once for this and its copies.
    pub(super) fn share(&mut self, track: &Track) {
        let mut following = self.following.clone();
        let told = track.told(RATE.hz());
        self.shared = Some(told.map(|(time_s, setpoint)| following.sample(time_s, setpoint)).collect());
    }
}

impl Following {
    /// The course at a time, and its heading.
    fn sample(&mut self, time_s: f64, setpoint: &Setpoint) -> (FifthOrderSample, Heading) {
        let sample = motor_loop::sample(&self.filled(setpoint).carried_to(time_s));
        (sample, Heading::from_angle(sample.flat.heading_rad))
    }

    /// The setpoint with snap and crackle of the fit through its jerks; as it is where it has them.
    fn filled(&mut self, setpoint: &Setpoint) -> Setpoint {
        if setpoint.snap_m_s4 != Vector3::zeros() || setpoint.crackle_m_s5 != Vector3::zeros() {
            return *setpoint;
        }
        if self.newest.is_none_or(|before| before.sent_s < setpoint.sent_s) {
            let after_s = self.newest.map_or(0.0, |before| setpoint.sent_s - before.sent_s);
            if self.newest.is_none_or(|before| (setpoint.position_m - before.position_m).norm() > JUMP_M) {
                self.fit.forget();
            }
            self.fit.accept(&setpoint.jerk_m_s3.cast(), after_s as f32);
            self.newest = Some(*setpoint);
        }
        let [snap_m_s4, crackle_m_s5] = self.fit.snap_and_crackle().map(Vector3::cast);
        Setpoint { snap_m_s4, crackle_m_s5, ..*setpoint }
    }
}

/// The cascade at 500 Hz that a scenario flies a vehicle with. For a built-in one it is designed with the standard weights for the lag
/// that is told, or for the one that it is flown with where none is. Another vehicle has the certified table that `quatrack gains craft`
/// makes, with the lag of its design, and its air where none is told; a lag that is told has to be in the table's region.
///
/// # Errors
/// [`NotFlown`] where there is no design or no certified table, or the core refuses a figure.
pub fn flown_cascade(vehicle: &Vehicle, told: &ToldFigures) -> Result<Cascade, NotFlown> {
    if vehicles::is_built_in(vehicle) {
        return Ok(cascade_of(vehicle, told)?);
    }
    let standard = standard_cascade(vehicle)?;
    told.certified_by(&standard.table.certified, vehicle)?;
    Ok(cascade_of_table(vehicle, told, &standard.table)?)
}

/// Designed with the standard weights for the lag that is told, or for the one that the vehicle is flown with.
fn cascade_of(vehicle: &Vehicle, told: &ToldFigures) -> Result<Cascade, FlightError> {
    let lag_s = told.lag_s.unwrap_or_else(|| untold_lag_s(vehicle));
    let design = cascade(vehicle, lag_s, &CascadeWeights::for_lag(lag_s), PERIOD_S)?;
    let gains = CascadeGains::from_numbers(design.numbers().map(|gain| gain as f32))?;
    let figures = *motor_loop::airframe(vehicle, lag_s)?.figures();
    let airframe = Airframe::new(AirframeFigures { mass_kg: told.mass_kg as f32, ..figures })?;
    Ok(Cascade::new(&gains, &airframe, RATE, &CascadeLimits::STANDARD, &air(vehicle, told)?)?)
}

/// The cascade of a table at 500 Hz, with its lag, and with its air where none is told.
///
/// # Errors
/// [`FlightError`] where the core refuses a figure.
pub fn cascade_of_table(vehicle: &Vehicle, told: &ToldFigures, table: &CascadeTable) -> Result<Cascade, FlightError> {
    let figures = *motor_loop::airframe(vehicle, f64::from(table.motor_lag_s))?.figures();
    let airframe = Airframe::new(AirframeFigures { mass_kg: told.mass_kg as f32, ..figures })?;
    let air = with_told(&table.air, told).checked()?;
    Ok(table.flown(&airframe, RATE, &CascadeLimits::STANDARD, &air)?)
}

impl ControlLaw for CascadeLaw {
    fn rate_hz(&self) -> u32 {
        RATE.hz()
    }

    fn step(&mut self, input: &Input) -> Result<Vector4<f64>, String> {
        let Self { cascade, memory, following, shared } = self;
        let own;
        // Borrowed from where it is.
        let (sample, heading) = match shared.as_ref().and_then(|shared| shared.get(motor_loop::step_at(input.time_s))) {
            Some(shared) => shared,
            None => {
                own = following.sample(input.time_s, &input.setpoint);
                &own
            }
        };
        let state = rigid_state(&input.estimate);
        let felt_m_s2 = input.estimate.specific_force_m_s2.cast();
        let measured = Measured::from(&state).with_specific_force(&felt_m_s2);
        // Forces come at once: there is nothing to be carried to the motors.
        match Controller::new(&*cascade, Limits::NONE).step(memory, measured, Target::with_sample(sample, *heading)) {
            Ok(Output::Forces(step)) => Ok(Vector4::from(step.forces_n.map(f64::from))),
            Ok(Output::Command(_)) => Err("the law gives no forces".to_owned()),
            Err(error) => Err(error.to_string()),
        }
    }
}

/// The Brushless is flown with a table for 50 ms, the brushed Crazyflies with one for 100 ms, where their owners state no lag.
fn untold_lag_s(vehicle: &Vehicle) -> f64 {
    match KnownCraft::of(vehicle) {
        Some(KnownCraft::Brushless) => 0.05,
        Some(KnownCraft::Brushed) => 0.1,
        None => vehicle.motors().lag_s,
    }
}

/// A built-in vehicle.
enum KnownCraft {
    Brushless,
    Brushed,
}

impl KnownCraft {
    fn of(vehicle: &Vehicle) -> Option<Self> {
        let is_brushless = vehicle.name().starts_with("crazyflie-2.1-brushless");
        vehicles::is_built_in(vehicle).then_some(if is_brushless { Self::Brushless } else { Self::Brushed })
    }
}

/// The told air, and for the rest that of Crazyflies; another vehicle begins with none and learns it.
fn air(vehicle: &Vehicle, told: &ToldFigures) -> Result<Air, FlightError> {
    let known = match KnownCraft::of(vehicle) {
        Some(KnownCraft::Brushless) => Air::BRUSHLESS,
        Some(KnownCraft::Brushed) => Air::BRUSHED,
        None => Air { learn: true, ..Air::NONE },
    };
    Ok(with_told(&known, told).checked()?)
}

fn with_told(air: &Air, told: &ToldFigures) -> Air {
    let drag_per_s = told.drag_per_s.map_or(air.drag_per_s, |drag| drag as f32);
    let moment_n_s = told.moment_n_m_per_m_s.map_or(air.moment_n_s, |moment| moment.map(|share| share as f32));
    Air { drag_per_s, moment_n_s, ..*air }
}

#[cfg(test)]
mod tests;
