//! Uploads as messages: a blob at the sender in; its announcement, its chunks, and the receiver's answers out.
//!
//! The sender announces a blob by kind, id, length and checksum, then sends chunks in order, each at the offset that the
//! last answer wanted ([`Progress::next_chunk`]). A chunk at another offset is refused with the wanted one; a sender that
//! lost touch asks, or announces the same blob again, and goes on from there.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::size::CHUNK_BYTES;
use crate::checksum::crc32c;

/// The kind of a blob.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BlobKind {
    /// A trajectory, see [`super::TrajectorySlot`].
    Trajectory,
    /// A gain table, see [`crate::gains::table`] and [`super::GainStore`].
    GainTable,
}

/// Announces a blob.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct UploadBegin {
    /// Its kind.
    pub kind: BlobKind,
    /// The sender's name for it; every chunk carries it.
    pub id: u32,
    /// Bytes in all.
    pub length: u32,
    /// [`super::crc32c`] of all of them.
    pub checksum: u32,
}

impl UploadBegin {
    /// Announces `blob`; nothing if it is longer than a `u32` counts.
    pub fn of(kind: BlobKind, id: u32, blob: &[u8]) -> Option<Self> {
        Some(Self { kind, id, length: u32::try_from(blob.len()).ok()?, checksum: crc32c(blob) })
    }
}

/// Some bytes of the announced blob.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Chunk {
    /// Id of the announced blob.
    pub id: u32,
    /// Where in the blob the bytes belong.
    pub offset: u32,
    /// The bytes, at least one.
    pub bytes: heapless::Vec<u8, CHUNK_BYTES>,
}

impl Chunk {
    /// From its parts; nothing if there are more bytes than [`CHUNK_BYTES`].
    pub fn new(id: u32, offset: u32, bytes: &[u8]) -> Option<Self> {
        Some(Self { id, offset, bytes: heapless::Vec::from_slice(bytes).ok()? })
    }
}

/// The progress of an upload.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Progress {
    /// Id of the announced blob.
    pub id: u32,
    /// The offset that the next chunk must have; the length when all is there.
    pub wanted_offset: u32,
    /// Bytes in all.
    pub length: u32,
}

impl Progress {
    /// The chunk that the receiver wants next, for the sender of `blob`; nothing when all is there.
    pub fn next_chunk(&self, blob: &[u8]) -> Option<Chunk> {
        let rest = blob.get(self.wanted_offset as usize..)?;
        let bytes = rest.chunks(CHUNK_BYTES).next()?;
        Chunk::new(self.id, self.wanted_offset, bytes)
    }
}

/// Why a part of an upload is refused. The bytes received so far stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum UploadError {
    /// Nothing has been announced.
    NotBegun,
    /// Another blob has been announced.
    OtherBlob {
        /// The announced one.
        announced: u32,
    },
    /// The blob is empty or does not fit.
    Length {
        /// Bytes announced.
        length: u32,
        /// Bytes that fit.
        capacity: u32,
    },
    /// The chunk is not the next one.
    Offset {
        /// The offset of the next one.
        wanted: u32,
    },
    /// The chunk is empty or goes beyond the announced length.
    ChunkLength {
        /// The offset of the next chunk.
        wanted: u32,
        /// Bytes in all.
        length: u32,
    },
    /// Not all of it is there yet.
    Incomplete {
        /// The offset of the next chunk.
        wanted: u32,
    },
    /// The whole has not the announced checksum; it has to be sent again from the start.
    Checksum {
        /// The announced checksum.
        announced: u32,
        /// The checksum of the bytes received.
        found: u32,
    },
}

impl fmt::Display for UploadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotBegun => f.write_str("upload: nothing announced; begin first"),
            Self::OtherBlob { announced } => write!(f, "upload: blob {announced} is announced; begin this one first"),
            Self::Length { length, capacity } => write!(f, "upload: {length} bytes; must be 1 to {capacity}"),
            Self::Offset { wanted } => write!(f, "upload: chunk out of order; go on at offset {wanted}"),
            Self::ChunkLength { wanted, length } => {
                write!(f, "upload: chunk empty or beyond the {length} bytes; go on at offset {wanted}")
            }
            Self::Incomplete { wanted } => write!(f, "upload: incomplete; go on at offset {wanted}"),
            Self::Checksum { announced, found } => {
                write!(f, "upload: checksum {found:08x}, announced {announced:08x}; begin again")
            }
        }
    }
}

impl core::error::Error for UploadError {}
