//! The estimator of the Crazyflie's firmware as its equations have it: an extended Kalman filter of position, body velocity and
//! attitude, predicted a hundred times a second from gyroscope and vertical accelerometer, corrected by positions. It knows of no
//! drag unless it is told. After M. Mueller, M. Hehn and R. D'Andrea, "Covariance Correction Step for Kalman Filtering with an
//! Attitude", 2017, with the firmware's default noises.

use nalgebra::{Matrix3, SMatrix, SVector, UnitQuaternion, Vector3};

use crate::cascade::plant::GRAVITY;

const PERIOD_S: f64 = 0.01;

pub(crate) struct Filter {
    pub(crate) p: Vector3<f64>,
    v: Vector3<f64>,
    pub(crate) q: UnitQuaternion<f64>,
    covariance: SMatrix<f64, 9, 9>,
    /// Drag over mass across, 1/s.
    drag: f64,
    gyro: Vector3<f64>,
    felt: f64,
    count: f64,
}

fn cross(v: &Vector3<f64>) -> Matrix3<f64> {
    v.cross_matrix()
}

impl Filter {
    pub(crate) fn at(p: Vector3<f64>, drag: f64) -> Self {
        let covariance = SMatrix::from_diagonal(&SVector::<f64, 9>::from_fn(|i, _| if i < 6 { 1e-4 } else { 1e-5 }));
        let zero = Vector3::zeros();
        Self { p, v: zero, q: UnitQuaternion::identity(), covariance, drag, gyro: zero, felt: 0.0, count: 0.0 }
    }

    /// World velocity.
    pub(crate) fn velocity(&self) -> Vector3<f64> {
        self.q * self.v
    }

    /// Gathers the sensors between predictions.
    pub(crate) fn sense(&mut self, gyro: &Vector3<f64>, felt: &Vector3<f64>) {
        self.gyro += gyro;
        self.felt += felt.z;
        self.count += 1.0;
    }

    /// Predicts over the period and takes a position.
    pub(crate) fn update(&mut self, measured: &Vector3<f64>) {
        let h = PERIOD_S;
        let w = self.gyro / self.count;
        let thrust = Vector3::new(0.0, 0.0, self.felt / self.count);
        (self.gyro, self.felt, self.count) = (Vector3::zeros(), 0.0, 0.0);
        let r = self.q.to_rotation_matrix();
        let r = r.matrix();
        let down = r.transpose() * Vector3::new(0.0, 0.0, GRAVITY);
        let drag = Vector3::new(self.drag, self.drag, 0.0);

        let mut f = SMatrix::<f64, 9, 9>::identity();
        f.fixed_view_mut::<3, 3>(0, 3).copy_from(&(r * h));
        f.fixed_view_mut::<3, 3>(0, 6).copy_from(&(-r * cross(&self.v) * h));
        let turning = Matrix3::identity() - cross(&w) * h;
        f.fixed_view_mut::<3, 3>(3, 3).copy_from(&(turning - Matrix3::from_diagonal(&drag) * h));
        f.fixed_view_mut::<3, 3>(3, 6).copy_from(&(-cross(&down) * h));
        f.fixed_view_mut::<3, 3>(6, 6).copy_from(&turning);

        let moved = self.v * h + thrust * (h * h / 2.0);
        self.p += r * moved - Vector3::new(0.0, 0.0, GRAVITY * h * h / 2.0);
        self.v += (thrust - w.cross(&self.v) - down - drag.component_mul(&self.v)) * h;
        self.q *= UnitQuaternion::from_scaled_axis(w * h);

        let (acceleration, gyro) = ([0.5, 0.5, 1.0], 0.1);
        let noise = SVector::<f64, 9>::from_fn(|i, _| match i {
            0..3 => acceleration[i] * h * h,
            3..6 => acceleration[i - 3] * h,
            _ => gyro * h,
        });
        self.covariance = f * self.covariance * f.transpose() + SMatrix::from_diagonal(&noise.component_mul(&noise));
        for axis in 0..3 {
            let column = self.covariance.column(axis).into_owned();
            let gain = column / (column[axis] + 0.01 * 0.01);
            let step = gain * (measured[axis] - self.p[axis]);
            self.covariance -= gain * column.transpose();
            self.p += step.fixed_rows::<3>(0);
            self.v += step.fixed_rows::<3>(3);
            self.q *= UnitQuaternion::from_scaled_axis(step.fixed_rows::<3>(6).into_owned());
        }
        self.covariance = (self.covariance + self.covariance.transpose()) * 0.5;
    }
}
