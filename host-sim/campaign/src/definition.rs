//! The flights of a campaign: a scenario with distributions and laws in; the scenario of run k out.

use std::path::{Path, PathBuf};

use quatrack_design::vehicle::Vehicle;
use quatrack_plan::bounded;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::scenario::file::ScenarioFile;
use quatrack_simulation::scenario::{CourseChoice, Law, Scenario, ScenarioError};
use sha2::{Digest as _, Sha256};
use toml::{Table, Value};

use crate::draws::Draws;
use crate::error::CampaignError;
use crate::vary::{self, Varied};

/// Makes a trajectory of a name or a path.
pub type Trajectories<'a> = &'a dyn Fn(&str) -> Result<PiecewisePolynomial, String>;

/// Choices that go before those of the file.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// The campaign's seed; the scenario's own, or 1, where absent.
    pub seed: Option<u64>,
    /// The laws; the scenario's where empty.
    pub laws: Vec<Law>,
}

/// A campaign that can be flown.
pub struct Campaign {
    /// The scenario with its distributions, laws and seed, as it is stored; the same for the same campaign.
    text: String,
    /// Files that it names, by the names that it has for them.
    files: Vec<(String, Vec<u8>)>,
    origin: String,
    folder: PathBuf,
    nominal: Table,
    varied: Vec<Varied>,
    laws: Vec<Law>,
    seed: u64,
    trajectory: Option<PiecewisePolynomial>,
    /// The vehicle of all runs, once it has been read.
    vehicle: Option<Vehicle>,
}

/// One run: its scenario and the numbers that were drawn for it.
pub struct Run {
    /// The scenario that every law flies.
    pub scenario: Result<Scenario, ScenarioError>,
    /// The drawn figures, in the campaign's order.
    pub drawn: Vec<f64>,
    /// Seed of noise and gusts.
    pub seed: u64,
}

impl Campaign {
    /// From a scenario's file.
    ///
    /// # Errors
    /// [`CampaignError`], also for a distribution that reaches beyond a scenario's range.
    pub fn read(path: &Path, asked: &Asked, trajectories: Trajectories<'_>) -> Result<Self, CampaignError> {
        let origin = path.display().to_string();
        let text =
            bounded::read_to_string(path).map_err(|error| CampaignError::file(path, "cannot be read", &error))?;
        // For its line numbers.
        let file = ScenarioFile::parse(&text, &origin)?;
        let mut whole: Table = toml::from_str(&text).map_err(|error| CampaignError::Vary {
            origin: origin.clone(),
            key: String::new(),
            reason: error.message().to_owned(),
        })?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let seed = asked.seed.or(file.seed).unwrap_or(1);
        let whole_seed = i64::try_from(seed)
            .map_err(|_| CampaignError::Asked(format!("--seed {seed}: must be at most {}", i64::MAX)))?;
        let laws = match (asked.laws.is_empty(), &file.laws) {
            (false, _) => asked.laws.clone(),
            (true, Some(laws)) if !laws.is_empty() => laws.clone(),
            (true, _) => vec![file.law.unwrap_or_default()],
        };
        if let Some(law) = laws.iter().enumerate().find(|(i, law)| laws[..*i].contains(law)).map(|(_, law)| law) {
            return Err(CampaignError::Asked(format!("{}: is among the laws twice; leave one out", law.name())));
        }
        let files = gather(&mut whole, &folder, &origin)?;
        let names = laws.iter().map(|law| Value::String(law.name().to_owned())).collect();
        whole.insert("laws".to_owned(), Value::Array(names));
        whole.insert("seed".to_owned(), Value::Integer(whole_seed));
        whole.remove("law");
        let text = whole.to_string();
        let mut nominal = whole;
        nominal.remove("laws");
        let vary = nominal.remove("vary").and_then(|vary| vary.as_table().cloned()).unwrap_or_default();
        let varied = vary::all(&vary, &mut nominal).map_err(|(key, reason)| CampaignError::Vary {
            origin: origin.clone(),
            key,
            reason,
        })?;
        let mut campaign =
            Self { text, files, origin, folder, nominal, varied, laws, seed, trajectory: None, vehicle: None };
        // Where its file lies now, under its own name.
        let of_vehicle = ScenarioFile::of_vehicle(&file.vehicle);
        campaign.vehicle = Some(Scenario::checked(&of_vehicle, &campaign.origin, &campaign.folder)?.vehicle);
        campaign.nominal()?;
        campaign.look_at_bounds()?;
        campaign.look_at_laws(trajectories, &file)?;
        Ok(campaign)
    }

    /// Every figure at both its ends, the others as they are: so that every drawn figure is one that a scenario takes.
    fn look_at_bounds(&self) -> Result<(), CampaignError> {
        for varied in &self.varied {
            for end in varied.kind.bounds() {
                let mut table = self.nominal.clone();
                let refused =
                    |reason: String| CampaignError::Vary { origin: self.origin.clone(), key: varied.name(), reason };
                varied.put(&mut table, end).map_err(refused)?;
                self.checked(table).map_err(|error| {
                    let line = error.to_string();
                    let why = line.strip_prefix(&format!("{}: ", self.origin)).unwrap_or(&line);
                    refused(format!("can draw {end}: {why}; narrow the distribution, or give it min and max"))
                })?;
            }
        }
        Ok(())
    }

