//! How far one reference is from another: two references in, the largest differences of state and input out.

use quatrack_design::model::{attitude, position, velocity};
use serde::Serialize;

use super::reference::Reference;

/// Parts of the time, in the middle of which the two are compared: at the very end, one that is a rounding error shorter
/// would already rest. Of a peak that lasts a hundred of them, at most 1e-4 is missed.
const PARTS: u32 = 20_000;

/// Largest differences over the whole time; vectors by their Euclidean norm. Not a number where either reference asks for
/// an acceleration that has no attitude (free fall, thrust downwards).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Deviation {
    /// Position, m.
    pub position_m: f64,
    /// Velocity, m/s.
    pub velocity_m_s: f64,
    /// Acceleration, m/s^2.
    pub acceleration_m_s2: f64,
    /// Jerk, m/s^3.
    pub jerk_m_s3: f64,
    /// Heading, rad.
    pub heading_rad: f64,
    /// Rate of the heading, rad/s.
    pub heading_rate_rad_s: f64,
    /// Angle of the rotation between the attitudes, rad.
    pub attitude_rad: f64,
    /// Thrust over mass, m/s^2.
    pub thrust_m_s2: f64,
    /// Body rates, rad/s.
    pub body_rates_rad_s: f64,
}

impl Deviation {
    /// Of `other` from `reference`, over the time of `reference`.
    pub fn between(reference: &dyn Reference, other: &dyn Reference) -> Self {
        let mut largest = Self::default();
        for k in 0..PARTS {
            let t_s = reference.duration_s() * (f64::from(k) + 0.5) / f64::from(PARTS);
            let (a, b) = (reference.at(t_s), other.at(t_s));
            let rates = |input: &quatrack_design::model::InputVector| input.fixed_rows::<3>(1).into_owned();
            // The chord between unit quaternions is twice the sine of a quarter of the angle; q and -q are one attitude.
            let (p, q) = (attitude(&a.state), attitude(&b.state));
            let chord = if p.dot(&q) < 0.0 { (p + q).norm() } else { (p - q).norm() };
            for (most, difference) in [
                (&mut largest.position_m, (position(&a.state) - position(&b.state)).norm()),
                (&mut largest.velocity_m_s, (velocity(&a.state) - velocity(&b.state)).norm()),
                (&mut largest.acceleration_m_s2, (a.acceleration_m_s2 - b.acceleration_m_s2).norm()),
                (&mut largest.jerk_m_s3, (a.jerk_m_s3 - b.jerk_m_s3).norm()),
                (&mut largest.heading_rad, (a.heading_rad - b.heading_rad).abs()),
                (&mut largest.heading_rate_rad_s, (a.heading_rate_rad_s - b.heading_rate_rad_s).abs()),
                (&mut largest.attitude_rad, 4.0 * (0.5 * chord).asin()),
                (&mut largest.thrust_m_s2, (a.input[0] - b.input[0]).abs()),
                (&mut largest.body_rates_rad_s, (rates(&a.input) - rates(&b.input)).norm()),
            ] {
                // `max` would drop a NaN.
                if difference.is_nan() || difference > *most {
                    *most = difference;
                }
            }
        }
        largest
    }
}
