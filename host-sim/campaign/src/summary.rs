//! A summary of the rows of each law: success with its interval, percentiles, the worst flights and how to see them
//! again, and which figure matters most.

mod text;

use std::path::Path;

use serde::Serialize;

use crate::error::CampaignError;
use crate::folder::Folder;
use crate::row::{Outcome, Row};
use crate::statistics::{Explained, explained, is_correlated, quantile, ranks, spearman, wilson};

/// The schema that the file states.
pub const SCHEMA: &str = "quatrack/campaign-summary/1";
/// Percentiles of errors.
pub const PERCENT: [f64; 3] = [50.0, 95.0, 99.0];

/// The bounds of a success, and how many flights are shown.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Largest position error of a flight that succeeded, m; any where absent.
    pub within_m: Option<f64>,
    /// How many of the worst flights are named for each law.
    pub worst: usize,
}

/// The summary of a whole campaign.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The campaign's seed.
    pub seed: u64,
    /// Runs that were asked for.
    pub runs: u64,
    /// Runs whose rows are there.
    pub runs_flown: u64,
    /// Largest position error of a success, m; none where only a lost flight is none.
    pub within_m: Option<f64>,
    /// The laws in the order in which they flew.
    pub laws: Vec<LawSummary>,
}

/// The summary of one law.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LawSummary {
    /// The law.
    pub law: String,
    /// Flights, without those that were refused.
    pub flights: u64,
    /// Flights that succeeded.
    pub successes: u64,
    /// Flights that were lost.
    pub lost: u64,
    /// Never flown: figures without sense together.
    pub refused: u64,
    /// Share of successes.
    pub success_rate: Option<f64>,
    /// Wilson's interval of 95 % for it.
    pub success_interval_95: Option<[f64; 2]>,
    /// At 50, 95 and 99 %, m s; none where that flight was lost. A lost flight is worse than any other.
    pub iae_m_s: [Option<f64>; 3],
    /// Likewise the largest position error, m.
    pub max_error_m: [Option<f64>; 3],
    /// The worst first: lost ones as early as they were, then by the largest error.
    pub worst: Vec<Worst>,
    /// The strongest first: by what its parts explain, or its correlation squared, whichever is more.
    pub matters: Vec<Matter>,
}

/// A flight to look at.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// The run's number.
    pub run: u64,
    /// Its seed of noise and gusts.
    pub seed: u64,
    /// Time at which it was lost, s.
    pub lost_s: Option<f64>,
    /// Largest position error, m.
    pub max_error_m: Option<f64>,
    /// The command that flies it again and plots it.
    pub replay: String,
}

/// How a figure goes with the largest error, a lost flight being worse than any other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Matter {
    /// The figure.
    pub figure: String,
    /// The share of the variance of the errors' ranks that equal parts of the figure explain ([`explained`]): also where both too
    /// little and too much of it do harm.
    pub explained: f64,
    /// Spearman's rank correlation: positive where more of the figure does harm.
    pub rank_correlation: f64,
    /// Whether chance alone would give as much of one of the two in less than one of twenty campaigns: each in one of forty, the
    /// correlation beyond 2.24/sqrt(n - 1).
    pub beyond_chance: bool,
}

impl Summary {
    /// Of a folder's rows: those of the whole campaign, or of all its shards as far as they are.
    ///
    /// # Errors
    /// [`CampaignError`].
    pub fn of(folder: &Folder, view: &View) -> Result<Self, CampaignError> {
        let card = folder.card();
        let mut laws: Vec<Gathered> = card.laws.iter().map(|_| Gathered::new(card.drawn.len())).collect();
        let mut runs_flown = 0;
        for shard in folder.parts()? {
            runs_flown += folder.flown(shard)?;
            for row in folder.rows(shard)? {
                let row = row?;
                if let Some(law) = card.laws.iter().position(|law| *law == row.law.name()) {
                    laws[law].take(&row, view);
                }
            }
        }
        let laws =
            card.laws.iter().zip(laws).map(|(law, gathered)| gathered.summary(law, folder.path(), &card.drawn, view));
        Ok(Self {
            schema: SCHEMA,
            seed: card.seed,
            runs: card.runs,
            runs_flown,
            within_m: view.within_m,
            laws: laws.collect(),
        })
    }
}

/// The numbers kept of the rows of one law, 8 bytes each.
struct Gathered {
    successes: u64,
    lost: u64,
    refused: u64,
    /// Infinite where it was lost.
    iae_m_s: Vec<f64>,
    max_error_m: Vec<f64>,
    drawn: Vec<Vec<f64>>,
    /// The worst so far, the worst first.
    worst: Vec<(f64, Row)>,
}

