//! The time limit of a search, and the receiver of its progress.

use std::cell::Cell;
use std::time::{Duration, Instant};

/// A time to end by, and an ear for progress. A plan is solved many times over where its times are free or a remedy is
/// looked for.
pub struct Budget<'a> {
    deadline: Option<Instant>,
    limit_s: f64,
    progress: Option<&'a dyn Fn(&str)>,
    exceeded: Cell<bool>,
}

impl<'a> Budget<'a> {
    /// A budget without a limit and without progress.
    pub fn unlimited() -> Self {
        Self { deadline: None, limit_s: f64::INFINITY, progress: None, exceeded: Cell::new(false) }
    }

    /// So many seconds from now; `progress` is told each stage.
    pub fn of_seconds(limit_s: f64, progress: &'a dyn Fn(&str)) -> Self {
        let deadline = Duration::try_from_secs_f64(limit_s).ok().and_then(|limit| Instant::now().checked_add(limit));
        Self { deadline, limit_s, progress: Some(progress), exceeded: Cell::new(false) }
    }

    /// Seconds left; `None` without a limit.
    pub(super) fn left_s(&self) -> Option<f64> {
        self.deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()).as_secs_f64())
    }

    /// Whether the time is up; stays so.
    pub(super) fn is_over(&self) -> bool {
        if self.left_s().is_some_and(|left_s| left_s <= 0.0) {
            self.exceeded.set(true);
        }
        self.exceeded.get()
    }

    pub(super) fn limit_s(&self) -> f64 {
        self.limit_s
    }

    pub(super) fn say(&self, stage: &str) {
        if let Some(progress) = self.progress {
            progress(stage);
        }
    }
}
