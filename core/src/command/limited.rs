//! Which parts of a command were cut, in; the same in one byte that is never zero, out.

use core::num::NonZeroU8;

/// Which parts of a command were cut to the limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(from = "u8", into = "u8"))]
pub struct Limited {
    /// `2 * bits + 1`. It is never zero, so that a `Result` of it stores its discriminant in the zero.
    marked: NonZeroU8,
}

impl Limited {
    /// Nothing was cut.
    pub const NOTHING: Self = Self { marked: NonZeroU8::MIN };

    /// Whether anything was cut.
    pub const fn any(self) -> bool {
        self.bits() != 0
    }

    /// Whether the thrust was cut.
    pub const fn thrust(self) -> bool {
        self.bits() & 1 != 0
    }

    /// Whether the body rates `p q r` were cut, each.
    pub const fn body_rates(self) -> [bool; 3] {
        let bits = self.bits();
        [bits & 2 != 0, bits & 4 != 0, bits & 8 != 0]
    }

    /// Bit i for the i-th of `T p q r`; for a log or a link.
    pub const fn bits(self) -> u8 {
        self.marked.get() >> 1
    }

    /// From [`Self::bits`]; higher bits are dropped.
    pub const fn from_bits(bits: u8) -> Self {
        match NonZeroU8::new((bits & 0b1111) << 1 | 1) {
            Some(marked) => Self { marked },
            None => Self::NOTHING,
        }
    }

    #[inline(always)]
    pub(super) fn note(&mut self, bit: u8) {
        self.marked |= bit << 1;
    }
}

impl Default for Limited {
    fn default() -> Self {
        Self::NOTHING
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Limited {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "Limited({=u8:#06b})", self.bits());
    }
}

impl From<u8> for Limited {
    fn from(bits: u8) -> Self {
        Self::from_bits(bits)
    }
}

impl From<Limited> for u8 {
    fn from(limited: Limited) -> Self {
        limited.bits()
    }
}
