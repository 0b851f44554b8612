//! The air's action on a craft: velocity through the air (body frame, m/s) in; drag (N) and airflow moment (N m), body
//! frame, out.

use nalgebra::Vector3;

use super::Wrench;

/// Forces and torques of a craft as a whole, of the velocity through the air in the body frame `v`. Figures identified on
/// real Crazyflies and explains their flights: NanoBench (arXiv 2603.09908) and the IDSIA benchmark (arXiv 2512.14450).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Airflow {
    /// Drag, `F = -c v` axis by axis, N per m/s.
    pub drag_n_s_m: Vector3<f64>,
    /// Moment, `tau_x = +c_x v_y`, `tau_y = -c_y v_x`, N m per m/s: rotors lean away from the wind and take the body with
    /// them.
    pub moment_n_s: [f64; 2],
    /// Lift of the velocity across the thrust, `F_z = c (v_x^2 + v_y^2)`, N per (m/s)^2.
    pub lift_n_s2_m2: f64,
    /// Drag of each rotor by itself.
    pub rotors: Option<RotorDrag>,
}

/// The drag of a rotor, which grows with its speed: RotorPy 3.0.0, `Multirotor.compute_body_wrench`, after Folk, Paulos and
/// Kumar, "RotorPy" (arXiv 2306.04485). Needs a [`super::Propeller`] for the speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RotorDrag {
    /// Across the rotor's axis, of each rotor, N per rad/s and m/s.
    pub across_n_s2_m: f64,
    /// Along it.
    pub along_n_s2_m: f64,
    /// Lift of the velocity across it, N per (m/s)^2.
    pub lift_n_s2_m2: f64,
}

impl Airflow {
    /// Force and torque of the whole craft, body frame.
    pub(super) fn wrench(&self, v: &Vector3<f64>) -> Wrench {
        let drag_n = self.drag_n_s_m.component_mul(v);
        let lift_n = self.lift_n_s2_m2 * (v.x * v.x + v.y * v.y);
        Wrench {
            force_n: Vector3::new(-drag_n.x, -drag_n.y, lift_n - drag_n.z),
            torque_n_m: Vector3::new(self.moment_n_s[0] * v.y, -self.moment_n_s[1] * v.x, 0.0),
        }
    }
}

impl RotorDrag {
    /// Force of one rotor that turns at a speed, rad/s, and moves through the air, body frame, N.
    pub(super) fn force_n(&self, speed_rad_s: f64, v: &Vector3<f64>) -> Vector3<f64> {
        let across = -speed_rad_s * self.across_n_s2_m;
        let lift_n = self.lift_n_s2_m2 * (v.x * v.x + v.y * v.y);
        Vector3::new(across * v.x, across * v.y, lift_n - speed_rad_s * self.along_n_s2_m * v.z)
    }
}
