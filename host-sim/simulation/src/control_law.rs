//! The interface by which a law flies: its inputs at a control step in, the motor forces that it commands out.
//!
//! A law of one's own implements [`ControlLaw`] and flies in every command and test beside the built-in ones; see the
//! example `own_law`. Conventions: world frame z up, body frame x forwards, y left, z up; SI; `f64`. A law that computes
//! in `f32` rounds its inputs.

use nalgebra::{UnitQuaternion, Vector3, Vector4};

use quatrack_plan::trajectory::fifth_order::FifthOrder;

/// Steps of a flight a second, as many as the Crazyflie's stabilizer makes.
pub const STEPS_HZ: u32 = 1000;

/// A control law.
pub trait ControlLaw {
    /// Control steps a second: a divisor of [`STEPS_HZ`]. Forces are held in between.
    fn rate_hz(&self) -> u32;

    /// Whether it looks at the accelerometer. To one that does not, a campaign tells 0: the specific force costs a flight as much
    /// as a quarter of its steps.
    fn feels(&self) -> bool {
        true
    }

    /// One control step: the forces asked of the four motors, N, numbered as in [`quatrack_design::vehicle`]. The
    /// motors then give them as far as they can.
    ///
    /// # Errors
    /// One line that says why there is no answer. The flight ends there and counts as lost.
    fn step(&mut self, input: &Input) -> Result<Vector4<f64>, String>;
}

/// The inputs of a law at a control step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// Now, s since the start of the flight.
    pub time_s: f64,
    /// Where the craft is, as far as anybody on board knows.
    pub estimate: Estimate,
    /// The setpoint.
    pub setpoint: Setpoint,
    /// Voltage of the battery, V.
    pub battery_v: f64,
}

/// The state estimate and the inertial sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Position, world frame, m.
    pub position_m: Vector3<f64>,
    /// Velocity, world frame, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Body to world.
    pub attitude: UnitQuaternion<f64>,
    /// Gyroscope, body frame, rad/s.
    pub body_rates_rad_s: Vector3<f64>,
    /// Accelerometer, body frame, m/s^2: the specific force, so +9.81 along z at hover.
    pub specific_force_m_s2: Vector3<f64>,
}

/// A point of a course, as it was sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    /// When it was sent, s. With setpoints at 100 Hz it is up to 10 ms old.
    pub sent_s: f64,
    /// Position, world frame, m.
    pub position_m: Vector3<f64>,
    /// Velocity, world frame, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Acceleration, world frame, m/s^2; 0 at rest.
    pub acceleration_m_s2: Vector3<f64>,
    /// Jerk, world frame, m/s^3.
    pub jerk_m_s3: Vector3<f64>,
    /// Snap, world frame, m/s^4; 0 where setpoints end with the jerk.
    pub snap_m_s4: Vector3<f64>,
    /// Crackle, world frame, m/s^5; likewise.
    pub crackle_m_s5: Vector3<f64>,
    /// Heading, rad.
    pub heading_rad: f64,
    /// Its rate, rad/s.
    pub heading_rate_rad_s: f64,
    /// Body rates of a craft in vacuum that flies this, rad/s.
    pub body_rates_rad_s: Vector3<f64>,
}

impl Setpoint {
    /// A point of a course with all its derivatives, sent at a time.
    pub fn exact(point: &FifthOrder, sent_s: f64) -> Self {
        let [position_m, velocity_m_s, acceleration_m_s2, jerk_m_s3, snap_m_s4, crackle_m_s5] = point.position;
        let [heading_rad, heading_rate_rad_s, ..] = point.heading;
        Self {
            sent_s,
            position_m,
            velocity_m_s,
            acceleration_m_s2,
            jerk_m_s3,
            snap_m_s4,
            crackle_m_s5,
            heading_rad,
            heading_rate_rad_s,
            body_rates_rad_s: body_rates(&acceleration_m_s2, &jerk_m_s3, heading_rad, heading_rate_rad_s),
        }
    }

    /// The same as a commander sends it, which knows no derivative beyond the jerk.
    pub fn to_jerk(point: &FifthOrder, sent_s: f64) -> Self {
        Self { snap_m_s4: Vector3::zeros(), crackle_m_s5: Vector3::zeros(), ..Self::exact(point, sent_s) }
    }

