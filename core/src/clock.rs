//! Time on board: an integer tick count and a rate. Seconds are never added up, so that hours of flight lose no accuracy.

/// Ticks of the control loop since some start; wraps after 2^32.
pub type Tick = u32;

/// Ticks a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rate {
    hz: u32,
}

impl Rate {
    /// Slowest rate, Hz.
    pub const MIN_HZ: u32 = 1;
    /// Fastest rate, Hz.
    pub const MAX_HZ: u32 = 10_000;

    /// From ticks a second; nothing outside [`Self::MIN_HZ`]..=[`Self::MAX_HZ`].
    pub const fn from_hz(hz: u32) -> Option<Self> {
        if hz >= Self::MIN_HZ && hz <= Self::MAX_HZ { Some(Self { hz }) } else { None }
    }

    /// Ticks a second.
    pub const fn hz(self) -> u32 {
        self.hz
    }
}

/// Nanoseconds from a number of ticks by one multiplication, for any rate, exact to a nanosecond over an hour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TickClock {
    /// Period of a tick in units of 2^-20 ns.
    period: u64,
}

impl TickClock {
    const FRACTION_BITS: u32 = 20;
    /// Half a nanosecond: times are rounded to the nearest.
    const HALF: u64 = 1 << (Self::FRACTION_BITS - 1);

    pub(crate) const fn new(rate: Rate) -> Self {
        const SECOND_NS: u32 = 1_000_000_000;
        let hz = rate.hz;
        // Long division, ten bits at a time, so that no step leaves 32 bits: those the processor divides by itself.
        let (whole, rest) = (SECOND_NS / hz, SECOND_NS % hz);
        let (upper, rest) = ((rest << 10) / hz, (rest << 10) % hz);
        let lower = ((rest << 10) + hz / 2) / hz;
        Self { period: ((whole as u64) << Self::FRACTION_BITS) + ((upper as u64) << 10) + lower as u64 }
    }

    /// Time of a tick, to the nearest nanosecond. The product does not overflow below 4.8 hours.
    pub(crate) const fn time_ns(self, tick: Tick) -> u64 {
        (tick as u64).wrapping_mul(self.period).wrapping_add(Self::HALF) >> Self::FRACTION_BITS
    }

    /// The first tick at or after a time of at most an hour.
    pub(crate) fn first_tick_at(self, time_ns: u64) -> Tick {
        // By halving, among the 2^26 ticks of more than an hour at the highest rate; at lower ones the product saturates.
        let is_before = |tick: Tick| {
            u64::from(tick).saturating_mul(self.period).saturating_add(Self::HALF) >> Self::FRACTION_BITS < time_ns
        };
        let mut first = 0;
        for bit in (0..26).rev() {
            let tick = first | 1 << bit;
            if is_before(tick - 1) {
                first = tick;
            }
        }
        first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tick_times_are_exact_to_a_nanosecond_over_an_hour() {
        for hz in [1, 3, 100, 333, 500, 997, 1000, 1024, 10_000] {
            let clock = TickClock::new(Rate::from_hz(hz).unwrap());
            for tick in [0, 1, 2, hz - 1, hz, 60 * hz + 1, 3600 * hz] {
                let exact = u128::from(tick) * 1_000_000_000 / u128::from(hz);
                let error = i128::from(clock.time_ns(tick)) - exact as i128;
                // Half a unit of 2^-20 ns a tick: 17 ns after the 3.6e7 ticks of an hour at 10 kHz.
                assert!(error.abs() <= 1 + i128::from(tick >> 21), "tick {tick} at {hz} Hz: {error} ns");
            }
            assert_eq!(clock.first_tick_at(1_000_000_000), hz);
            assert_eq!(clock.first_tick_at(0), 0);
            assert_eq!(clock.first_tick_at(1), 1);
            assert_eq!(clock.first_tick_at(3_600_000_000_000), 3600 * hz);
        }
    }

    #[test]
    fn rates_out_of_range_are_refused() {
        assert!(Rate::from_hz(0).is_none() && Rate::from_hz(10_001).is_none());
        assert_eq!(Rate::from_hz(10_000).map(Rate::hz), Some(10_000));
    }
}
