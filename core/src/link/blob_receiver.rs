//! The receiving end of an upload: an announcement and chunks in, the whole and checked blob out.

use super::upload::{BlobKind, Chunk, Progress, UploadBegin, UploadError};
use crate::checksum::crc32c;

/// Collects one blob of at most `N` bytes. A new one is all zeros, so that a static costs no flash.
#[derive(Clone, Debug)]
pub struct BlobReceiver<const N: usize> {
    /// Of length 0 as long as nothing has been announced.
    announced: UploadBegin,
    bytes: heapless::Vec<u8, N>,
}

impl<const N: usize> BlobReceiver<N> {
    /// Nothing announced.
    pub const fn new() -> Self {
        let announced = UploadBegin { kind: BlobKind::Trajectory, id: 0, length: 0, checksum: 0 };
        Self { announced, bytes: heapless::Vec::new() }
    }

    /// Takes an announcement. The one in force again changes nothing; another one drops the bytes received so far.
    ///
    /// # Errors
    /// [`UploadError::Length`].
    pub fn begin(&mut self, begin: &UploadBegin) -> Result<Progress, UploadError> {
        let capacity = u32::try_from(N).unwrap_or(u32::MAX);
        if begin.length == 0 || begin.length > capacity {
            return Err(UploadError::Length { length: begin.length, capacity });
        }
        if self.announced != *begin {
            self.announced = *begin;
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
        let fits = (1..=left).contains(&chunk.bytes.len());
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
        self.announced().map(|begin| self.progress_of(&begin))
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

    /// Uses the room for a blob that comes from elsewhere: `read` fills the start of a buffer and says how much of it.
    /// The announcement is forgotten.
    pub fn fill(&mut self, read: impl FnOnce(&mut [u8]) -> Option<usize>) -> Option<&[u8]> {
        self.clear();
        // There is room for as many as there is room for.
        let _ = self.bytes.resize(N, 0);
        let bytes = read(&mut self.bytes);
        self.bytes.truncate(bytes.unwrap_or(0));
        bytes.map(|_| &*self.bytes)
    }

    /// Forgets the announcement and the bytes received.
    pub fn clear(&mut self) {
        self.announced.length = 0;
        self.bytes.clear();
    }

    fn announced(&self) -> Result<UploadBegin, UploadError> {
        if self.announced.length > 0 { Ok(self.announced) } else { Err(UploadError::NotBegun) }
    }

    fn announced_as(&self, id: u32) -> Result<UploadBegin, UploadError> {
        let announced = self.announced()?;
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

#[cfg(test)]
mod tests {
    use super::*;

    const BLOB: [u8; 200] = {
        let mut blob = [0; 200];
        let mut i = 0;
        while i < blob.len() {
            blob[i] = (i * 7) as u8;
            i += 1;
        }
        blob
    };

    fn announcement(id: u32) -> UploadBegin {
        UploadBegin::of(BlobKind::Trajectory, id, &BLOB).unwrap()
    }

    fn receiver_with(bytes: usize) -> BlobReceiver<256> {
        let mut receiver = BlobReceiver::new();
        let mut progress = receiver.begin(&announcement(1)).unwrap();
        while (progress.wanted_offset as usize) < bytes {
            progress = receiver.chunk(&progress.next_chunk(&BLOB[..bytes]).unwrap()).unwrap();
        }
        receiver
    }

    #[test]
    fn a_whole_blob_comes_out_as_often_as_it_is_asked_for() {
        let mut receiver = receiver_with(BLOB.len());
        assert_eq!(receiver.progress().unwrap().next_chunk(&BLOB), None, "all is there");
        for _ in 0..2 {
            assert_eq!(receiver.finish(1), Ok((announcement(1), &BLOB[..])));
        }
    }

    #[test]
    fn the_same_announcement_resumes_and_another_starts_over() {
        let mut receiver = receiver_with(96);
        assert_eq!(receiver.begin(&announcement(1)).map(|p| p.wanted_offset), Ok(96));
        assert_eq!(receiver.progress(), Ok(Progress { id: 1, wanted_offset: 96, length: 200 }));
        assert_eq!(receiver.begin(&announcement(2)).map(|p| p.wanted_offset), Ok(0));
    }

    #[test]
    fn chunks_out_of_place_are_refused_with_the_wanted_offset() {
        let mut receiver = receiver_with(96);
        let cases = [
            (1, 0, 96, UploadError::Offset { wanted: 96 }, "the one before again"),
            (1, 95, 1, UploadError::Offset { wanted: 96 }, "overlapping"),
            (1, 97, 1, UploadError::Offset { wanted: 96 }, "one byte skipped"),
            (2, 96, 1, UploadError::OtherBlob { announced: 1 }, "of another blob"),
            (1, 96, 0, UploadError::ChunkLength { wanted: 96, length: 200 }, "empty"),
        ];
        for (id, offset, bytes, error, case) in cases {
            let chunk = Chunk::new(id, offset, &BLOB[..bytes]).unwrap();
            assert_eq!(receiver.chunk(&chunk), Err(error), "{case}");
        }
        let mut nearly = receiver_with(192);
        let beyond = Chunk::new(1, 192, &[0; 9]).unwrap();
        assert_eq!(nearly.chunk(&beyond), Err(UploadError::ChunkLength { wanted: 192, length: 200 }), "beyond the end");
        assert_eq!(nearly.progress().map(|p| p.wanted_offset), Ok(192), "nothing of it is kept");
    }

    #[test]
    fn nothing_is_taken_before_an_announcement_that_fits() {
        let mut receiver = BlobReceiver::<199>::new();
        let chunk = Chunk::new(0, 0, &BLOB[..1]).unwrap();
        assert_eq!(receiver.chunk(&chunk), Err(UploadError::NotBegun));
        assert_eq!(receiver.progress(), Err(UploadError::NotBegun));
        assert_eq!(receiver.finish(0), Err(UploadError::NotBegun));
        assert_eq!(receiver.begin(&announcement(1)), Err(UploadError::Length { length: 200, capacity: 199 }));
        let empty = UploadBegin::of(BlobKind::Trajectory, 1, &[]).unwrap();
        assert_eq!(receiver.begin(&empty), Err(UploadError::Length { length: 0, capacity: 199 }));
        assert_eq!(receiver.progress(), Err(UploadError::NotBegun), "refused announcements announce nothing");
    }

    #[test]
    fn an_incomplete_or_altered_blob_does_not_come_out() {
        assert_eq!(receiver_with(96).finish(1), Err(UploadError::Incomplete { wanted: 96 }));
        let mut receiver = receiver_with(96);
        for offset in [96, 192] {
            let chunk = Chunk::new(1, offset, &[0; 96][..usize::min(96, 200 - offset as usize)]).unwrap();
            receiver.chunk(&chunk).unwrap();
        }
        let announced = announcement(1).checksum;
        let refused = receiver.finish(1);
        assert!(
            matches!(refused, Err(UploadError::Checksum { announced: a, found }) if a == announced && found != a),
            "{refused:?}"
        );
        assert_eq!(receiver.progress().map(|p| p.wanted_offset), Ok(0), "to be sent again from the start");
    }
}
