//! The reference in air: the forces and moments that the motion takes in air, exactly, with their derivatives up to the
//! lead that the motors need.
//!
//! Drag that is the same in all directions asks for an acceleration more, `a' = a + d v`, and so `j' = j + d a`, `s' =
//! s + d j`,
//! `c' = c + d s`; a lateral disturbance for one less. The flat map of these gives attitude, body rates and forces. The
//! moment of the air in the reference's body frame, `v_b = R_r' v`, `v_b' = R_r' a - w_r x v_b`, is answered by `tau =
//! (-c_x v_b,y, c_y v_b,x)`. On the way to a goal the craft moves beside its reference: a share of that velocity, as
//! the position error asks for it, is added to
//! `v` there. It is a function of the position alone, so that a wind does not enter.

use nalgebra::Vector3;

use super::air_learner::Coefficients;
use crate::airframe::Airframe;
use crate::error::ReferenceError;
use crate::mixer::Parts;
use crate::motor_reference::{FifthOrderSample, Motion, Turn, Turning};
use crate::quaternion::{Heading, Quaternion};

/// Cosine and sine of half the farthest heading from the craft's own, 0.8 rad, and the tangent.
const HALF_APART: [f32; 3] = [0.921_061, 0.389_418_3, 0.422_793_2];

/// Share of the moment on the way to a reference that is answered. A craft without any moment, told of one, then
/// overshoots a goal by as much as one that has it: a centimetre each.
const APPROACH_SHARE: f32 = 0.4;

/// The air and the disturbance that act on the craft.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    pub(super) air: Coefficients,
    /// Lateral disturbance in the world frame, m/s^2, and its slope, m/s^3.
    pub(super) disturbance: [f32; 2],
    pub(super) slope: [f32; 2],
    /// The wind's moment to be answered, as parts, N.
    pub(super) wind: [f32; 2],
    /// The craft's way to the reference.
    pub(super) approach: Approach,
}

/// How the craft should move beside its reference on its way there, sideways in the world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Approach {
    /// m/s.
    pub(super) velocity: [f32; 2],
    /// m/s^2.
    pub(super) acceleration: [f32; 2],
}

impl Approach {
    pub(super) const NONE: Self = Self { velocity: [0.0; 2], acceleration: [0.0; 2] };
}

impl Surroundings {
    /// Nothing.
    pub(super) const STILL: Self = Self {
        air: Coefficients { drag: 0.0, moment: [0.0; 2] },
        disturbance: [0.0; 2],
        slope: [0.0; 2],
        wind: [0.0; 2],
        approach: Approach::NONE,
    };
}

/// The reference as the loop takes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct InAir {
    /// Acceleration that thrust and gravity have to make, m/s^2.
    pub(super) acceleration: Vector3<f32>,
    pub(super) heading: Heading,
    pub(super) body_rates: [f32; 3],
    /// Forces and the commands that give them, in parts, N.
    pub(super) forces: Parts,
    pub(super) commands: Parts,
    /// The part of the forces that answers the air, roll and pitch, N.
    pub(super) answer: [f32; 2],
    /// Velocity in the body frame, x and y, m/s.
    pub(super) body_velocity: [f32; 2],
}

