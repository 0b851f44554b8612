//! Distributions over the figures of a scenario: the table `[vary]` in; which figures are drawn, and how, out.
//!
//! ```toml
//! [vary]
//! speed_m_s = { uniform = [1.5, 2.5] }
//! errors.lag_ms = { normal = [67.0, 10.0], min = 20.0, max = 150.0 }      # mean, deviation
//! errors.inertia_factor = { log_normal = [1.0, 0.1] }                     # median, deviation of the logarithm
//! errors.delay_ms = { choice = [0.0, 5.0, 10.0] }
//! air.drag_per_s = { uniform = [0.8, 1.2], relative = true }              # times the figure in the file
//! air.wind_m_s = [{ uniform = [-1.0, 1.0] }, { uniform = [-1.0, 1.0] }, 0.0]
//! ```

mod written;

use toml::{Table, Value};

use crate::draws::Draws;
use written::{EXAMPLE, distribution, finite, is_distribution};

/// Farthest that a normal draw lies from its mean, in deviations; a draw beyond, two in a billion, is taken again.
const FARTHEST: f64 = 6.0;
/// Least share of a distribution that its bounds may leave: every hundredth draw at least is within them.
const SHARE_LEAST: f64 = 0.01;
/// How often a draw beyond its bounds is repeated; that of [`SHARE_LEAST`] fails all of them once in 10^43.
const TRIES: u32 = 10_000;

/// A distribution.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// Between two numbers.
    Uniform([f64; 2]),
    /// By mean and standard deviation, within bounds.
    Normal([f64; 2], [f64; 2]),
    /// Its logarithm normal: by median and the logarithm's deviation, within bounds.
    LogNormal([f64; 2], [f64; 2]),
    /// One of them, each as likely as the others.
    Choice(Vec<f64>),
}

/// A figure that is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Varied {
    /// Its keys from the outermost table inwards.
    pub path: Vec<String>,
    /// Which number of a list; all of them where absent.
    pub index: Option<usize>,
    /// Its distribution.
    pub kind: Kind,
    /// Whether it is a factor of the figure in the file.
    pub relative: bool,
}

impl Kind {
    /// Least and most that can be drawn.
    pub fn bounds(&self) -> [f64; 2] {
        match self {
            Self::Uniform(ends) => *ends,
            Self::Normal(_, bounds) | Self::LogNormal(_, bounds) => *bounds,
            Self::Choice(values) => [
                values.iter().copied().fold(f64::INFINITY, f64::min),
                values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            ],
        }
    }

    /// The middle of what can be drawn; of a choice the first.
    pub fn middle(&self) -> f64 {
        match self {
            Self::Uniform([least, most]) => 0.5 * least + 0.5 * most,
            Self::Normal([middle, _], [least, most]) | Self::LogNormal([middle, _], [least, most]) => {
                middle.max(*least).min(*most)
            }
            Self::Choice(values) => values.first().copied().unwrap_or_default(),
        }
    }

    /// The numbers that a scenario has to take so that it takes every draw: all of a choice, of the others both ends and the middle.
    pub fn to_look_at(&self) -> Vec<f64> {
        let [least, most] = self.bounds();
        if let Self::Choice(values) = self { values.clone() } else { vec![least, self.middle(), most] }
    }

    /// What to do about a number that no scenario takes.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Choice(_) => "leave it out",
            Self::Uniform(_) => "narrow the distribution, or write the numbers that may be as a choice",
            Self::Normal(..) | Self::LogNormal(..) => "narrow the distribution, or give it min and max",
        }
    }

    fn draw(&self, draws: &mut Draws) -> f64 {
        let within = |[least, most]: [f64; 2], mut value: Box<dyn FnMut() -> f64 + '_>| {
            let mut drawn = value();
            for _ in 0..TRIES {
                if (least..=most).contains(&drawn) {
                    break;
                }
                drawn = value();
            }
            drawn.max(least).min(most)
        };
        match self {
            Self::Uniform([least, most]) => least + (most - least) * draws.uniform(),
            Self::Normal([mean, deviation], bounds) => within(*bounds, Box::new(|| mean + deviation * draws.normal())),
            Self::LogNormal([median, deviation], bounds) => {
                within(*bounds, Box::new(|| median * (deviation * draws.normal()).exp()))
            }
            Self::Choice(values) => values[((draws.uniform() * values.len() as f64) as usize).min(values.len() - 1)],
        }
    }
}

impl Varied {
    /// As columns and summaries call it: `errors.lag_ms`, `air.wind_m_s.0`.
    pub fn name(&self) -> String {
        let path = self.path.join(".");
        self.index.map_or_else(|| path.clone(), |index| format!("{path}.{index}"))
    }

    /// Its value in a run of a campaign: the drawn number.
    pub fn drawn(&self, seed: u64, run: u64) -> f64 {
        self.kind.draw(&mut Draws::new(seed, run, &self.name()))
    }

