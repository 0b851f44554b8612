//! The same filter in f64 with whole matrices of nine rows, beside the blocks in f32.

use nalgebra::{Matrix3, SMatrix, SVector, UnitQuaternion, Vector3};
use quatrack::estimator::{Estimate, Estimator, EstimatorConfig, Imu, ImuAverager};
use quatrack::{Quaternion, State};

use crate::estimator::simulation::{Flight, POSITION_M, told_the_truth};

type Matrix9 = SMatrix<f64, 9, 9>;
type Vector9 = SVector<f64, 9>;

/// State and covariance by the equations of the module's documentation, term by term.
struct Twin {
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    attitude: UnitQuaternion<f64>,
    covariance: Matrix9,
}

fn diagonal(d: [f64; 3]) -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::from(d))
}

impl Twin {
    fn of(estimate: &Estimate) -> Self {
        let State { position_m, attitude: Quaternion { w, x, y, z }, velocity_m_s } = estimate.state();
        let rows = estimate.covariance().to_rows();
        Self {
            position: position_m.cast(),
            velocity: velocity_m_s.cast(),
            attitude: UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(*w, *x, *y, *z).cast()),
            covariance: Matrix9::from_fn(|row, column| f64::from(rows[row][column])),
        }
    }

    fn predict(&mut self, config: &EstimatorConfig, imu: &Imu, h: f64) {
        let (rates, gravity): (Vector3<f64>, Vector3<f64>) =
            (imu.body_rates_rad_s.cast(), Vector3::z() * f64::from(9.81_f32));
        let [dx, dy] = config.drag_per_s.map(f64::from);
        let drag = diagonal([dx, dy, 0.0]);
        let rotation = self.attitude.to_rotation_matrix().into_inner();
        let body = rotation.transpose() * self.velocity;
        let input = Vector3::z() * f64::from(imu.specific_force_m_s2.z);
        let change = input - drag * body - rotation.transpose() * gravity - rates.cross(&body);
        let force = input - drag * (body + change * (0.5 * h));
        let cross = (rates * h).cross_matrix();
        let mean: Vector3<f64> = (Matrix3::identity() + cross / 2.0 + cross * cross / 6.0) * force;
        let early: Vector3<f64> = (Matrix3::identity() + cross / 3.0 + cross * cross / 12.0) * force;
        let turn = UnitQuaternion::from_scaled_axis(rates * h);
        self.position += self.velocity * h + (rotation * early - gravity) * (0.5 * h * h);
        self.velocity += (rotation * mean - gravity) * h;
        self.attitude *= turn;

        let from_attitude = -h * rotation * (mean.cross_matrix() + drag * body.cross_matrix());
        let mut transition = Matrix9::identity();
        transition.fixed_view_mut::<3, 3>(0, 3).copy_from(&(Matrix3::identity() * h));
        transition.fixed_view_mut::<3, 3>(0, 6).copy_from(&(from_attitude * (0.5 * h)));
        transition
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&(Matrix3::identity() - h * rotation * drag * rotation.transpose()));
        transition.fixed_view_mut::<3, 3>(3, 6).copy_from(&from_attitude);
        transition.fixed_view_mut::<3, 3>(6, 6).copy_from(&turn.inverse().to_rotation_matrix().into_inner());
        let squared = |noise: [f32; 3]| diagonal(noise.map(|n| f64::from(n).powi(2)));
        let mut noise = Matrix9::zeros();
        noise
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&(rotation * squared(config.acceleration_noise) * rotation.transpose() * h));
        noise.fixed_view_mut::<3, 3>(6, 6).copy_from(&(squared(config.gyro_noise) * h));
        self.covariance = transition * (self.covariance + noise / 2.0) * transition.transpose() + noise / 2.0;
    }

    fn update(&mut self, position: &Vector3<f32>, deviation: f64) -> f64 {
        let h = SMatrix::<f64, 3, 9>::identity();
        let difference = position.cast() - self.position;
        let noise = Matrix3::identity() * deviation.powi(2);
        let expected = (h * self.covariance * h.transpose() + noise).try_inverse().unwrap();
        let gain = self.covariance * h.transpose() * expected;
        let error: Vector9 = gain * difference;
        let left = Matrix9::identity() - gain * h;
        // The filter's allowance for its roundings.
        let widened = Matrix9::from_diagonal(&(self.covariance.diagonal() * 2e-6));
        self.covariance = left * self.covariance * left.transpose() + gain * noise * gain.transpose();
        self.position += error.fixed_rows::<3>(0);
        self.velocity += error.fixed_rows::<3>(3);
        let turn: Vector3<f64> = error.fixed_rows::<3>(6).into();
        self.attitude *= UnitQuaternion::from_scaled_axis(turn);
        let half = -turn.cross_matrix() / 2.0;
        let mut back = Matrix9::identity();
        back.fixed_view_mut::<3, 3>(6, 6).copy_from(&(Matrix3::identity() + half + half * half / 2.0));
        self.covariance = back * self.covariance * back.transpose() + widened;
        difference.dot(&(expected * difference))
    }
}

