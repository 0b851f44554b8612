//! The outer loop: errors of position and velocity in, the acceleration to be flown out, with limits nested one in the
//! other.
//!
//! `A = -k_v sat[(v - v_r) + sat((k_p / k_v) (p - p_r))]`: the inner bound is the speed with which a position error is
//! made good. With
//! `k_p = g k_r / k_th`, `k_v = g k_v / k_th` sideways and `4 k / (m (1 + k_f))` in height it is the LQR's own answer
//! where nothing is limited. The specific force that thrust then has to make, `h = a' + A + g z`, keeps its upward part
//! first, then its tilt, then its size. Of it the thrust makes the part along its axis, and no less than keeps the height.

use nalgebra::Vector3;

use super::bounds::{between, larger, shortened, smaller, within};
use super::gains::CascadeGains;
use super::limits::CascadeLimits;
use super::reference::Approach;
use crate::airframe::Airframe;
use crate::flatness::GRAVITY_M_S2;
use crate::math::sqrt;

/// Largest velocity that the velocity loop answers to, m/s.
const VELOCITY_MOST_M_S: f32 = 3.0;
/// Least upward part of the specific force, m/s^2.
const UPWARD_LEAST_M_S2: f32 = 2.0;
/// Its largest size as a share of that of all motors together: the allocation cuts the rest, and keeps the attitude.
const SIZE_MOST_SHARE: f32 = 1.2;

/// By so much the upward acceleration may fall short while the tilt is not the wanted one, m/s^2: more than noise and the tilt's
/// errors along a course make of it.
const SHORTFALL_M_S2: f32 = 1.0;
/// Cosine of the tilt up to which thrust makes good for it.
const UPRIGHT: f32 = 0.57;

/// The loop's gains and limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct OuterLoop {
    across: Axis,
    height: Axis,
    limits: CascadeLimits,
    /// Largest acceleration of thrust, m/s^2.
    most_m_s2: f32,
}

#[derive(Clone, Copy, Debug)]
struct Axis {
    /// Velocity per position error, 1/s.
    position: f32,
    /// Acceleration per velocity error, 1/s.
    velocity: f32,
}

impl OuterLoop {
    /// Of the LQR's gains. Sideways both directions get the mean of theirs, which differ by the inertias: the answer
    /// then does not depend on the heading.
    pub(super) const fn new(gains: &CascadeGains, airframe: &Airframe, limits: &CascadeLimits) -> Self {
        let (roll, pitch, height) = (gains.roll(), gains.pitch(), gains.height());
        let position = 0.5 * GRAVITY_M_S2 * (pitch.position / pitch.rotation - roll.position / roll.rotation);
        let velocity = 0.5 * GRAVITY_M_S2 * (pitch.velocity / pitch.rotation - roll.velocity / roll.rotation);
        let quarter_mass = airframe.mixing.quarter_mass_kg;
        Self {
            across: Axis { position: position / velocity, velocity },
            height: Axis {
                position: height.position / height.velocity,
                velocity: height.velocity / (quarter_mass * (1.0 + height.force)),
            },
            limits: *limits,
            most_m_s2: SIZE_MOST_SHARE * airframe.figures().force_max_n / quarter_mass,
        }
    }

    /// Stiffer or softer by a factor: position gains by its square, velocity gains by itself.
    pub(super) const fn scaled(self, factor: f32) -> Self {
        let Self { across, height, .. } = self;
        Self {
            across: Axis { position: across.position * factor, velocity: across.velocity * factor },
            height: Axis { position: height.position * factor, velocity: height.velocity * factor },
            ..self
        }
    }

    /// How the craft should move beside its reference: the velocity that the position error asks for, as the velocity
    /// loop makes it.
    #[inline(always)]
    pub(super) fn approach(
        &self,
        before: &Approach,
        position: &Vector3<f32>,
        (speed_m_s, period_s): (f32, f32),
    ) -> Approach {
        let across = &self.across;
        let [x, y] = shortened([across.position * position.x, across.position * position.y], speed_m_s);
        let [ux, uy] = before.velocity;
        let [bx, by] = [across.velocity * (-x - ux), across.velocity * (-y - uy)];
        Approach { velocity: [ux + period_s * bx, uy + period_s * by], acceleration: [bx, by] }
    }

