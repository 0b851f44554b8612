//! `quatrack gains sign`: tables and a key in; the tables with a signature out.

use std::path::{Path, PathBuf};

use quatrack::gains::table::GainTable;
use quatrack::link::{Key, signature, unsigned};

use super::super::{Failure, key_file, output};
use super::read;

/// Signs tables, each of which a board could read.
pub(super) fn sign(tables: &[PathBuf], key: &Path, folder: Option<&Path>) -> Result<(), Failure> {
    let key = Key::new(&key_file::read(key)?);
    if let Some(folder) = folder {
        output::create_dir(folder)?;
    }
    for path in tables {
        let blob = read(path)?;
        let table = unsigned(&blob);
        GainTable::from_bytes(table).map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
        let signed = [table, &signature(&key, table)].concat();
        let beside = path.with_extension("signed.bin");
        let out = folder.zip(beside.file_name()).map_or_else(|| beside.clone(), |(folder, name)| folder.join(name));
        output::write(&out, &signed)?;
        output::print(&format!("wrote {}\n", out.display()))?;
    }
    Ok(())
}
