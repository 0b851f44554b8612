//! Laws carried to the motors of a vehicle: a vehicle, a lag and weights in; tables with their certificates, and the
//! lag that a law of the paper tolerates behind a rate loop, out; and one flight with any of them.

use nalgebra::{DMatrix, SMatrix, Vector4};
use quatrack::airframe::AirframeError;
use quatrack::cascade::{AirError, CascadeGainError};
use quatrack::gain::GainError;
use quatrack::law::ActuatorAwareGain;
use quatrack::motor_lag::MotorLagError;
use quatrack::{Actuation, ActuatorAware, Airframe, Controller as CoreController, Equilibrium, Limits, ReferenceError};
use quatrack_design::certify::{
    CertifyError, Controller, Plant, Region, RegionCertificate, Timing, certify, certify_region,
};
use quatrack_design::design::DesignError;
use quatrack_design::design::actuator_aware::{ActuatorAwareWeights, actuator_aware};
use quatrack_design::vehicle::{Vehicle, VehicleError};
use quatrack_plan::trajectory::fifth_order::FlatTrajectory;

use super::motor_loop::{self, MotorLoop, PERIOD_S};
use super::rigid_loop::{Conditions, RigidFlight, fly_rigid};
use crate::plant::{Craft, RigidState};
use crate::vehicles;

/// A table designed for less does not hold at 126 ms with mass and inertia off and a delay, s.
const DEFAULT_LAG_MIN_S: f64 = 0.1;

