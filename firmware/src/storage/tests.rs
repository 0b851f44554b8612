//! Blobs on a modelled flash whose power goes at any byte.

use embedded_storage::nor_flash::{ErrorType, NorFlashError, NorFlashErrorKind, ReadNorFlash};

use super::*;

const ERASE: usize = 256;
const WRITE: usize = 4;
const LAYOUT: Layout = Layout { slots: [0, 512], slot_bytes: 512 };

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Failure {
    PowerLost,
    NotErased,
    OutOfPlace,
}

impl NorFlashError for Failure {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

/// A NOR flash as on the board: a write clears bits, an erase sets all of a block, both byte by byte; after so many bytes the power
/// goes, in the middle of one.
#[derive(Clone)]
struct Model {
    bytes: Vec<u8>,
    left: usize,
}

impl Model {
    fn new() -> Self {
        Self { bytes: vec![0xFF; 1024], left: usize::MAX }
    }

    /// One byte more; one that is cut has some of its bits.
    fn put(&mut self, at: usize, byte: u8) -> Result<(), Failure> {
        if self.left == 0 {
            self.bytes[at] = (self.bytes[at] & 0b1010_0101) | (byte & 0b0101_1010);
            return Err(Failure::PowerLost);
        }
        self.left -= 1;
        self.bytes[at] = byte;
        Ok(())
    }
}

impl ErrorType for Model {
    type Error = Failure;
}

impl ReadNorFlash for Model {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failure> {
        let from = offset as usize;
        let found = self.bytes.get(from..from + bytes.len()).ok_or(Failure::OutOfPlace)?;
        bytes.copy_from_slice(found);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Model {
    const WRITE_SIZE: usize = WRITE;
    const ERASE_SIZE: usize = ERASE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failure> {
        let (from, to) = (from as usize, to as usize);
        if !(from.is_multiple_of(ERASE) && to.is_multiple_of(ERASE)) {
            return Err(Failure::OutOfPlace);
        }
        (from..to).try_for_each(|at| self.put(at, 0xFF))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failure> {
        let at = offset as usize;
        if !(at.is_multiple_of(WRITE) && bytes.len().is_multiple_of(WRITE)) {
            return Err(Failure::OutOfPlace);
        }
        for (i, byte) in bytes.iter().enumerate() {
            if self.bytes[at + i] & byte != *byte {
                return Err(Failure::NotErased);
            }
            self.put(at + i, *byte)?;
        }
        Ok(())
    }
}

fn blob(seed: u8, bytes: usize) -> Vec<u8> {
    (0..bytes).map(|i| (i as u8).wrapping_mul(31).wrapping_add(seed)).collect()
}

fn loaded(flash: &Model) -> Option<Vec<u8>> {
    let mut buffer = [0; 512];
    let mut storage = Storage::new(Model { left: usize::MAX, ..flash.clone() }, LAYOUT).unwrap();
    storage.load(&mut buffer).unwrap().map(<[u8]>::to_vec)
}

#[test]
fn power_lost_at_any_byte_leaves_the_blob_before_or_the_new_one() {
    // Longer and shorter ones in turn, into either slot.
    let lengths = [200, 1, 496, 130, 64, 0, 333];
    let mut flash = Model::new();
    let mut before = None;
    for (round, bytes) in lengths.into_iter().enumerate() {
        let new = blob(round as u8, bytes);
        let mut cut_at = 0;
        loop {
            let mut storage = Storage::new(Model { left: cut_at, ..flash.clone() }, LAYOUT).unwrap();
            let stored = storage.store(&new);
            let found = loaded(&storage.free());
            if stored.is_ok() {
                assert_eq!(found.as_ref(), Some(&new));
                break;
            }
            assert_eq!(stored, Err(StorageError::Flash(Failure::PowerLost)));
            assert!(found == before || found.as_ref() == Some(&new), "round {round}, cut at {cut_at}");
            cut_at += 1;
        }
        // 512 erased, the blob, the header.
        assert!(cut_at >= 512 + bytes, "{cut_at}");
        let mut storage = Storage::new(Model { left: usize::MAX, ..flash }, LAYOUT).unwrap();
        storage.store(&new).unwrap();
        flash = storage.free();
        before = Some(new);
    }
}

#[test]
fn a_slot_that_was_cut_is_written_over() {
    let mut storage = Storage::new(Model::new(), LAYOUT).unwrap();
    storage.store(&blob(1, 100)).unwrap();
    let mut storage = Storage::new(Model { left: 700, ..storage.free() }, LAYOUT).unwrap();
    assert!(storage.store(&blob(2, 400)).is_err());
    let mut storage = Storage::new(Model { left: usize::MAX, ..storage.free() }, LAYOUT).unwrap();
    storage.store(&blob(3, 300)).unwrap();
    assert_eq!(loaded(&storage.free()), Some(blob(3, 300)));
}

#[test]
fn any_bit_that_turns_makes_the_one_before_count() {
    let mut storage = Storage::new(Model::new(), LAYOUT).unwrap();
    storage.store(&blob(1, 60)).unwrap();
    storage.store(&blob(2, 60)).unwrap();
    let flash = storage.free();
    for bit in 0..8 * (16 + 60) {
        let mut turned = flash.clone();
        turned.bytes[512 + bit / 8] ^= 1 << (bit % 8);
        assert_eq!(loaded(&turned), Some(blob(1, 60)), "bit {bit}");
    }
}

#[test]
fn an_empty_flash_holds_nothing_and_a_blob_too_long_is_refused() {
    assert_eq!(loaded(&Model::new()), None);
    let mut storage = Storage::new(Model::new(), LAYOUT).unwrap();
    let refused = storage.store(&[0; 497]);
    assert_eq!(refused, Err(StorageError::TooLong { bytes: 497, capacity: 496 }));
    storage.store(&blob(1, 100)).unwrap();
    assert_eq!(storage.load(&mut [0; 99]), Err(StorageError::TooLong { bytes: 100, capacity: 99 }));
}

#[test]
fn a_layout_that_is_none_of_the_flash_is_refused() {
    for (slots, slot_bytes) in [([0, 256], 512), ([0, 512], 768), ([0, 500], 256), ([0, 512], 0), ([0, u32::MAX], 256)]
    {
        assert!(Storage::new(Model::new(), Layout { slots, slot_bytes }).is_none(), "{slots:?} {slot_bytes}");
    }
}
