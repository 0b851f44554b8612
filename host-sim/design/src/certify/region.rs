//! An actuator-aware gain on craft other than its own: a vehicle and a region of lag, mass, inertia and delay in; the
//! spectral radius all over the region's grid out.
//!
//! The grid has every value of each quantity with every value of the others: each singly, and all corners. The controller
//! predicts with the lag of its design throughout. Between the points nothing is promised; the lags are close together.

use std::fmt;

use nalgebra::DMatrix;
use serde::Serialize;

use super::CertifyError;
use super::limits::StabilityLimit;
use super::linear_loop::LinearLoop;
use super::plant::{Controller, Plant, Predictor, Timing};
use super::rounding::single_precision;
use super::sampled_loop::SampledLoop;
use crate::analysis::eigenvalues;
use crate::vehicle::Vehicle;

/// Spectral radii closer than this are the same but for rounding.
const SAME: f64 = 1e-9;

/// How a craft and its link differ from the vehicle that the gain was designed for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Variation {
    /// Time constant of the motors, s.
    pub lag_s: f64,
    /// Mass over that of the vehicle.
    pub mass_factor: f64,
    /// Inertia over that of the vehicle.
    pub inertia_factor: f64,
    /// Delay of a command, s.
    pub delay_s: f64,
}

impl fmt::Display for Variation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { lag_s, mass_factor, inertia_factor, delay_s } = self;
        let [lag_ms, delay_ms] = [1e3 * lag_s, 1e3 * delay_s];
        write!(
            f,
            "{lag_ms:.1} ms of motor lag, {mass_factor:.2} times the mass, {inertia_factor:.2} times the inertia and {delay_ms:.1} ms of delay"
        )
    }
}

/// Values of each quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Region {
    /// Time constants of the motors, s.
    pub lags_s: Vec<f64>,
    /// Masses over that of the vehicle.
    pub mass_factors: Vec<f64>,
    /// Inertias over that of the vehicle.
    pub inertia_factors: Vec<f64>,
    /// Delay of the commands, s.
    pub delays_s: Vec<f64>,
}

/// How far a region reaches to either side of the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RegionBounds {
    /// Shortest and longest time constant of the motors, s.
    pub lag_s: [f64; 2],
    /// How much of its mass the vehicle may have more or less.
    pub mass_share: f64,
    /// The same for its inertia.
    pub inertia_share: f64,
    /// Longest delay of commands, s.
    pub delay_s: f64,
}

impl RegionBounds {
    /// The region of a default table: 50 to 126 ms of lag, with the mass off by 20 %, the inertia by 30 % and 10 ms of
    /// delay.
    pub const ANY_CRAZYFLIE: Self = Self { lag_s: [0.050, 0.126], mass_share: 0.2, inertia_share: 0.3, delay_s: 0.010 };

    /// The grid of the region: seven lags, and ends and middle of the other quantities.
    pub fn grid(&self) -> Region {
        let [shortest_s, longest_s] = self.lag_s;
        let around = |share: f64| if share > 0.0 { vec![1.0 - share, 1.0, 1.0 + share] } else { vec![1.0] };
        Region {
            mass_factors: around(self.mass_share),
            inertia_factors: around(self.inertia_share),
            delays_s: if self.delay_s > 0.0 { vec![0.0, 0.5 * self.delay_s, self.delay_s] } else { vec![0.0] },
            ..Region::of_lags(shortest_s, longest_s)
        }
    }
}

/// The result over a region.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionCertificate {
    /// The region.
    pub region: Region,
    /// Points of its grid.
    pub points: usize,
    /// Where the spectral radius is largest.
    pub worst: Variation,
    /// The largest spectral radius; below 1 every point is stable.
    pub spectral_radius: f64,
}

impl Region {
    /// Lags between two, in even steps of ratio, and nothing else.
    pub fn of_lags(shortest_s: f64, longest_s: f64) -> Self {
        const STEPS: i32 = 6;
        let ratio = longest_s / shortest_s;
        let lags_s = (0..=STEPS).map(|k| shortest_s * ratio.powf(f64::from(k) / f64::from(STEPS))).collect();
        Self { lags_s, mass_factors: vec![1.0], inertia_factors: vec![1.0], delays_s: vec![0.0] }
    }

    /// [`RegionBounds::ANY_CRAZYFLIE`].
    pub fn of_any_crazyflie() -> Self {
        RegionBounds::ANY_CRAZYFLIE.grid()
    }

    /// The region of a table for a known lag: half of it to one and a half of it.
    pub fn around_lag(lag_s: f64) -> Self {
        Self::of_lags(0.5 * lag_s, 1.5 * lag_s)
    }

