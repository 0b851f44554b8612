//! The laws, the rate loop and the mixer in f64, from their formulas: rotation matrices, whole gain matrices, the motors' places.
//! No line of the core is used, and none is like one of its.

use nalgebra::{Matrix4, Rotation3, SMatrix, SVector, UnitQuaternion, Vector3, Vector4};
use quatrack::{AirframeFigures, Command, State};
use quatrack_design::model::flat::{FlatSample, ReferencePoint, phi, reference_point, unit};
use quatrack_design::model::{GRAVITY_M_S2, attitude, position, velocity};

/// A measured state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Craft {
    pub(crate) position_m: Vector3<f64>,
    pub(crate) attitude: UnitQuaternion<f64>,
    pub(crate) velocity_m_s: Vector3<f64>,
}

pub(crate) fn wide(v: &Vector3<f32>) -> Vector3<f64> {
    v.map(f64::from)
}

pub(crate) fn craft(state: &State) -> Craft {
    let q = state.attitude;
    let attitude = nalgebra::Quaternion::new(f64::from(q.w), f64::from(q.x), f64::from(q.y), f64::from(q.z));
    Craft {
        position_m: wide(&state.position_m),
        attitude: UnitQuaternion::from_quaternion(attitude),
        velocity_m_s: wide(&state.velocity_m_s),
    }
}

pub(crate) fn goal(sample: &quatrack::FlatSample) -> ReferencePoint {
    reference_point(&FlatSample {
        position_m: wide(&sample.position_m),
        velocity_m_s: wide(&sample.velocity_m_s),
        acceleration_m_s2: wide(&sample.acceleration_m_s2),
        jerk_m_s3: wide(&sample.jerk_m_s3),
        heading_rad: f64::from(sample.heading_rad),
        heading_rate_rad_s: f64::from(sample.heading_rate_rad_s),
    })
}

pub(crate) fn input(command: &Command) -> Vector4<f64> {
    let rates = wide(&command.body_rates_rad_s);
    Vector4::new(f64::from(command.thrust_m_s2), rates.x, rates.y, rates.z)
}

pub(crate) fn matrix<const M: usize, const N: usize>(rows: &[[f32; N]; M]) -> SMatrix<f64, M, N> {
    SMatrix::from_fn(|row, column| f64::from(rows[row][column]))
}

/// From the world to the frame of a heading.
fn to_heading(heading_rad: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), -heading_rad)
}

fn target_attitude(goal: &ReferencePoint) -> UnitQuaternion<f64> {
    unit(&attitude(&goal.state))
}

/// The vector part of the shorter of the two turns that an attitude error is.
fn shorter(turn: UnitQuaternion<f64>) -> Vector3<f64> {
    if turn.w < 0.0 { -turn.imag() } else { turn.imag() }
}

/// Position and velocity errors turned by minus the heading, the vector part of `q_r^-1 q`.
pub(crate) fn heading_error(x: &Craft, goal: &ReferencePoint) -> SVector<f64, 9> {
    let turn = to_heading(goal.heading_rad);
    let r = turn * (x.position_m - position(&goal.state));
    let v = turn * (x.velocity_m_s - velocity(&goal.state));
    let q = shorter(target_attitude(goal).inverse() * x.attitude);
    SVector::from([r.x, r.y, r.z, q.x, q.y, q.z, v.x, v.y, v.z])
}

/// The paper's: `x - x_r` as it is, with the sign of `q` that is nearer to `q_r`.
pub(crate) fn paper_error(x: &Craft, goal: &ReferencePoint) -> SVector<f64, 9> {
    let (r, v) = (x.position_m - position(&goal.state), x.velocity_m_s - velocity(&goal.state));
    let q_r = target_attitude(goal).into_inner();
    let q = x.attitude.into_inner();
    let q = if (q - q_r).norm() < (q + q_r).norm() { q - q_r } else { -q - q_r };
    SVector::from([r.x, r.y, r.z, q.i, q.j, q.k, v.x, v.y, v.z])
}

