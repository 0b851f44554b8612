//! Which gain tables are taken: a blob in; its table out, if it is signed, or if that is not asked for.

use quatrack::link::{Key, signed_with, unsigned};

/// The key that tables are to be signed with, if any.
#[derive(Clone, Debug)]
pub struct Signatures {
    key: Option<Key>,
}

impl Signatures {
    /// Any table is taken, signed or not.
    pub const NONE: Self = Self { key: None };

    /// Those that are signed with this key alone are taken.
    pub const fn with(key: Key) -> Self {
        Self { key: Some(key) }
    }

    /// Whether they are asked for.
    pub const fn are_asked_for(&self) -> bool {
        self.key.is_some()
    }

    /// The table of a blob that is taken.
    pub fn checked<'b>(&self, blob: &'b [u8]) -> Option<&'b [u8]> {
        self.key.as_ref().map_or(Some(unsigned(blob)), |key| signed_with(key, blob))
    }
}
