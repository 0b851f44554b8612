//! Headings that arrive slowly, each dated and with its rate, in; the heading at every step between them, with its derivatives
//! to the third, out: as [`crate::stream`] does for positions.
//!
//! The acceleration is the difference of successive rates, the jerk that of two accelerations, each carried on to the
//! newest setpoint. A heading that moves while a rate of 0 is sent, as scripts do, gets the rate at which it moves. No rate is
//! differenced over a gap of more than [`GAP_MAX_MS`], no heading over more than [`EXTRAPOLATION_MAX_MS`], and nothing where no
//! craft turns like that.

use quatrack::{FifthOrderSample, Heading};

use crate::stream::{EXTRAPOLATION_MAX_MS, GAP_MAX_MS};
use crate::units::HEADING_RATE_MAX_RAD_S;

/// Largest acceleration (rad/s^2) and jerk (rad/s^3) that are taken for a turn, some times those of a quarter turn in a
/// second; beyond lies a jump of the rate.
const ACCELERATION_MAX_RAD_S2: f32 = 20.0;
const JERK_MAX_RAD_S3: f32 = 400.0;

/// Share of a new slope of the headings in the rate that is taken where none is sent: full-state packets have headings in steps
/// of 0.16 degrees.
const SLOPE_SHARE: f32 = 0.2;
/// Largest slope that is taken for a turn where headings come more rarely than [`GAP_MAX_MS`], rad/s: a faster one is a new goal.
const SLOW_SLOPE_MAX_RAD_S: f32 = 2.0;
/// Rate below which a heading is taken to be at rest, rad/s.
const REST_RAD_S: f32 = 1e-3;

/// The newest heading, and the state of the fit through those before.
#[derive(Clone, Copy, Debug)]
pub struct HeadingStream {
    heading: Heading,
    rate_rad_s: f32,
    acceleration_rad_s2: f32,
    jerk_rad_s3: f32,
    /// Difference of the newest two rates over their time.
    difference_rad_s2: Option<f32>,
    /// Arrival of the newest, ms.
    since_ms: u32,
}

impl HeadingStream {
    /// Heading 0, for ever.
    #[allow(clippy::new_without_default, reason = "a default is not const")]
    pub const fn new() -> Self {
        Self {
            heading: Heading::ZERO,
            rate_rad_s: 0.0,
            acceleration_rad_s2: 0.0,
            jerk_rad_s3: 0.0,
            difference_rad_s2: None,
            since_ms: 0,
        }
    }

    /// Takes a heading that was sent at a time of a clock that may wrap and does not continue the ones before.
    pub const fn begin(&mut self, heading: Heading, rate_rad_s: f32, date_ms: u32) {
        *self = Self { heading, rate_rad_s, since_ms: date_ms, ..Self::new() };
    }

    /// Takes one that continues the ones before; differences its rate where that is asked for.
    #[inline(always)]
    pub fn accept(&mut self, heading: Heading, sent_rate_rad_s: f32, date_ms: u32, is_differenced: bool) {
        // Most flights do not turn.
        if sent_rate_rad_s == 0.0 && self.rate_rad_s == 0.0 && heading == self.heading {
            self.since_ms = date_ms;
            return;
        }
        self.turn(heading, sent_rate_rad_s, date_ms, is_differenced);
    }

    #[inline(never)]
    fn turn(&mut self, heading: Heading, sent_rate_rad_s: f32, date_ms: u32, is_differenced: bool) {
        let gap_ms = date_ms.wrapping_sub(self.since_ms);
        let before = self.rate_rad_s;
        let rate_rad_s = if sent_rate_rad_s == 0.0 { self.slope_rad_s(heading, gap_ms) } else { sent_rate_rad_s };
        (self.heading, self.rate_rad_s, self.since_ms) = (heading, rate_rad_s, date_ms);
        if !is_differenced || sent_rate_rad_s == 0.0 {
            (self.acceleration_rad_s2, self.jerk_rad_s3, self.difference_rad_s2) = (0.0, 0.0, None);
            return;
        }
        self.difference(before, gap_ms);
    }

