//! Results of a flight: its samples in, the paper's IAE and the figures a pilot asks for out.

use quatrack_design::model::{attitude, position, thrust_axis};
use serde::Serialize;

use super::closed_loop::{Flight, SAMPLE_PERIOD_S};

/// Figures of one flight. A flight that was lost has figures up to there and no IAE.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// Integral (22) of the position error's norm, trapezoidal rule over the samples, m s.
    pub iae_integral_m_s: Option<f64>,
    /// Sum (23) of the position error's norm over all samples, times the sampling period, m s: Table I.
    pub iae_m_s: Option<f64>,
    /// Largest position error, m.
    pub max_error_m: f64,
    /// Root of the mean squared position error, m.
    pub rms_error_m: f64,
    /// Lowest height, m.
    pub min_z_m: f64,
    /// Time at which it was lowest, s.
    pub min_z_time_s: f64,
    /// Largest tilt of the thrust axis from the vertical, degrees.
    pub max_tilt_deg: f64,
    /// Largest thrust, m/s^2.
    pub max_thrust_m_s2: f64,
    /// Largest body rate of any axis, rad/s.
    pub max_body_rate_rad_s: f64,
    /// Control steps whose command was cut to the limits.
    pub saturated_steps: u64,
}

impl Metrics {
    /// Of a flight with at least one sample; all zero without.
    pub fn of(flight: &Flight) -> Self {
        let errors: Vec<f64> = flight.samples.iter().map(|s| s.position_error_m().norm()).collect();
        let sum: f64 = errors.iter().sum();
        let ends = errors.first().copied().unwrap_or(0.0) + errors.last().copied().unwrap_or(0.0);
        let whole = flight.lost.is_none();
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, f64::max);
        let tilt_deg =
            |s: &super::closed_loop::Sample| thrust_axis(&attitude(&s.state)).z.clamp(-1.0, 1.0).acos().to_degrees();
        let (min_z_time_s, min_z_m) = flight
            .samples
            .iter()
            .map(|s| (s.time_s, position(&s.state).z))
            .reduce(|lowest, next| if next.1 < lowest.1 { next } else { lowest })
            .unwrap_or_default();
        Self {
            iae_integral_m_s: whole.then_some((sum - 0.5 * ends) * SAMPLE_PERIOD_S),
            iae_m_s: whole.then_some(sum * SAMPLE_PERIOD_S),
            max_error_m: largest(&mut errors.iter().copied()),
            rms_error_m: (errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt(),
            min_z_m,
            min_z_time_s,
            max_tilt_deg: largest(&mut flight.samples.iter().map(tilt_deg)),
            max_thrust_m_s2: largest(&mut flight.samples.iter().map(|s| s.input[0])),
            max_body_rate_rad_s: largest(&mut flight.samples.iter().map(|s| s.input.fixed_rows::<3>(1).amax())),
            saturated_steps: flight.saturated_steps,
        }
    }
}