    /// The speed over ground with which a position error is made good, m/s.
    #[inline(always)]
    pub(super) const fn speed_m_s(&self) -> f32 {
        self.limits.speed_m_s
    }

    /// The acceleration (m/s^2) that the errors of position and velocity ask for, beside the reference's own, where a
    /// position error over ground is made good with a speed; nothing sideways where the craft is on the ground or is
    /// flown by tilt.
    #[inline(always)]
    pub(super) fn correction(
        &self,
        position: &Vector3<f32>,
        velocity: &Vector3<f32>,
        sideways_m_s: Option<f32>,
    ) -> Vector3<f32> {
        let (across, height) = (&self.across, &self.height);
        let climb = within(height.position * position.z, self.limits.climb_m_s);
        let up = -height.velocity * within(velocity.z + climb, VELOCITY_MOST_M_S);
        let Some(speed_m_s) = sideways_m_s else { return Vector3::new(0.0, 0.0, up) };
        let [sx, sy] = shortened([across.position * position.x, across.position * position.y], speed_m_s);
        let [x, y] = shortened([velocity.x + sx, velocity.y + sy], VELOCITY_MOST_M_S);
        Vector3::new(-across.velocity * x, -across.velocity * y, up)
    }

    /// The specific force (m/s^2) that thrust has to make for a reference's acceleration and a correction, within its
    /// limits.
    #[inline(always)]
    pub(super) fn limited(&self, own: &Vector3<f32>, correction: &Vector3<f32>) -> Vector3<f32> {
        let (x, y) = (own.x + correction.x, own.y + correction.y);
        let up = own.z + correction.z + GRAVITY_M_S2;
        let (upright, most) = (self.limits.tilt_tangent, self.most_m_s2);
        let squared = x * x + y * y;
        let within_tilt = upright * up;
        if up >= UPWARD_LEAST_M_S2 && squared <= within_tilt * within_tilt && squared + up * up <= most * most {
            return Vector3::new(x, y, up);
        }
        self.cut(own, x, y, up)
    }

    /// The acceleration that the thrust should make along its axis, where the wanted specific force has a part `along` it and points
    /// `up`, and the axis points `upward`: that part, or more, all in m/s^2 but the axis.
    ///
    /// A craft that has to tilt back first would fall: its thrust, farther from the vertical than the wanted force, lifts less than that
    /// should. So the upward part falls short by no more than a bound. Beyond 55 degrees of tilt, where thrust hardly lifts, the
    /// least thrust goes down to none at 90.
    #[inline(always)]
    pub(super) fn lifting(along: f32, up: f32, upward: f32) -> f32 {
        let least = up - SHORTFALL_M_S2;
        if along * upward < least { Self::lifted(along, least, upward) } else { along }
    }

    #[inline(never)]
    fn lifted(along: f32, least: f32, upward: f32) -> f32 {
        const FADED: f32 = 1.0 / (UPRIGHT * UPRIGHT);
        larger(along, if upward > UPRIGHT { least / upward } else { least * upward * FADED })
    }

    #[inline(never)]
    fn cut(&self, own: &Vector3<f32>, x: f32, y: f32, up: f32) -> Vector3<f32> {
        let most = self.most_m_s2;
        let up = between(up, UPWARD_LEAST_M_S2, most);
        // A reference that tilts farther may.
        let own_up = own.z + GRAVITY_M_S2;
        let own_across = sqrt(own.x * own.x + own.y * own.y);
        let tangent = self.limits.tilt_tangent;
        let tilted =
            if own_up > UPWARD_LEAST_M_S2 && own_across > tangent * own_up { own_across / own_up } else { tangent };
        let across = smaller(tilted * up, sqrt(most * most - up * up));
        let [x, y] = shortened([x, y], across);
        Vector3::new(x, y, up)
    }
}

#[cfg(test)]
mod tests {
    use super::super::gains::tests::BRUSHLESS;
    use super::*;

    fn outer() -> OuterLoop {
        OuterLoop::new(&BRUSHLESS, &Airframe::CRAZYFLIE_2_1_BRUSHLESS, &CascadeLimits::STANDARD)
    }

