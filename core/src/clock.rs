//! Time on board: an integer tick count and a rate, never seconds added up.

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

    pub(crate) const fn new(rate: Rate) -> Self {
        let second: u64 = 1_000_000_000 << Self::FRACTION_BITS;
        let hz = rate.hz as u64;
        Self { period: (second + hz / 2) / hz }
    }

    /// Time of a tick, to the nearest nanosecond. The product does not overflow below 4.8 hours.
    pub(crate) const fn time_ns(self, tick: Tick) -> u64 {
        const HALF: u64 = 1 << (TickClock::FRACTION_BITS - 1);
        (tick as u64).wrapping_mul(self.period).wrapping_add(HALF) >> Self::FRACTION_BITS
    }

    /// The first tick at or after a time of at most an hour.
    pub(crate) fn first_tick_at(self, time_ns: u64) -> Tick {
        let mut tick = ((time_ns << Self::FRACTION_BITS) / self.period) as Tick;
        while self.time_ns(tick) < time_ns {
            tick = tick.wrapping_add(1);
        }
        tick
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
        }
    }

    #[test]
    fn rates_out_of_range_are_refused() {
        assert!(Rate::from_hz(0).is_none() && Rate::from_hz(10_001).is_none());
        assert_eq!(Rate::from_hz(10_000).map(Rate::hz), Some(10_000));
    }
}
