//! Campaigns: a scenario with distributions flown thousands of times, its rows read back.

use std::collections::BTreeMap;
use std::fs;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use quatrack_campaign::definition::Asked;
use quatrack_campaign::row::header;
use quatrack_campaign::{Campaign, Folder, Row, Shard, fly::fly};
use quatrack_simulation::scenario::Law;

use crate::arrays::shaped;
use crate::error::refused;
use crate::long_call::{Cancelled, long_call};
use crate::trajectory::by_name;
use crate::values::{self, Source};

/// Said by a flight that is told to stop; nobody but this module sees it.
struct Stopped;

fn flown(
    path: &Path,
    runs: u64,
    asked: &Asked,
    out: &Path,
    threads: usize,
    cancelled: &Cancelled,
) -> Result<Rows, String> {
    let campaign = Campaign::read(path, asked, &by_name).map_err(|error| error.to_string())?;
    let folder = Folder::begin(out, &campaign, runs).map_err(|error| error.to_string())?;
    let progress = |_| {
        if cancelled.is_said() {
            // Without the message of a panic: the flights on other threads end as after one.
            resume_unwind(Box::new(Stopped));
        }
    };
    match catch_unwind(AssertUnwindSafe(|| fly(&campaign, &folder, Shard::WHOLE, threads, &progress))) {
        Ok(done) => done.map_err(|error| error.to_string())?,
        Err(stopped) if stopped.is::<Stopped>() => return Err("cancelled".to_owned()),
        Err(panic) => resume_unwind(panic),
    }
    folder.write_parquet().map_err(|error| error.to_string())?;
    let names = header(&campaign.drawn_names());
    let rows = folder.rows(Shard::WHOLE).map_err(|error| error.to_string())?;
    let rows = rows.collect::<Result<_, _>>().map_err(|error| error.to_string())?;
    Ok(Rows { names, rows })
}

struct Rows {
    names: Vec<String>,
    rows: Vec<Row>,
}

/// Columns that hold words.
const WORDS: [&str; 3] = ["law", "outcome", "reason"];

/// Flies a scenario thousands of times, with figures drawn from its vary table, under each of its laws.
///
/// scenario: path of a scenario with distributions, or its keys as a dictionary
/// runs: how many; each law flies them all
/// out: folder for the rows, made or gone on with: runs in it are not flown again
/// laws: names; the scenario's where left out
/// seed: of all draws; the scenario's where left out
/// threads: as many as there are processors where left out
///
/// Returns the rows as columns by name: arrays of shape (rows,), NaN where a row has no such number, and lists of text for law, outcome
/// and reason. The folder then has them as CSV and Parquet too.
#[pyfunction]
#[pyo3(signature = (scenario, runs, out, *, laws=None, seed=None, threads=None))]
pub(crate) fn campaign<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
    runs: u64,
    out: PathBuf,
    laws: Option<Vec<String>>,
    seed: Option<&Bound<'py, PyAny>>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let threads = threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, NonZeroUsize::get));
    if runs == 0 || threads == 0 {
        return Err(PyValueError::new_err("runs and threads: must be at least 1"));
    }
    let laws =
        laws.unwrap_or_default().iter().map(|law| Law::from_str(law)).collect::<Result<_, _>>().map_err(refused)?;
    let asked = Asked { seed: seed.filter(|seed| !seed.is_none()).map(values::seed).transpose()?, laws };
    let (path, made) = match Source::read("scenario", scenario)? {
        Source::Path(path) => (path, None),
        Source::Text(text) => {
            let path = std::env::temp_dir().join(format!("quatrack-campaign-{}.toml", std::process::id()));
            fs::write(&path, text)
                .map_err(|error| refused(format!("{}: cannot be written ({error})", path.display())))?;
            (path.clone(), Some(path))
        }
    };
    let rows = long_call(py, move |cancelled| {
        let rows = flown(&path, runs, &asked, &out, threads, cancelled);
        // Of a dictionary; the folder has its own copy.
        if let Some(made) = made {
            let _ = fs::remove_file(made);
        }
        rows
    })?;
    let Rows { names, rows } = rows.map_err(refused)?;
    let mut columns: BTreeMap<usize, Vec<String>> = BTreeMap::new();
    for row in &rows {
        for (column, cell) in row.cells().into_iter().enumerate() {
            columns.entry(column).or_default().push(cell);
        }
    }
    let dictionary = PyDict::new(py);
    for (column, name) in names.iter().enumerate() {
        let cells = columns.remove(&column).unwrap_or_default();
        if WORDS.contains(&name.as_str()) {
            dictionary.set_item(name, cells)?;
        } else if matches!(name.as_str(), "run" | "seed") {
            let numbers: Vec<u64> = cells.iter().filter_map(|cell| cell.parse().ok()).collect();
            dictionary.set_item(name, shaped(py, &[numbers.len()], numbers)?)?;
        } else {
            let numbers: Vec<f64> = cells.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
            dictionary.set_item(name, shaped(py, &[numbers.len()], numbers)?)?;
        }
    }
    Ok(dictionary)
}