    /// The rate at which headings move, smoothed; 0 where they jump.
    fn slope_rad_s(&self, heading: Heading, gap_ms: u32) -> f32 {
        if !(1..=EXTRAPOLATION_MAX_MS).contains(&gap_ms) {
            return 0.0;
        }
        let (old, new) = (self.heading, heading);
        let sin = old.cos_half() * new.sin_half() - old.sin_half() * new.cos_half();
        let cos = old.cos_half() * new.cos_half() + old.sin_half() * new.sin_half();
        // Of a small angle; both quaternions of a heading are the same one.
        let slope = 2.0 * if cos < 0.0 { -sin } else { sin } / (gap_ms as f32 * 1e-3);
        let most = if gap_ms > GAP_MAX_MS { SLOW_SLOPE_MAX_RAD_S } else { HEADING_RATE_MAX_RAD_S };
        if slope.abs() > most {
            return 0.0;
        }
        let rate = self.rate_rad_s + SLOPE_SHARE * (slope - self.rate_rad_s);
        if rate.abs() > REST_RAD_S { rate } else { 0.0 }
    }

    #[inline(never)]
    fn difference(&mut self, rate_before_rad_s: f32, gap_ms: u32) {
        let gap_s = gap_ms as f32 * 1e-3;
        let difference = (self.rate_rad_s - rate_before_rad_s) / gap_s;
        let jerk = self.difference_rad_s2.map_or(0.0, |before| (difference - before) / gap_s);
        let is_a_turn = (1..=GAP_MAX_MS).contains(&gap_ms)
            && difference.abs() <= ACCELERATION_MAX_RAD_S2
            && jerk.abs() <= JERK_MAX_RAD_S3;
        // The difference of two rates is the acceleration halfway between them.
        (self.acceleration_rad_s2, self.jerk_rad_s3, self.difference_rad_s2) =
            if is_a_turn { (difference + 0.5 * gap_s * jerk, jerk, Some(difference)) } else { (0.0, 0.0, None) };
    }

    /// The heading at a time, its derivatives into `sample`; after the last setpoint's time is over it stays where it has
    /// come to.
    #[inline(never)]
    pub fn at(&self, now_ms: u32, sample: &mut FifthOrderSample) -> Heading {
        let (rate, acceleration, jerk) = (self.rate_rad_s, self.acceleration_rad_s2, self.jerk_rad_s3);
        if rate == 0.0 && acceleration == 0.0 {
            sample.flat.heading_rate_rad_s = 0.0;
            (sample.heading_acceleration_rad_s2, sample.heading_jerk_rad_s3) = (0.0, 0.0);
            return self.heading;
        }
        let age_ms = now_ms.wrapping_sub(self.since_ms);
        if age_ms > EXTRAPOLATION_MAX_MS {
            return self.end(sample);
        }
        let t = age_ms as f32 * 1e-3;
        sample.flat.heading_rate_rad_s = rate + t * (acceleration + 0.5 * t * jerk);
        (sample.heading_acceleration_rad_s2, sample.heading_jerk_rad_s3) = (acceleration + t * jerk, jerk);
        self.heading.turned_slightly(t * (rate + 0.5 * t * acceleration))
    }

    /// Where a turn without successors has come to.
    #[cold]
    #[inline(never)]
    fn end(&self, sample: &mut FifthOrderSample) -> Heading {
        let t = EXTRAPOLATION_MAX_MS as f32 * 1e-3;
        sample.flat.heading_rate_rad_s = 0.0;
        (sample.heading_acceleration_rad_s2, sample.heading_jerk_rad_s3) = (0.0, 0.0);
        self.heading.turned_slightly(t * self.rate_rad_s)
    }
}
