//! Setpoints that arrive slowly, a hundred a second or so, each dated and with its derivatives up to the jerk, in; the motion
//! at every step between them, with snap and crackle, out.
//!
//! Between two setpoints the newest is extrapolated by its own derivatives. Snap and crackle are those of a parabola through the
//! last eight jerks ([`JerkFit`]). Where no jerk is sent, as in full-state packets, jerk and snap are those of a parabola
//! through the last accelerations. Nothing is fitted over a jump or a gap of more than [`GAP_MAX_MS`].

mod extrapolation;
mod jerk_source;

use quatrack::cascade::JerkFit;
use quatrack::nalgebra::Vector3;

pub use self::extrapolation::EXTRAPOLATION_MAX_MS;
use self::jerk_source::{Source, is_zero};
use crate::motion::Motion;

/// Longest time between two setpoints of one motion, ms: one in a row of any rate above 40 a second may be missing.
pub const GAP_MAX_MS: u32 = 50;

/// Differences from the extrapolated last setpoint, beyond which a setpoint is a jump: m, m/s, m/s^2, summed over
/// the axes.
const JUMP: [f32; 3] = [0.02, 0.2, 2.0];

/// Largest snap (m/s^4) and crackle (m/s^5) that are taken for a motion, ten and fifty times those of the fastest flights;
/// beyond lies the corner of a trajectory.
const SNAP_MAX_M_S4: f32 = 1_000.0;
const CRACKLE_MAX_M_S5: f32 = 25_000.0;

/// The newest setpoint's motion, and the fit through those before.
#[derive(Clone, Copy, Debug)]
pub struct Stream {
    newest: Motion,
    snap_m_s4: Vector3<f32>,
    crackle_m_s5: Vector3<f32>,
    /// When the newest was sent, ms; nothing before the first.
    since_ms: Option<u32>,
    /// The jerk of the newest as it was sent, m/s^3.
    sent_jerk_m_s3: Vector3<f32>,
    source: Source,
    fit: JerkFit,
    /// The newest setpoint has not been fitted yet: snap and crackle are those of the one before, carried on.
    is_due: bool,
    /// Time from the setpoint before to the newest one, s.
    gap_s: f32,
}

