//! The flat map carried on to the angular jerk: derivatives of position to the fifth and of heading to the third in;
//! thrust, attitude and the derivatives of both out, exactly.
//!
//! In the frame F of the tilt alone (the smallest rotation that takes the vertical to n) gravity and acceleration are
//! `T e3`, and the frame turns with `w = (p, q, r)`. Jerk j, snap s and crackle c, seen from F, are then
//!
//! ```text
//! j = T' e3 + w x T e3,   s = dj/dt + w x j,   c = ds/dt + w x s
//! ```
//!
//! which are solved one after the other for `(T', p, q)`, `(T'', p', q')` and `(p'', q'')`:
//!
//! ```text
//! p   = -j_y / T                               q   = j_x / T                                T'  = j_z
//! p'  = -s_y / T - 2 t1 p + r q                q'  = s_x / T - 2 t1 q - r p                 T'' = s_z + T (p^2 + q^2)
//! p'' = -c_y / T - 3 t2 p - 3 t1 (p' - r q) + p w.w + r' q + 2 r q'
//! q'' =  c_x / T - 3 t2 q - 3 t1 (q' + r p) + q w.w - r' p - 2 r p'
//! ```
//!
//! with `t1 = T'/T`, `t2 = T''/T`. That F turns no more than the tilt needs gives r, by `i = 1 / (1 + n_z)`:
//!
//! ```text
//! r = i (n_x p + n_y q)    r' = i (n_x p' + n_y q')    r'' = i (n_x p'' + n_y q'' + p' q - q' p)
//! ```
//!
//! Heading psi turns the body about n on top of F: `w_b = R_z(-psi) w + psi' e3`, differentiated twice.

use nalgebra::Vector3;

use crate::error::{Field, ReferenceError};
use crate::flatness::{GRAVITY_M_S2, MIN_AXIS_Z, MIN_THRUST_M_S2};
use crate::math::sqrt;
use crate::quaternion::{Heading, Quaternion};

/// Derivatives of the position that the map takes, from the second on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub(crate) acceleration: Vector3<f32>,
    pub(crate) jerk: Vector3<f32>,
    pub(crate) snap: Vector3<f32>,
    pub(crate) crackle: Vector3<f32>,
}

/// A heading with its first three derivatives. Most craft do not turn: none means heading 0 throughout.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    heading: Heading,
    rates: [f32; 3],
}

impl Turn {
    /// From a heading whose sine and cosine are known.
    #[inline(always)]
    pub(crate) fn at(heading: Heading, rates: [f32; 3]) -> Self {
        Self { heading, rates }
    }

    /// Rate of the heading.
    #[inline(always)]
    pub(crate) fn rate_rad_s(&self) -> f32 {
        let [rate, ..] = self.rates;
        rate
    }
}

/// The angular motion of the map; rates, accelerations and jerks in the body frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turning {
    pub(crate) attitude: Quaternion,
    pub(crate) heading: Heading,
    /// Thrust over mass, m/s^2, and its rate.
    pub(crate) thrust: f32,
    pub(crate) thrust_rate: f32,
    pub(crate) rates: [f32; 3],
    pub(crate) acceleration: [f32; 3],
    pub(crate) jerk: [f32; 3],
}