/// `u_e - K e`, or `u_r - K e` with feed-forward.
pub(crate) fn equilibrium(
    gain: &SMatrix<f64, 4, 9>,
    error: &SVector<f64, 9>,
    goal: &ReferencePoint,
    feed_forward: bool,
) -> Vector4<f64> {
    let open = if feed_forward { goal.input } else { Vector4::new(GRAVITY_M_S2, 0.0, 0.0, 0.0) };
    open - gain * error
}

/// The flat state seen from the heading's frame: the flat output, the acceleration that a thrust gives in an attitude, `q3`.
fn flat_state(x: &Craft, heading_rad: f64, thrust_m_s2: f64) -> SVector<f64, 10> {
    let turn = to_heading(heading_rad);
    let q = UnitQuaternion::from_rotation_matrix(&turn) * x.attitude;
    let (r, v) = (turn * x.position_m, turn * x.velocity_m_s);
    let a = q * Vector3::new(0.0, 0.0, thrust_m_s2) - Vector3::new(0.0, 0.0, GRAVITY_M_S2);
    let q3 = if q.w < 0.0 { -q.k } else { q.k };
    SVector::from([r.x, r.y, r.z, v.x, v.y, v.z, a.x, a.y, a.z, q3])
}

/// `v = -K (z - z_r)`, with `v_r` added on feed-forward, then the flat map at the measured `q3`.
pub(crate) fn flat_output(
    gain: &SMatrix<f64, 7, 10>,
    x: &Craft,
    goal: &ReferencePoint,
    feed_forward: bool,
) -> Vector4<f64> {
    let thrust = goal.input[0];
    let on_goal = Craft {
        position_m: position(&goal.state),
        attitude: target_attitude(goal),
        velocity_m_s: velocity(&goal.state),
    };
    let z = flat_state(x, goal.heading_rad, thrust);
    let mut v = -gain * (z - flat_state(&on_goal, goal.heading_rad, thrust));
    if feed_forward {
        let turn = to_heading(goal.heading_rad);
        let (a, j) = (turn * goal.acceleration_m_s2, turn * goal.jerk_m_s3);
        // q3 = cos(tilt / 2) sin((psi - psi_r) / 2) there, and psi passes through psi_r.
        let cos_half_tilt = (0.5 * (on_goal.attitude * Vector3::z()).z.acos()).cos();
        v += SVector::from([a.x, a.y, a.z, j.x, j.y, j.z, 0.5 * cos_half_tilt * goal.heading_rate_rad_s]);
    }
    phi(&Vector3::new(v[0], v[1], v[2]), &Vector3::new(v[3], v[4], v[5]), z[9], v[6]).1
}

/// `u - K_i i`, the sum in the heading frame.
pub(crate) fn integral(
    gain: &SMatrix<f64, 4, 12>,
    sum_m_s: &Vector3<f64>,
    x: &Craft,
    goal: &ReferencePoint,
    feed_forward: bool,
) -> Vector4<f64> {
    let constant = equilibrium(&gain.fixed_columns::<9>(0).into_owned(), &heading_error(x, goal), goal, feed_forward);
    constant - gain.fixed_columns::<3>(9) * (to_heading(goal.heading_rad) * sum_m_s)
}

/// Thrust and torque from forces, each at its motor's place: front right, rear right, rear left, front left; M1 and M3 turn the
/// craft clockwise.
pub(crate) fn wrench_of_forces(figures: &AirframeFigures) -> Matrix4<f64> {
    let (a, c) = (f64::from(figures.lever_arm_m), f64::from(figures.torque_per_thrust_m));
    let motors = [(a, -a, -c), (-a, -a, c), (-a, a, -c), (a, a, c)].map(|(x, y, turn)| {
        let torque = Vector3::new(x, y, 0.0).cross(&Vector3::z());
        Vector4::new(1.0, torque.x, torque.y, turn)
    });
    Matrix4::from_columns(&motors)
}

/// `I k (w_cmd - w) + w x I w`.
pub(crate) fn torque(
    figures: &AirframeFigures,
    bandwidth_rad_s: f64,
    asked: &Vector3<f64>,
    rates: &Vector3<f64>,
) -> Vector3<f64> {
    let inertia = SMatrix::<f64, 3, 3>::from_diagonal(&Vector3::from(figures.inertia_kg_m2.map(f64::from)));
    inertia * (asked - rates) * bandwidth_rad_s + rates.cross(&(inertia * rates))
}
