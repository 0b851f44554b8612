//! Ways to the solution of a Riccati equation, cheap ones first: their results in; the first that is known to the last digit, else
//! the best, out.

/// A solution counts as found if the last correction, relative to P, is below this.
pub(super) const ACCURATE: f64 = 1e-13;
/// A solution to which no other way needs to be compared: its error, relative to P.
const EXACT: f64 = 1e-17;

/// A solution with what is known of its error.
pub(super) trait Attempt {
    /// Whether its closed loop is stable.
    fn is_stable(&self) -> bool;

    /// A bound of its error, relative to P.
    fn error(&self) -> f64;

    /// The last correction, relative to P.
    fn last_correction(&self) -> f64;
}

/// The best of some attempts: a stable one beats one that is not, else the smaller error wins.
///
/// The second of them may know P better than the first. The later ones are taken only where neither is stable and accurate.
pub(super) fn best<A: Attempt>(attempts: impl Iterator<Item = Option<A>>) -> Option<A> {
    let mut best: Option<A> = None;
    for (number, attempt) in attempts.enumerate() {
        let Some(attempt) = attempt else { continue };
        let rank = |attempt: &A| (!attempt.is_stable(), attempt.error());
        if best.as_ref().is_none_or(|held| rank(&attempt) < rank(held)) {
            best = Some(attempt);
        }
        let is_enough =
            |held: &A| held.is_stable() && (held.error() <= EXACT || number > 0 && held.last_correction() <= ACCURATE);
        if best.as_ref().is_some_and(is_enough) {
            break;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Debug, PartialEq)]
    struct Made(bool, f64, f64);

    impl Attempt for Made {
        fn is_stable(&self) -> bool {
            self.0
        }

        fn error(&self) -> f64 {
            self.1
        }

        fn last_correction(&self) -> f64 {
            self.2
        }
    }

    #[test]
    fn later_ways_are_taken_where_the_first_do_not_do() {
        let taken = |made: &[Option<Made>]| {
            let mut count = 0;
            let best = best(made.iter().cloned().inspect(|_| count += 1));
            (best, count)
        };
        let (exact, fair, poor) = (Made(true, 1e-18, 1e-20), Made(true, 1e-15, 1e-15), Made(true, 1e-9, 1e-9));
        let unstable = Made(false, 0.0, 0.0);
        assert_eq!(taken(&[Some(exact.clone()), Some(fair.clone())]), (Some(exact.clone()), 1));
        assert_eq!(taken(&[Some(fair.clone()), Some(poor.clone()), Some(exact.clone())]), (Some(fair.clone()), 2));
        assert_eq!(taken(&[Some(poor.clone()), None, Some(fair.clone())]), (Some(fair), 3));
        assert_eq!(taken(&[Some(unstable.clone()), Some(poor.clone())]), (Some(poor), 2));
        assert_eq!(taken(&[None, Some(unstable.clone())]), (Some(unstable), 2));
        assert_eq!(taken(&[None]), (None, 1));
    }
}
