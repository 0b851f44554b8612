//! Rows as CSV on disk: a folder and a shard in; its whole runs as rows, or a file that grows by whole runs after the
//! last of them, out.

use std::fs::{File, OpenOptions};
use std::io::{BufRead as _, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use super::Folder;
use crate::error::CampaignError;
use crate::row::{self, Row};
use crate::shard::Shard;

/// A file of rows that grows by whole runs.
pub struct Growing {
    file: File,
    path: PathBuf,
    /// The first run that it has not.
    pub next_run: u64,
}

impl Folder {
    /// The file of a shard's rows, cut after the last whole run, for this process alone.
    ///
    /// # Errors
    /// [`CampaignError`], also where another process grows it, where shards of another number are here, and where the file is not
    /// one of this campaign's rows.
    pub fn grow(&self, shard: Shard) -> Result<Growing, CampaignError> {
        if let Some(other) = self.shard_files()?.into_iter().find(|other| other.count() != shard.count()) {
            // Shards beside the whole are those that it was merged from.
            if other != Shard::WHOLE {
                let reason = format!("holds shard {other}; fly --shard I/{}, or choose another --out", other.count());
                return Err(CampaignError::folder(&self.path, reason));
            }
        }
        let path = self.path.join(shard.file_name());
        let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let mut file = opened.map_err(|error| CampaignError::file(&path, "cannot be opened", &error))?;
        lock(&file, &path)?;
        let runs = shard.runs(self.card.runs);
        let (next_run, kept) =
            self.whole_runs(&file, runs.start).map_err(|e| CampaignError::file(&path, "cannot be read", &e))?;
        let cut = (|| {
            file.set_len(kept)?;
            file.seek(SeekFrom::Start(kept))?;
            if kept == 0 {
                file.write_all(self.header().as_bytes())?;
            }
            file.sync_data()
        })();
        cut.map_err(|error| CampaignError::file(&path, "cannot be written", &error))?;
        Ok(Growing { file, path, next_run })
    }

    /// Refuses where another process grows a file of rows.
    pub(super) fn is_still(&self) -> Result<(), CampaignError> {
        for shard in self.shard_files()? {
            let path = self.path.join(shard.file_name());
            let file = File::open(&path).map_err(|error| CampaignError::file(&path, "cannot be read", &error))?;
            lock(&file, &path)?;
        }
        Ok(())
    }

    pub(super) fn header(&self) -> String {
        row::header(&self.card.drawn).join(",") + "\n"
    }

    /// The first run that is not wholly there, and where its rows would begin.
    fn whole_runs(&self, mut file: &File, first: u64) -> std::io::Result<(u64, u64)> {
        // The end of the last line that has one: all but the very last do.
        let length = file.seek(SeekFrom::End(0))?;
        let mut last = [0];
        if length > 0 {
            file.seek(SeekFrom::Start(length - 1))?;
            file.read_exact(&mut last)?;
        }
        let ended = if last == *b"\n" { length } else { length.saturating_sub(1) };
        file.rewind()?;
        let mut reader = BufReader::new(file);
        let (mut line, mut next_run) = (Vec::new(), first);
        reader.read_until(b'\n', &mut line)?;
        if line != self.header().as_bytes() {
            // A writer that was killed at once leaves a part of it.
            let is_part = self.header().as_bytes().starts_with(&line);
            return if is_part { Ok((first, 0)) } else { Err(foreign("the first line is not the header")) };
        }
        let header = line.len() as u64;
        let mut kept = header;
        // One reader for all lines: to make one takes a hundred times the reading of a line.
        let mut lines = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(reader);
        let mut cells = csv::StringRecord::new();
        let mut laws = self.card.laws.iter();
        loop {
            let row = match lines.read_record(&mut cells) {
                Ok(true) => Row::of_cells(&cells).filter(|row| row.drawn.len() == self.card.drawn.len()),
                Ok(false) => return Ok((next_run, kept)),
                Err(error) => match error.into_kind() {
                    csv::ErrorKind::Io(error) => return Err(error),
                    _ => None,
                },
            };
            let place = header + lines.position().byte();
            // A line that a killed writer left behind has no end.
            if place > ended {
                return Ok((next_run, kept));
            }
            match (row, laws.next()) {
                (Some(row), Some(law)) if row.run == next_run && row.law.name() == law => {}
                _ => {
                    return Err(foreign(&format!("line {} is not the row of run {next_run}", lines.position().line())));
                }
            }
            if laws.len() == 0 {
                laws = self.card.laws.iter();
                next_run += 1;
                kept = place;
            }
        }
    }

    /// The rows of a shard in their order.
    ///
    /// # Errors
    /// [`CampaignError::File`].
    pub fn rows(&self, shard: Shard) -> Result<impl Iterator<Item = Result<Row, CampaignError>>, CampaignError> {
        let path = self.path.join(shard.file_name());
        let mut file = File::open(&path).map_err(|error| CampaignError::file(&path, "cannot be read", &error))?;
        // A part line that a killed writer left behind is not read.
        let (_, kept) = self
            .whole_runs(&file, shard.runs(self.card.runs).start)
            .and_then(|whole| file.rewind().map(|()| whole))
            .map_err(|error| CampaignError::file(&path, "cannot be read", &error))?;
        let records = csv::ReaderBuilder::new().from_reader(file.take(kept)).into_records();
        Ok(records.map(move |record| {
            let row = record.ok().as_ref().and_then(Row::of_cells);
            row.ok_or_else(|| {
                CampaignError::folder(&path, "holds a line that is no row; delete the file and fly it again")
            })
        }))
    }

    /// How many runs of a shard are wholly there.
    ///
    /// # Errors
    /// [`CampaignError::File`].
    pub fn flown(&self, shard: Shard) -> Result<u64, CampaignError> {
        let path = self.path.join(shard.file_name());
        let first = shard.runs(self.card.runs).start;
        let file = File::open(&path).map_err(|error| CampaignError::file(&path, "cannot be read", &error))?;
        let whole = self.whole_runs(&file, first);
        whole.map(|(next, _)| next - first).map_err(|error| CampaignError::file(&path, "cannot be read", &error))
    }
}

/// For this process alone, until the file is closed.
fn lock(file: &File, path: &Path) -> Result<(), CampaignError> {
    let refused = |error| CampaignError::folder(path, format!("is being written by another process ({error})"));
    file.try_lock().map_err(refused)
}

/// The error of a file whose lines a campaign has not written so.
fn foreign(fault: &str) -> std::io::Error {
    let remedy = "put back the file as it was flown, or move it away and fly it again";
    std::io::Error::new(std::io::ErrorKind::InvalidData, format!("{fault}; {remedy}"))
}

impl Growing {
    /// Appends whole runs; they are on the disk when this returns.
    ///
    /// # Errors
    /// [`CampaignError::File`]: the rows there stay whole.
    pub fn append(&mut self, rows: &[u8], next_run: u64) -> Result<(), CampaignError> {
        let written = self.file.write_all(rows).and_then(|()| self.file.sync_data());
        written.map_err(|error| CampaignError::file(&self.path, "cannot be written", &error))?;
        self.next_run = next_run;
        Ok(())
    }
}
