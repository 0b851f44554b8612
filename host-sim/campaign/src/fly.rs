//! Runs on all cores, their rows in the order of the runs: a campaign and a shard in; a file of rows, as long as it is flown,
//! out.

mod crew;

use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use crate::definition::Campaign;
use crate::error::CampaignError;
use crate::folder::Folder;
use crate::row::Row;
use crate::shard::Shard;
pub use crew::Crew;

/// Runs that are written, and reach the disk, at once.
const BLOCK: u64 = 16;
/// Blocks that a core may be ahead of the oldest that is still flown: the rows that wait in memory are bounded.
const AHEAD: u64 = 8;

/// The state that the cores share.
#[derive(Default)]
struct Shared {
    /// The next block that nobody flies.
    next: u64,
    /// Blocks that are on the disk.
    written: u64,
    /// Blocks that were flown and wait for those before them.
    flown: BTreeMap<u64, Vec<u8>>,
    /// Nobody goes on.
    over: bool,
}

struct Desk {
    shared: Mutex<Shared>,
    changed: Condvar,
}

impl Desk {
    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, guard: MutexGuard<'a, Shared>) -> MutexGuard<'a, Shared> {
        self.changed.wait(guard).unwrap_or_else(PoisonError::into_inner)
    }
}

/// Says that it is over when it goes, also in a panic: nobody then waits for ever.
struct Over<'a>(&'a Desk);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.lock().over = true;
        self.0.changed.notify_all();
    }
}

/// Flies the runs of a shard that are not flown yet. `progress` is told how many of its runs are on the disk.
///
/// # Errors
/// [`CampaignError`] where the file cannot be written; the rows written stay.
pub fn fly(
    campaign: &Campaign,
    folder: &Folder,
    shard: Shard,
    threads: usize,
    progress: &dyn Fn(u64),
) -> Result<(), CampaignError> {
    let mut file = folder.grow(shard)?;
    let runs = shard.runs(folder.card().runs);
    let first = file.next_run;
    progress(first - runs.start);
    let blocks = (runs.end - first).div_ceil(BLOCK);
    let block = |index: u64| first + index * BLOCK..(first + (index + 1) * BLOCK).min(runs.end);
    let desk = Desk { shared: Mutex::default(), changed: Condvar::new() };
    thread::scope(|scope| {
        for number in 1..=threads.max(1) {
            let begun = thread::Builder::new().spawn_scoped(scope, || {
                let over = Over(&desk);
                let mut crew = Crew::default();
                loop {
                    let mut shared = desk.lock();
                    while !shared.over && shared.next < blocks && shared.next >= shared.written + AHEAD * threads as u64
                    {
                        shared = desk.wait(shared);
                    }
                    if shared.over || shared.next >= blocks {
                        // Others are still flying.
                        std::mem::forget(over);
                        return;
                    }
                    let index = shared.next;
                    shared.next += 1;
                    drop(shared);
                    let rows = crew.fly(campaign, block(index));
                    desk.lock().flown.insert(index, Row::to_csv(&rows));
                    desk.changed.notify_all();
                }
            });
            if let Err(error) = begun {
                // Those that have begun stop.
                drop(Over(&desk));
                let reason = format!("--threads {threads}: thread {number} cannot begin ({error}); give fewer");
                return Err(CampaignError::Asked(reason));
            }
        }
        let over = Over(&desk);
        for index in 0..blocks {
            let mut shared = desk.lock();
            let rows = loop {
                if let Some(rows) = shared.flown.remove(&index) {
                    break rows;
                }
                if shared.over {
                    // A panic, which the scope passes on.
                    return Ok(());
                }
                shared = desk.wait(shared);
            };
            drop(shared);
            file.append(&rows, block(index).end)?;
            progress(file.next_run - runs.start);
            desk.lock().written = index + 1;
            desk.changed.notify_all();
        }
        drop(over);
        Ok(())
    })
}