impl Gathered {
    fn new(drawn: usize) -> Self {
        Self {
            successes: 0,
            lost: 0,
            refused: 0,
            iae_m_s: Vec::new(),
            max_error_m: Vec::new(),
            drawn: vec![Vec::new(); drawn],
            worst: Vec::new(),
        }
    }

    fn take(&mut self, row: &Row, view: &View) {
        if row.outcome == Outcome::Refused {
            self.refused += 1;
            return;
        }
        let is_lost = row.outcome == Outcome::Lost;
        let error_m = row.max_error_m.unwrap_or(f64::INFINITY);
        self.lost += u64::from(is_lost);
        self.successes += u64::from(!is_lost && view.within_m.is_none_or(|within| error_m <= within));
        self.iae_m_s.push(row.iae_m_s.unwrap_or(f64::INFINITY));
        self.max_error_m.push(if is_lost { f64::INFINITY } else { error_m });
        for (figure, drawn) in self.drawn.iter_mut().zip(&row.drawn) {
            figure.push(*drawn);
        }
        // Lost flights before all others, the earlier the worse.
        let badness = if is_lost { 1e9 - row.lost_s.unwrap_or(0.0) } else { error_m };
        let place = self.worst.partition_point(|(other, _)| *other >= badness);
        if place < view.worst {
            self.worst.insert(place, (badness, row.clone()));
            self.worst.truncate(view.worst);
        }
    }

    fn summary(self, law: &str, folder: &Path, names: &[String], view: &View) -> LawSummary {
        let flights = self.max_error_m.len() as u64;
        let rates = (flights > 0).then(|| (self.successes as f64 / flights as f64, wilson(self.successes, flights)));
        let error_ranks = ranks(&self.max_error_m);
        let mut matters: Vec<Matter> = names
            .iter()
            .zip(&self.drawn)
            .filter_map(|(figure, drawn)| {
                let ranks = ranks(drawn);
                let rank_correlation = spearman(&ranks, &error_ranks)?;
                let Explained { share, beyond_chance } = explained(&ranks, &error_ranks)?;
                let beyond_chance = beyond_chance || is_correlated(rank_correlation, flights);
                Some(Matter { figure: figure.clone(), explained: share, rank_correlation, beyond_chance })
            })
            .collect();
        // A few flights tell a line better than their parts do.
        let weight = |matter: &Matter| matter.explained.max(matter.rank_correlation.powi(2));
        matters.sort_by(|a, b| weight(b).total_cmp(&weight(a)));
        let percentiles = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            PERCENT.map(|percent| quantile(&values, 0.01 * percent).filter(|value| value.is_finite()))
        };
        LawSummary {
            law: law.to_owned(),
            flights,
            successes: self.successes,
            lost: self.lost,
            refused: self.refused,
            success_rate: rates.map(|(rate, _)| rate),
            success_interval_95: rates.map(|(_, interval)| interval),
            iae_m_s: percentiles(self.iae_m_s),
            max_error_m: percentiles(self.max_error_m),
            worst: self.worst.iter().take(view.worst).map(|(_, row)| Worst::of(row, folder)).collect(),
            matters,
        }
    }
}

impl Worst {
    fn of(row: &Row, folder: &Path) -> Self {
        let (run, law) = (row.run, row.law.name());
        let dir = folder.display().to_string();
        let dir = as_argument(&dir);
        Self {
            run,
            seed: row.seed,
            lost_s: row.lost_s,
            max_error_m: row.max_error_m,
            replay: format!("quatrack campaign replay {dir} --run {run} --law {law} --plot run-{run}-{law}.svg"),
        }
    }
}

/// A path as a shell and the command take it.
fn as_argument(path: &str) -> String {
    let path = if path.starts_with('-') { format!("./{path}") } else { path.to_owned() };
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+,:@%=".contains(c);
    if path.chars().all(is_plain) { path } else { format!("'{}'", path.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_gets_the_path_as_it_is() {
        for path in
            ["a&b", "x;y", "(a)", "#a", "a*", "it's", "two words", "a\"b", "$HOME", "-dash", "~a", "a`b", "plain/a-1.b"]
        {
            let echoed =
                std::process::Command::new("sh").args(["-c", &format!("printf %s {}", as_argument(path))]).output();
            let expected = if path.starts_with('-') { format!("./{path}") } else { path.to_owned() };
            assert_eq!(String::from_utf8(echoed.unwrap().stdout).unwrap(), expected);
        }
    }
}
