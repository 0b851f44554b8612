//! A value that several tasks use, one at a time: the second gets nothing instead of waiting.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

/// The value and whether somebody is at it.
pub(crate) struct TryCell<T> {
    taken: AtomicBool,
    value: UnsafeCell<T>,
}

#[allow(unsafe_code, reason = "a static that is written; the flag keeps everybody but one away from it")]
// SAFETY: the value is reached only in `with`, by one caller at a time.
unsafe impl<T: Send> Sync for TryCell<T> {}

impl<T> TryCell<T> {
    /// Holding a value.
    pub(crate) const fn new(value: T) -> Self {
        Self { taken: AtomicBool::new(false), value: UnsafeCell::new(value) }
    }

    /// Does something with the value, unless somebody else is doing so.
    #[inline]
    #[allow(unsafe_code, reason = "the one place where the value is reached")]
    pub(crate) fn with<R>(&self, act: impl FnOnce(&mut T) -> R) -> Option<R> {
        // Nothing in here panics on the target; on a desk a panic leaves the cell taken, never shared.
        if self.taken.swap(true, Ordering::Acquire) {
            return None;
        }
        // SAFETY: any other task that comes before `taken` is cleared has returned above.
        let result = act(unsafe { &mut *self.value.get() });
        self.taken.store(false, Ordering::Release);
        Some(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_visitor_is_turned_away() {
        let cell = TryCell::new(1);
        let inner = cell.with(|value| {
            *value += 1;
            cell.with(|value| *value += 10)
        });
        assert_eq!(inner, Some(None));
        assert_eq!(cell.with(|value| *value), Some(2));
    }
}
