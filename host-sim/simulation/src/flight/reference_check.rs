//! Faults of a reference before anything flies it: a trajectory and limits in; where it starts in motion, jumps in
//! velocity, or asks for more than the limits out, in one line.

use std::fmt;

use quatrack::Limits;
use quatrack_plan::trajectory::Trajectory as _;
use quatrack_plan::trajectory::polynomial::{Coordinate, PiecewisePolynomial};

use super::core_loop::saturate;
use super::reference::{Exact, Reference as _};

/// A craft at rest, or a joint of rounded coefficients, differs from the reference by less than this, m/s.
const SAME_VELOCITY_M_S: f64 = 1e-2;

/// Most samples of the reference's thrust and body rates.
const SAMPLES: usize = 20_000;

/// The parts of a reference that no law can follow, as far as there are any.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceCheck {
    /// Speed at the start, m/s.
    pub start_speed_m_s: Option<f64>,
    /// The largest step in velocity where two pieces meet: the piece before it, from 1, when, s, and its size, m/s.
    pub velocity_jump: Option<(usize, f64, f64)>,
    /// Where it asks for most beyond the limits.
    pub beyond: Option<Beyond>,
}

/// A demand beyond a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Beyond {
    /// The time, s.
    pub time_s: f64,
    /// The quantity: thrust, m/s^2, or a body rate, rad/s.
    pub quantity: &'static str,
    /// Asked for, SI.
    pub asked: f64,
    /// The limit, SI.
    pub limit: f64,
}

impl ReferenceCheck {
    /// Looks at a trajectory.
    pub fn of(trajectory: &PiecewisePolynomial, limits: &Limits) -> Self {
        let speed_m_s = trajectory.at(0.0).velocity_m_s.norm();
        Self {
            start_speed_m_s: Some(speed_m_s).filter(|speed| *speed > SAME_VELOCITY_M_S),
            velocity_jump: velocity_jump(trajectory),
            beyond: beyond(trajectory, limits),
        }
    }

    /// The line to print; `None` if there is nothing to say.
    pub fn line(&self) -> Option<String> {
        let text = self.to_string();
        (!text.is_empty()).then_some(text)
    }
}

impl fmt::Display for ReferenceCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut findings = Vec::new();
        if let Some(speed_m_s) = self.start_speed_m_s {
            findings.push(format!("starts in motion, at {speed_m_s:.2} m/s"));
        }
        if let Some((piece, time_s, size_m_s)) = self.velocity_jump {
            findings.push(format!("jumps by {size_m_s:.3} m/s behind piece {piece}, at {time_s:.2} s"));
        }
        if let Some(Beyond { time_s, quantity, asked, limit }) = &self.beyond {
            findings.push(format!("asks for {quantity} of {asked:.2} at {time_s:.2} s where the limit is {limit:.2}"));
        }
        if findings.is_empty() { Ok(()) } else { write!(f, "the reference itself {}", findings.join(", ")) }
    }
}

fn velocity_jump(trajectory: &PiecewisePolynomial) -> Option<(usize, f64, f64)> {
    let axes = [Coordinate::X, Coordinate::Y, Coordinate::Z];
    let jumps = trajectory.pieces().windows(2).enumerate().map(|(index, pair)| {
        let square = |axis| {
            let before = pair[0].derivative(axis, 1, pair[0].duration_s);
            (pair[1].derivative(axis, 1, 0.0) - before).powi(2)
        };
        (index + 1, trajectory.boundaries_s()[index + 1], axes.map(square).iter().sum::<f64>().sqrt())
    });
    jumps.filter(|(.., size)| *size > SAME_VELOCITY_M_S).max_by(|a, b| a.2.total_cmp(&b.2))
}

/// The sample with the largest demand beyond a limit, as a share of it.
fn beyond(trajectory: &PiecewisePolynomial, limits: &Limits) -> Option<Beyond> {
    const NAMES: [&str; 4] = ["a thrust, m/s^2,", "a roll rate, rad/s,", "a pitch rate, rad/s,", "a yaw rate, rad/s,"];
    let reference = Exact(trajectory);
    let duration_s = trajectory.duration_s();
    let intervals = ((duration_s / 2e-3).ceil() as usize).clamp(1, SAMPLES);
    let mut worst: Option<(f64, Beyond)> = None;
    for k in 0..=intervals {
        let time_s = duration_s * k as f64 / intervals as f64;
        let asked = reference.at(time_s).input;
        let Some((cut, true)) = saturate(&asked, limits) else { continue };
        for (part, quantity) in NAMES.into_iter().enumerate() {
            let excess = (asked[part] - cut[part]).abs() / (1.0 + cut[part].abs());
            // A command cut in one part is rounded in the others.
            if excess > 1e-6 && worst.as_ref().is_none_or(|(most, _)| excess > *most) {
                worst = Some((excess, Beyond { time_s, quantity, asked: asked[part], limit: cut[part] }));
            }
        }
    }
    worst.map(|(_, beyond)| beyond)
}

#[cfg(test)]
mod tests {
    use super::*;
    use quatrack::nalgebra::Vector3;
    use quatrack_plan::trajectory::polynomial::Piece;

    fn pieces(x: [[f64; 8]; 2]) -> PiecewisePolynomial {
        let piece = |x| Piece { duration_s: 1.0, coefficients: [x, [0.0; 8], [0.0; 8], [0.0; 8]] };
        PiecewisePolynomial::new(x.map(piece).to_vec()).unwrap()
    }

    #[test]
    fn each_finding_is_in_the_one_line() {
        // 2 m/s from the start; then 0.5 m/s more, with 6 m/s^2.
        let moving = pieces([[0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], [2.0, 2.5, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0]]);
        let limits = Limits::new(1.0, 11.0, Vector3::new(20.0, 20.0, 10.0)).unwrap();
        let line = ReferenceCheck::of(&moving, &limits).line().unwrap();
        // sqrt(9.81^2 + 6^2)
        assert_eq!(
            line,
            "the reference itself starts in motion, at 2.00 m/s, jumps by 0.500 m/s behind piece 1, at 1.00 s, asks for a \
             thrust, m/s^2, of 11.50 at 1.00 s where the limit is 11.00"
        );
        let rest = pieces([[0.0; 8]; 2]);
        assert_eq!(ReferenceCheck::of(&rest, &limits).line(), None);
        assert_eq!(ReferenceCheck::of(&moving, &Limits::NONE).beyond, None);
    }
}
