//! `planner.c` and `pptraj.c`: orders to the high-level commander, and its setpoints.

use std::f32::consts::{PI, TAU};

use quatrack_crazyflie::abi::{Attitude, Mode, Modes, Setpoint};

use super::sent::{NOTHING, vector};

const GRAVITY_M_S2: f32 = 9.81;

/// A polynomial of degree 7 for x, y, z and yaw (rad), and how long it lasts.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) coefficients: [[f32; 8]; 4],
    pub(crate) duration_s: f32,
}

/// `traj_eval`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planned {
    pub(crate) position: [f32; 3],
    pub(crate) velocity: [f32; 3],
    pub(crate) acceleration: [f32; 3],
    pub(crate) jerk: [f32; 3],
    pub(crate) yaw: f32,
    pub(crate) yaw_body_rate: f32,
}

impl Planned {
    /// At rest.
    pub(crate) fn at(position: [f32; 3], yaw: f32) -> Self {
        let zero = [0.0; 3];
        Self { position, velocity: zero, acceleration: zero, jerk: zero, yaw, yaw_body_rate: 0.0 }
    }

    /// `piecewise_eval` with `traj_eval_transform`: all is turned but the jerk.
    pub(crate) fn turned(&self, by: f32) -> Self {
        let (sin, cos) = by.sin_cos();
        let turn = |[x, y, z]: [f32; 3]| [cos * x - sin * y, sin * x + cos * y, z];
        let (position, velocity, acceleration) = (turn(self.position), turn(self.velocity), turn(self.acceleration));
        Self { position, velocity, acceleration, yaw: self.yaw + by, ..*self }
    }

    /// `crtpCommanderHighLevelGetSetpoint`.
    pub(crate) fn setpoint(&self) -> Setpoint {
        let on = Mode::ABSOLUTE;
        Setpoint {
            position: vector(self.position),
            velocity: vector(self.velocity),
            acceleration: vector(self.acceleration),
            jerk: vector(self.jerk),
            attitude: Attitude { yaw: self.yaw.to_degrees(), ..Attitude::default() },
            attitude_rate: Attitude { yaw: self.yaw_body_rate.to_degrees(), ..Attitude::default() },
            mode: Modes { x: on, y: on, z: on, yaw: on, ..NOTHING },
            ..Setpoint::OFF
        }
    }
}

/// Value and first three derivatives at a time.
fn derivatives(p: &[f32; 8], t: f32) -> [f32; 4] {
    let mut p = *p;
    [(); 4].map(|()| {
        let value = p.iter().rev().fold(0.0, |sum, c| sum * t + c);
        for i in 1..8 {
            p[i - 1] = i as f32 * p[i];
        }
        p[7] = 0.0;
        value
    })
}

/// `poly7_nojerk`: value, slope and curvature at both ends, no jerk there.
fn septic([x0, d0, dd0]: [f32; 3], [xf, df, ddf]: [f32; 3], t: f32) -> [f32; 8] {
    let t2 = t * t;
    let gap = x0 - xf;
    [
        x0,
        d0,
        dd0 / 2.0,
        0.0,
        -(5.0 * (14.0 * gap + 8.0 * t * d0 + 6.0 * t * df + 2.0 * t2 * dd0 - t2 * ddf)) / (2.0 * t.powi(4)),
        (84.0 * gap + 45.0 * t * d0 + 39.0 * t * df + 10.0 * t2 * dd0 - 7.0 * t2 * ddf) / t.powi(5),
        -(140.0 * gap + 72.0 * t * d0 + 68.0 * t * df + 15.0 * t2 * dd0 - 13.0 * t2 * ddf) / (2.0 * t.powi(6)),
        (2.0 * (10.0 * gap + 5.0 * t * d0 + 5.0 * t * df + t2 * dd0 - t2 * ddf)) / t.powi(7),
    ]
}

impl Piece {
    /// `plan_go_to_from`, take-off and landing among it; a linear one keeps one velocity from end to end.
    pub(crate) fn go_to(from: &Planned, to: [f32; 3], yaw: f32, duration_s: f32, is_linear: bool) -> Self {
        let normal = |angle: f32| (angle + PI).rem_euclid(TAU) - PI;
        let yaw_from = normal(from.yaw);
        let turn = normal(yaw - yaw_from);
        let axis = |i: usize| {
            let (start, end) = (from.position[i], to[i]);
            let speed = (end - start) / duration_s;
            if is_linear {
                septic([start, speed, 0.0], [end, speed, 0.0], duration_s)
            } else {
                septic([start, from.velocity[i], from.acceleration[i]], [end, 0.0, 0.0], duration_s)
            }
        };
        let rate = if is_linear { turn / duration_s } else { 0.0 };
        let rate_from = if is_linear { rate } else { from.yaw_body_rate };
        let heading = septic([yaw_from, rate_from, 0.0], [yaw_from + turn, rate, 0.0], duration_s);
        Self { coefficients: [axis(0), axis(1), axis(2), heading], duration_s }
    }

    /// `plan_spiral_from`, anticlockwise and looking ahead: from one radius to another over an angle, climbing.
    pub(crate) fn spiral(from: &Planned, angle: f32, radii: [f32; 2], ascent: f32, duration_s: f32) -> Self {
        let (omega, [r0, rf]) = (angle / duration_s, radii);
        let (dr, phi0) = ((rf - r0) / duration_s, from.yaw);
        let end = |r: f32, phi: f32| {
            let (s, c) = phi.sin_cos();
            let x = [r * s, r * c * omega + dr * s, -r * s * omega * omega + 2.0 * dr * c * omega];
            let y = [-r * c, r * s * omega - dr * c, r * c * omega * omega + 2.0 * dr * s * omega];
            (x, y)
        };
        let ((x0, y0), (xf, yf)) = (end(r0, phi0), end(rf, phi0 + angle));
        let centre = [from.position[0] - x0[0], from.position[1] - y0[0]];
        let shifted = |[v, d, dd]: [f32; 3], by: f32| [v + by, d, dd];
        let (z, climb) = (from.position[2], ascent / duration_s);
        let coefficients = [
            septic(shifted(x0, centre[0]), shifted(xf, centre[0]), duration_s),
            septic(shifted(y0, centre[1]), shifted(yf, centre[1]), duration_s),
            septic([z, climb, 0.0], [z + ascent, climb, 0.0], duration_s),
            septic([phi0, omega, 0.0], [phi0 + angle, omega, 0.0], duration_s),
        ];
        Self { coefficients, duration_s }
    }

    /// `poly4d_eval`; after its end `piecewise_eval` rests there.
    pub(crate) fn eval(&self, t_s: f32) -> Planned {
        let [x, y, z, yaw] = [0, 1, 2, 3].map(|i| derivatives(&self.coefficients[i], t_s.min(self.duration_s)));
        let [position, velocity, acceleration, jerk] = [0, 1, 2, 3].map(|order| [x[order], y[order], z[order]]);
        if t_s > self.duration_s {
            return Planned::at(position, yaw[0]);
        }
        let [ax, ay, az] = acceleration;
        let thrust = (ax * ax + ay * ay + (az + GRAVITY_M_S2).powi(2)).sqrt();
        let yaw_body_rate = (az + GRAVITY_M_S2) / thrust * yaw[1];
        Planned { position, velocity, acceleration, jerk, yaw: yaw[0], yaw_body_rate }
    }
}
