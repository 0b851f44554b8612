//! Setpoints that arrive slowly, a hundred a second, each with its derivatives up to the jerk, in; the motion at every
//! step between them, with snap and crackle, out.
//!
//! Between two setpoints the newest is extrapolated by its own derivatives. Snap and crackle come from backward
//! differences of the jerks of successive setpoints: the difference of two jerks is the snap halfway between them, that of
//! two such snaps the crackle in the middle, and each is carried on by the next. Nothing is differenced over a jump, over
//! a gap of more than [`GAP_MAX_MS`], or from a stream that sends no jerk.

use quatrack::FifthOrderSample;
use quatrack::nalgebra::Vector3;

use crate::craft::PERIOD_S;
use crate::demand::Motion;

/// Longest time between two setpoints over which jerks are differenced, ms.
pub const GAP_MAX_MS: u32 = 25;

/// Longest time that a setpoint is extrapolated, ms; then the motion stands still where it has come to.
pub const EXTRAPOLATION_MAX_MS: u32 = 100;

/// Differences from what the last setpoint led to expect, beyond which a setpoint is a jump: m, m/s, m/s^2, summed over
/// the axes.
const JUMP: [f32; 3] = [0.02, 0.2, 2.0];

/// Largest snap (m/s^4) and crackle (m/s^5) that are taken for a motion, ten and fifty times those of the fastest flights;
/// beyond lies the corner of a trajectory.
const SNAP_MAX_M_S4: f32 = 1_000.0;
const CRACKLE_MAX_M_S5: f32 = 25_000.0;

/// Largest difference of a sound jerk, in the mean of two setpoints, from the slope of their accelerations, m/s^3,
/// summed over the axes: four times that of the fastest flights.
const JERK_OFF_MAX_M_S3: f32 = 0.5;

/// Sound jerks in a row after which they are taken again: a quarter of a second.
const SOUND_JERKS: u8 = 25;

/// The newest setpoint's motion, and what the ones before tell about it.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    newest: Motion,
    snap_m_s4: Vector3<f32>,
    crackle_m_s5: Vector3<f32>,
    /// First and second difference of the newest jerks, as far as there are enough of them, each over its time.
    differences: [Option<Vector3<f32>>; 2],
    /// Time between the newest two setpoints, s.
    gap_s: f32,
    /// When the newest came, ms; nothing before the first.
    since_ms: Option<u32>,
    /// While the jerks that are sent are not the slope of the accelerations.
    mended: Option<Mended>,
}

/// Jerks that are not taken as they are sent.
#[derive(Clone, Copy, Debug)]
struct Mended {
    /// The newest one as it was sent, m/s^3.
    sent: Vector3<f32>,
    /// Slope of the accelerations over the last gap, m/s^3.
    slope: Vector3<f32>,
    /// How many of those that were sent last were sound.
    sound: u8,
}

/// What a setpoint was to the ones before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// Their continuation.
    Continued,
    /// A new beginning: the first one, or one after a gap.
    Begun,
    /// Somewhere else.
    Jumped,
}

impl Stream {
    /// Nothing yet.
    #[allow(clippy::new_without_default, reason = "a default is not const")]
    pub const fn new() -> Self {
        Self {
            newest: Motion::ZERO,
            snap_m_s4: Vector3::new(0.0, 0.0, 0.0),
            crackle_m_s5: Vector3::new(0.0, 0.0, 0.0),
            differences: [None; 2],
            gap_s: 0.0,
            since_ms: None,
            mended: None,
        }
    }

    /// Takes a setpoint's motion, at a time of a clock that may wrap, and differences jerks. The one that is flown already
    /// changes nothing.
    pub fn accept(&mut self, motion: &Motion, now_ms: u32) -> Arrival {
        if self.is_newest(motion) {
            return Arrival::Continued;
        }
        let mut motion = *motion;
        let arrival = match self.gap_s(now_ms) {
            Some(gap_s) => {
                motion.jerk_m_s3 = self.jerk_m_s3(&motion, gap_s);
                self.difference(&motion, gap_s)
            }
            None => Arrival::Begun,
        };
        if arrival != Arrival::Continued {
            self.forget();
        }
        (self.newest, self.since_ms) = (motion, Some(now_ms));
        arrival
    }

    /// The same for laws that do not look beyond the jerk.
    #[inline(always)]
    pub fn accept_to_jerk(&mut self, motion: &Motion, now_ms: u32) -> Arrival {
        if self.is_newest(motion) {
            return Arrival::Continued;
        }
        let (mut arrival, mut jerk_m_s3) = (Arrival::Begun, motion.jerk_m_s3);
        if let Some(gap_s) = self.gap_s(now_ms) {
            arrival = if self.leads_to(motion, gap_s) { Arrival::Continued } else { Arrival::Jumped };
            jerk_m_s3 = self.jerk_m_s3(motion, gap_s);
        }
        if self.differences[0].is_some() {
            self.forget();
        }
        (self.newest, self.since_ms) = (Motion { jerk_m_s3, ..*motion }, Some(now_ms));
        arrival
    }