    fn points(&self) -> impl Iterator<Item = Variation> + '_ {
        self.lags_s.iter().flat_map(move |lag_s| {
            self.mass_factors.iter().flat_map(move |mass_factor| {
                self.inertia_factors.iter().flat_map(move |inertia_factor| {
                    self.delays_s.iter().map(move |delay_s| Variation {
                        lag_s: *lag_s,
                        mass_factor: *mass_factor,
                        inertia_factor: *inertia_factor,
                        delay_s: *delay_s,
                    })
                })
            })
        })
    }
}

/// Finds the least stable point of a region for an actuator-aware gain in parts (4 x 19), rounded to f32 first, designed
/// for `design_lag_s`.
///
/// # Errors
/// As [`super::certify`]; an unstable point is no error, it shows in the spectral radius.
pub fn certify_region(
    vehicle: &Vehicle,
    gain_in_parts: &DMatrix<f64>,
    design_lag_s: f64,
    period_s: f64,
    region: &Region,
) -> Result<RegionCertificate, CertifyError> {
    let mut controller = Controller::actuator_aware(&single_precision(gain_in_parts)?, design_lag_s, period_s);
    if let Some(Predictor { decay, .. }) = &mut controller.predictor {
        *decay = f64::from(*decay as f32);
    }
    let mut worst: Option<(Variation, f64)> = None;
    let mut points = 0;
    for variation in region.points() {
        let radius = spectral_radius(vehicle, &controller, period_s, &variation)?;
        points += 1;
        // Points that differ only in quantities that a chain does not feel are equal: the first of them counts, on
        // every processor. A NaN is as bad as it gets.
        if worst.is_none_or(|(_, held)| radius.is_nan() || radius > held * (1.0 + SAME)) {
            worst = Some((variation, radius));
        }
    }
    let (worst, spectral_radius) = worst.ok_or(CertifyError::EmptyRegion)?;
    Ok(RegionCertificate { region: region.clone(), points, worst, spectral_radius })
}

/// The longest motor lag up to which the loop stays stable, everything else as designed; walked to in steps of 4 % from the
/// design's own and then halved.
///
/// # Errors
/// As [`certify_region`].
pub fn motor_lag_limit(
    vehicle: &Vehicle,
    gain_in_parts: &DMatrix<f64>,
    design_lag_s: f64,
    period_s: f64,
) -> Result<StabilityLimit, CertifyError> {
    const STEP: f64 = 1.04;
    const LONGEST_S: f64 = 3.0;
    const HALVINGS: i32 = 30;
    let controller = Controller::actuator_aware(&single_precision(gain_in_parts)?, design_lag_s, period_s);
    let stable = |lag_s: f64| {
        let variation = Variation { lag_s, mass_factor: 1.0, inertia_factor: 1.0, delay_s: 0.0 };
        spectral_radius(vehicle, &controller, period_s, &variation).map(|radius| radius < 1.0)
    };
    let channels = String::from("all");
    let (mut low_s, mut high_s) = (design_lag_s, design_lag_s * STEP);
    while stable(high_s)? {
        if high_s >= LONGEST_S {
            return Ok(StabilityLimit { channels, stable_to_s: high_s, resolution_s: None });
        }
        (low_s, high_s) = (high_s, high_s * STEP);
    }
    let resolution_s = (high_s - low_s) * f64::from(-HALVINGS).exp2();
    for _ in 0..HALVINGS {
        let middle_s = 0.5 * (low_s + high_s);
        if stable(middle_s)? { low_s = middle_s } else { high_s = middle_s }
    }
    Ok(StabilityLimit { channels, stable_to_s: low_s, resolution_s: Some(resolution_s) })
}

/// The largest modulus of the poles per sample.
fn spectral_radius(
    vehicle: &Vehicle,
    controller: &Controller,
    period_s: f64,
    variation: &Variation,
) -> Result<f64, CertifyError> {
    let Variation { lag_s, mass_factor, inertia_factor, delay_s } = *variation;
    let plant = Plant::hover_with_motors(vehicle, lag_s, mass_factor, inertia_factor);
    plant.require_fitting(controller)?;
    let timing = Timing { period_s, delay_samples: 0 };
    let mut largest = 0.0_f64;
    for part in LinearLoop::new(&plant, controller).independent() {
        let delays = vec![delay_s; part.channels.len()];
        let poles = eigenvalues(&SampledLoop::new(&part, &timing, &delays)?.closed_loop())?;
        largest = poles.iter().map(|pole| pole.norm()).fold(largest, f64::max);
    }
    Ok(largest)
}
