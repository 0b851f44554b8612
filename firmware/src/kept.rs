//! The uploads that survive a loss of power: a trajectory and a gain table, each in two slots of its own.

use embedded_storage::nor_flash::NorFlash;
use quatrack::link::BlobKind;

use crate::storage::{Layout, Storage};

/// Keeps one blob of each kind.
pub trait Keep {
    /// Keeps a blob in the place of the one before; whether it did. Where it did not, the one before is as it was.
    fn keep(&mut self, kind: BlobKind, blob: &[u8]) -> bool;

    /// Reads the stored blob into the start of a buffer; its length, if there is any.
    fn kept(&mut self, kind: BlobKind, buffer: &mut [u8]) -> Option<usize>;
}

/// A board that keeps nothing.
#[derive(Clone, Copy, Debug)]
pub struct NoFlash;

impl Keep for NoFlash {
    fn keep(&mut self, _kind: BlobKind, _blob: &[u8]) -> bool {
        false
    }

    fn kept(&mut self, _kind: BlobKind, _buffer: &mut [u8]) -> Option<usize> {
        None
    }
}

/// In a flash, from its start: two slots for trajectories, two for gain tables.
#[derive(Clone, Debug)]
pub struct InFlash<F> {
    flash: F,
    slot_bytes: u32,
}

impl<F: NorFlash> InFlash<F> {
    /// In slots of so many bytes, a multiple of the flash's erase size.
    pub const fn new(flash: F, slot_bytes: u32) -> Self {
        Self { flash, slot_bytes }
    }

    fn storage(&mut self, kind: BlobKind) -> Option<Storage<&mut F>> {
        let first = match kind {
            BlobKind::Trajectory => 0,
            BlobKind::GainTable => 2,
        };
        let at = |slot: u32| slot.checked_mul(self.slot_bytes);
        let layout = Layout { slots: [at(first)?, at(first + 1)?], slot_bytes: self.slot_bytes };
        Storage::new(&mut self.flash, layout)
    }
}

impl<F: NorFlash> Keep for InFlash<F> {
    fn keep(&mut self, kind: BlobKind, blob: &[u8]) -> bool {
        self.storage(kind).is_some_and(|mut storage| storage.store(blob).is_ok())
    }

    fn kept(&mut self, kind: BlobKind, buffer: &mut [u8]) -> Option<usize> {
        self.storage(kind)?.load(buffer).ok().flatten().map(<[u8]>::len)
    }
}