impl Turning {
    /// Not finite where the derivatives are not, or are beyond the range of f32.
    ///
    /// # Errors
    /// [`ReferenceError`] at the singularities of the flat map.
    #[inline(always)]
    pub(crate) fn of(motion: &Motion, turn: Option<&Turn>) -> Result<Self, ReferenceError> {
        let (a, j, s, c) = (&motion.acceleration, &motion.jerk, &motion.snap, &motion.crackle);
        let hz = a.z + GRAVITY_M_S2;
        let thrust = sqrt(a.x * a.x + a.y * a.y + hz * hz);
        let inverse = 1.0 / thrust;
        let (nx, ny, nz) = (a.x * inverse, a.y * inverse, hz * inverse);
        let half = 0.5 * (1.0 + nz);
        let (root, scale) = (sqrt(half), 0.5 / half);
        // Fails for NaN.
        if !(thrust >= MIN_THRUST_M_S2 && nz >= MIN_AXIS_Z) {
            return Err(fault(thrust, nz));
        }

        // World to F: the component across n that the tilt turns away, then that along n.
        let across = |v: &Vector3<f32>| {
            let horizontal = nx * v.x + ny * v.y;
            let w = horizontal * scale + v.z;
            (v.x - nx * w, v.y - ny * w, horizontal + nz * v.z)
        };
        let (jx, jy, thrust_rate) = across(j);
        let (p, q) = (-(jy * inverse), jx * inverse);
        let r = scale * (nx * p + ny * q);

        let (sx, sy, sz) = across(s);
        let t1 = thrust_rate * inverse;
        let twice = t1 + t1;
        let p1 = r * q - sy * inverse - twice * p;
        let q1 = sx * inverse - twice * q - r * p;
        let r1 = scale * (nx * p1 + ny * q1);
        let tilting = p * p + q * q;
        let t2 = sz * inverse + tilting;

        let (cx, cy, _) = across(c);
        let (three_t1, turning) = (twice + t1, tilting + r * r - 3.0 * t2);
        let p2 = turning * p - cy * inverse - three_t1 * (p1 - r * q) + r1 * q + 2.0 * (r * q1);
        let q2 = turning * q + cx * inverse - three_t1 * (q1 + r * p) - r1 * p - 2.0 * (r * p1);
        let r2 = scale * (nx * p2 + ny * q2 + (p1 * q - q1 * p));

        let half_axis = root * scale;
        let (tilt_x, tilt_y) = (-(ny * half_axis), nx * half_axis);
        let Some(&Turn { heading, rates: [h1, h2, h3] }) = turn else {
            return Ok(Self {
                attitude: Quaternion::new(root, tilt_x, tilt_y, 0.0),
                heading: Heading::ZERO,
                thrust,
                thrust_rate,
                rates: [p, q, r],
                acceleration: [p1, q1, r1],
                jerk: [p2, q2, r2],
            });
        };
        let ((cos, sin), (c, s)) = (heading.cos_sin(), (heading.cos_half(), heading.sin_half()));
        let turned = |x: f32, y: f32| (cos * x + sin * y, cos * y - sin * x);
        let ((p, q), (p1, q1), (p2, q2)) = (turned(p, q), turned(p1, q1), turned(p2, q2));
        let (p1_seen, q1_seen) = (p1 + h1 * q, q1 - h1 * p);
        Ok(Self {
            // `q_tilt q_z(psi)`, whose tilt has no third component.
            attitude: Quaternion::new(root * c, tilt_x * c + tilt_y * s, tilt_y * c - tilt_x * s, root * s),
            heading,
            thrust,
            thrust_rate,
            rates: [p, q, r + h1],
            acceleration: [p1_seen, q1_seen, r1 + h2],
            jerk: [p2 + h1 * (q1 + q1_seen) + h2 * q, q2 - h1 * (p1 + p1_seen) - h2 * p, r2 + h3],
        })
    }
}

/// Why a direction of thrust has no attitude.
#[cold]
fn fault(thrust_m_s2: f32, axis_z: f32) -> ReferenceError {
    if thrust_m_s2 < MIN_THRUST_M_S2 {
        ReferenceError::NoThrust { thrust_m_s2 }
    } else if axis_z < MIN_AXIS_Z {
        ReferenceError::Inverted { axis_z }
    } else {
        ReferenceError::NonFinite { field: Field::Acceleration, value: thrust_m_s2 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(acceleration: [f32; 3]) -> Motion {
        let zero = Vector3::zeros();
        Motion { acceleration: Vector3::from(acceleration), jerk: zero, snap: zero, crackle: zero }
    }

    #[test]
    fn a_turn_on_an_upright_axis_has_the_derivatives_of_its_heading() {
        let turn = Turn::at(Heading::from_angle(0.7), [0.5, -1.5, 4.0]);
        let turning = Turning::of(&motion([0.0; 3]), Some(&turn)).unwrap();
        let found = [turning.rates, turning.acceleration, turning.jerk];
        assert_eq!(found, [[0.0, 0.0, 0.5], [0.0, 0.0, -1.5], [0.0, 0.0, 4.0]]);
    }

    #[test]
    fn each_singularity_alone_is_refused_by_name() {
        // Upright with a thrust of 0.01 m/s^2; upside down with one of 10 m/s^2; and NaN, of which neither is true.
        let refused = |z: f32| Turning::of(&motion([0.0, 0.0, z - GRAVITY_M_S2]), None).unwrap_err();
        assert!(matches!(refused(0.01), ReferenceError::NoThrust { .. }), "{:?}", refused(0.01));
        assert!(matches!(refused(-10.0), ReferenceError::Inverted { .. }), "{:?}", refused(-10.0));
        assert!(Turning::of(&motion([f32::NAN, 0.0, 0.0]), None).is_err());
    }
}
