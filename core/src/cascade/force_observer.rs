//! The disturbing force: an observer of the acceleration (m/s^2) beside thrust, gravity and the known drag, fed by the
//! velocity alone.
//!
//! `v^' = n (T^ / m + d_z) - g z - d v + (d_x, d_y, 0)`, corrected by `e = v - v^`. Across, the disturbance is a double integrator,
//! `d' = s`, and the gains are those of the steady Kalman filter for a velocity noise of 0.01 m/s and a noise of 6 m/s^3/sqrt(s)
//! on the slope s: a wind that grows is followed without lag. Along the thrust the error is one of the thrust itself, `d_z`,
//! and acts along n: held in the world frame instead, the loop is unstable with a craft 20 % lighter than told.

use nalgebra::Vector3;

use super::bounds::{is_beyond, within};
use crate::flatness::GRAVITY_M_S2;

/// Largest disturbance across and along the thrust, m/s^2: the latter is that of motors that give 70 % of their command.
const DISTURBANCE_MAX_M_S2: f32 = 4.0;
const ALONG_MAX_M_S2: f32 = 5.0;

/// Largest slope of it, m/s^3.
const SLOPE_MAX_M_S3: f32 = 15.0;

/// Share of the slope that is left after a step with the disturbance on its bound.
const SLOPE_DECAY: f32 = 0.95;

/// Velocity jump along an axis, between measured and predicted, that no air makes, m/s: that of 25 m/s^2 while an
/// estimate is held for 10 ms, and the error that a disturbance of 11 m/s^2 leaves at every step until it is learned. A
/// wall stops a craft faster.
const JUMP_M_S: f32 = 0.25;
/// Jump beyond which it is another estimate, or the first one, m/s.
const ANOTHER_M_S: f32 = 3.0;

/// Poles along the thrust: natural frequency, rad/s, and damping.
const ALONG_RAD_S: f32 = 5.0;
const ALONG_DAMPING: f32 = 0.8;

/// Gains a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceObserver {
    /// Of velocity, disturbance and slope, across.
    across: [f32; 3],
    /// Of velocity and disturbance, along the thrust.
    along: [f32; 2],
    period_s: f32,
}

/// Memory of the force observer: the predicted velocity and the disturbance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Disturbance {
    velocity: Vector3<f32>,
    /// The acceleration over the last step by all forces, m/s^2.
    pub(super) acceleration: Vector3<f32>,
    /// Across in the world frame, m/s^2, and its slope, m/s^3.
    pub(super) across: [f32; 2],
    pub(super) slope: [f32; 2],
    /// Along the thrust, m/s^2.
    pub(super) along: f32,
}

/// The forces on the craft over the step that has ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pushed {
    /// Velocity at its end, and the mean over it, m/s.
    pub(super) velocity: Vector3<f32>,
    pub(super) mean_velocity: Vector3<f32>,
    /// Means of thrust axis and thrust over mass, m/s^2.
    pub(super) axis: Vector3<f32>,
    pub(super) thrust: f32,
    /// Drag, 1/s.
    pub(super) drag: f32,
}

impl ForceObserver {
    /// For a control period: the filter's poles are kept by the powers of the period that its gains go with.
    pub(super) const fn new(period_s: f32) -> Self {
        let ratio = period_s / 0.002;
        Self {
            across: [0.090_68 * ratio, 2.154_2 * ratio, 25.587 * ratio],
            along: [2.0 * ALONG_DAMPING * ALONG_RAD_S * period_s, ALONG_RAD_S * ALONG_RAD_S * period_s],
            period_s,
        }
    }

    /// Moves the memory on by a step; whether the craft has been stopped over ground as only a wall or a hand does.
    #[inline(always)]
    pub(super) fn step(&self, memory: &mut Disturbance, pushed: &Pushed) -> bool {
        let (h, n, v, mean) = (self.period_s, &pushed.axis, &pushed.velocity, &pushed.mean_velocity);
        let Disturbance { velocity: known, across: [dx, dy], slope: [sx, sy], along, .. } = *memory;
        let (thrust, d) = (pushed.thrust + along, pushed.drag);
        let a = Vector3::new(
            n.x * thrust - d * mean.x + dx,
            n.y * thrust - d * mean.y + dy,
            n.z * thrust - d * mean.z - GRAVITY_M_S2,
        );
        let expected = Vector3::new(known.x + h * a.x, known.y + h * a.y, known.z + h * a.z);
        let (ex, ey, ez) = (v.x - expected.x, v.y - expected.y, v.z - expected.z);
        if is_beyond(ex, JUMP_M_S) || is_beyond(ey, JUMP_M_S) || is_beyond(ez, JUMP_M_S) {
            memory.velocity = *v;
            let is_same = ex.abs() <= ANOTHER_M_S && ey.abs() <= ANOTHER_M_S;
            let is_across = is_beyond(ex, JUMP_M_S) || is_beyond(ey, JUMP_M_S);
            return is_same && is_across && ex * expected.x + ey * expected.y < 0.0;
        }
        let [l1, l2, l3] = self.across;
        let [m1, m2] = self.along;
        memory.velocity = Vector3::new(expected.x + l1 * ex, expected.y + l1 * ey, expected.z + m1 * ez);
        let (x, slope_x) = bounded(dx + h * sx + l2 * ex, sx + l3 * ex);
        let (y, slope_y) = bounded(dy + h * sy + l2 * ey, sy + l3 * ey);
        memory.across = [x, y];
        memory.slope = [slope_x, slope_y];
        memory.along = within(along + m2 * (n.z * ez), ALONG_MAX_M_S2);
        // Not of a first step, whose forces are not known.
        memory.acceleration = a;
        false
    }
}

