//! Shards: a campaign's runs in equal parts, one after the other.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// One part of several.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    index: u64,
    count: u64,
}

impl Shard {
    /// Everything.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Part `index` of `count`, from 1.
    pub fn new(index: u64, count: u64) -> Option<Self> {
        (1..=count).contains(&index).then_some(Self { index, count })
    }

    /// All parts of a number.
    pub fn all(count: u64) -> impl Iterator<Item = Self> {
        (1..=count).map(move |index| Self { index, count })
    }

    /// Its runs of all.
    pub fn runs(&self, all: u64) -> Range<u64> {
        let bound = |index: u64| (u128::from(all) * u128::from(index) / u128::from(self.count)) as u64;
        bound(self.index - 1)..bound(self.index)
    }

    /// The number of parts.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Its file of rows.
    pub fn file_name(&self) -> String {
        if self.count == 1 { "rows.csv".to_owned() } else { format!("rows-{}-of-{}.csv", self.index, self.count) }
    }

    /// The part whose file of rows has a name.
    pub fn of_file(name: &str) -> Option<Self> {
        let (index, count) = name.strip_prefix("rows-")?.strip_suffix(".csv")?.split_once("-of-")?;
        Self::new(index.parse().ok()?, count.parse().ok()?).filter(|shard| shard.file_name() == name)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        let shard = parts.and_then(|(index, count)| Self::new(index, count));
        shard.ok_or_else(|| "must be i/n with i from 1 to n: 3/8 is the third of eight".to_owned())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_cover_every_run_once() {
        for (runs, count) in [(10, 3), (7, 7), (2, 5), (100_000, 9), (u64::MAX, 2)] {
            let parts: Vec<_> = Shard::all(count).map(|shard| shard.runs(runs)).collect();
            assert_eq!((parts[0].start, parts[parts.len() - 1].end), (0, runs));
            assert!(parts.windows(2).all(|pair| pair[0].end == pair[1].start), "{parts:?}");
        }
    }

    #[test]
    fn a_shard_is_written_as_it_is_read() {
        let shard: Shard = "3/8".parse().unwrap();
        assert_eq!((shard.to_string().as_str(), Shard::of_file(&shard.file_name())), ("3/8", Some(shard)));
        for wrong in ["0/8", "9/8", "3", "a/b", "3/0", "-1/2"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
        assert_eq!(Shard::of_file("rows-03-of-8.csv"), None);
    }
}
