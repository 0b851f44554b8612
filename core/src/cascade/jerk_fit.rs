//! Snap and crackle of setpoints that are sent to the jerk: the parabola through the last eight jerks that is nearest to them.
//!
//! Differences of jerks double their noise with each order; a parabola over 80 ms of setpoints does not, and takes odd periods and
//! missing setpoints as they come, each dated by its own stamp.

use nalgebra::Vector3;

/// Number of jerks that are kept.
const KEPT: usize = 8;

/// The last jerks, newest first, dated.
#[derive(Clone, Copy, Debug)]
pub struct JerkFit {
    x: [f32; KEPT],
    y: [f32; KEPT],
    z: [f32; KEPT],
    /// How long before the newest each was, s.
    ages_s: [f32; KEPT],
    count: u8,
}

impl JerkFit {
    /// None yet.
    pub const NONE: Self = Self { x: [0.0; KEPT], y: [0.0; KEPT], z: [0.0; KEPT], ages_s: [0.0; KEPT], count: 0 };

    /// Forgets the jerks: before a motion that does not continue the last one.
    pub const fn forget(&mut self) {
        self.count = 0;
    }

    /// Takes a jerk (m/s^3), so many seconds after the last one.
    pub fn accept(&mut self, jerk_m_s3: &Vector3<f32>, after_s: f32) {
        self.x = pushed(jerk_m_s3.x, &self.x);
        self.y = pushed(jerk_m_s3.y, &self.y);
        self.z = pushed(jerk_m_s3.z, &self.z);
        self.ages_s = pushed(0.0, &self.ages_s.map(|age| age + after_s));
        if usize::from(self.count) < KEPT {
            self.count += 1;
        }
    }

    /// Snap (m/s^4) at the newest setpoint and crackle (m/s^5); zero as long as there are too few jerks, 2 and 3.
    pub fn snap_and_crackle(&self) -> [Vector3<f32>; 2] {
        let zero = Vector3::new(0.0, 0.0, 0.0);
        let count = usize::from(self.count);
        let oldest_s = self.ages_s.get(count.wrapping_sub(1)).copied().unwrap_or(0.0);
        if oldest_s.is_nan() || oldest_s <= 1e-4 {
            return [zero; 2];
        }
        // Powers of time, in units of half the oldest age: all sums are then of the size of the count.
        let per = 2.0 / oldest_s;
        let (mut s1, mut s2, mut s3, mut s4) = (0.0, 0.0, 0.0, 0.0);
        // The newest is at time 0.
        let ([x0, xs @ ..], [y0, ys @ ..], [z0, zs @ ..], [_, ages @ ..]) = (&self.x, &self.y, &self.z, &self.ages_s);
        let (mut bx, mut by, mut bz) = ([*x0, 0.0, 0.0], [*y0, 0.0, 0.0], [*z0, 0.0, 0.0]);
        for ((age, x), (y, z)) in ages.iter().zip(xs).zip(ys.iter().zip(zs)).take(count.wrapping_sub(1)) {
            let t = -age * per;
            let t2 = t * t;
            (s1, s2, s3, s4) = (s1 + t, s2 + t2, s3 + t * t2, s4 + t2 * t2);
            for (sums, j) in [(&mut bx, *x), (&mut by, *y), (&mut bz, *z)] {
                let [b0, b1, b2] = *sums;
                *sums = [b0 + j, b1 + t * j, b2 + t2 * j];
            }
        }
        // The mean taken off, two equations for the slope and half the curvature.
        let mean = 1.0 / f32::from(self.count);
        let (m11, m12, m22) = (s2 - s1 * s1 * mean, s3 - s1 * s2 * mean, s4 - s2 * s2 * mean);
        let line = 1.0 / m11;
        let rest = m22 - m12 * m12 * line;
        let curve = if self.count >= 3 && rest > 1e-4 { 1.0 / rest } else { 0.0 };
        let solve = |[b0, b1, b2]: [f32; 3]| {
            let (r1, r2) = (b1 - s1 * b0 * mean, b2 - s2 * b0 * mean);
            let curvature = (r2 - m12 * r1 * line) * curve;
            ((r1 - m12 * curvature) * line * per, 2.0 * curvature * per * per)
        };
        let (x, y, z) = (solve(bx), solve(by), solve(bz));
        [Vector3::new(x.0, y.0, z.0), Vector3::new(x.1, y.1, z.1)]
    }
}

/// A value put before others, of which the last falls out.
#[inline(always)]
fn pushed(newest: f32, [a, b, c, d, e, f, g, _]: &[f32; KEPT]) -> [f32; KEPT] {
    [newest, *a, *b, *c, *d, *e, *f, *g]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_found_at_any_times() {
        for gaps in [[0.01; 8], [0.005, 0.021, 0.01, 0.03, 0.007, 0.011, 0.01, 0.009]] {
            let (mut fit, mut t) = (JerkFit::NONE, 0.0);
            for gap in [gaps, gaps].concat() {
                t += gap;
                fit.accept(&Vector3::new(1.0 + 20.0 * t + 150.0 * t * t, -t, 3.0), gap);
            }
            let [snap, crackle] = fit.snap_and_crackle();
            // Roundings of jerks of up to 10 over the 80 ms, once and twice.
            assert!((snap - Vector3::new(20.0 + 300.0 * t, -1.0, 0.0)).norm() < 0.02, "{snap}");
            assert!((crackle - Vector3::new(300.0, 0.0, 0.0)).norm() < 0.5, "{crackle}");
        }
    }

    #[test]
    fn few_jerks_give_as_many_derivatives_as_they_can() {
        let mut fit = JerkFit::NONE;
        assert_eq!(fit.snap_and_crackle(), [Vector3::zeros(); 2]);
        fit.accept(&Vector3::x(), 0.0);
        assert_eq!(fit.snap_and_crackle(), [Vector3::zeros(); 2]);
        fit.accept(&Vector3::new(1.5, 0.0, 0.0), 0.01);
        let [snap, crackle] = fit.snap_and_crackle();
        assert!((snap.x - 50.0).abs() < 1e-3 && crackle == Vector3::zeros(), "{snap}");
        fit.forget();
        assert_eq!(fit.snap_and_crackle(), [Vector3::zeros(); 2]);
    }
}