    #[test]
    fn near_the_goal_it_is_the_lqrs_answer() {
        let (outer, off, speed) = (outer(), 0.01, 0.02);
        let found = outer.correction(&Vector3::new(off, off, off), &Vector3::new(speed, speed, speed), Some(1.8));
        // The figures of the design: 10.4 1/s^2 and 5.1 1/s, the two directions within 2 % of it.
        let pitch = -9.81 * (0.2150 * off + 0.1060 * speed) / 0.2034;
        assert!((found.x / pitch - 1.0).abs() < 0.02 && found.x == found.y, "{found}");
        let height = -(0.3125 * off + 0.1481 * speed) / (0.0393 / 4.0 * 1.585);
        assert!((found.z / height - 1.0).abs() < 1e-5, "{found}");
    }

    #[test]
    fn a_far_goal_asks_for_a_speed() {
        let outer = outer();
        let at = |distance: f32, speed: f32| {
            outer.correction(&Vector3::new(-distance, 0.0, -distance), &Vector3::new(speed, 0.0, speed), Some(1.8))
        };
        // At the bound of the speed nothing more is asked for, however far the goal.
        for distance in [2.0, 50.0, 1e6] {
            assert!(at(distance, 1.8).x.abs() < 1e-5 && at(distance, 1.5).z.abs() < 1e-5, "{distance}");
        }
        assert_eq!(outer.correction(&Vector3::new(1.0, 1.0, 0.0), &Vector3::zeros(), None), Vector3::zeros());
    }

    #[test]
    fn while_the_craft_tilts_back_its_thrust_keeps_the_height() {
        let at = |wanted: [f32; 2], tilt_deg: f32| {
            let (sin, cos) = tilt_deg.to_radians().sin_cos();
            (OuterLoop::lifting(wanted[0] * sin + wanted[1] * cos, wanted[1], cos), cos)
        };
        let upright = [0.0, 10.0];
        // On its axis, and a little beside it, the force's own part.
        assert_eq!(at(upright, 0.0).0, 10.0);
        assert!((at(upright, 15.0).0 - 10.0 * 15.0_f32.to_radians().cos()).abs() < 1e-5);
        // On the way to the wanted tilt that part lifts enough.
        let (towards, cos) = at([8.0, 10.0], 20.0);
        assert!((towards - (8.0 * 20.0_f32.to_radians().sin() + 10.0 * cos)).abs() < 1e-5 && towards * cos > 10.0);
        // On the way back the upward part is 1 m/s^2 short.
        for tilt_deg in [25.0, 40.0, 54.0] {
            let (along, cos) = at(upright, tilt_deg);
            assert!((along * cos - 9.0).abs() < 1e-5, "{tilt_deg}: {along}");
        }
        // Without a step at the end of it, and none upside down.
        let [before, behind] = [55.24, 55.26].map(|tilt_deg| at(upright, tilt_deg).0);
        assert!((before - behind).abs() < 0.02, "{before} {behind}");
        assert!(at(upright, 89.9).0 < 0.1 && at(upright, 170.0).0 < 0.0);
        assert!(OuterLoop::lifting(f32::NAN, 10.0, 1.0).is_nan());
    }

    #[test]
    fn tilt_and_size_are_bounded_and_height_comes_first() {
        let outer = outer();
        for (x, z) in [(30.0, 0.0), (30.0, -20.0), (5.0, 60.0), (100.0, 5.0)] {
            let found = outer.limited(&Vector3::zeros(), &Vector3::new(x, -x, z));
            let across = found.x.hypot(found.y);
            assert!(found.z >= UPWARD_LEAST_M_S2 && across <= 1.4021 * found.z, "{found}");
            assert!(found.norm() <= 1.0001 * outer.most_m_s2, "{found}");
            assert!((found.z - (z + 9.81)).abs() < 1e-5 || !(-7.81..=14.0).contains(&z));
        }
        let steep = Vector3::new(20.0, 0.0, 0.0);
        let found = outer.limited(&steep, &Vector3::new(5.0, 0.0, 0.0));
        assert!((found.x - 20.0).abs() < 1e-4 && found.z == 9.81, "{found}");
    }
}
