//! The laws in f64, as the paper writes them: state and reference point in, input out.
//!
//! They share no line with the `f32` core; the parity tests check that the two agree.

use nalgebra::{Rotation3, SMatrix, SVector, UnitQuaternion, Vector3, Vector4};
use quatrack_design::model::flat::{ReferencePoint, phi, scalar_first, unit};
use quatrack_design::model::{
    GRAVITY_M_S2, InputVector, StateVector, attitude, hover_input, position, thrust_axis, velocity,
};

/// Gain of the equilibrium laws: `[T p q r]` from `[r(3) q1 q2 q3 v(3)]`.
pub type EquilibriumGain = SMatrix<f64, 4, 9>;

/// Gain of the flat output laws: `[a(3) j(3) q3']` from `[r(3) v(3) a(3) q3]`.
pub type FlatOutputGain = SMatrix<f64, 7, 10>;

/// A law with its gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law<'a> {
    /// (LYAP-E), (LQR-E) in the paper's own form: errors in the world frame, `q - q_r`.
    EquilibriumPaper(&'a EquilibriumGain),
    /// The same with errors in the reference's heading frame and `q_r^-1 q`: valid at every heading.
    EquilibriumHeading(&'a EquilibriumGain),
    /// (LYAP-F), (LQR-F), in the reference's heading frame, which is the world frame in the paper.
    FlatOutput(&'a FlatOutputGain),
}

/// A law and whether the reference's input is fed forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback<'a> {
    /// The law.
    pub law: Law<'a>,
    /// Whether `u_r` (E) or `v_r` (F) is added.
    pub feed_forward: bool,
}

impl Feedback<'_> {
    /// The input for a state of unit quaternion norm; not finite where the flat map is singular.
    pub fn input(&self, state: &StateVector, target: &ReferencePoint) -> InputVector {
        match self.law {
            Law::EquilibriumPaper(gain) => self.equilibrium_input(gain, &paper_error(state, &target.state), target),
            Law::EquilibriumHeading(gain) => self.equilibrium_input(gain, &heading_error(state, target), target),
            Law::FlatOutput(gain) => {
                let (z, z_r, heading) = flat_states(state, target);
                let mut v = -gain * (z - z_r);
                if self.feed_forward {
                    v += flat_input(target, &heading);
                }
                phi(&v.fixed_rows::<3>(0).into_owned(), &v.fixed_rows::<3>(3).into_owned(), z[9], v[6]).1
            }
        }
    }

    fn equilibrium_input(
        &self,
        gain: &EquilibriumGain,
        error: &SVector<f64, 9>,
        target: &ReferencePoint,
    ) -> InputVector {
        let feed = if self.feed_forward { target.input } else { hover_input() };
        feed - gain * error
    }
}

/// `q` or `-q`, whichever is in the hemisphere of `other`.
fn in_hemisphere_of(q: Vector4<f64>, other: &Vector4<f64>) -> Vector4<f64> {
    if q.dot(other) < 0.0 { -q } else { q }
}

fn stacked(r: Vector3<f64>, q: Vector3<f64>, v: Vector3<f64>) -> SVector<f64, 9> {
    SVector::from_iterator(r.iter().chain(q.iter()).chain(v.iter()).copied())
}

fn paper_error(state: &StateVector, target: &StateVector) -> SVector<f64, 9> {
    let q = in_hemisphere_of(attitude(state), &attitude(target)) - attitude(target);
    stacked(position(state) - position(target), q.fixed_rows::<3>(1).into_owned(), velocity(state) - velocity(target))
}

fn heading_error(state: &StateVector, target: &ReferencePoint) -> SVector<f64, 9> {
    let to_heading = Rotation3::from_axis_angle(&Vector3::z_axis(), -target.heading_rad);
    let q = in_hemisphere_of(attitude(state), &attitude(&target.state));
    let error = unit(&attitude(&target.state)).inverse() * unit(&q);
    stacked(
        to_heading * (position(state) - position(&target.state)),
        error.imag(),
        to_heading * (velocity(state) - velocity(&target.state)),
    )
}

/// `z` and `z_r` (6a) in the heading frame. The acceleration is that of the reference's thrust in either attitude.
fn flat_states(state: &StateVector, target: &ReferencePoint) -> (SVector<f64, 10>, SVector<f64, 10>, Rotation3<f64>) {
    let to_heading = Rotation3::from_axis_angle(&Vector3::z_axis(), -target.heading_rad);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -target.heading_rad);
    let thrust = target.input[0];
    let flat = |x: &StateVector| {
        let q = scalar_first(&(turn * unit(&attitude(x))));
        let q = if q[0] < 0.0 { -q } else { q };
        let a = thrust_axis(&q) * thrust - Vector3::new(0.0, 0.0, GRAVITY_M_S2);
        let (r, v) = (to_heading * position(x), to_heading * velocity(x));
        SVector::from_iterator(r.iter().chain(v.iter()).chain(a.iter()).copied().chain([q[3]]))
    };
    (flat(state), flat(&target.state), to_heading)
}

/// `v_r` (6b) in the heading frame, where `q3 = cos(tilt/2) sin((psi - psi_r)/2)` passes through 0.
fn flat_input(target: &ReferencePoint, to_heading: &Rotation3<f64>) -> SVector<f64, 7> {
    let (a, j) = (to_heading * target.acceleration_m_s2, to_heading * target.jerk_m_s3);
    let q = attitude(&target.state);
    let q3_rate = 0.5 * q[0].hypot(q[3]) * target.heading_rate_rad_s;
    SVector::from_iterator(a.iter().chain(j.iter()).copied().chain([q3_rate]))
}
