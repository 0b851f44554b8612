//! A time after the newest setpoint in; the motion that its own derivatives lead to out.

use quatrack::FifthOrderSample;
use quatrack::nalgebra::Vector3;

use super::Stream;
use crate::motion::Motion;

/// Longest time that a setpoint is extrapolated, ms; then the motion stops where it has come to.
pub const EXTRAPOLATION_MAX_MS: u32 = 100;

impl Stream {
    /// The motion at a time, heading aside, into `sample`; with snap and crackle only where they are asked for.
    #[inline(never)]
    pub fn at(&self, now_ms: u32, beyond_jerk: bool, sample: &mut FifthOrderSample) {
        let age_ms = self.since_ms.map_or(0, |since_ms| now_ms.wrapping_sub(since_ms));
        if age_ms > EXTRAPOLATION_MAX_MS {
            return self.end(sample);
        }
        let t = age_ms as f32 * 1e-3;
        if beyond_jerk {
            self.put_to_fifth(t, sample);
            return;
        }
        let flat = &mut sample.flat;
        [flat.position_m, flat.velocity_m_s, flat.acceleration_m_s2] = self.extrapolated(t);
        flat.jerk_m_s3 = self.newest.jerk_m_s3;
    }

    /// Position, velocity and acceleration so many seconds after the newest setpoint, by its own derivatives.
    #[inline(always)]
    pub(super) fn extrapolated(&self, t: f32) -> [Vector3<f32>; 3] {
        let Motion { position_m: p, velocity_m_s: v, acceleration_m_s2: a, jerk_m_s3: j } = &self.newest;
        let (t2, t3) = (t * (1.0 / 2.0), t * (1.0 / 3.0));
        let along = |p: f32, v: f32, a: f32, j: f32| (p + t * (v + t2 * (a + t3 * j)), v + t * (a + t2 * j), a + t * j);
        let (x, y, z) = (along(p.x, v.x, a.x, j.x), along(p.y, v.y, a.y, j.y), along(p.z, v.z, a.z, j.z));
        [Vector3::new(x.0, y.0, z.0), Vector3::new(x.1, y.1, z.1), Vector3::new(x.2, y.2, z.2)]
    }

    #[inline(always)]
    fn put_to_fifth(&self, t: f32, sample: &mut FifthOrderSample) {
        let Motion { position_m: p, velocity_m_s: v, acceleration_m_s2: a, jerk_m_s3: j } = &self.newest;
        let (s, c) = (&self.snap_m_s4, &self.crackle_m_s5);
        let (t2, t3, t4, t5) = (t * (1.0 / 2.0), t * (1.0 / 3.0), t * (1.0 / 4.0), t * (1.0 / 5.0));
        let along = |p: f32, v: f32, a: f32, j: f32, s: f32, c: f32| {
            (
                p + t * (v + t2 * (a + t3 * (j + t4 * (s + t5 * c)))),
                v + t * (a + t2 * (j + t3 * (s + t4 * c))),
                a + t * (j + t2 * (s + t3 * c)),
                j + t * (s + t2 * c),
                s + t * c,
            )
        };
        let x = along(p.x, v.x, a.x, j.x, s.x, c.x);
        let y = along(p.y, v.y, a.y, j.y, s.y, c.y);
        let z = along(p.z, v.z, a.z, j.z, s.z, c.z);
        let flat = &mut sample.flat;
        flat.position_m = Vector3::new(x.0, y.0, z.0);
        flat.velocity_m_s = Vector3::new(x.1, y.1, z.1);
        flat.acceleration_m_s2 = Vector3::new(x.2, y.2, z.2);
        flat.jerk_m_s3 = Vector3::new(x.3, y.3, z.3);
        sample.snap_m_s4 = Vector3::new(x.4, y.4, z.4);
        sample.crackle_m_s5 = *c;
    }

    /// Where a motion without successors has come to.
    #[cold]
    #[inline(never)]
    fn end(&self, sample: &mut FifthOrderSample) {
        [sample.flat.position_m, ..] = self.extrapolated(EXTRAPOLATION_MAX_MS as f32 * 1e-3);
        *sample = FifthOrderSample::at_rest(sample.flat.position_m, 0.0);
    }
}
