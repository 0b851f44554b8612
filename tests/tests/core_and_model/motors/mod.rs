//! From the laws to the motors: airframes, mixer, body-rate loop, references carried to the forces, and the
//! actuator-aware law against the rigid plant.

mod airframes;
mod flights;
mod law;
mod reference;

use nalgebra::{Quaternion as Quaternion64, UnitQuaternion, Vector3, Vector4};
use quatrack::{Airframe, FifthOrderSample, FlatSample, MotorReference, Quaternion, RigidState, State};
use quatrack_simulation::plant;

const CRAFT: [(&str, Airframe); 3] = [
    ("crazyflie-2.1", Airframe::CRAZYFLIE_2_1),
    ("crazyflie-2.1-upgrade-kit", Airframe::CRAZYFLIE_2_1_UPGRADE_KIT),
    ("crazyflie-2.1-brushless", Airframe::CRAZYFLIE_2_1_BRUSHLESS),
];

fn to_f32(v: &Vector3<f64>) -> Vector3<f32> {
    v.map(|value| value as f32)
}

/// Figure eight with height and heading in motion: every derivative of every output is at work, and none of them repeats
/// another's phase.
#[derive(Clone, Copy)]
struct Eight {
    frequency_rad_s: f64,
    height_m: f64,
    heading_rate_rad_s: f64,
    heading_swing_rad: f64,
}

impl Eight {
    /// The flight of the published comparison: 2.1 m/s, level, heading 0.
    const LEVEL: Self = Self { frequency_rad_s: 1.485, height_m: 0.0, heading_rate_rad_s: 0.0, heading_swing_rad: 0.0 };
    const TURNING: Self =
        Self { frequency_rad_s: 1.485, height_m: 0.3, heading_rate_rad_s: 0.7, heading_swing_rad: 0.8 };

    fn at(&self, t: f64) -> FifthOrderSample {
        // `sin(k w t + phase)` and its derivatives.
        let sine = |size: f64, k: f64, phase: f64, order: i32| {
            let w = k * self.frequency_rad_s;
            size * w.powi(order) * (w * t + phase + f64::from(order) * std::f64::consts::FRAC_PI_2).sin()
        };
        let position = |order: i32| {
            let height = sine(self.height_m, 1.3, 0.4, order) + if order == 0 { 1.0 } else { 0.0 };
            Vector3::new(sine(1.0, 1.0, 0.0, order), sine(0.5, 2.0, 0.0, order), height)
        };
        let heading = |order: i32| {
            let steady = [self.heading_rate_rad_s * t, self.heading_rate_rad_s, 0.0, 0.0][order as usize];
            (steady + sine(self.heading_swing_rad, 0.9, 0.2, order)) as f32
        };
        FifthOrderSample {
            flat: FlatSample {
                position_m: to_f32(&position(0)),
                velocity_m_s: to_f32(&position(1)),
                acceleration_m_s2: to_f32(&position(2)),
                jerk_m_s3: to_f32(&position(3)),
                heading_rad: heading(0),
                heading_rate_rad_s: heading(1),
            },
            snap_m_s4: to_f32(&position(4)),
            crackle_m_s5: to_f32(&position(5)),
            heading_acceleration_rad_s2: heading(2),
            heading_jerk_rad_s3: heading(3),
        }
    }

    fn reference(&self, t: f64, airframe: &Airframe) -> MotorReference {
        MotorReference::from_flat(&self.at(t), airframe).expect("flyable")
    }
}

/// The plant's state on a reference.
fn on(reference: &MotorReference) -> plant::RigidState {
    let State { position_m, attitude: q, velocity_m_s } = *reference.state();
    let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
    plant::RigidState {
        position_m: position_m.map(f64::from),
        velocity_m_s: velocity_m_s.map(f64::from),
        attitude: UnitQuaternion::from_quaternion(Quaternion64::new(w, x, y, z)),
        body_rates_rad_s: reference.body_rates_rad_s().map(f64::from),
        thrusts_n: Vector4::from(reference.forces_n()).map(f64::from),
    }
}

/// An ideal estimate of the plant's state.
fn measured(x: &plant::RigidState) -> RigidState {
    let q = x.attitude.quaternion();
    RigidState {
        state: State {
            position_m: to_f32(&x.position_m),
            attitude: Quaternion::new(q.w as f32, q.i as f32, q.j as f32, q.k as f32),
            velocity_m_s: to_f32(&x.velocity_m_s),
        },
        body_rates_rad_s: to_f32(&x.body_rates_rad_s),
    }
}
