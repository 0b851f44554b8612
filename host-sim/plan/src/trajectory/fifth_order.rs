//! The flat output to its fifth derivative: motor forces and their rates depend on it.

use nalgebra::Vector3;

use super::polynomial::{Coordinate, Piece, PiecewisePolynomial};

/// A flat output and its derivatives at one time, world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FifthOrder {
    /// Position and its derivatives in order, to the fifth; m/s^k.
    pub position: [Vector3<f64>; 6],
    /// Heading and its derivatives in order, to the third; rad/s^k.
    pub heading: [f64; 4],
}

/// A flat output that can be followed down to the motors, over `0 <= t <= duration_s`; it rests after that.
pub trait FlatTrajectory {
    /// Length in time, s.
    fn duration_s(&self) -> f64;
    /// The flat output at a time.
    fn at(&self, t_s: f64) -> FifthOrder;
    /// The two places between which it jumps, m, where it does: a craft on its way is on the line between them.
    fn jump_m(&self) -> Option<[Vector3<f64>; 2]> {
        None
    }
}

impl FifthOrder {
    /// Rest at a position and heading.
    pub fn at_rest(position_m: Vector3<f64>, heading_rad: f64) -> Self {
        let mut position = [Vector3::zeros(); 6];
        position[0] = position_m;
        Self { position, heading: [heading_rad, 0.0, 0.0, 0.0] }
    }
}

/// A horizontal eight, `x = sin(w t)`, `y = 1/2 sin(2 w t)`, at a height of 1 m with heading 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eight {
    /// w, rad/s.
    pub rate_rad_s: f64,
    /// Length in time, s.
    pub duration_s: f64,
}

impl FlatTrajectory for Eight {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, t_s: f64) -> FifthOrder {
        // The k-th derivative of sin(w t) is w^k sin(w t + k pi/2).
        let sine = |w: f64, k: i32| {
            let (sin, cos) = (w * t_s).sin_cos();
            w.powi(k) * [sin, cos, -sin, -cos][k as usize % 4]
        };
        let w = self.rate_rad_s;
        let position = [0, 1, 2, 3, 4, 5]
            .map(|k| Vector3::new(sine(w, k), 0.5 * sine(2.0 * w, k), if k == 0 { 1.0 } else { 0.0 }));
        FifthOrder { position, heading: [0.0; 4] }
    }
}

/// Rest at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// The position, m.
    pub position_m: Vector3<f64>,
    /// Heading, rad.
    pub heading_rad: f64,
    /// For how long, s.
    pub duration_s: f64,
}

impl FlatTrajectory for Rest {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, _t_s: f64) -> FifthOrder {
        FifthOrder::at_rest(self.position_m, self.heading_rad)
    }
}

/// Rest at one place and, from a time on, at another: no craft can follow it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// Before, m.
    pub from_m: Vector3<f64>,
    /// After, m.
    pub to_m: Vector3<f64>,
    /// The time, s.
    pub at_s: f64,
    /// Length in time, s.
    pub duration_s: f64,
}

impl FlatTrajectory for Jump {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, t_s: f64) -> FifthOrder {
        FifthOrder::at_rest(if t_s < self.at_s { self.from_m } else { self.to_m }, 0.0)
    }

    fn jump_m(&self) -> Option<[Vector3<f64>; 2]> {
        Some([self.from_m, self.to_m])
    }
}

/// `S = 35 s^4 - 84 s^5 + 70 s^6 - 20 s^7`, from 0 to 1 with three derivatives of 0 at both ends.
const SMOOTH: Piece = Piece { duration_s: 1.0, coefficients: [[0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0]; 4] };

/// From rest to rest along a straight line, without a jump up to the jerk: `35 s^4 - 84 s^5 + 70 s^6 - 20 s^7` of the
/// way, heading 0; then rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestToRest {
    from_m: Vector3<f64>,
    way_m: Vector3<f64>,
    moving_s: f64,
    duration_s: f64,
}

impl RestToRest {
    /// From one place to another in `moving_s`, which is positive; the whole takes `duration_s`.
    pub fn new(from_m: Vector3<f64>, to_m: Vector3<f64>, moving_s: f64, duration_s: f64) -> Self {
        Self { from_m, way_m: to_m - from_m, moving_s, duration_s }
    }
}

impl FlatTrajectory for RestToRest {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, t_s: f64) -> FifthOrder {
        if t_s >= self.moving_s {
            return FifthOrder::at_rest(self.from_m + self.way_m, 0.0);
        }
        let share = t_s / self.moving_s;
        let mut position = [0, 1, 2, 3, 4, 5]
            .map(|k| self.way_m * (SMOOTH.derivative(Coordinate::X, k, share) / self.moving_s.powi(k as i32)));
        position[0] += self.from_m;
        FifthOrder { position, heading: [0.0; 4] }
    }
}

impl FlatTrajectory for PiecewisePolynomial {
    fn duration_s(&self) -> f64 {
        super::Trajectory::duration_s(self)
    }

    fn at(&self, t_s: f64) -> FifthOrder {
        let value = |coordinate, order| self.derivative(coordinate, order, t_s);
        FifthOrder {
            position: [0, 1, 2, 3, 4, 5]
                .map(|k| Vector3::from([Coordinate::X, Coordinate::Y, Coordinate::Z].map(|c| value(c, k)))),
            heading: [0, 1, 2, 3].map(|k| value(Coordinate::Yaw, k)),
        }
    }
}
