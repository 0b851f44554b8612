//! A region of crafts and air for a cascade: gains and the region's grid in; its least stable point with the spectral
//! radius there out.

use serde::Serialize;

use super::{CascadeChain, CascadeCraft, CascadeVariation};
use crate::certify::CertifyError;

/// Spectral radii closer than this are the same but for rounding.
const SAME: f64 = 1e-9;

/// Largest drag that the core's force observer believes, 1/s.
const BELIEVED_DRAG_MAX_PER_S: f64 = 0.6;

/// Values of each quantity; every value is tried with every value of the others that a chain feels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CascadeRegion {
    /// Time constants of the motors, s.
    pub lags_s: Vec<f64>,
    /// Masses over that told.
    pub mass_factors: Vec<f64>,
    /// Inertias over those told; of roll, pitch and yaw over the motors' learned share, which is inertia
    /// over mass.
    pub inertia_factors: Vec<f64>,
    /// The same about yaw, where others are looked at there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub yaw_inertia_factors: Option<Vec<f64>>,
    /// Forces over commands, of the thrust.
    pub command_factors: Vec<f64>,
    /// Forces over commands of roll, pitch and yaw, over the motors' learned share: 1 after some seconds of
    /// flight.
    pub torque_factors: Vec<f64>,
    /// Delay of the commands, s.
    pub delays_s: Vec<f64>,
    /// Drag, 1/s.
    pub drags_per_s: Vec<f64>,
    /// Moments of the air over the identified one.
    pub moment_factors: Vec<f64>,
    /// Drags that are believed, 1/s.
    pub believed_drags_per_s: Vec<f64>,
    /// Moments over drag that are believed, over that told.
    pub believed_ratio_factors: Vec<f64>,
}

/// The result of one chain over a region.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CascadeCertificate {
    /// The chain.
    pub chain: CascadeChain,
    /// Points that were looked at.
    pub points: usize,
    /// The least stable one.
    pub worst: CascadeVariation,
    /// Its spectral radius; below 1 every point is stable.
    pub spectral_radius: f64,
}

impl CascadeRegion {
    /// Motors between two lags, in five even steps of ratio, and all that a Crazyflie in air may have otherwise: mass
    /// off by 20 %, inertia over mass by 30 %, 70 to 105 % of the force told, up to 10 ms of delay, drag to 0.6 1/s,
    /// moment to 1.2 times the identified one, any air believed that the bounds of the core allow. The craft has flown
    /// for some seconds and learned its motors' share.
    pub fn in_air(shortest_s: f64, longest_s: f64) -> Self {
        Self {
            mass_factors: vec![0.8, 1.0, 1.2],
            inertia_factors: vec![0.7, 1.0, 1.3],
            command_factors: vec![0.7, 0.85, 1.05],
            torque_factors: vec![1.0],
            delays_s: vec![0.0, 0.010],
            drags_per_s: vec![0.0, 0.3, 0.6],
            moment_factors: vec![0.0, 0.6, 1.2],
            believed_drags_per_s: vec![0.0, 0.3, BELIEVED_DRAG_MAX_PER_S],
            believed_ratio_factors: vec![0.0, 1.0, 1.5],
            ..Self::of_lags(shortest_s, longest_s)
        }
    }

    /// The same before the craft has learned its motors' share: torques are 70 to 105 % of their command, the inertia
    /// is as told.
    pub fn before_its_motors_are_seen(&self) -> Self {
        Self {
            inertia_factors: vec![1.0],
            yaw_inertia_factors: None,
            torque_factors: vec![0.7, 0.85, 1.05],
            ..self.clone()
        }
    }

    /// Motors between two lags, and nothing else.
    pub fn of_lags(shortest_s: f64, longest_s: f64) -> Self {
        const STEPS: i32 = 4;
        let ratio = longest_s / shortest_s;
        let one = vec![1.0];
        Self {
            lags_s: (0..=STEPS).map(|k| shortest_s * ratio.powf(f64::from(k) / f64::from(STEPS))).collect(),
            mass_factors: one.clone(),
            inertia_factors: one.clone(),
            yaw_inertia_factors: None,
            command_factors: one.clone(),
            torque_factors: one.clone(),
            delays_s: vec![0.0],
            drags_per_s: vec![0.0],
            moment_factors: vec![0.0],
            believed_drags_per_s: vec![0.0],
            believed_ratio_factors: one,
        }
    }

    /// The points that a chain tells apart.
    fn points(&self, chain: CascadeChain) -> Vec<CascadeVariation> {
        let one = [1.0];
        let none = [0.0];
        let tilt = matches!(chain, CascadeChain::X | CascadeChain::Y);
        let height = chain == CascadeChain::Z;
        let masses = if height { &self.mass_factors[..] } else { &one };
        let inertias = match (chain, &self.yaw_inertia_factors) {
            (CascadeChain::Z, _) => &one,
            (CascadeChain::Yaw, Some(factors)) => &factors[..],
            _ => &self.inertia_factors[..],
        };
        let (drags, believed) = if tilt || height {
            (&self.drags_per_s[..], &self.believed_drags_per_s[..])
        } else {
            (&none[..], &none[..])
        };
        let (moments, ratios) =
            if tilt { (&self.moment_factors[..], &self.believed_ratio_factors[..]) } else { (&none[..], &one[..]) };
        let mut points = vec![CascadeVariation::none(1.0)];
        let mut vary = |values: &[f64], set: fn(&mut CascadeVariation, f64)| {
            points = points
                .iter()
                .flat_map(|point| {
                    values.iter().map(|value| {
                        let mut point = *point;
                        set(&mut point, *value);
                        point
                    })
                })
                .collect();
        };
        vary(&self.lags_s, |point, value| point.lag_s = value);
        vary(masses, |point, value| point.mass_factor = value);
        vary(inertias, |point, value| point.inertia_factor = value);
        vary(if height { &self.command_factors } else { &self.torque_factors }, |point, value| {
            point.command_factor = value;
        });
        vary(&self.delays_s, |point, value| point.delay_s = value);
        vary(drags, |point, value| point.drag_per_s = value);
        vary(moments, |point, value| point.moment_factor = value);
        vary(believed, |point, value| point.believed_drag_per_s = value);
        vary(ratios, |point, value| point.believed_ratio_factor = value);
        points
    }

    /// Finds the least stable point of each chain.
    ///
    /// # Errors
    /// [`CertifyError`] where there are no points, or eigenvalues are not found; an unstable point is no error.
    pub fn certify(&self, craft: &CascadeCraft) -> Result<[CascadeCertificate; 4], CertifyError> {
        let [x, y, z, yaw] = CascadeChain::ALL.map(|chain| self.certify_chain(chain, craft));
        Ok([x?, y?, z?, yaw?])
    }

    fn certify_chain(&self, chain: CascadeChain, craft: &CascadeCraft) -> Result<CascadeCertificate, CertifyError> {
        let points = self.points(chain);
        let mut worst: Option<(CascadeVariation, f64)> = None;
        for point in &points {
            let radius = chain.spectral_radius(craft, point)?;
            // A NaN is as bad as it gets.
            if worst.is_none_or(|(_, held)| radius.is_nan() || radius > held * (1.0 + SAME)) {
                worst = Some((*point, radius));
            }
        }
        let (worst, spectral_radius) = worst.ok_or(CertifyError::EmptyRegion)?;
        Ok(CascadeCertificate { chain, points: points.len(), worst, spectral_radius })
    }
}
