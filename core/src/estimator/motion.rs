//! Position, velocity (world frame) and attitude carried over a period by gyroscope and accelerometer (body frame): the
//! prediction of the filter's state.

use nalgebra::{Matrix3, Vector3};

use super::config::{EstimatorConfig, Force, Integration};
use super::covariance::Transition;
use super::rotation::{matrix_back, matrix_of, quaternion_of, times_cross, turned};
use crate::flatness::GRAVITY_M_S2;
use crate::quaternion::Quaternion;
use crate::state::State;

/// Readings of gyroscope and accelerometer, mean values over the period that is predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Imu {
    /// Body rates, rad/s.
    pub body_rates_rad_s: Vector3<f32>,
    /// Specific force along the body axes, m/s^2: 9.81 along z at rest on level ground.
    pub specific_force_m_s2: Vector3<f32>,
}

/// A state carried on, and how its errors go with it.
pub(super) struct Motion {
    pub(super) state: State,
    pub(super) transition: Transition,
    /// From body to world axes at the start of the period.
    pub(super) rotation: Matrix3<f32>,
}

/// `d_x x, d_y y, d_z z`.
#[inline]
fn along_axes(d: [f32; 3], v: &Vector3<f32>) -> Vector3<f32> {
    let [x, y, z] = d;
    Vector3::new(x * v.x, y * v.y, z * v.z)
}

impl Motion {
    /// From a state over a period; `imu` has been checked.
    pub(super) fn over(config: &EstimatorConfig, state: &State, imu: &Imu, period_s: f32) -> Self {
        let (h, rates, measured) = (period_s, &imu.body_rates_rad_s, &imu.specific_force_m_s2);
        let drag = config.drag();
        let rotation = matrix_of(&state.attitude);
        let world_z = Vector3::new(0.0, 0.0, 1.0);
        // Velocity and the world's vertical in the body frame.
        let velocity = rotation.tr_mul(&state.velocity_m_s);
        let vertical = rotation.tr_mul(&world_z);
        let input = match config.force {
            Force::ThrustAxis => Vector3::new(0.0, 0.0, measured.z),
            Force::AllAxes => *measured,
        };
        let turn = rates * h;
        let step = quaternion_of(&turn);
        let attitude = turned(state.attitude, &step);

        let (force, position_m, velocity_m_s) = match config.integration {
            Integration::SecondOrder => {
                // Drag at the velocity of the middle of the period.
                let rate = input - along_axes(drag, &velocity) - vertical * GRAVITY_M_S2;
                let middle = velocity + (velocity.cross(&turn) + rate * h) * 0.5;
                let force = input - along_axes(drag, &middle);
                // The body turns under the force: the first and the second integral of e^([turn] s / h) over s.
                let once = turn.cross(&force);
                let twice = turn.cross(&once);
                let mean = force + once * (1.0 / 2.0) + twice * (1.0 / 6.0);
                let early = force + once * (1.0 / 3.0) + twice * (1.0 / 12.0);
                let acceleration = rotation * mean - world_z * GRAVITY_M_S2;
                let at_first = rotation * early - world_z * GRAVITY_M_S2;
                let position = state.position_m + (state.velocity_m_s + at_first * (0.5 * h)) * h;
                (mean, position, state.velocity_m_s + acceleration * h)
            }
            Integration::Crazyflie => {
                let force = input - along_axes(drag, &velocity);
                let rate = force + velocity.cross(rates) - vertical * GRAVITY_M_S2;
                let at_first = rotation * input - world_z * GRAVITY_M_S2;
                let position = state.position_m + (state.velocity_m_s + at_first * (0.5 * h)) * h;
                (force, position, matrix_of(&attitude) * (velocity + rate * h))
            }
        };

        // An error a of the attitude turns the force, and the body in which the drag acts: d(dv/dt) = -R ([f] + D [v])
        // a.
        let dragged = rotation * Matrix3::from_diagonal(&Vector3::from(drag));
        let from_attitude = times_cross(&rotation, &force) + times_cross(&dragged, &velocity);
        let has_drag = drag != [0.0; 3];
        let transition = Transition {
            period_s,
            velocity: has_drag.then(|| Matrix3::identity() - dragged * rotation.transpose() * h),
            velocity_from_attitude: from_attitude * -h,
            attitude: match config.integration {
                Integration::SecondOrder => matrix_of(&step.conjugate()),
                Integration::Crazyflie => matrix_back(&(turn * 0.5)),
            },
        };
        Self { state: State { position_m, attitude, velocity_m_s }, transition, rotation }
    }
}

