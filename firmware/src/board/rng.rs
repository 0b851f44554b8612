//! The random number generator of the microcontroller: words of noise in, a nonce out.
//!
//! It runs on the 48 MHz of the PLL. Without a crystal it does not, and there is no nonce: a board with a key is then silent.

use quatrack::link::Nonce;
use stm32f4::stm32f405::{RCC, RNG};

/// Looks at the ready flag before it is given up: a word takes 40 of its cycles.
const LOOKS: u32 = 2000;

/// The started generator.
#[derive(Debug)]
pub struct Rng(RNG);

impl Rng {
    pub(super) fn start(rng: RNG, rcc: &RCC) -> Self {
        rcc.ahb2enr().modify(|_, w| w.rngen().enabled());
        rng.cr().modify(|_, w| w.rngen().enabled());
        Self(rng)
    }

    /// Four words that are ready, without a fault of clock or seed, and each another one than the last, as the reference manual
    /// RM0090 asks in section 24.3.1.
    pub fn nonce(&self) -> Option<Nonce> {
        let mut words = [[0; 4]; 4];
        let mut last = self.word()?;
        for word in &mut words {
            let next = self.word().filter(|next| *next != last)?;
            *word = next.to_le_bytes();
            last = next;
        }
        words.as_flattened().first_chunk().map(|bytes| Nonce(*bytes))
    }

    fn word(&self) -> Option<u32> {
        for _ in 0..LOOKS {
            let status = self.0.sr().read();
            if status.secs().bit_is_set() || status.cecs().bit_is_set() {
                return None;
            }
            if status.drdy().bit_is_set() {
                return Some(self.0.dr().read().bits());
            }
        }
        None
    }
}
