//! Uploads that are whole: put to use, kept over a loss of power, and put to use again after it.

use quatrack::gains::table::{GainTable, LoadError};
use quatrack::link::{BlobError, BlobKind, Refusal};

use super::{Session, Shared, disarmed};
use crate::kept::Keep;
use crate::signature::Signatures;
use crate::vehicle::VEHICLE;

impl<K: Keep> Session<K> {
    /// Counts refusals.
    pub(super) fn counted(&mut self, put: impl FnOnce(&mut Self) -> Result<(), Refusal>) -> Result<(), Refusal> {
        let done = put(self);
        if done.is_err() {
            self.uploads_refused = self.uploads_refused.saturating_add(1);
        }
        done
    }

    /// Checks the uploaded blob and puts it to use.
    pub(super) fn commit(&mut self, id: u32, flight: &mut impl Shared) -> Result<(), Refusal> {
        let (begin, blob) = self.uploads.finish(id).map_err(Refusal::Upload)?;
        if self.committed == Some(begin) {
            return Ok(());
        }
        put_to_use(begin.kind, blob, &self.signatures, flight)?;
        self.committed = Some(begin);
        Ok(())
    }

    /// The same, and keeps it.
    pub(super) fn keep(&mut self, id: u32, flight: &mut impl Shared) -> Result<(), Refusal> {
        disarmed(flight)?;
        self.commit(id, flight)?;
        let (begin, blob) = self.uploads.finish(id).map_err(Refusal::Upload)?;
        if self.kept_last == Some(begin) {
            return Ok(());
        }
        // Of the other kind nothing is said any more: a flash is written once too often rather than not at all.
        self.kept_last = None;
        if !self.kept.keep(begin.kind, blob) {
            return Err(Refusal::NotKept);
        }
        self.kept_last = Some(begin);
        Ok(())
    }

    /// Puts to use the uploads that were kept before the power went; one that is no longer accepted is left alone. A kept
    /// table can be chosen, and is not flown before it is.
    pub fn restore(&mut self, flight: &mut impl Shared) {
        for kind in [BlobKind::Trajectory, BlobKind::GainTable] {
            let kept = self.uploads.fill(|buffer| self.kept.kept(kind, buffer));
            if let Some(blob) = kept {
                // The image, its keys or its vehicle may have changed since.
                let _ = put_to_use(kind, blob, &self.signatures, flight);
            }
        }
        self.uploads.clear();
    }
}

/// Checks a blob, of a gain table the signature too, and puts it to use.
fn put_to_use(kind: BlobKind, blob: &[u8], signatures: &Signatures, flight: &mut impl Shared) -> Result<(), Refusal> {
    match kind {
        BlobKind::Trajectory => {
            // Checking pieces takes longer than a tick, and must not change the trajectory that is flown.
            disarmed(flight)?;
            flight.with(|flight| flight.playback.store().commit(blob)).map_err(Refusal::Blob)
        }
        BlobKind::GainTable => {
            // Read while the loop goes on; it waits only for the copy.
            let rate = flight.with(|flight| flight.table_rate()).ok_or(Refusal::NoTable)?;
            let blob = signatures.checked(blob).ok_or(Refusal::Blob(BlobError::Unsigned))?;
            let refused = |error: LoadError| Refusal::Blob(error.into());
            let table = GainTable::from_bytes(blob).map_err(|error| refused(error.into()))?;
            let accepted = table.accept_for(&VEHICLE, rate).map_err(|error| refused(error.into()))?;
            flight.with(|flight| flight.load(&accepted)).map_err(Refusal::from)
        }
    }
}