/// The attitude after an error has been taken out of it, and the matrix that carries the covariance over to it.
///
/// The error `a` lies between the old attitude and the truth. Seen from the new attitude, an error next to it is turned
/// back by half of it (Mueller, Hehn and D'Andrea 2017): `exp(-[a / 2])`, here to the second order.
pub(super) fn corrected(attitude: Quaternion, error: &Vector3<f32>) -> (Quaternion, Matrix3<f32>) {
    (turned(attitude, &quaternion_of(error)), matrix_back(&(error * 0.5)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sqrt;

    const CONFIG: EstimatorConfig = EstimatorConfig {
        integration: Integration::SecondOrder,
        drag_per_s: [0.45, 0.4],
        ..EstimatorConfig::CRAZYFLIE
    };

    fn state() -> State {
        let q = Quaternion::new(0.9, 0.2, -0.3, 0.25);
        let attitude = q.scaled(1.0 / sqrt(q.dot(q)));
        State { attitude, velocity_m_s: Vector3::new(1.5, -1.0, 0.5), ..State::at_rest(Vector3::new(0.1, 0.2, 1.0)) }
    }

    fn imu() -> Imu {
        Imu { body_rates_rad_s: Vector3::new(1.0, -2.0, 0.5), specific_force_m_s2: Vector3::new(0.3, -0.2, 11.0) }
    }

    /// A circle: constant force across, turning with the body, `v = f / w (sin wt, 1 - cos wt)`.
    #[test]
    fn a_turning_force_gives_a_circle() {
        let config = EstimatorConfig { force: Force::AllAxes, ..CONFIG };
        let (rate, force, period) = (3.0_f32, 2.0, 0.01);
        let imu = Imu {
            body_rates_rad_s: Vector3::new(0.0, 0.0, rate),
            specific_force_m_s2: Vector3::new(force, 0.0, GRAVITY_M_S2),
        };
        let mut state = State::at_rest(Vector3::zeros());
        for _ in 0..100 {
            state = Motion::over(&config, &state, &imu, period).state;
        }
        let (sin, cos) = rate.sin_cos();
        let radius = force / rate;
        let velocity = Vector3::new(radius * sin, radius * (1.0 - cos), 0.0);
        let position = Vector3::new(radius / rate * (1.0 - cos), radius * (1.0 - sin / rate), 0.0);
        // Each step leaves out (w h)^3 / 24 of f h, 2e-8 m/s; a hundred roundings of 6e-8.
        assert!((state.velocity_m_s - velocity).norm() < 8e-6, "{} {velocity}", state.velocity_m_s);
        assert!((state.position_m - position).norm() < 8e-6, "{} {position}", state.position_m);
        assert!((state.attitude.z - (0.5 * rate).sin()).abs() < 2e-6);
    }

    /// Terminal velocity: the drag against the component of gravity in the body's plane, sideways at a fixed tilt.
    #[test]
    fn drag_ends_an_acceleration() {
        let attitude = quaternion_of(&Vector3::new(0.0, 0.3, 0.0));
        let mut state = State { attitude, ..State::at_rest(Vector3::zeros()) };
        let imu = Imu {
            body_rates_rad_s: Vector3::zeros(),
            specific_force_m_s2: Vector3::new(0.0, 0.0, GRAVITY_M_S2 * 0.3_f32.cos()),
        };
        for _ in 0..4000 {
            state = Motion::over(&CONFIG, &state, &imu, 0.01).state;
        }
        // Along body x gravity pulls with g sin 0.3, along body z nothing is left; e^(-0.45 40) of it.
        let along = matrix_of(&attitude).tr_mul(&state.velocity_m_s);
        let wanted = GRAVITY_M_S2 * 0.3_f32.sin() / 0.45;
        assert!((along.x / wanted - 1.0).abs() < 1e-4, "{} {wanted}", along.x);
    }

    /// The transition beside the true motion of a state that is a little off.
    #[test]
    fn errors_go_as_the_transition_says() {
        let period = 0.01;
        for (force, integration) in [
            (Force::ThrustAxis, Integration::SecondOrder),
            (Force::AllAxes, Integration::SecondOrder),
            (Force::ThrustAxis, Integration::Crazyflie),
        ] {
            let config = EstimatorConfig { force, integration, ..CONFIG };
            let start = state();
            let motion = Motion::over(&config, &start, &imu(), period);
            let transition = &motion.transition;
            let is_second_order = matches!(integration, Integration::SecondOrder);
            for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                let small = axis * 0.02;
                let off = State { velocity_m_s: start.velocity_m_s + small, ..start };
                let found = Motion::over(&config, &off, &imu(), period).state.velocity_m_s - motion.state.velocity_m_s;
                let wanted = transition.velocity.map_or(small, |e| e * small);
                // Drag times turn times period, 0.45 * 0.023 * 0.01 of 0.02, and roundings of 2 m/s.
                assert!((found - wanted).norm() < 6e-6, "{found} {wanted}");

                // To either side, so that no square is left of the error.
                let [plus, minus] = [small, -small].map(|small| {
                    let off = State { attitude: turned(start.attitude, &quaternion_of(&small)), ..start };
                    Motion::over(&config, &off, &imu(), period).state
                });
                let found = (plus.velocity_m_s - minus.velocity_m_s) * 0.5;
                let wanted = transition.velocity_from_attitude * small;
                // The vertical's part in the drag, 0.5 * 0.01 * 0.45 * 9.81 * 0.01 of 0.02, and roundings; Euler's rule
                // turns the force by all of the turn, 0.023, instead of half of it.
                let bound = if is_second_order { 8e-6 } else { 6e-5 };
                assert!((found - wanted).norm() < bound, "{found} {wanted}");
                let moved = (plus.position_m - minus.position_m) * 0.5;
                assert!((moved - wanted * (0.5 * period)).norm() < 6e-7, "{moved}");
                let between = (minus.attitude.conjugate() * plus.attitude).vector();
                let wanted = transition.attitude * small;
                // The Crazyflie's is off by half of the turn, 0.0115 of 0.02.
                let bound = if is_second_order { 3e-6 } else { 3e-4 };
                assert!((between - wanted).norm() < bound, "{between} {wanted}");
            }
        }
    }
}
