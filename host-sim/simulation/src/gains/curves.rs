//! The loops of a cascade's design as curves: loop gain and sensitivity by frequency, and the answer to a step.

use quatrack_design::certify::CertifyError;
use quatrack_design::certify::cascade::{
    CascadeChain, CascadeCraft, CascadeVariation, ChainMargins, cascade_craft, in_identified_air,
};

use super::GainsError;
use super::certified::Certified;
use super::design::Problem;
use super::designed::Gains;

/// Frequencies a curve, from the lowest (rad/s) to the Nyquist frequency.
const POINTS: usize = 400;
const LOWEST_RAD_S: f64 = 0.1;
/// Duration of a step's curve, s.
const STEP_S: f64 = 4.0;
/// The accelerometer is looked at once in so many seconds.
const LOOK_S: f64 = 0.01;

/// A design of the cascade in curves, in the identified air.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopCurves {
    /// rad/s.
    pub frequencies_rad_s: Vec<f64>,
    /// Times of the steps' curves, s.
    pub times_s: Vec<f64>,
    /// The four chains.
    pub chains: Vec<ChainCurves>,
}

/// One chain.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainCurves {
    /// The motion of the chain.
    pub name: &'static str,
    /// Size of the open loop's gain, cut at the command.
    pub gain: Vec<f64>,
    /// Distance of the sensitivity from one half: the disk margin is one over its peak.
    pub from_half: Vec<f64>,
    /// Its margins.
    pub margins: ChainMargins,
    /// The way after a step of 1 of its reference, over the times.
    pub step: Vec<f64>,
}

impl LoopCurves {
    /// The curves of a design; none of one for another law.
    ///
    /// # Errors
    /// [`GainsError::Certify`] where eigenvalues are not found.
    pub fn of(certified: &Certified) -> Result<Option<Self>, GainsError> {
        let design = &certified.design;
        let (Problem::Cascade { motor_lag_s, air, .. }, Gains::Cascade(gains)) =
            (&design.problem, &certified.designed.gains)
        else {
            return Ok(None);
        };
        let period_s = 1.0 / f64::from(design.rate.hz());
        let craft = cascade_craft(&design.vehicle, **gains, *motor_lag_s, air, period_s)?;
        let at = in_identified_air(&craft, air);
        let highest_rad_s = std::f64::consts::PI / period_s;
        let share = |k: usize| k as f64 / (POINTS - 1) as f64;
        let frequencies_rad_s: Vec<f64> =
            (0..POINTS).map(|k| LOWEST_RAD_S * (highest_rad_s / LOWEST_RAD_S).powf(share(k))).collect();
        let steps = (STEP_S / period_s).round() as usize;
        let chains =
            [("x", CascadeChain::X), ("y", CascadeChain::Y), ("z", CascadeChain::Z), ("yaw", CascadeChain::Yaw)]
                .into_iter()
                .map(|(name, chain)| {
                    let cut = chain.cut(&craft, &at)?;
                    let sizes = |of: &dyn Fn(f64) -> Option<f64>| {
                        frequencies_rad_s.iter().map(|frequency| of(*frequency).unwrap_or(f64::NAN)).collect()
                    };
                    Ok(ChainCurves {
                        name,
                        gain: sizes(&|frequency| Some(cut.gain(frequency)?.norm())),
                        from_half: sizes(&|frequency| Some((cut.sensitivity(frequency)? - 0.5).norm())),
                        margins: chain.margins(&craft, &at)?,
                        step: stepped(chain, &craft, &at, steps),
                    })
                })
                .collect::<Result<Vec<_>, CertifyError>>()?;
        Ok(Some(Self { frequencies_rad_s, times_s: (0..steps).map(|k| k as f64 * period_s).collect(), chains }))
    }
}

/// From 1 behind its reference, with its first estimates seen and nothing else remembered.
fn stepped(chain: CascadeChain, craft: &CascadeCraft, at: &CascadeVariation, steps: usize) -> Vec<f64> {
    let [without, with] = [false, true].map(|looks| chain.matrix(craft, at, looks));
    let every = (LOOK_S / craft.period_s).round().max(1.0) as usize;
    let mut x = nalgebra::DVector::zeros(with.nrows());
    x[0] = -1.0;
    // The position that the velocity is held to, behind the plant's states.
    match chain {
        CascadeChain::X | CascadeChain::Y => x[5] = -1.0,
        CascadeChain::Z => x[3] = -1.0,
        CascadeChain::Yaw => {}
    }
    (0..steps)
        .map(|step| {
            let way = 1.0 + x[0];
            x = if step.is_multiple_of(every) { &with } else { &without } * &x;
            way
        })
        .collect()
}
