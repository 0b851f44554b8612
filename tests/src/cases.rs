//! States off references, spread evenly over a box of 24 dimensions: the laws are compared on them.

use quatrack::nalgebra::Vector3;
use quatrack::{FlatSample, Quaternion, Reference, State};

use crate::halton;

/// A point of a reference, any heading up to a largest one, and a measured state off it.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The flat output.
    pub sample: FlatSample,
    /// The reference that flies it.
    pub reference: Reference,
    /// Half a metre, 1 m/s and up to 30 degrees about each body axis off the reference, with a quaternion whose norm is up to
    /// 1 % off 1.
    pub state: State,
}

/// Plus or minus `size` from a coordinate of the unit box.
pub fn spread(unit: f64, size: f64) -> f32 {
    ((2.0 * unit - 1.0) * size) as f32
}

fn vector(units: &[f64], size: f64) -> Vector3<f32> {
    Vector3::new(spread(units[0], size), spread(units[1], size), spread(units[2], size))
}

/// Case `index`. Every one of its 24 numbers is a coordinate of its own.
///
/// # Panics
/// On a heading that is not finite; with accelerations of up to 4 m/s^2 every reference has thrust, upwards.
pub fn case(index: u32, heading_max_rad: f64) -> Case {
    let u = halton::<24>(index);
    let sample = FlatSample {
        position_m: vector(&u[0..3], 2.0),
        velocity_m_s: vector(&u[3..6], 2.0),
        acceleration_m_s2: vector(&u[6..9], 4.0),
        jerk_m_s3: vector(&u[9..12], 10.0),
        heading_rad: spread(u[12], heading_max_rad),
        heading_rate_rad_s: spread(u[13], 2.0),
    };
    let reference = Reference::from_flat(&sample).expect("there is thrust, and it is upwards");
    let target = reference.state();
    // The vector part of a turn by twice its arcsine.
    let turn = vector(&u[20..23], 0.26);
    let q = target.attitude * Quaternion::new((1.0 - turn.norm_squared()).sqrt(), turn.x, turn.y, turn.z);
    let norm = 1.0 + spread(u[23], 0.01);
    let state = State {
        position_m: target.position_m + vector(&u[14..17], 0.5),
        attitude: Quaternion::new(q.w * norm, q.x * norm, q.y * norm, q.z * norm),
        velocity_m_s: target.velocity_m_s + vector(&u[17..20], 1.0),
    };
    Case { sample, reference, state }
}
