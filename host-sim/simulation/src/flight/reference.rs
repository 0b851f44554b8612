//! References over time: a trajectory in, the point to be at out; sampled and interpolated as in the paper, or exact.

use quatrack_design::model::flat::{ReferencePoint, reference_point};
use quatrack_plan::trajectory::Trajectory;

/// A reference over time.
pub trait Reference {
    /// Length in time, s.
    fn duration_s(&self) -> f64;
    /// The point to be at.
    fn at(&self, t_s: f64) -> ReferencePoint;
}

/// The trajectory's flat map, evaluated wherever it is asked for.
#[derive(Clone, Copy)]
pub struct Exact<'a>(pub &'a dyn Trajectory);

impl Reference for Exact<'_> {
    fn duration_s(&self) -> f64 {
        self.0.duration_s()
    }

    fn at(&self, t_s: f64) -> ReferencePoint {
        reference_point(&self.0.at(t_s))
    }
}

/// Points at multiples of a period, linearly interpolated in between: how the paper's simulation reads its tables.
#[derive(Clone, Debug)]
pub struct Sampled {
    duration_s: f64,
    period_s: f64,
    points: Vec<ReferencePoint>,
}

impl Sampled {
    /// Samples `trajectory` every `period_s`, mapping each sample by `map`.
    pub fn new(
        trajectory: &dyn Trajectory,
        period_s: f64,
        map: impl Fn(&dyn Trajectory, f64) -> ReferencePoint,
    ) -> Self {
        let duration_s = trajectory.duration_s();
        let intervals = (duration_s / period_s - 1e-9).ceil().max(1.0) as usize;
        let points = (0..=intervals).map(|k| map(trajectory, (k as f64 * period_s).min(duration_s))).collect();
        Self { duration_s, period_s, points }
    }
}

impl Reference for Sampled {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, t_s: f64) -> ReferencePoint {
        let position = (t_s / self.period_s).clamp(0.0, (self.points.len() - 1) as f64);
        let index = (position as usize).min(self.points.len() - 2);
        let share = position - index as f64;
        let (a, b) = (&self.points[index], &self.points[index + 1]);
        ReferencePoint {
            state: a.state.lerp(&b.state, share),
            input: a.input.lerp(&b.input, share),
            acceleration_m_s2: a.acceleration_m_s2.lerp(&b.acceleration_m_s2, share),
            jerk_m_s3: a.jerk_m_s3.lerp(&b.jerk_m_s3, share),
            heading_rad: a.heading_rad + share * (b.heading_rad - a.heading_rad),
            heading_rate_rad_s: a.heading_rate_rad_s + share * (b.heading_rate_rad_s - a.heading_rate_rad_s),
        }
    }
}