/// Why there is no flight.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FlightError {
    /// No gain.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// No certificate.
    #[error(transparent)]
    Certify(#[from] CertifyError),
    /// The core takes no such vehicle.
    #[error("the core refuses the vehicle: {0}")]
    Airframe(#[from] AirframeError),
    /// Limits that vanish as f32.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// The core takes no such lag.
    #[error("the core refuses the lag: {0}")]
    Lag(#[from] MotorLagError),
    /// The core takes no such gain.
    #[error("the core refuses the gain: {0}")]
    Gain(#[from] GainError),
    /// The cascade takes no such gain.
    #[error("the core refuses the gain: {0}")]
    CascadeGain(#[from] CascadeGainError),
    /// The cascade takes no such air.
    #[error("the core refuses the air: {0}")]
    Air(#[from] AirError),
    /// The course cannot be flown at its start.
    #[error("the course cannot be flown from its start: {0}")]
    Start(#[from] ReferenceError),
}

/// An actuator-aware table, as it is flown, with its certified region.
#[derive(Clone, Debug)]
pub struct AwareTable {
    gain: ActuatorAwareGain,
    airframe: Airframe,
    /// Over the region that it was asked for.
    pub certificate: RegionCertificate,
}

/// The lag that a vehicle's default table is designed for, s: the longest published, and at least 100 ms.
pub fn default_lag_s(vehicle: &Vehicle) -> f64 {
    let [_, longest_s] = vehicle.motors().published_lag_s;
    longest_s.max(DEFAULT_LAG_MIN_S)
}

/// The bandwidth that the core's body-rate loop has behind motors of a lag, rad/s: that of
/// [`quatrack::BodyRateLoop::behind_lag`] below its bound.
pub fn body_rate_bandwidth_rad_s(lag_s: f64) -> f64 {
    0.5 / lag_s
}

impl AwareTable {
    /// Designs a table for a lag, rounds it and certifies it over a region.
    ///
    /// # Errors
    /// [`FlightError`] where there is no design, no certificate, or the core refuses one of them.
    pub fn new(
        vehicle: &Vehicle,
        lag_s: f64,
        weights: &ActuatorAwareWeights,
        region: &Region,
    ) -> Result<Self, FlightError> {
        let design = actuator_aware(vehicle, lag_s, weights, PERIOD_S)?;
        let rows = std::array::from_fn(|i| std::array::from_fn(|j| design.gain[(i, j)] as f32));
        Ok(Self {
            gain: ActuatorAwareGain::new(rows)?,
            airframe: motor_loop::airframe(vehicle, lag_s)?,
            certificate: certify_region(vehicle, &design.gain_in_parts, lag_s, PERIOD_S, region)?,
        })
    }

    /// The craft as the core takes it.
    pub fn airframe(&self) -> &Airframe {
        &self.airframe
    }

    /// The gain as the core takes it.
    pub fn gain(&self) -> &ActuatorAwareGain {
        &self.gain
    }

    /// The law on its craft.
    ///
    /// # Errors
    /// [`FlightError::Lag`] for a lag below two control periods.
    pub fn craft_law(&self) -> Result<CraftLaw<'_>, FlightError> {
        let actuation = Actuation::new(&self.airframe, motor_loop::RATE)?;
        Ok(CraftLaw { flown: ControllerSource::Gain(&self.gain), actuation })
    }
}

/// A law on a craft as the core takes it.
#[derive(Clone, Copy, Debug)]
pub struct CraftLaw<'a> {
    flown: ControllerSource<'a>,
    actuation: Actuation,
}

/// The parts of a controller on the craft.
#[derive(Clone, Copy, Debug)]
enum ControllerSource<'a> {
    Gain(&'a ActuatorAwareGain),
    ByBodyRates(Equilibrium<'a>, Limits),
}

impl<'a> CraftLaw<'a> {
    /// A law of the paper on a vehicle's motors, through the core's body-rate loop and mixer.
    ///
    /// # Errors
    /// [`FlightError`] where the core refuses vehicle or lag.
    pub fn by_body_rates(vehicle: &Vehicle, law: Equilibrium<'a>, lag_s: f64) -> Result<Self, FlightError> {
        let actuation = Actuation::new(&motor_loop::airframe(vehicle, lag_s)?, motor_loop::RATE)?;
        Ok(Self { flown: ControllerSource::ByBodyRates(law, vehicles::limits(vehicle)?), actuation })
    }

    /// The craft as the core takes it.
    pub fn airframe(&self) -> &Airframe {
        self.actuation.airframe()
    }

    /// The law in the loop, its motors at the given thrusts, N; nothing where one of them is not finite.
    pub fn started(&self, thrusts_n: &Vector4<f64>) -> Option<MotorLoop<'_>> {
        MotorLoop::new(self.controller(), self.airframe(), thrusts_n)
    }

    fn controller(&self) -> CoreController<'_> {
        match &self.flown {
            ControllerSource::Gain(gain) => {
                CoreController::new(ActuatorAware::new(gain, &self.actuation), Limits::NONE)
            }
            ControllerSource::ByBodyRates(law, limits) => {
                CoreController::new(*law, *limits).with_actuation(&self.actuation)
            }
        }
    }
}

/// The motor lag that a gain of the paper tolerates at hover, s, behind the rate loop that the core would run for motors of
/// `lag_s`.
///
/// # Errors
/// [`CertifyError`] for a loop that is unstable without any lag.
pub fn paper_law_limit_s(gain: &SMatrix<f64, 4, 9>, lag_s: f64) -> Result<f64, CertifyError> {
    let controller = Controller::memoryless(DMatrix::from_column_slice(4, 9, gain.as_slice()));
    let timing = Timing::at_rate(motor_loop::RATE.hz());
    let found = certify(&Plant::equilibrium(), &controller, &timing, Some(body_rate_bandwidth_rad_s(lag_s)))?;
    // All channels at once are the last.
    Ok(found.motors_in_rate_loop.iter().flatten().last().map_or(0.0, |limit| limit.stable_to_s))
}

/// Flies `course` with a law from a state, the motors at the thrusts of that state.
pub fn fly(
    law: &CraftLaw<'_>,
    craft: &Craft,
    start: &RigidState,
    course: &dyn FlatTrajectory,
    conditions: &Conditions,
) -> RigidFlight {
    let mut control = law.started(&start.thrusts_n);
    fly_rigid(
        craft,
        start,
        conditions,
        |t_s| course.at(t_s).position[0],
        |tick, measured| {
            let control = control.as_mut().ok_or("the motors' thrusts are not finite")?;
            control.step(measured, &course.at(f64::from(tick) * PERIOD_S))
        },
    )
}
