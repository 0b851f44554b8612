//! Signals in, a flag out: a command that is asked to stop still removes its temporary files.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use signal_hook::consts::{SIGINT, SIGTERM};

use super::PilError;

/// Raised by the first signal that asks to stop; the second one stops at once.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    raised: Arc<AtomicBool>,
}

impl Interrupt {
    /// Listens to SIGINT and SIGTERM from here on.
    ///
    /// # Errors
    /// [`PilError::Io`].
    pub fn listen() -> Result<Self, PilError> {
        let interrupt = Self::default();
        for signal in [SIGINT, SIGTERM] {
            signal_hook::flag::register_conditional_shutdown(signal, 1, Arc::clone(&interrupt.raised))
                .and_then(|_| signal_hook::flag::register(signal, Arc::clone(&interrupt.raised)))
                .map_err(PilError::io("listening to signals"))?;
        }
        Ok(interrupt)
    }

    /// Whether to go on.
    ///
    /// # Errors
    /// [`PilError::Interrupted`] once asked to stop.
    pub fn check(&self) -> Result<(), PilError> {
        if self.raised.load(Relaxed) { Err(PilError::Interrupted) } else { Ok(()) }
    }
}
