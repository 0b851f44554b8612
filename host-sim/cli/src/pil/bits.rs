//! The comparison of board and host: commands in; their bits, and a hash of many out.

use std::fmt;

use quatrack::Command;

/// The bits of a command.
pub(super) fn words(command: &Command) -> [u32; 4] {
    let rates = &command.body_rates_rad_s;
    [command.thrust_m_s2, rates.x, rates.y, rates.z].map(f32::to_bits)
}

/// The hash FNV-1a of 64 bits.
pub(super) struct Fnv1a(u64);

impl Fnv1a {
    pub(super) const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub(super) fn add(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

impl fmt::Display for Fnv1a {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}