/// Roundings do not add up: the positions take them back within the filter's memory, about 0.1 s for position and
/// velocity and some seconds for the attitude. Each prediction rounds a velocity near 2 m/s by up to 1.2e-7 and the
/// quaternion by up to 1e-7, so that within these times N roundings make root N: of the velocity 10 (100 in 0.1 s at 1
/// kHz, 1e-6 m/s), of the attitude 70 (5000 in 5 s, 7e-6 rad), which the thrust turns into 10 times as much
/// acceleration and the next positions into velocity, 7e-6 m/s. The position, rounded to 1.2e-7 m, follows the measured
/// one. Bounds are four times that, 1e-3 of the variances and of the innovations, whose expected deviation is 1 mm.
#[test]
fn the_filter_is_its_twin_in_f64() {
    for steps_per_prediction in [10_u16, 2, 1] {
        let config = told_the_truth();
        let estimator = Estimator::new(config).unwrap();
        let mut flight = Flight::new(7);
        let guess = flight.guess(&config.at_start);
        let mut estimate = estimator.start(&guess).unwrap();
        let mut twin = Twin::of(&estimate);
        let mut averager = ImuAverager::new();
        let mut most = [0.0_f64; 5];
        for step in 1..=20_000_u16 {
            averager.add(&flight.step()).unwrap();
            if step.is_multiple_of(steps_per_prediction) {
                let (imu, period) = (averager.take().unwrap(), 0.001 * f32::from(steps_per_prediction));
                estimator.predict(&mut estimate, &imu, period).unwrap();
                twin.predict(&config, &imu, f64::from(period));
            }
            if !step.is_multiple_of(10) {
                continue;
            }
            let position = flight.position();
            let taken = estimator.update_position(&mut estimate, &position, POSITION_M as f32).unwrap();
            let nis = twin.update(&position, f64::from(POSITION_M as f32));
            let State { position_m, attitude: Quaternion { w, x, y, z }, velocity_m_s } = estimate.state();
            let attitude = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(*w, *x, *y, *z).cast::<f64>());
            let rows = estimate.covariance().to_rows();
            let deviation = |index: usize| twin.covariance[(index, index)].sqrt();
            let off = (0..81).map(|index| (index / 9, index % 9)).map(|(row, column)| {
                let difference = f64::from(rows[row][column]) - twin.covariance[(row, column)];
                (difference / (deviation(row) * deviation(column))).abs()
            });
            let found = [
                (position_m.cast::<f64>() - twin.position).norm(),
                (velocity_m_s.cast::<f64>() - twin.velocity).norm(),
                (attitude.inverse() * twin.attitude).scaled_axis().norm(),
                off.fold(0.0, f64::max),
                (f64::from(taken.normalised_squared) - nis).abs() / nis.max(1.0),
            ];
            most = std::array::from_fn(|index| most[index].max(found[index]));
        }
        let listed = most.map(|x| format!("{x:.1e}")).join(", ");
        println!("every {steps_per_prediction} ms: m, m/s, rad, covariance over deviations, NIS: {listed}");
        let bounds = [2e-6, 4e-5, 4e-5, 1e-3, 4e-3];
        for (most, bound) in most.into_iter().zip(bounds) {
            assert!(most < bound, "{most} of {bound}, every {steps_per_prediction} ms");
        }
    }
}