    /// Whether a scenario has the figure itself.
    fn is_stated(&self, scenario: &Table) -> bool {
        let Some((last, tables)) = self.path.split_last() else { return false };
        let table = tables.iter().try_fold(scenario, |table, key| table.get(key).and_then(Value::as_table));
        let own = table.and_then(|table| table.get(last));
        match (self.index, own) {
            (Some(index), Some(Value::Array(list))) => index < list.len(),
            (_, own) => own.is_some(),
        }
    }

    /// Puts a drawn number into a scenario's table.
    ///
    /// # Errors
    /// Why there is no place for it.
    pub fn put(&self, scenario: &mut Table, drawn: f64) -> Result<(), String> {
        let Some((last, tables)) = self.path.split_last() else { return Err("a figure has a name".to_owned()) };
        let mut table = scenario;
        for key in tables {
            let entry = table.entry(key.clone()).or_insert_with(|| Value::Table(Table::new()));
            if key == "air" && entry.as_str() == Some("vehicle") {
                // The same by its other form, which has room for figures.
                *entry = Value::Table(Table::from_iter([("of".to_owned(), Value::String("vehicle".to_owned()))]));
            }
            table = entry.as_table_mut().ok_or_else(|| format!("{key} is no table in the scenario"))?;
        }
        let own = table.get(last);
        let number = |value: &Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
        let factor = |own: Option<&Value>| match (self.relative, own.and_then(number)) {
            (false, _) => Ok(drawn),
            (true, Some(own)) => Ok(own * drawn),
            (true, None) => Err("relative = true needs the figure itself in the scenario; add it".to_owned()),
        };
        let value = match (self.index, own.and_then(Value::as_array)) {
            (None, Some(list)) => {
                Value::Array(list.iter().map(|own| factor(Some(own)).map(Value::Float)).collect::<Result<_, _>>()?)
            }
            (None, None) => Value::Float(factor(own)?),
            (Some(index), list) => {
                let mut list = list.cloned().unwrap_or_default();
                let value = factor(list.get(index))?;
                while list.len() <= index {
                    list.push(Value::Float(0.0));
                }
                list[index] = Value::Float(value);
                Value::Array(list)
            }
        };
        table.insert(last.clone(), value);
        Ok(())
    }
}

/// All figures of a table `[vary]`, in the order of their names; fixed numbers within lists are put into the scenario.
///
/// # Errors
/// The figure's name, and why not.
pub fn all(vary: &Table, scenario: &mut Table) -> Result<Vec<Varied>, (String, String)> {
    let mut found = Vec::new();
    walk(vary, &mut Vec::new(), scenario, &mut found)?;
    let mut places: Vec<(u32, String)> =
        found.iter().map(Varied::name).map(|name| (crate::draws::place(&name), name)).collect();
    places.sort();
    if let Some(pair) = places.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err((pair[1].1.clone(), format!("draws the numbers of {}; leave out one of them", pair[0].1)));
    }
    Ok(found)
}

fn walk(
    vary: &Table,
    path: &mut Vec<String>,
    scenario: &mut Table,
    found: &mut Vec<Varied>,
) -> Result<(), (String, String)> {
    for (key, value) in vary {
        let depth = path.len();
        // A quoted key, as a dictionary has it, is a path as well.
        path.extend(key.split('.').map(str::to_owned));
        let refused = |reason: String| (path.join("."), reason);
        if ["seed", "vary", "laws", "law"].contains(&path[0].as_str()) {
            return Err(refused("is not drawn: seeds are a campaign's own, laws are in laws = [...]".to_owned()));
        }
        match value {
            Value::Table(table) if is_distribution(table) => {
                let (kind, relative) = distribution(table).map_err(refused)?;
                found.push(Varied { path: path.clone(), index: None, kind, relative });
            }
            Value::Table(table) => walk(table, path, scenario, found)?,
            Value::Array(list) if !list.iter().any(|entry| entry.as_table().is_some_and(is_distribution)) => {
                return Err(refused(format!("{value} holds no distribution; {EXAMPLE}")));
            }
            Value::Array(list) => {
                for (index, entry) in list.iter().enumerate() {
                    let one = |kind, relative| Varied { path: path.clone(), index: Some(index), kind, relative };
                    match entry {
                        Value::Table(table) if is_distribution(table) => {
                            let (kind, relative) = distribution(table).map_err(refused)?;
                            let varied = one(kind, relative);
                            // The scenario's list is whole, also before anything is drawn.
                            if !varied.is_stated(scenario) && !relative {
                                varied.put(scenario, varied.kind.middle()).map_err(refused)?;
                            }
                            found.push(varied);
                        }
                        Value::Integer(_) | Value::Float(_) => {
                            let fixed = finite(entry).map_err(refused)?;
                            one(Kind::Choice(vec![fixed]), false).put(scenario, fixed).map_err(refused)?;
                        }
                        _ => return Err(refused("a list holds distributions and numbers".to_owned())),
                    }
                }
            }
            _ => return Err(refused(format!("{value} is no distribution; {EXAMPLE}"))),
        }
        path.truncate(depth);
    }
    Ok(())
}

#[cfg(test)]
mod tests;
