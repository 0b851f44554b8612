//! From the commander's clock, with which setpoints are stamped, to the stabilizer's steps: both count milliseconds, from
//! different beginnings and with different quartzes.
//!
//! A setpoint is seen some steps after its stamp. The least of these delays is the difference between the clocks; a
//! setpoint that is seen later than that was on its way for longer.

/// Longest that a setpoint is on its way, beyond the shortest, ms; a later one means that the clock was set anew.
const LATE_MAX_MS: u32 = 20;

/// Setpoints in a row that are late after which the clocks are taken to have drifted: half a second.
const DRIFTED: u8 = 50;

/// The difference between the clocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    /// Step less stamp, as both wrap.
    difference_ms: u32,
    late: u8,
}

impl Clock {
    pub(super) const fn new() -> Self {
        Self { difference_ms: 0, late: 0 }
    }

    /// The step at which a setpoint was taken that bears a stamp and was first seen at a step.
    #[inline(always)]
    pub(super) fn date_ms(&mut self, stamp_ms: u32, seen_ms: u32) -> u32 {
        if stamp_ms == 0 {
            return seen_ms;
        }
        let difference_ms = seen_ms.wrapping_sub(stamp_ms);
        let later_ms = difference_ms.wrapping_sub(self.difference_ms);
        self.late = if later_ms == 0 { 0 } else { self.late.saturating_add(1) };
        // Earlier than the least so far is a large number here.
        if later_ms > LATE_MAX_MS || self.late >= DRIFTED {
            *self = Self { difference_ms, late: 0 };
        }
        stamp_ms.wrapping_add(self.difference_ms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setpoint_seen_late_is_dated_by_its_stamp() {
        let mut clock = Clock::new();
        // The clocks are 5000 ms apart, also where they wrap.
        for start in [0_u32, u32::MAX - 60] {
            for k in 0..20 {
                let stamp = start.wrapping_add(10 * k + 1);
                let late = u32::from(k % 7 == 3);
                assert_eq!(clock.date_ms(stamp, stamp.wrapping_add(5000 + late)), stamp.wrapping_add(5000), "{k}");
            }
        }
        assert_eq!(clock.date_ms(0, 77), 77, "without a stamp it was sent when it was seen");
    }

    #[test]
    fn clocks_that_drift_are_followed() {
        let mut clock = Clock::new();
        assert_eq!(clock.date_ms(10, 110), 110);
        // The stabilizer's is faster by a step from here on, and slower by two in the end.
        let dates: Vec<u32> = (1..100).map(|k| clock.date_ms(10 + 10 * k, 111 + 10 * k) - 10 * k).collect();
        assert!(dates[0] == 110 && dates[98] == 111, "{dates:?}");
        assert_eq!(clock.date_ms(2010, 2109), 2109);
    }
}
