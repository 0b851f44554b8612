//! Uploads: an announcement and chunks in, a whole and checked blob out.
//!
//! The sender announces a blob by kind, id, length and checksum, then sends chunks in order, each at the offset that the
//! last answer wanted. A chunk at another offset is refused with the wanted one; a sender that lost touch asks, or
//! announces the same blob again, and goes on from there. [`BlobReceiver::finish`] may be called again, should its
//! answer be lost.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::checksum::crc32c;
use super::size::CHUNK_BYTES;

/// What a blob is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BlobKind {
    /// A trajectory, see [`super::TrajectorySlot`].
    Trajectory,
    /// A gain table.
    GainTable,
}

/// Announces a blob.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct UploadBegin {
    /// What it is.
    pub kind: BlobKind,
    /// The sender's name for it; every chunk carries it.
    pub id: u32,
    /// Bytes in all.
    pub length: u32,
    /// [`super::crc32c`] of all of them.
    pub checksum: u32,
}

/// Some bytes of the announced blob.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Chunk {
    /// Of the announced blob.
    pub id: u32,
    /// Where in the blob the bytes belong.
    pub offset: u32,
    /// At least one.
    pub bytes: heapless::Vec<u8, CHUNK_BYTES>,
}

/// How far an upload is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Progress {
    /// Of the announced blob.
    pub id: u32,
    /// The offset that the next chunk must have; the length when all is there.
    pub wanted_offset: u32,
    /// Bytes in all.
    pub length: u32,
}

/// Why a part of an upload is refused. What has been received so far stays.
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
    /// The whole is not what was announced; it has to be sent again from the start.
    Checksum {
        /// As announced.
        announced: u32,
        /// Of what is there.
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

/// Collects one blob of at most `N` bytes.
#[derive(Clone, Debug)]
pub struct BlobReceiver<const N: usize> {
    announced: Option<UploadBegin>,
    bytes: heapless::Vec<u8, N>,
}

impl<const N: usize> BlobReceiver<N> {
    /// Nothing announced.
    pub const fn new() -> Self {
        Self { announced: None, bytes: heapless::Vec::new() }
    }

    /// Takes an announcement. The one in force again changes nothing; another one drops what has been received.
    ///
    /// # Errors
    /// [`UploadError::Length`].
    pub fn begin(&mut self, begin: &UploadBegin) -> Result<Progress, UploadError> {
        let capacity = u32::try_from(N).unwrap_or(u32::MAX);
        if begin.length == 0 || begin.length > capacity {
            return Err(UploadError::Length { length: begin.length, capacity });
        }
        if self.announced != Some(*begin) {
            self.announced = Some(*begin);
            self.bytes.clear();
        }
        Ok(self.progress_of(begin))
    }

    /// Takes the next chunk.
    ///
    /// # Errors
    /// [`UploadError`]; nothing of the chunk is kept then.
    pub fn chunk(&mut self, chunk: &Chunk) -> Result<Progress, UploadError> {
        let announced = self.announced_as(chunk.id)?;
        let wanted = self.received();
        if chunk.offset != wanted {
            return Err(UploadError::Offset { wanted });
        }
        let left = announced.length.saturating_sub(wanted) as usize;
        let fits = !chunk.bytes.is_empty() && chunk.bytes.len() <= left;
        if !fits || self.bytes.extend_from_slice(&chunk.bytes).is_err() {
            return Err(UploadError::ChunkLength { wanted, length: announced.length });
        }
        Ok(self.progress_of(&announced))
    }

    /// How far the announced upload is.
    ///
    /// # Errors
    /// [`UploadError::NotBegun`].
    pub fn progress(&self) -> Result<Progress, UploadError> {
        self.announced.map(|begin| self.progress_of(&begin)).ok_or(UploadError::NotBegun)
    }

    /// The whole blob, checked, with its announcement. It stays until another one is announced.
    ///
    /// # Errors
    /// [`UploadError`]. A blob of the wrong checksum is dropped, but stays announced.
    pub fn finish(&mut self, id: u32) -> Result<(UploadBegin, &[u8]), UploadError> {
        let announced = self.announced_as(id)?;
        let wanted = self.received();
        if wanted != announced.length {
            return Err(UploadError::Incomplete { wanted });
        }
        let found = crc32c(&self.bytes);
        if found != announced.checksum {
            self.bytes.clear();
            return Err(UploadError::Checksum { announced: announced.checksum, found });
        }
        Ok((announced, &self.bytes))
    }

    fn announced_as(&self, id: u32) -> Result<UploadBegin, UploadError> {
        let announced = self.announced.ok_or(UploadError::NotBegun)?;
        if announced.id == id { Ok(announced) } else { Err(UploadError::OtherBlob { announced: announced.id }) }
    }

    fn progress_of(&self, begin: &UploadBegin) -> Progress {
        Progress { id: begin.id, wanted_offset: self.received(), length: begin.length }
    }

    fn received(&self) -> u32 {
        u32::try_from(self.bytes.len()).unwrap_or(u32::MAX)
    }
}

impl<const N: usize> Default for BlobReceiver<N> {
    fn default() -> Self {
        Self::new()
    }
}
