//! Uploaded trajectories: a blob in, checked pieces out, the ones in use untouched until then.
//!
//! The blob is postcard's encoding of a slice of [`Piece`]: their number as a varint, then for each its duration in ns
//! as a varint and the 32 coefficients of x, y, z and heading, ascending powers, `f32` lowest byte first.

use core::fmt;

use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::upload::BlobKind;
use crate::gains::table::LoadError;
use crate::trajectory::{Piece, Summary, Trajectory, TrajectoryError};

/// Pieces that an uploaded trajectory may have; the paper's longest has 38.
pub const TRAJECTORY_PIECES: usize = 64;

/// Bytes that a blob of so many pieces may have: the number, and for each piece a `u64` varint and 32 `f32`.
pub const TRAJECTORY_BLOB_BYTES: usize = 2 + TRAJECTORY_PIECES * (10 + 32 * 4);

/// Why a blob is not put to use.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BlobError {
    /// This firmware has no use for blobs of this kind.
    Kind(BlobKind),
    /// More pieces than there is room for.
    TooManyPieces {
        /// Pieces in the blob.
        pieces: u32,
        /// Pieces that fit.
        capacity: u32,
    },
    /// The blob ends within a piece, or a number in it is none.
    Malformed {
        /// The piece, from 0.
        piece: u32,
    },
    /// Bytes are left after the last piece.
    BytesLeft {
        /// The number of bytes.
        bytes: u32,
    },
    /// The pieces are no trajectory.
    Trajectory(TrajectoryError),
    /// The gain table is not flown.
    GainTable(LoadError),
    /// The board takes only gain tables that are signed for it, and this one is not.
    Unsigned,
}

impl fmt::Display for BlobError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kind(kind) => write!(f, "blob: this firmware has no use for a {kind:?}"),
            Self::TooManyPieces { pieces, capacity } => {
                write!(f, "blob: {pieces} pieces, room for {capacity}; plan with fewer or longer ones")
            }
            Self::Malformed { piece } => write!(f, "blob: piece {piece} does not decode; encode it as documented"),
            Self::BytesLeft { bytes } => write!(f, "blob: {bytes} bytes after the last piece; encode it as documented"),
            Self::Trajectory(error) => error.fmt(f),
            Self::GainTable(error) => error.fmt(f),
            Self::Unsigned => {
                f.write_str("gain table: not signed with this board's key; sign it with `quatrack gains sign`")
            }
        }
    }
}

impl core::error::Error for BlobError {}

/// Writes the blob of `pieces` into `buffer` and returns its part that was written; nothing if it is too short.
///
/// [`TRAJECTORY_BLOB_BYTES`] are enough for [`TRAJECTORY_PIECES`].
pub fn encode_trajectory<'b>(pieces: &[Piece], buffer: &'b mut [u8]) -> Option<&'b [u8]> {
    postcard::to_slice(pieces, buffer).ok().map(|blob| &*blob)
}

/// Room for one uploaded trajectory of at most `P` pieces.
#[derive(Clone, Debug)]
pub struct TrajectorySlot<const P: usize> {
    pieces: Vec<Piece, P>,
    /// Whether they have been checked as a whole, and the result. Not an option of one: an empty slot is all zero
    /// bytes, and a static one then takes no flash.
    checked: bool,
    summary: Summary,
}

impl<const P: usize> TrajectorySlot<P> {
    /// Empty.
    pub const fn new() -> Self {
        Self { pieces: Vec::new(), checked: false, summary: Summary::EMPTY }
    }

    /// Decodes and checks a blob.
    ///
    /// # Errors
    /// [`BlobError`]; the slot is empty then.
    pub fn load(&mut self, blob: &[u8]) -> Result<(), BlobError> {
        self.checked = false;
        self.decode(blob)?;
        self.summary = Trajectory::new(&self.pieces).map_err(BlobError::Trajectory)?.summary();
        self.checked = true;
        Ok(())
    }

    /// The trajectory, if one has been loaded.
    pub fn trajectory(&self) -> Option<Trajectory<'_>> {
        if self.checked { Trajectory::of_checked(&self.pieces, self.summary) } else { None }
    }

    /// One piece after the other, so that no more than one is ever on the stack.
    fn decode(&mut self, blob: &[u8]) -> Result<(), BlobError> {
        self.pieces.clear();
        let (pieces, mut rest) =
            postcard::take_from_bytes::<u32>(blob).map_err(|_| BlobError::Malformed { piece: 0 })?;
        let capacity = u32::try_from(P).unwrap_or(u32::MAX);
        let too_many = BlobError::TooManyPieces { pieces, capacity };
        if pieces > capacity {
            return Err(too_many);
        }
        for piece in 0..pieces {
            let (decoded, left) =
                postcard::take_from_bytes::<Piece>(rest).map_err(|_| BlobError::Malformed { piece })?;
            self.pieces.push(decoded).map_err(|_| too_many)?;
            rest = left;
        }
        match u32::try_from(rest.len()).unwrap_or(u32::MAX) {
            0 => Ok(()),
            bytes => Err(BlobError::BytesLeft { bytes }),
        }
    }
}

impl<const P: usize> Default for TrajectorySlot<P> {
    fn default() -> Self {
        Self::new()
    }
}

/// Two slots: the one in use, and the one that the next upload is decoded into.
#[derive(Clone, Debug)]
pub struct TrajectoryStore<const P: usize> {
    slots: [TrajectorySlot<P>; 2],
    second_in_use: bool,
}