impl InAir {
    /// For a craft at an attitude. The sample's own angle of heading is not looked at, but its rates are.
    ///
    /// # Errors
    /// [`ReferenceError`] at the singularities of the flat map.
    #[inline(always)]
    pub(super) fn of(
        sample: &FifthOrderSample,
        heading: Heading,
        around: &Surroundings,
        own: Quaternion,
        airframe: &Airframe,
    ) -> Result<Self, ReferenceError> {
        let (flat, d) = (&sample.flat, around.air.drag);
        let (v, a, j, s, c) =
            (&flat.velocity_m_s, &flat.acceleration_m_s2, &flat.jerk_m_s3, &sample.snap_m_s4, &sample.crackle_m_s5);
        let ([dx, dy], [sx, sy]) = (around.disturbance, around.slope);
        let motion = Motion {
            acceleration: Vector3::new(a.x + d * v.x - dx, a.y + d * v.y - dy, a.z + d * v.z),
            jerk: Vector3::new(j.x + d * a.x - sx, j.y + d * a.y - sy, j.z + d * a.z),
            snap: Vector3::new(s.x + d * j.x, s.y + d * j.y, s.z + d * j.z),
            crackle: Vector3::new(c.x + d * s.x, c.y + d * s.y, c.z + d * s.z),
        };
        let rates = [flat.heading_rate_rad_s, sample.heading_acceleration_rad_s2, sample.heading_jerk_rad_s3];
        let turn = match kept_near(heading, own) {
            None => Turn::at(heading, rates),
            Some(nearer) => Turn::at(nearer, [0.0; 3]),
        };
        let turning = Turning::of(&motion, Some(&turn))?;
        let (forces, force_rates) = turning.force_parts(airframe);

        let [p, q, r] = turning.rates;
        let ([vx, vy, vz], [ax, ay, _]) = (to_body(turning.attitude, v), to_body(turning.attitude, a));
        let body_velocity = [vx, vy];
        let Approach { velocity: [ux, uy], acceleration: [bx, by] } = around.approach;
        let share = APPROACH_SHARE;
        let ([ux, uy, uz], [bx, by, _]) = (
            to_body(turning.attitude, &Vector3::new(share * ux, share * uy, 0.0)),
            to_body(turning.attitude, &Vector3::new(share * bx, share * by, 0.0)),
        );
        let ([vx, vy, vz], [ax, ay]) = ([vx + ux, vy + uy, vz + uz], [ax + bx, ay + by]);
        let (vx1, vy1) = (ax - (q * vz - r * vy), ay - (r * vx - p * vz));
        let ([cx, cy], [wx, wy]) = (around.air.moment, around.wind);
        let answer = [wx - cx * vy, wy + cy * vx];
        let [roll, pitch] = answer;
        let lead_s = airframe.lead_s;
        Ok(Self {
            acceleration: motion.acceleration,
            heading: turning.heading,
            body_rates: turning.rates,
            forces: Parts { roll: forces.roll + roll, pitch: forces.pitch + pitch, ..forces },
            commands: Parts {
                thrust: forces.thrust + lead_s * force_rates.thrust,
                roll: forces.roll + roll + lead_s * (force_rates.roll - cx * vy1),
                pitch: forces.pitch + pitch + lead_s * (force_rates.pitch + cy * vx1),
                yaw: forces.yaw + lead_s * force_rates.yaw,
            },
            answer,
            body_velocity,
        })
    }
}

/// A heading moved to within 0.8 rad of a craft's own, where it is farther off.
#[inline(always)]
fn kept_near(heading: Heading, own: Quaternion) -> Option<Heading> {
    let (c, s) = (heading.cos_half(), heading.sin_half());
    // Cosine and sine of half the difference, times the cosine of half the craft's tilt.
    let (cos, sin) = (c * own.w + s * own.z, s * own.w - c * own.z);
    let [half_cos, half_sin, tangent] = HALF_APART;
    if sin.abs() <= tangent * cos.abs() {
        return None;
    }
    // Upside down the craft has no heading of its own.
    let squared = own.w * own.w + own.z * own.z;
    if squared < 1e-6 {
        return None;
    }
    let side = if (sin < 0.0) == (cos < 0.0) { half_sin } else { -half_sin };
    Some(Heading::from_half(half_cos * own.w - side * own.z, half_cos * own.z + side * own.w))
}