    /// Carried on to a later time by its own derivatives: Taylor's polynomial of the setpoint.
    pub fn carried_to(&self, time_s: f64) -> FifthOrder {
        let h = time_s - self.sent_s;
        let sent = [
            self.position_m,
            self.velocity_m_s,
            self.acceleration_m_s2,
            self.jerk_m_s3,
            self.snap_m_s4,
            self.crackle_m_s5,
        ];
        // Horner's scheme of the k-th derivative: x + h (x' + h/2 (x'' + h/3 (...))).
        let carried = |k: usize| {
            let above = sent.iter().enumerate().skip(k + 1).rev();
            let rest = above.fold(Vector3::zeros(), |rest, (n, value)| (value + rest) * (h / (n - k) as f64));
            sent[k] + rest
        };
        let heading = [self.heading_rad + h * self.heading_rate_rad_s, self.heading_rate_rad_s, 0.0, 0.0];
        FifthOrder { position: [0, 1, 2, 3, 4, 5].map(carried), heading }
    }
}

/// Mellinger and Kumar 2011, equations (7) and (8) and `r = psi' z_W . z_B`: body rates of the attitude that
/// [`attitude_along`] gives to the thrust. All 0 in free fall.
pub fn body_rates(
    acceleration_m_s2: &Vector3<f64>,
    jerk_m_s3: &Vector3<f64>,
    heading_rad: f64,
    heading_rate_rad_s: f64,
) -> Vector3<f64> {
    let thrust = acceleration_m_s2 + Vector3::z() * quatrack_design::model::GRAVITY_M_S2;
    let Some([x, y, z]) = attitude_along(&thrust, heading_rad) else { return Vector3::zeros() };
    let h_w = (jerk_m_s3 - z * z.dot(jerk_m_s3)) / thrust.norm();
    Vector3::new(-h_w.dot(&y), h_w.dot(&x), heading_rate_rad_s * z.z)
}

/// The body axes x, y and z in the world frame of a craft that thrusts along a force at a heading: `z = F/|F|`,
/// `y = z x x_C / |z x x_C|` with `x_C = (cos psi, sin psi, 0)`, `x = y x z` (Mellinger and Kumar 2011, section III). Nothing
/// where the force vanishes or lies along `x_C`.
pub fn attitude_along(force: &Vector3<f64>, heading_rad: f64) -> Option<[Vector3<f64>; 3]> {
    let (sin, cos) = heading_rad.sin_cos();
    let z = force.try_normalize(f64::EPSILON)?;
    let y = z.cross(&Vector3::new(cos, sin, 0.0)).try_normalize(f64::EPSILON)?;
    Some([y.cross(&z), y, z])
}

#[cfg(test)]
mod tests {
    use super::*;
    use quatrack_plan::trajectory::fifth_order::{Eight, FlatTrajectory};

    #[test]
    fn a_setpoint_that_is_carried_on_leaves_its_course_by_the_next_term_alone() {
        let eight = Eight { rate_rad_s: 1.485, duration_s: 12.0 };
        let (t, h) = (1.3, 0.01);
        let error = |setpoint: Setpoint| (setpoint.carried_to(t + h).position[0] - eight.at(t + h).position[0]).norm();
        // The fourth and the sixth derivative of the eight are at most |w^4, 8 w^4| and |w^6, 32 w^6|.
        let bound = |order: i32, size: f64| 1.485_f64.powi(order) * size * h.powi(order);
        let to_jerk = error(Setpoint::to_jerk(&eight.at(t), t));
        assert!(to_jerk < bound(4, 8.1) / 24.0, "{to_jerk}");
        let exact = error(Setpoint::exact(&eight.at(t), t));
        assert!(exact < bound(6, 32.1) / 720.0 + 1e-15, "{exact}");
    }

    #[test]
    fn body_rates_are_those_of_the_attitude_along_the_course() {
        let course = Eight { rate_rad_s: 2.0, duration_s: 12.0 };
        let axes = |t: f64| {
            let point = course.at(t);
            let thrust = point.position[2] + Vector3::z() * quatrack_design::model::GRAVITY_M_S2;
            nalgebra::Matrix3::from_columns(&attitude_along(&thrust, 0.4 + 0.7 * t).unwrap())
        };
        let (t, h) = (0.9, 1e-5);
        // R' R' = the rates' cross-product matrix; central difference, error h^2 and rounding over h.
        let turning = axes(t).transpose() * (axes(t + h) - axes(t - h)) / (2.0 * h);
        let point = course.at(t);
        let rates = body_rates(&point.position[2], &point.position[3], 0.4 + 0.7 * t, 0.7);
        assert!((rates.x - turning.m32).abs() < 1e-8 && (rates.y - turning.m13).abs() < 1e-8, "{rates} {turning}");
    }
}
