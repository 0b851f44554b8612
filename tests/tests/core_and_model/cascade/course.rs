//! The courses: position, velocity, acceleration, jerk and heading over time.

use nalgebra::Vector3;
/// Position and its derivatives to the jerk; heading, its rate and acceleration.
pub(crate) type Motion = ([Vector3<f64>; 4], [f64; 3]);

#[derive(Clone, Copy, Debug)]
pub(crate) enum Course {
    Hover,
    /// At rest at a place from a time on, after hover.
    Step {
        to: Vector3<f64>,
        yaw: f64,
        at_s: f64,
    },
    /// `x = sin wt, y = sin(2 wt)/2` behind 2 s of hover and 3 s of ramp; turning with a rate.
    Eight {
        w: f64,
        turn: f64,
    },
    /// The paper's W behind 2 s of hover.
    W,
    /// At a place on the ground, then up.
    TakeOff {
        from: Vector3<f64>,
        at_s: f64,
        in_s: f64,
    },
}

mod aggressive {
    #![allow(unreachable_pub, reason = "written for the crates that fly it")]
    use quatrack::Piece;

    include!("../../../../plans/aggressive.rs");
}

use self::aggressive::AGGRESSIVE;

/// Height of hover, m.
pub(crate) const HEIGHT: f64 = 1.0;

impl Course {
    pub(crate) fn at(&self, t: f64) -> Motion {
        let zero = Vector3::zeros();
        let home = Vector3::new(0.0, 0.0, HEIGHT);
        match *self {
            Self::Hover => ([home, zero, zero, zero], [0.0; 3]),
            Self::Step { to, yaw, at_s } => {
                if t < at_s {
                    ([home, zero, zero, zero], [0.0; 3])
                } else {
                    ([home + to, zero, zero, zero], [yaw, 0.0, 0.0])
                }
            }
            Self::Eight { w, turn } => eight(w, turn, t),
            Self::W => ([w(t - 2.0)[0] + home, w(t - 2.0)[1], w(t - 2.0)[2], w(t - 2.0)[3]], [0.0; 3]),
            Self::TakeOff { from, at_s, in_s } => {
                let [z, v, a, j] = septic(((t - at_s) / in_s).clamp(0.0, 1.0), in_s, HEIGHT);
                let [p, v, a, j] = [z, v, a, j].map(|z| Vector3::new(0.0, 0.0, z));
                ([from + p, v, a, j], [0.0; 3])
            }
        }
    }
}

/// From rest to rest over a height.
fn septic(s: f64, duration: f64, d: f64) -> [f64; 4] {
    let (s2, s3) = (s * s, s * s * s);
    let rate = |order: i32| d / duration.powi(order);
    [
        d * s3 * s * (35.0 - 84.0 * s + 70.0 * s2 - 20.0 * s3),
        rate(1) * s3 * (140.0 - 420.0 * s + 420.0 * s2 - 140.0 * s3),
        rate(2) * s2 * (420.0 - 1680.0 * s + 2100.0 * s2 - 840.0 * s3),
        rate(3) * s * (840.0 - 5040.0 * s + 8400.0 * s2 - 4200.0 * s3),
    ]
}

/// The phase goes from standing to its rate by a polynomial of degree 7 in the rate: smooth to the jerk and beyond.
fn eight(w: f64, turn: f64, t: f64) -> Motion {
    const RAMP_S: f64 = 3.0;
    let s = ((t - 2.0) / RAMP_S).clamp(0.0, 1.0);
    let after = (t - 2.0 - RAMP_S).max(0.0);
    let [r0, r1, r2, _] = septic(s, RAMP_S, 1.0);
    // Integral of the septic over its time.
    let (s2, s4) = (s * s, s * s * s * s);
    let covered = RAMP_S * s4 * s * (7.0 - 14.0 * s + 10.0 * s2 - 2.5 * s2 * s);
    let (f, f1, f2, f3) = (w * (covered + after), w * r0, w * r1, w * r2);
    let sine = |n: f64, k: f64| {
        let (sin, cos) = (n * f).sin_cos();
        let (g1, g2, g3) = (n * f1, n * f2, n * f3);
        [k * sin, k * cos * g1, k * (cos * g2 - sin * g1 * g1), k * (cos * (g3 - g1 * g1 * g1) - 3.0 * sin * g1 * g2)]
    };
    let (x, y) = (sine(1.0, 1.0), sine(2.0, 0.5));
    let at = |i: usize| Vector3::new(x[i], y[i], if i == 0 { HEIGHT } else { 0.0 });
    ([at(0), at(1), at(2), at(3)], [turn * (covered + after), turn * r0, turn * r1])
}

fn w(t: f64) -> [Vector3<f64>; 4] {
    let mut rest = t.max(0.0);
    for (i, piece) in AGGRESSIVE.iter().enumerate() {
        let duration = piece.duration_ns as f64 * 1e-9;
        if rest <= duration || i + 1 == AGGRESSIVE.len() {
            let s = rest.min(duration);
            let still = t <= 0.0 || rest > duration;
            let of = |k: &[f32; 8]| {
                let c = k.map(f64::from);
                let mut d = [0.0; 4];
                for (order, value) in d.iter_mut().enumerate() {
                    for (n, c) in c.iter().enumerate().skip(order) {
                        let factor = (0..order).map(|i| (n - i) as f64).product::<f64>();
                        *value += c * factor * s.powi((n - order) as i32);
                    }
                    if still && order > 0 {
                        *value = 0.0;
                    }
                }
                d
            };
            let (x, y, z) = (of(&piece.x), of(&piece.y), of(&piece.z));
            return [0, 1, 2, 3].map(|i| Vector3::new(x[i], y[i], z[i]));
        }
        rest -= duration;
    }
    [Vector3::zeros(); 4]
}