    fn look_at_laws(&mut self, trajectories: Trajectories<'_>, file: &ScenarioFile) -> Result<(), CampaignError> {
        let scenario = self.checked(self.nominal.clone())?;
        if let CourseChoice::Trajectory(_) = &scenario.course {
            // As it was written, where it lies now.
            let name = file.course.clone().unwrap_or_default();
            let path = if CourseChoice::NAMES.contains(&name.as_str()) {
                name.clone()
            } else {
                self.folder.join(&name).display().to_string()
            };
            let made = trajectories(&path);
            self.trajectory = Some(made.map_err(|reason| CampaignError::Trajectory { name, reason })?);
        }
        for law in &self.laws {
            law.start(&scenario.vehicle, &scenario.told)?;
        }
        Ok(())
    }

    fn checked(&self, table: Table) -> Result<Scenario, ScenarioError> {
        let file: ScenarioFile = Value::Table(table).try_into().map_err(|error: toml::de::Error| {
            let words: Vec<&str> = error.message().split_whitespace().collect();
            ScenarioError::Named { origin: self.origin.clone(), key: "vary", reason: words.join(" ") }
        })?;
        match &self.vehicle {
            Some(vehicle) => Scenario::on(vehicle.clone(), &file, &self.origin, &self.folder),
            None => Scenario::checked(&file, &self.origin, &self.folder),
        }
    }

    /// The table of one run: no distributions, every figure as it was drawn, and its seed.
    pub fn table(&self, run: u64) -> (Table, Vec<f64>, u64) {
        let mut table = self.nominal.clone();
        let drawn: Vec<f64> = self.varied.iter().map(|varied| varied.drawn(self.seed, run)).collect();
        for (varied, drawn) in self.varied.iter().zip(&drawn) {
            // There was a place for both its ends.
            let _ = varied.put(&mut table, *drawn);
        }
        let seed = Draws::new(self.seed, run, "seed").seed();
        // 53 bits.
        table.insert("seed".to_owned(), Value::Integer(seed as i64));
        (table, drawn, seed)
    }

    /// The scenario of a run.
    pub fn run(&self, run: u64) -> Run {
        let (table, drawn, seed) = self.table(run);
        Run { scenario: self.checked(table), drawn, seed }
    }

    /// Without anything drawn.
    ///
    /// # Errors
    /// None for a campaign that was read.
    pub fn nominal(&self) -> Result<Scenario, ScenarioError> {
        self.checked(self.nominal.clone())
    }

    /// Names of the drawn figures.
    pub fn drawn_names(&self) -> Vec<String> {
        self.varied.iter().map(Varied::name).collect()
    }

    /// The laws that fly.
    pub fn laws(&self) -> &[Law] {
        &self.laws
    }

    /// Its seed.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The trajectory that is flown, where there is one.
    pub fn trajectory(&self) -> Option<&PiecewisePolynomial> {
        self.trajectory.as_ref()
    }

    /// The scenario's text as it is stored.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Files that the stored text names.
    pub fn files(&self) -> &[(String, Vec<u8>)] {
        &self.files
    }

    /// SHA-256 of everything that its rows depend on but the number of runs, in hexadecimal.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(b"quatrack campaign 1\n");
        hash.update(self.text.as_bytes());
        for (name, bytes) in &self.files {
            hash.update(name.as_bytes());
            hash.update((bytes.len() as u64).to_le_bytes());
            hash.update(bytes);
        }
        hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// The files that a scenario names, under names of their own beside it: a campaign's folder can be taken elsewhere.
fn gather(whole: &mut Table, folder: &Path, origin: &str) -> Result<Vec<(String, Vec<u8>)>, CampaignError> {
    let mut files = Vec::new();
    let mut take = |whole: &mut Table, key: &'static str, stem: &str| {
        let Some(name) = whole.get(key).and_then(Value::as_str).map(str::to_owned) else { return Ok(()) };
        let path = folder.join(&name);
        let bytes = bounded::read(&path).map_err(|error| ScenarioError::Named {
            origin: origin.to_owned(),
            key,
            reason: format!("{name}: cannot be read ({error})"),
        })?;
        let end = path.extension().map_or_else(String::new, |end| format!(".{}", end.display()));
        let own = format!("{stem}{end}");
        whole.insert(key.to_owned(), Value::String(own.clone()));
        files.push((own, bytes));
        Ok::<(), ScenarioError>(())
    };
    if whole.get("vehicle").and_then(Value::as_str).is_some_and(|name| name.ends_with(".toml")) {
        take(whole, "vehicle", "vehicle")?;
    }
    if whole.get("course").and_then(Value::as_str).is_some_and(|name| !CourseChoice::NAMES.contains(&name)) {
        take(whole, "course", "course")?;
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vehicle_file_has_any_name() {
        let dir = tempfile::tempdir().unwrap();
        let vehicle = include_str!("../../../gains/vehicles/crazyflie-2.1-legacy.toml");
        std::fs::write(dir.path().join("mine.toml"), vehicle).unwrap();
        let path = dir.path().join("s.toml");
        std::fs::write(&path, "vehicle = \"mine.toml\"\nlaw = \"lee\"\n").unwrap();
        let campaign = Campaign::read(&path, &Asked::default(), &|name| Err(name.to_owned())).unwrap();
        assert_eq!(campaign.run(3).scenario.unwrap().vehicle.name(), "crazyflie-2.1-legacy");
        // It is kept beside the rows under a name of the campaign's.
        assert!(campaign.text().contains("vehicle.toml") && campaign.files()[0].0 == "vehicle.toml");
    }
}