/// A disturbance and its slope within their bounds.
#[inline(always)]
fn bounded(disturbance: f32, slope: f32) -> (f32, f32) {
    let slope = within(slope, SLOPE_MAX_M_S3);
    let kept = within(disturbance, DISTURBANCE_MAX_M_S2);
    if kept == disturbance { (kept, slope) } else { (kept, slope * SLOPE_DECAY) }
}

impl Disturbance {
    /// None, at a velocity not seen yet: the first is taken as it is.
    pub(super) const NONE: Self = Self {
        velocity: Vector3::new(f32::INFINITY, 0.0, 0.0),
        acceleration: Vector3::new(0.0, 0.0, 0.0),
        across: [0.0; 2],
        slope: [0.0; 2],
        along: 0.0,
    };

    /// Forgotten, at a velocity: as for a craft on the ground.
    pub(super) fn rest(&mut self, velocity: &Vector3<f32>) {
        *self = Self { velocity: *velocity, ..Self::NONE };
    }

    /// At a velocity that is not known any more.
    pub(super) fn anew(self) -> Self {
        Self { velocity: Self::NONE.velocity, ..self }
    }

    /// Whether it is on its bound.
    #[inline(always)]
    pub(super) fn is_on_bound(&self) -> bool {
        let [x, y] = self.across;
        x.abs() >= DISTURBANCE_MAX_M_S2 || y.abs() >= DISTURBANCE_MAX_M_S2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f32 = 0.002;

    /// The disturbance found after some seconds of a force along x that grows, and a thrust that is off.
    fn found(seconds: f32, slope: f32, thrust_off: f32) -> Disturbance {
        let (observer, mut memory) = (ForceObserver::new(H), Disturbance::NONE);
        let (mut vx, mut vz, mut time) = (0.0, 0.0, 0.0);
        while time < seconds {
            let before = Vector3::new(vx, 0.0, vz);
            vx += H * (slope * time - 0.3 * vx);
            vz += H * (thrust_off - 0.3 * vz);
            let velocity = Vector3::new(vx, 0.0, vz);
            let mean_velocity = (before + velocity) * 0.5;
            let thrust = GRAVITY_M_S2;
            observer.step(&mut memory, &Pushed { velocity, mean_velocity, axis: Vector3::z(), thrust, drag: 0.3 });
            time += H;
        }
        memory
    }

    #[test]
    fn a_growing_force_is_followed_without_lag() {
        let Disturbance { across: [x, y], slope: [slope, _], .. } = found(2.0, 1.0, 0.0);
        // The slope has settled (poles of 23 rad/s); rounding of the velocity times the gains.
        assert!((x - 2.0).abs() < 0.01 && (slope - 1.0).abs() < 0.01 && y == 0.0, "{x} {slope}");
    }

    #[test]
    fn a_thrust_that_is_off_is_found_along_the_thrust() {
        let Disturbance { across, along, .. } = found(4.0, 0.0, -1.0);
        assert!((along + 1.0).abs() < 1e-3 && across == [0.0; 2], "{along}");
    }

    #[test]
    fn a_wall_stops_a_craft_and_a_gust_or_another_estimate_does_not() {
        let observer = ForceObserver::new(H);
        let at = |speed: f32| Vector3::new(speed, 0.0, 0.0);
        for (before, after, is_stopped) in [(1.0, 0.7, true), (1.0, 1.3, false), (1.0, 0.9, false), (1.0, -4.0, false)]
        {
            let mut memory = Disturbance { velocity: at(before), ..Disturbance::NONE };
            let (velocity, axis, thrust) = (at(after), Vector3::z(), GRAVITY_M_S2);
            let found =
                observer.step(&mut memory, &Pushed { velocity, mean_velocity: velocity, axis, thrust, drag: 0.3 });
            assert_eq!(found, is_stopped, "{before} {after}");
            assert!(!is_stopped || memory.across == [0.0; 2], "nothing is learned of it");
        }
        let mut memory = Disturbance { velocity: at(1.0), ..Disturbance::NONE }.anew();
        let first =
            Pushed { velocity: at(0.0), mean_velocity: at(0.0), axis: Vector3::z(), thrust: GRAVITY_M_S2, drag: 0.3 };
        assert!(!observer.step(&mut memory, &first) && memory.velocity == at(0.0));
    }

    #[test]
    fn it_stays_within_its_bounds() {
        let Disturbance { across: [x, _], slope: [slope, _], along, .. } = found(8.0, 4.0, -40.0);
        assert_eq!((x, along), (DISTURBANCE_MAX_M_S2, -ALONG_MAX_M_S2));
        assert!(slope.abs() <= SLOPE_MAX_M_S3);
    }
}
