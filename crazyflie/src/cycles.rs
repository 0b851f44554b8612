//! The processor's cycle counter, to log the length of a step: it runs once the app has started it, and reads 0 on a
//! desk.

/// The count now.
#[inline]
pub(crate) fn now() -> u32 {
    #[cfg(target_os = "none")]
    {
        cortex_m::peripheral::DWT::cycle_count()
    }
    #[cfg(not(target_os = "none"))]
    {
        0
    }
}

/// Cycles since a count, at most the largest `u16`.
#[inline]
pub(crate) fn since(begun: u32) -> u16 {
    u16::try_from(now().wrapping_sub(begun)).unwrap_or(u16::MAX)
}