/// A world vector in the frame of an attitude of norm 1.
#[inline(always)]
fn to_body(q: Quaternion, v: &Vector3<f32>) -> [f32; 3] {
    // `v + 2 u x (u x v - w v)`, u the vector part.
    let (tx, ty, tz) =
        (q.y * v.z - q.z * v.y - q.w * v.x, q.z * v.x - q.x * v.z - q.w * v.y, q.x * v.y - q.y * v.x - q.w * v.z);
    [v.x + 2.0 * (q.y * tz - q.z * ty), v.y + 2.0 * (q.z * tx - q.x * tz), v.z + 2.0 * (q.x * ty - q.y * tx)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_is_turned_into_the_body() {
        let q = Quaternion::new(0.5, 0.5, -0.1, 0.7);
        let v = Vector3::new(0.3, -1.2, 2.0);
        let turned = (q.conjugate() * Quaternion::new(0.0, v.x, v.y, v.z) * q).vector();
        let [x, y, z] = to_body(q, &v);
        // Some roundings of numbers of about 2.
        assert!((Vector3::new(x, y, z) - turned).norm() < 2e-6, "{turned}");
    }

    #[test]
    fn a_heading_stays_within_its_distance_of_the_crafts_own() {
        for own in [-3.0_f32, -1.0, 0.0, 0.5, 3.1] {
            for apart in [-3.1_f32, -1.5, -0.81, -0.79, 0.0, 0.79, 0.81, 1.5, 3.1] {
                for tilt in [Quaternion::IDENTITY, Quaternion::new(0.8, 0.36, -0.48, 0.0)] {
                    let attitude = tilt * Heading::from_angle(own).quaternion();
                    let asked = Heading::from_angle(own + apart);
                    let kept = kept_near(asked, attitude).unwrap_or(asked);
                    let wanted = Heading::from_angle(own + apart.clamp(-0.8, 0.8));
                    let ((a, b), (c, d)) = (kept.cos_sin(), wanted.cos_sin());
                    // Some roundings of numbers below 1.
                    assert!((a - c).abs() + (b - d).abs() < 2e-6, "{own} {apart}");
                }
            }
        }
        assert!(kept_near(Heading::ZERO, Quaternion::new(0.0, 1.0, 0.0, 0.0)).is_none());
    }

    #[test]
    fn without_air_nothing_is_added() {
        let mut sample = FifthOrderSample::at_rest(Vector3::zeros(), 0.0);
        (sample.flat.velocity_m_s, sample.flat.acceleration_m_s2) =
            (Vector3::new(1.0, 2.0, 0.5), Vector3::new(3.0, 1.0, 2.0));
        (sample.flat.jerk_m_s3, sample.snap_m_s4) = (Vector3::new(4.0, -5.0, 6.0), Vector3::new(7.0, 8.0, -9.0));
        let still = Surroundings::STILL;
        let craft = Airframe::CRAZYFLIE_2_1;
        let found = InAir::of(&sample, Heading::ZERO, &still, Quaternion::IDENTITY, &craft).unwrap();
        let wanted = crate::MotorReference::from_flat(&sample, &craft).unwrap();
        assert_eq!(found.forces.forces(), wanted.forces_n());
        assert_eq!(found.commands.forces(), wanted.commands_n());
        assert_eq!(Vector3::from(found.body_rates), wanted.body_rates_rad_s());
    }

    #[test]
    fn derivatives_in_air_are_those_of_the_acceleration_in_air() {
        // Along x = sin t the forces of half a millisecond later are the commands without the lag's share.
        let around = Surroundings {
            air: Coefficients { drag: 0.4, moment: [4e-3, 5e-3] },
            disturbance: [0.0; 2],
            slope: [0.0; 2],
            wind: [0.0; 2],
            approach: Approach::NONE,
        };
        let craft = Airframe::CRAZYFLIE_2_1;
        let at = |t: f64| {
            let (s, c) = (t.sin() as f32, t.cos() as f32);
            let on = |x: f32, y: f32| Vector3::new(x, y, 0.0);
            let flat = crate::FlatSample {
                position_m: on(s, 2.0 * c),
                velocity_m_s: on(c, -2.0 * s),
                acceleration_m_s2: on(-s, -2.0 * c),
                jerk_m_s3: on(-c, 2.0 * s),
                heading_rad: 0.0,
                heading_rate_rad_s: 0.7,
            };
            let sample = FifthOrderSample {
                snap_m_s4: on(s, 2.0 * c),
                crackle_m_s5: on(c, -2.0 * s),
                ..FifthOrderSample::of_jerk(flat)
            };
            let heading = Heading::from_angle(0.7 * t as f32);
            InAir::of(&sample, heading, &around, heading.quaternion(), &craft).unwrap()
        };
        let (now, h) = (at(1.0), 0.02);
        let (before, after) = (at(1.0 - h), at(1.0 + h));
        let lag = craft.figures().motor_lag_s;
        for part in [|p: &Parts| p.thrust, |p: &Parts| p.roll, |p: &Parts| p.pitch, |p: &Parts| p.yaw] {
            let rate = (part(&after.forces) - part(&before.forces)) / (2.0 * h as f32);
            let found = (part(&now.commands) - part(&now.forces)) / lag;
            // The difference's own error, h^2 / 6 of the third derivative, and the roundings over 2 h.
            assert!((found - rate).abs() < 3e-6, "{found} {rate}");
        }
    }
}
