//! Certificates of the cascade, with everything in the loop: observers, the accelerometer's share, delay, motors of
//! another lag that give less than told, another mass and inertia, air that is not the told one and air that is believed.
//!
//! At hover the loop is four chains. Each is a linear map over a control period (`chains`); the accelerometer is looked
//! at every fifth one, so that its spectral radius is that of five periods. Between the points of a region nothing is
//! promised.

mod chains;
mod held;
mod margins;
mod observers;
mod region;
mod table;

use std::fmt;

use nalgebra::DMatrix;
use serde::Serialize;

use self::chains::{Chain, HeightChain, TiltChain, YawChain};
pub use self::margins::{ChainLoop, ChainMargins};
use self::observers::AIR_TICK_S;
pub use self::region::{CascadeCertificate, CascadeRegion};
pub use self::table::{
    CascadeAir, CascadeBounds, CascadeRegionCertificate, cascade_craft, certify_cascade, certify_cascade_region,
    in_identified_air,
};
use super::CertifyError;
use crate::analysis::eigenvalues;
use crate::vehicle::Vehicle;

/// A craft as the controller is told of it, and its gains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CascadeCraft {
    /// Gains in the order of [`crate::design::cascade::CascadeDesign::numbers`].
    pub gains: [f64; 16],
    /// Mass, kg.
    pub mass_kg: f64,
    /// Principal moments of inertia, kg m^2.
    pub inertia_kg_m2: [f64; 3],
    /// Distance of the motors from body x and y, m.
    pub lever_m: f64,
    /// Torque over thrust of a motor, m.
    pub torque_per_thrust_m: f64,
    /// Motor lag of the design, s.
    pub lag_s: f64,
    /// Control period, s.
    pub period_s: f64,
    /// Moment of the air about x and y that is identified, N s: the region's factors multiply it.
    pub moment_n_s: [f64; 2],
    /// Drag and moment that are told, 1/s and N s.
    pub told_drag_per_s: f64,
    /// Moment that is told, N s.
    pub told_moment_n_s: [f64; 2],
    /// Share of the wind's moment that is fed forward.
    pub gust: f64,
}

impl CascadeCraft {
    /// A vehicle with gains for a lag, told nothing of the air.
    pub fn new(vehicle: &Vehicle, gains: [f64; 16], lag_s: f64, period_s: f64) -> Self {
        let (inertia, motors) = (vehicle.inertia_kg_m2(), vehicle.motors());
        Self {
            gains,
            mass_kg: vehicle.mass_kg(),
            inertia_kg_m2: [inertia[(0, 0)], inertia[(1, 1)], inertia[(2, 2)]],
            lever_m: motors.half_arm_m(),
            torque_per_thrust_m: motors.torque_per_thrust_m,
            lag_s,
            period_s,
            moment_n_s: [0.0; 2],
            told_drag_per_s: 0.0,
            told_moment_n_s: [0.0; 2],
            gust: 0.0,
        }
    }
}

/// How a craft, its air and its link differ from those that the controller is told.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CascadeVariation {
    /// Time constant of the motors, s.
    pub lag_s: f64,
    /// Mass over that told.
    pub mass_factor: f64,
    /// Inertia over that told; over mass, where the craft has learned its motors' share.
    pub inertia_factor: f64,
    /// Force of the motors over their command; of torques over the share that the craft has learned.
    pub command_factor: f64,
    /// Delay of a command, s.
    pub delay_s: f64,
    /// Linear drag over mass, 1/s.
    pub drag_per_s: f64,
    /// Moment of the air over the identified one.
    pub moment_factor: f64,
    /// Drag that the controller has learned, 1/s.
    pub believed_drag_per_s: f64,
    /// Moment over drag that it has learned, over that told.
    pub believed_ratio_factor: f64,
}

impl fmt::Display for CascadeVariation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.1} ms of motor lag, {:.2} times the mass, {:.2} times the inertia, {:.2} times the force, {:.1} ms of delay, drag of \
             {:.2} 1/s and {:.2} times the moment, believed {:.2} 1/s and {:.2} times the ratio",
            1e3 * self.lag_s,
            self.mass_factor,
            self.inertia_factor,
            self.command_factor,
            1e3 * self.delay_s,
            self.drag_per_s,
            self.moment_factor,
            self.believed_drag_per_s,
            self.believed_ratio_factor
        )
    }
}

impl CascadeVariation {
    /// No deviation, in vacuum.
    pub fn none(lag_s: f64) -> Self {
        Self {
            lag_s,
            mass_factor: 1.0,
            inertia_factor: 1.0,
            command_factor: 1.0,
            delay_s: 0.0,
            drag_per_s: 0.0,
            moment_factor: 0.0,
            believed_drag_per_s: 0.0,
            believed_ratio_factor: 1.0,
        }
    }

    /// Whole periods of delay, rounded up.
    fn late(&self, period_s: f64) -> usize {
        (self.delay_s / period_s - 1e-9).ceil().max(0.0) as usize
    }
}

/// A chain of the cascade.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum CascadeChain {
    /// x with pitch.
    X,
    /// y with roll.
    Y,
    /// Height.
    Z,
    /// Heading.
    Yaw,
}

impl fmt::Display for CascadeChain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x with pitch",
            Self::Y => "y with roll",
            Self::Z => "height",
            Self::Yaw => "yaw",
        })
    }
}

impl CascadeChain {
    /// All four.
    pub const ALL: [Self; 4] = [Self::X, Self::Y, Self::Z, Self::Yaw];

    fn of(self, craft: &CascadeCraft, at: &CascadeVariation) -> Box<dyn Chain> {
        match self {
            Self::X => Box::new(TiltChain::new(craft, true, at)),
            Self::Y => Box::new(TiltChain::new(craft, false, at)),
            Self::Z => Box::new(HeightChain::new(craft, at)),
            Self::Yaw => Box::new(YawChain::new(craft, at)),
        }
    }

    /// The matrix of a period, of the plant's states first: `p v tilt rate force`, of height and heading three of them.
    pub fn matrix(self, craft: &CascadeCraft, at: &CascadeVariation, looks: bool) -> DMatrix<f64> {
        self.of(craft, at).matrices(looks).0
    }

    /// The matrix from one look at the accelerometer to the next.
    fn of_tick(self, craft: &CascadeCraft, at: &CascadeVariation) -> DMatrix<f64> {
        let chain = self.of(craft, at);
        let steps = (AIR_TICK_S / craft.period_s).round().max(1.0) as usize;
        let without = chain.matrices(false).0;
        (1..steps).fold(chain.matrices(true).0, |all, _| &without * all)
    }

    /// The largest modulus of the poles, per period.
    ///
    /// # Errors
    /// [`CertifyError`] where eigenvalues are not found.
    pub fn spectral_radius(self, craft: &CascadeCraft, at: &CascadeVariation) -> Result<f64, CertifyError> {
        let steps = (AIR_TICK_S / craft.period_s).round().max(1.0);
        let poles = eigenvalues(&self.of_tick(craft, at))?;
        Ok(poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max).powf(1.0 / steps))
    }
}