impl<const P: usize> TrajectoryStore<P> {
    /// Both empty.
    pub const fn new() -> Self {
        Self { slots: [const { TrajectorySlot::new() }; 2], second_in_use: false }
    }

    /// Decodes and checks a blob, and only then puts it to use.
    ///
    /// # Errors
    /// [`BlobError`]; the trajectory in use stays in use.
    pub fn commit(&mut self, blob: &[u8]) -> Result<(), BlobError> {
        let (_, spare) = self.split();
        spare.load(blob)?;
        self.swap();
        Ok(())
    }

    /// The trajectory in use.
    pub fn active(&self) -> &TrajectorySlot<P> {
        let [first, second] = &self.slots;
        if self.second_in_use { second } else { first }
    }

    /// The slot in use and the spare one: one is played while the other is loaded.
    pub fn split(&mut self) -> (&TrajectorySlot<P>, &mut TrajectorySlot<P>) {
        let [first, second] = &mut self.slots;
        if self.second_in_use { (second, first) } else { (first, second) }
    }

    /// Puts the spare slot to use.
    pub fn swap(&mut self) {
        self.second_in_use = !self.second_in_use;
    }
}

impl<const P: usize> Default for TrajectoryStore<P> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At rest at a height for a second, as often as asked.
    fn hover(pieces: usize, height_m: f32) -> std::vec::Vec<Piece> {
        let mut z = [0.0; 8];
        z[0] = height_m;
        std::vec![Piece { duration_ns: 1_000_000_000, x: [0.0; 8], y: [0.0; 8], z, heading: [0.0; 8] }; pieces]
    }

    fn blob(pieces: &[Piece]) -> std::vec::Vec<u8> {
        let mut buffer = std::vec![0; TRAJECTORY_BLOB_BYTES];
        encode_trajectory(pieces, &mut buffer).unwrap().to_vec()
    }

    #[test]
    fn as_many_pieces_as_stated_go_through_with_all_their_bits() {
        let mut pieces = hover(TRAJECTORY_PIECES, 1.0);
        for (i, piece) in pieces.iter_mut().enumerate() {
            piece.duration_ns += i as u64;
            piece.x[7] = f32::from_bits(i as u32 + 1);
        }
        let mut slot = TrajectorySlot::<TRAJECTORY_PIECES>::new();
        slot.load(&blob(&pieces)).unwrap();
        assert_eq!(slot.pieces[..], pieces[..]);
        assert_eq!(slot.trajectory(), Some(Trajectory::new(&pieces).unwrap()));
        // The longest duration that a varint holds, in every piece.
        pieces.iter_mut().for_each(|piece| piece.duration_ns = u64::MAX);
        assert_eq!(blob(&pieces).len(), TRAJECTORY_BLOB_BYTES - 1, "64 takes one byte of the two for the number");
    }

    #[test]
    fn every_fault_of_a_blob_is_named_and_leaves_the_slot_empty() {
        let whole = blob(&hover(3, 1.0));
        let mut jump = hover(2, 1.0);
        jump.extend(hover(1, 2.0));
        let (mut longer, mut endless) = (whole.clone(), whole.clone());
        longer.extend([0; 5]);
        endless[1..11].fill(0xFF);
        let cases: [(&[u8], BlobError); 8] = [
            (&[], BlobError::Malformed { piece: 0 }),
            (&whole[..whole.len() - 1], BlobError::Malformed { piece: 2 }),
            (&whole[..1], BlobError::Malformed { piece: 0 }),
            (&endless, BlobError::Malformed { piece: 0 }),
            (&longer, BlobError::BytesLeft { bytes: 5 }),
            (&blob(&hover(5, 1.0)), BlobError::TooManyPieces { pieces: 5, capacity: 4 }),
            (&blob(&[]), BlobError::Trajectory(TrajectoryError::Empty)),
            (&blob(&jump), BlobError::Trajectory(TrajectoryError::Jump { piece: 2, size: 1.0 })),
        ];
        for (bytes, error) in cases {
            let mut slot = TrajectorySlot::<4>::new();
            slot.load(&whole).unwrap();
            assert_eq!(slot.load(bytes), Err(error));
            assert_eq!(slot.trajectory(), None, "after {error}");
        }
    }

    #[test]
    fn a_refused_blob_leaves_the_one_in_use() {
        let mut store = TrajectoryStore::<4>::new();
        assert_eq!(store.active().trajectory(), None);
        for pieces in 1..=4 {
            store.commit(&blob(&hover(pieces, 1.0))).unwrap();
            assert!(store.commit(&[9]).is_err());
            let in_use = store.active().trajectory().map(|trajectory| trajectory.duration_ns());
            assert_eq!(in_use, Some(pieces as u64 * 1_000_000_000));
        }
    }

    #[test]
    fn one_slot_plays_while_the_other_one_is_loaded() {
        let mut store = TrajectoryStore::<4>::new();
        store.commit(&blob(&hover(1, 1.0))).unwrap();
        let (active, spare) = store.split();
        let playing = active.trajectory().unwrap();
        spare.load(&blob(&hover(2, 1.0))).unwrap();
        assert_eq!(playing.duration_ns(), 1_000_000_000);
        store.swap();
        assert_eq!(store.active().trajectory().map(|t| t.duration_ns()), Some(2_000_000_000));
    }
}
