//! Files that are whole or absent.

use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::error::CampaignError;

/// A file under a name of this process beside its place: shards that begin at once do not meet. It goes where it is not renamed.
pub(super) struct Partial(PathBuf);

impl Partial {
    pub(super) fn beside(path: &Path) -> Result<(Self, File), CampaignError> {
        let mut partial = path.as_os_str().to_owned();
        partial.push(format!(".{}.partial", std::process::id()));
        let partial = Self(PathBuf::from(partial));
        let file = File::create(&partial.0).map_err(|error| CampaignError::file(path, "cannot be written", &error))?;
        Ok((partial, file))
    }

    pub(super) fn rename(self, path: &Path) -> std::io::Result<()> {
        fs::rename(&self.0, path)
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        // Not there once it was renamed.
        let _ = fs::remove_file(&self.0);
    }
}

/// Writes a file.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), CampaignError> {
    let (partial, mut file) = Partial::beside(path)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all()).and_then(|()| partial.rename(path));
    written.map_err(|error| CampaignError::file(path, "cannot be written", &error))
}
