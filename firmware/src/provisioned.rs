//! The keys that this image was given after it was built: its slot in the flash in, keys out.

#[cfg(target_os = "none")]
use quatrack::link::KEY_SLOT_BYTES;
use quatrack::link::{GivenKeys, Key, Protection};

use crate::signature::Signatures;

/// The keys that a session is given.
#[derive(Clone, Debug)]
pub struct Keys {
    /// The link's key and the messages that it protects; nothing on a cable.
    pub link: Option<(Key, Protection)>,
    /// Which gain tables are taken.
    pub signatures: Signatures,
}

impl Keys {
    /// None: the line is a cable, and any table is taken.
    pub const NONE: Self = Self { link: None, signatures: Signatures::NONE };

    /// Those of a slot.
    pub fn of(given: &GivenKeys) -> Self {
        Self {
            link: given.link.map(|(bytes, protection)| (Key::new(&bytes), protection)),
            signatures: given.signing.map_or(Signatures::NONE, |bytes| Signatures::with(Key::new(&bytes))),
        }
    }

    /// This image's own.
    #[cfg(target_os = "none")]
    pub fn provisioned() -> Self {
        Self::of(&GivenKeys::read(&slot()))
    }
}

#[cfg(target_os = "none")]
static SLOT: [u8; KEY_SLOT_BYTES] = GivenKeys::NONE.write();

/// As it is in the flash, which may have been written since the compiler saw it.
#[cfg(target_os = "none")]
#[allow(unsafe_code, reason = "reads a static whose bytes change after the build")]
fn slot() -> [u8; KEY_SLOT_BYTES] {
    // SAFETY: the static is whole, aligned and never written while the image runs.
    unsafe { core::ptr::read_volatile(&raw const SLOT) }
}