/// The relation of a setpoint to those before it.
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
        const ZERO: Vector3<f32> = Vector3::new(0.0, 0.0, 0.0);
        Self {
            newest: Motion::ZERO,
            snap_m_s4: ZERO,
            crackle_m_s5: ZERO,
            since_ms: None,
            sent_jerk_m_s3: ZERO,
            source: Source::Sent { unsound: 0 },
            fit: JerkFit::NONE,
            is_due: false,
            gap_s: 0.0,
        }
    }

    /// Takes a setpoint's motion that was sent at a time of a clock that may wrap; with snap and crackle where a law looks
    /// beyond the jerk. One of the same time changes place and velocity alone.
    #[inline(always)]
    pub fn accept(&mut self, motion: &Motion, date_ms: u32, beyond_jerk: bool) -> Arrival {
        let Some(since_ms) = self.since_ms else { return self.begin(motion, date_ms, Arrival::Begun) };
        let gap_ms = date_ms.wrapping_sub(since_ms);
        if gap_ms == 0 {
            (self.newest.position_m, self.newest.velocity_m_s) = (motion.position_m, motion.velocity_m_s);
            return Arrival::Continued;
        }
        if gap_ms > GAP_MAX_MS {
            return self.begin(motion, date_ms, Arrival::Begun);
        }
        let gap_s = gap_ms as f32 * 1e-3;
        if !self.leads_to(motion, gap_s, beyond_jerk) {
            return self.begin(motion, date_ms, Arrival::Jumped);
        }
        let source = self.source_of(motion, gap_s);
        self.sent_jerk_m_s3 = motion.jerk_m_s3;
        self.since_ms = Some(date_ms);
        if !(beyond_jerk || matches!(source, Source::Mistrusted { .. })) {
            // A law that takes no snap gets the setpoint as it is sent.
            (self.newest, self.source, self.is_due) = (*motion, source, false);
            self.forget_fit();
            return Arrival::Continued;
        }
        self.keep(motion, gap_s, source);
        Arrival::Continued
    }

    /// A motion that does not continue the one before.
    #[cold]
    #[inline(never)]
    fn begin(&mut self, motion: &Motion, date_ms: u32, arrival: Arrival) -> Arrival {
        let source = match self.source {
            // Jerks that were mistrusted before a jump are those of the same sender.
            Source::Mistrusted { .. } if arrival == Arrival::Jumped => Source::Mistrusted { sound: 0 },
            _ if is_zero(&motion.jerk_m_s3) => Source::Accelerations,
            _ => Source::Sent { unsound: 0 },
        };
        *self =
            Self { newest: *motion, since_ms: Some(date_ms), sent_jerk_m_s3: motion.jerk_m_s3, source, ..Self::new() };
        self.keep(motion, 0.0, source);
        arrival
    }

    /// Whether the newest setpoint leads to a motion so many seconds later.
    #[inline(always)]
    fn leads_to(&self, motion: &Motion, t: f32, to_acceleration: bool) -> bool {
        let [position, velocity, acceleration] = self.extrapolated(t);
        let [position_most, velocity_most, acceleration_most] = JUMP;
        distance(&motion.position_m, &position) <= position_most
            && (!to_acceleration
                || (distance(&motion.velocity_m_s, &velocity) <= velocity_most
                    && distance(&motion.acceleration_m_s2, &acceleration) <= acceleration_most))
    }

    /// Takes a motion; until it is fitted, its higher derivatives are extrapolated from the one before.
    #[inline(always)]
    fn keep(&mut self, motion: &Motion, gap_s: f32, source: Source) {
        if self.is_due {
            self.fit_newest();
        }
        let (was_sent, is_sent) = (self.is_sent(), matches!(source, Source::Sent { .. }));
        if was_sent != is_sent {
            self.forget_fit();
        }
        let ahead =
            |a: &Vector3<f32>, b: &Vector3<f32>| Vector3::new(a.x + gap_s * b.x, a.y + gap_s * b.y, a.z + gap_s * b.z);
        let jerk = if is_sent { motion.jerk_m_s3 } else { ahead(&self.newest.jerk_m_s3, &self.snap_m_s4) };
        self.snap_m_s4 = ahead(&self.snap_m_s4, &self.crackle_m_s5);
        self.newest = Motion { jerk_m_s3: jerk, ..*motion };
        (self.source, self.is_due, self.gap_s) = (source, true, gap_s);
    }

    /// Whether the newest setpoint is still to be fitted.
    #[inline(always)]
    pub const fn is_due(&self) -> bool {
        self.is_due
    }

    /// Hands the newest setpoint to the fit, which takes jerks where they are sent and accelerations where not.
    #[inline(always)]
    fn fit_newest(&mut self) {
        self.is_due = false;
        let Motion { acceleration_m_s2, jerk_m_s3, .. } = &self.newest;
        self.fit.accept(if self.is_sent() { jerk_m_s3 } else { acceleration_m_s2 }, self.gap_s);
    }

    /// Fits the newest setpoint and the ones before.
    #[inline(never)]
    pub fn catch_up(&mut self) {
        self.fit_newest();
        let [first, second] = self.fit.snap_and_crackle();
        if self.is_sent() {
            (self.snap_m_s4, self.crackle_m_s5) = (first, second);
        } else {
            (self.newest.jerk_m_s3, self.snap_m_s4) = (first, second);
        }
        let size = |v: &Vector3<f32>| v.x.abs() + v.y.abs() + v.z.abs();
        if !(size(&self.snap_m_s4) <= SNAP_MAX_M_S4 && size(&self.crackle_m_s5) <= CRACKLE_MAX_M_S5) {
            self.forget_fit();
        }
    }

    fn is_sent(&self) -> bool {
        matches!(self.source, Source::Sent { .. })
    }

    /// Forgets snap and crackle.
    #[inline(always)]
    fn forget_fit(&mut self) {
        self.fit.forget();
        (self.snap_m_s4, self.crackle_m_s5) = (Vector3::new(0.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 0.0));
    }

    /// The newest setpoint's motion as it was sent, but for its jerk.
    pub fn newest(&self) -> &Motion {
        &self.newest
    }
}

/// Summed over the axes.
#[inline(always)]
fn distance(a: &Vector3<f32>, b: &Vector3<f32>) -> f32 {
    (a.x - b.x).abs() + (a.y - b.y).abs() + (a.z - b.z).abs()
}
