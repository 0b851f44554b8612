//! Uploads that are kept over a loss of power, through the session: at any byte of the flash the power may go.

use std::cell::RefCell;
use std::rc::Rc;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use quatrack::Piece;
use quatrack::gains::table::TABLE_BYTES_MAX;
use quatrack::link::{
    BlobError, BlobKind, FromBoard, Refusal, TRAJECTORY_BLOB_BYTES, ToBoard, TrajectoryCommand, TrajectoryId,
    encode_trajectory,
};
use quatrack_firmware::kept::{InFlash, NoFlash};

use super::signed_tables::{Board, TABLE, random_key, signed};

const SLOT_BYTES: usize = 12 * 1024;
const ERASE_BYTES: usize = 1024;

/// A NOR flash that stays when the board restarts. After so many bytes the power goes.
#[derive(Clone)]
struct Flash(Rc<RefCell<Cells>>);

struct Cells {
    bytes: Vec<u8>,
    left: usize,
}

#[derive(Debug)]
struct PowerLost;

impl NorFlashError for PowerLost {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Flash {
    type Error = PowerLost;
}

impl Flash {
    fn new() -> Self {
        Self(Rc::new(RefCell::new(Cells { bytes: vec![0xFF; 4 * SLOT_BYTES], left: usize::MAX })))
    }

    fn power(&self, left: usize) {
        self.0.borrow_mut().left = left;
    }

    fn put(&mut self, at: usize, change: impl FnOnce(u8) -> u8) -> Result<(), PowerLost> {
        let mut cells = self.0.borrow_mut();
        cells.left = cells.left.checked_sub(1).ok_or(PowerLost)?;
        cells.bytes[at] = change(cells.bytes[at]);
        Ok(())
    }
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerLost> {
        let at = offset as usize;
        bytes.copy_from_slice(&self.0.borrow().bytes[at..at + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        4 * SLOT_BYTES
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = ERASE_BYTES;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerLost> {
        (from as usize..to as usize).try_for_each(|at| self.put(at, |_| 0xFF))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerLost> {
        (offset as usize..).zip(bytes).try_for_each(|(at, byte)| self.put(at, |there| there & byte))
    }
}

fn board(flash: &Flash, signing: Option<[u8; 32]>) -> Board<InFlash<Flash>> {
    Board::started(signing, InFlash::new(flash.clone(), SLOT_BYTES as u32))
}

fn keep(id: u32) -> ToBoard {
    ToBoard::UploadKeep { id }
}

fn commit(id: u32) -> ToBoard {
    ToBoard::UploadCommit { id }
}

#[test]
fn a_table_and_a_trajectory_are_there_after_a_restart() {
    let flash = Flash::new();
    assert!(SLOT_BYTES > TABLE_BYTES_MAX.max(TRAJECTORY_BLOB_BYTES) + 100);
    let mut buffer = [0; TRAJECTORY_BLOB_BYTES];
    let pieces = [Piece { duration_ns: 1_000_000_000, x: [0.0; 8], y: [0.0; 8], z: [0.0; 8], heading: [0.0; 8] }];
    let trajectory = encode_trajectory(&pieces, &mut buffer).unwrap();
    let start = ToBoard::Trajectory(TrajectoryCommand::Start(TrajectoryId::Uploaded));
    let mut first = board(&flash, None);
    assert!(matches!(first.ask(&start), FromBoard::Nack { .. }) && !first.has_table(), "an empty flash");
    assert_eq!(first.upload(BlobKind::GainTable, TABLE, keep), Ok(()));
    assert_eq!(first.upload(BlobKind::Trajectory, trajectory, keep), Ok(()));
    let mut second = board(&flash, None);
    assert!(second.has_table());
    assert!(matches!(second.ask(&start), FromBoard::Ack { .. }));
}

#[test]
fn an_upload_committed_alone_is_gone_after_a_restart() {
    let flash = Flash::new();
    assert_eq!(board(&flash, None).upload(BlobKind::GainTable, TABLE, commit), Ok(()));
    assert!(!board(&flash, None).has_table());
}

#[test]
fn a_board_without_a_flash_says_so() {
    let mut without = Board::started(None, NoFlash);
    assert_eq!(without.upload(BlobKind::GainTable, TABLE, keep), Err(Refusal::NotKept));
    assert!(without.has_table(), "it is in use all the same");
}

#[test]
fn power_lost_at_any_byte_leaves_the_table_before() {
    let flash = Flash::new();
    assert_eq!(board(&flash, None).upload(BlobKind::GainTable, TABLE, keep), Ok(()));
    let before = flash.0.borrow().bytes.clone();
    // The whole slot is erased, the blob written in whole words, and the header.
    let bytes = SLOT_BYTES + TABLE.len().next_multiple_of(4) + 16;
    for left in (0..bytes).step_by(61).chain(bytes - 16..bytes) {
        flash.0.borrow_mut().bytes.clone_from(&before);
        flash.power(left);
        let mut cut = board(&flash, None);
        assert_eq!(cut.upload(BlobKind::GainTable, TABLE, keep), Err(Refusal::NotKept), "{left}");
        flash.power(usize::MAX);
        assert!(board(&flash, None).has_table(), "{left}");
    }
    flash.0.borrow_mut().bytes.clone_from(&before);
    flash.power(bytes);
    assert_eq!(board(&flash, None).upload(BlobKind::GainTable, TABLE, keep), Ok(()));
}

#[test]
fn kept_uploads_are_checked_again() {
    let (flash, key) = (Flash::new(), random_key());
    assert_eq!(board(&flash, None).upload(BlobKind::GainTable, TABLE, keep), Ok(()));
    // The same flash behind an image that takes signed tables alone.
    let mut signing = board(&flash, Some(key));
    assert!(!signing.has_table());
    assert_eq!(signing.upload(BlobKind::GainTable, TABLE, keep), Err(Refusal::Blob(BlobError::Unsigned)));
    assert_eq!(signing.upload(BlobKind::GainTable, &signed(TABLE, &key), keep), Ok(()));
    assert!(board(&flash, Some(key)).has_table());
    assert!(!board(&flash, Some(random_key())).has_table());
}
