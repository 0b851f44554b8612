//! The quantities of a curve: a curve in, its largest and least quantities at dense samples out.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use quatrack_design::model::GRAVITY_M_S2;
use quatrack_design::model::flat::FlatSample;

use super::{Limit, Plan};
use crate::trajectory::Trajectory;
use crate::trajectory::bspline::BSpline;

/// Samples over the flight: 1 ms for the mild one. A maximum between two samples is missed by the square of that.
const INTERVALS: usize = 30_000;

/// Largest and least quantities of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Length of the path, m.
    pub length_m: f64,
    /// Largest speed, m/s.
    pub speed_max_m_s: f64,
    /// Largest acceleration without gravity, m/s^2.
    pub acceleration_max_m_s2: f64,
    /// Largest angle between thrust and vertical, rad.
    pub tilt_max_rad: f64,
    /// Least thrust over mass, m/s^2.
    pub thrust_min_m_s2: f64,
    /// Largest thrust over mass, m/s^2.
    pub thrust_max_m_s2: f64,
    /// Largest rate at which the thrust axis turns, `sqrt(p^2 + q^2)`, rad/s: a plan bounds it.
    pub turn_rate_max_rad_s: f64,
    /// Largest rate of the heading, rad/s.
    pub heading_rate_max_rad_s: f64,
    /// Largest body rate `|(p, q, r)|`, that of the heading in it, rad/s; not a number if the thrust vanishes or points straight down.
    pub body_rate_max_rad_s: f64,
}

/// A curve measured against its plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Realised {
    /// Largest and least values at dense samples.
    pub sampled: Extremes,
    /// The values that the control points prove for all t, for each bound that they can: the limit and its value, SI.
    pub proved: Vec<(Limit, f64)>,
    /// Distance from each waypoint at its time, m.
    pub misses_m: Vec<f64>,
}

impl Extremes {
    /// Measures a curve.
    pub fn of(curve: &BSpline) -> Self {
        let mut extremes = Self {
            length_m: 0.0,
            speed_max_m_s: 0.0,
            acceleration_max_m_s2: 0.0,
            tilt_max_rad: 0.0,
            thrust_min_m_s2: f64::INFINITY,
            thrust_max_m_s2: 0.0,
            turn_rate_max_rad_s: 0.0,
            heading_rate_max_rad_s: 0.0,
            body_rate_max_rad_s: 0.0,
        };
        let step_s = curve.duration_s() / INTERVALS as f64;
        for k in 0..=INTERVALS {
            let sample = curve.at((k as f64 * step_s).min(curve.duration_s()));
            let speed = sample.velocity_m_s.norm();
            let thrust = sample.acceleration_m_s2 + Vector3::new(0.0, 0.0, GRAVITY_M_S2);
            extremes.length_m += speed * step_s * if k == 0 || k == INTERVALS { 0.5 } else { 1.0 };
            extremes.speed_max_m_s = extremes.speed_max_m_s.max(speed);
            extremes.acceleration_max_m_s2 = extremes.acceleration_max_m_s2.max(sample.acceleration_m_s2.norm());
            extremes.tilt_max_rad = extremes.tilt_max_rad.max(thrust.xy().norm().atan2(thrust.z));
            extremes.thrust_min_m_s2 = extremes.thrust_min_m_s2.min(thrust.norm());
            extremes.thrust_max_m_s2 = extremes.thrust_max_m_s2.max(thrust.norm());
            extremes.heading_rate_max_rad_s = extremes.heading_rate_max_rad_s.max(sample.heading_rate_rad_s.abs());
            let mut rates = body_rates_rad_s(&sample);
            // The heading turns about the thrust axis, which turns nothing but p and q into each other.
            rates.z += sample.heading_rate_rad_s;
            // `max` would drop a NaN.
            for (most, rate) in [
                (&mut extremes.turn_rate_max_rad_s, rates.xy().norm()),
                (&mut extremes.body_rate_max_rad_s, rates.norm()),
            ] {
                if rate.is_nan() || rate > *most {
                    *most = rate;
                }
            }
        }
        extremes
    }
}

/// Body rates `(p, q, r)` of the attitude with `q3 = 0`, rad/s; not a number where that attitude is not defined.
fn body_rates_rad_s(sample: &FlatSample) -> Vector3<f64> {
    let thrust = sample.acceleration_m_s2 + Vector3::new(0.0, 0.0, GRAVITY_M_S2);
    let axis = thrust / thrust.norm();
    let turning = (sample.jerk_m_s3 - axis * axis.dot(&sample.jerk_m_s3)) / thrust.norm();
    let q0 = ((1.0 + axis.z) / 2.0).sqrt();
    let (q1, q2) = (-axis.y / (2.0 * q0), axis.x / (2.0 * q0));
    let attitude = UnitQuaternion::new_unchecked(Quaternion::new(q0, q1, q2, 0.0));
    let p = -(attitude * Vector3::y()).dot(&turning);
    let q = (attitude * Vector3::x()).dot(&turning);
    Vector3::new(p, q, (p * q2 - q * q1) / q0)
}

impl Plan {
    /// Measures a curve against this plan: at dense samples, by its control points, and at the waypoints.
    pub fn realised(&self, curve: &BSpline) -> Realised {
        let limits =
            [Limit::Speed, Limit::Acceleration, Limit::Tilt, Limit::ThrustMin, Limit::ThrustMax, Limit::BodyRate];
        let miss = |waypoint: &super::Waypoint| (curve.at(waypoint.time_s).position_m - waypoint.position_m).norm();
        Realised {
            sampled: Extremes::of(curve),
            proved: limits
                .into_iter()
                .filter(|limit| *limit != Limit::Acceleration || self.bounds().acceleration_max_m_s2.is_some())
                .filter_map(|limit| Some((limit, self.needed(limit, curve)?)))
                .collect(),
            misses_m: self.waypoints().iter().map(miss).collect(),
        }
    }
}