    /// Changes place and velocity of the newest setpoint, which came when it came.
    #[cold]
    #[inline(never)]
    pub fn divert(&mut self, motion: &Motion) {
        (self.newest.position_m, self.newest.velocity_m_s) = (motion.position_m, motion.velocity_m_s);
    }

    /// Time since the newest setpoint, if it is not too long ago for another one to continue it, s.
    #[inline(always)]
    fn gap_s(&self, now_ms: u32) -> Option<f32> {
        let gap_ms = now_ms.wrapping_sub(self.since_ms?);
        (1..=GAP_MAX_MS).contains(&gap_ms).then_some(gap_ms as f32 * 1e-3)
    }

    /// Whether the newest setpoint leads to the place of a motion so many seconds later. Within the gap that setpoints may
    /// leave, what the acceleration adds is below the bound.
    #[inline(always)]
    fn leads_to(&self, motion: &Motion, t: f32) -> bool {
        let Motion { position_m: p, velocity_m_s: v, .. } = &self.newest;
        let ahead = Vector3::new(p.x + t * v.x, p.y + t * v.y, p.z + t * v.z);
        distance(&motion.position_m, &ahead) <= JUMP[0]
    }

    /// The jerk of a motion so many seconds after the newest setpoint.
    ///
    /// The firmware turns a trajectory that is started with a relative yaw, but for its jerk (`traj_eval_transform`). A jerk
    /// that is not the slope of the accelerations gives way to that slope.
    #[inline(always)]
    fn jerk_m_s3(&mut self, motion: &Motion, gap_s: f32) -> Vector3<f32> {
        let (new, j) = (&motion.acceleration_m_s2, &motion.jerk_m_s3);
        let (old, k) = (&self.newest.acceleration_m_s2, &self.newest.jerk_m_s3);
        let twice = 2.0 / gap_s;
        let off = (twice * (new.x - old.x) - (j.x + k.x)).abs()
            + (twice * (new.y - old.y) - (j.y + k.y)).abs()
            + (twice * (new.z - old.z) - (j.z + k.z)).abs();
        let is_sound = off <= 2.0 * JERK_OFF_MAX_M_S3 && self.mended.is_none();
        // Packets without a jerk have none to be mended.
        if is_sound || (j.x == 0.0 && j.y == 0.0 && j.z == 0.0) {
            return *j;
        }
        self.mend(&Motion { ..*motion }, gap_s)
    }

    /// The slope of the accelerations over the gap, carried on by half of it.
    #[cold]
    #[inline(never)]
    fn mend(&mut self, motion: &Motion, gap_s: f32) -> Vector3<f32> {
        let per_gap = 1.0 / gap_s;
        let slope = over(&motion.acceleration_m_s2, &self.newest.acceleration_m_s2, per_gap);
        let Some(Mended { sent, slope: before, sound }) = self.mended else {
            self.mended = Some(Mended { sent: motion.jerk_m_s3, slope, sound: 0 });
            self.newest.jerk_m_s3 = slope;
            self.forget();
            return slope;
        };
        let is_sound = distance(&slope, &middle(&sent, &motion.jerk_m_s3)) <= JERK_OFF_MAX_M_S3;
        if is_sound && sound >= SOUND_JERKS {
            (self.mended, self.newest.jerk_m_s3) = (None, sent);
            self.forget();
            return motion.jerk_m_s3;
        }
        let sound = if is_sound { sound + 1 } else { 0 };
        self.mended = Some(Mended { sent: motion.jerk_m_s3, slope, sound });
        let on = |slope: f32, before: f32| slope + 0.5 * (slope - before);
        Vector3::new(on(slope.x, before.x), on(slope.y, before.y), on(slope.z, before.z))
    }

    #[inline(always)]
    fn is_newest(&self, motion: &Motion) -> bool {
        *motion == self.newest && self.since_ms.is_some()
    }

    /// Forgets snap and crackle.
    #[cold]
    #[inline(never)]
    fn forget(&mut self) {
        *self = Self { newest: self.newest, since_ms: self.since_ms, mended: self.mended, ..Self::new() };
    }

    /// The newest setpoint's motion as it was sent, but for a jerk that was mended.
    pub fn newest(&self) -> &Motion {
        &self.newest
    }

