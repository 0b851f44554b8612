//! Runs on all cores, their rows in the order of the runs: a campaign and a shard in; a file of rows, as long as it is flown,
//! out.

use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use quatrack_simulation::scenario::{Law, Scenario};

use crate::definition::Campaign;
use crate::error::CampaignError;
use crate::folder::Folder;
use crate::row::{Outcome, Row};
use crate::shard::Shard;

/// Runs that are written, and reach the disk, at once.
const BLOCK: u64 = 16;
/// Blocks that a core may be ahead of the oldest that is still flown: what waits in memory is bounded.
const AHEAD: u64 = 8;

/// What the cores share.
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

/// Flies what of a shard is not flown yet. `progress` is told how many of its runs are on the disk.
///
/// # Errors
/// [`CampaignError`] where the file cannot be written; what was written stays.
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
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                let over = Over(&desk);
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
                    let rows: Vec<Row> = block(index).flat_map(|run| fly_run(campaign, run)).collect();
                    desk.lock().flown.insert(index, Row::to_csv(&rows));
                    desk.changed.notify_all();
                }
            });
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

/// The rows of one run, law by law.
pub fn fly_run(campaign: &Campaign, run: u64) -> Vec<Row> {
    let drawn = campaign.run(run);
    let row = |law: &Law| {
        let refused = |reason: String| Row {
            run,
            law: *law,
            seed: drawn.seed,
            outcome: Outcome::Refused,
            iae_m_s: None,
            max_error_m: None,
            saturated_steps: None,
            lost_s: None,
            reason: one_line(&reason),
            drawn: drawn.drawn.clone(),
        };
        match &drawn.scenario {
            Ok(scenario) => flown(campaign, scenario, *law, &refused),
            Err(error) => refused(error.to_string()),
        }
    };
    campaign.laws().iter().map(row).collect()
}

fn flown(campaign: &Campaign, scenario: &Scenario, law: Law, refused: &dyn Fn(String) -> Row) -> Row {
    let mut flying = match law.start(&scenario.vehicle, &scenario.told) {
        Ok(flying) => flying,
        Err(error) => return refused(error.to_string()),
    };
    let flight = match scenario.fly(flying.as_mut(), &scenario.flown(campaign.trajectory().cloned())) {
        Ok(flight) => flight,
        Err(error) => return refused(error.to_string()),
    };
    let row = refused(String::new());
    Row {
        outcome: if flight.lost.is_some() { Outcome::Lost } else { Outcome::Flown },
        iae_m_s: flight.iae_m_s(),
        max_error_m: Some(flight.max_error_m()),
        saturated_steps: Some(flight.saturated_steps),
        lost_s: flight.lost.as_ref().map(|lost| lost.time_s),
        reason: flight.lost.map_or_else(String::new, |lost| one_line(&lost.reason)),
        ..row
    }
}

/// A row is one line.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