    /// The motion at a time, heading aside, into `sample`; with snap and crackle only where they are asked for.
    #[inline(always)]
    pub fn at(&self, now_ms: u32, to_fifth: bool, sample: &mut FifthOrderSample) {
        let age_ms = self.since_ms.map_or(0, |since_ms| now_ms.wrapping_sub(since_ms));
        if age_ms > EXTRAPOLATION_MAX_MS {
            return self.end(sample);
        }
        let t = age_ms as f32 * 1e-3;
        if to_fifth {
            self.put_to_fifth(t, sample);
            return;
        }
        let flat = &mut sample.flat;
        [flat.position_m, flat.velocity_m_s, flat.acceleration_m_s2] = self.extrapolated(t);
        flat.jerk_m_s3 = self.newest.jerk_m_s3;
    }

    /// Position, velocity and acceleration so many seconds after the newest setpoint, by its own derivatives.
    #[inline(always)]
    fn extrapolated(&self, t: f32) -> [Vector3<f32>; 3] {
        let Motion { position_m: p, velocity_m_s: v, acceleration_m_s2: a, jerk_m_s3: j } = &self.newest;
        let (t2, t3) = (t * (1.0 / 2.0), t * (1.0 / 3.0));
        let along = |p: f32, v: f32, a: f32, j: f32| (p + t * (v + t2 * (a + t3 * j)), v + t * (a + t2 * j), a + t * j);
        let (x, y, z) = (along(p.x, v.x, a.x, j.x), along(p.y, v.y, a.y, j.y), along(p.z, v.z, a.z, j.z));
        [Vector3::new(x.0, y.0, z.0), Vector3::new(x.1, y.1, z.1), Vector3::new(x.2, y.2, z.2)]
    }

    #[inline]
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
        self.put_to_fifth(EXTRAPOLATION_MAX_MS as f32 * 1e-3, sample);
        *sample = FifthOrderSample::at_rest(sample.flat.position_m, 0.0);
    }

    /// Snap and crackle at a setpoint that continues the ones before, so many seconds after the last of them.
    fn difference(&mut self, motion: &Motion, gap_s: f32) -> Arrival {
        let mut expected = FifthOrderSample::at_rest(motion.position_m, 0.0);
        self.put_to_fifth(gap_s, &mut expected);
        let expected = &expected.flat;
        let continues = distance(&motion.position_m, &expected.position_m) <= JUMP[0]
            && distance(&motion.velocity_m_s, &expected.velocity_m_s) <= JUMP[1]
            && distance(&motion.acceleration_m_s2, &expected.acceleration_m_s2) <= JUMP[2];
        if !continues {
            return Arrival::Jumped;
        }
        let (new, old) = (&motion.jerk_m_s3, &self.newest.jerk_m_s3);
        let zero = Vector3::new(0.0, 0.0, 0.0);
        if *new == zero {
            (self.differences, self.snap_m_s4, self.crackle_m_s5) = ([None; 2], zero, zero);
            return Arrival::Continued;
        }
        // The snap halfway between two jerks, the crackle at the middle one of three; what follows them by half a gap and
        // by a whole one comes from the next difference.
        let (per_gap, [snap_before, crackle_before]) = (1.0 / gap_s, self.differences);
        let snap = over(new, old, per_gap);
        let crackle = snap_before.map(|before| over(&snap, &before, 2.0 / (gap_s + self.gap_s)));
        let growth = match (&crackle, &crackle_before) {
            (Some(crackle), Some(before)) => over(crackle, before, per_gap),
            _ => zero,
        };
        let ahead =
            |a: &Vector3<f32>, b: &Vector3<f32>, t: f32| Vector3::new(a.x + t * b.x, a.y + t * b.y, a.z + t * b.z);
        let middle = crackle.unwrap_or(zero);
        let size = |v: &Vector3<f32>| v.x.abs() + v.y.abs() + v.z.abs();
        if !(size(&snap) <= SNAP_MAX_M_S4 && size(&middle) <= CRACKLE_MAX_M_S5) {
            return Arrival::Jumped;
        }
        self.snap_m_s4 = ahead(&snap, &ahead(&middle, &growth, 0.75 * gap_s), 0.5 * gap_s);
        // Held until the next setpoint, it is that of the middle of the control steps until then.
        self.crackle_m_s5 = ahead(&middle, &growth, 1.5 * gap_s + 0.5 * PERIOD_S);
        (self.differences, self.gap_s) = ([Some(snap), crackle], gap_s);
        Arrival::Continued
    }
}

/// `(a - b) rate`.
#[inline(always)]
fn over(a: &Vector3<f32>, b: &Vector3<f32>, rate: f32) -> Vector3<f32> {
    Vector3::new((a.x - b.x) * rate, (a.y - b.y) * rate, (a.z - b.z) * rate)
}

fn middle(a: &Vector3<f32>, b: &Vector3<f32>) -> Vector3<f32> {
    Vector3::new(0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z))
}

/// Summed over the axes.
#[inline(always)]
fn distance(a: &Vector3<f32>, b: &Vector3<f32>) -> f32 {
    (a.x - b.x).abs() + (a.y - b.y).abs() + (a.z - b.z).abs()
}
