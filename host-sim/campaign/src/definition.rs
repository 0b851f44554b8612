//! The flights of a campaign: a scenario with distributions and laws in; the scenario of run k out.

mod read;

use std::path::PathBuf;

use quatrack_design::vehicle::Vehicle;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::scenario::file::ScenarioFile;
use quatrack_simulation::scenario::{Law, Scenario, ScenarioError};
use sha2::{Digest as _, Sha256};
use toml::{Table, Value};

use crate::draws::Draws;
use crate::vary::Varied;

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
    fn checked(&self, table: Table) -> Result<Scenario, ScenarioError> {
        let file = Self::file(table).map_err(|reason| ScenarioError::Named {
            origin: self.origin.clone(),
            key: "vary",
            reason,
        })?;
        self.checked_file(&file)
    }

    /// A scenario's file of its table, or the parser's message.
    fn file(table: Table) -> Result<ScenarioFile, String> {
        let words = |error: toml::de::Error| error.message().split_whitespace().collect::<Vec<_>>().join(" ");
        Value::Table(table).try_into().map_err(words)
    }

    fn checked_file(&self, file: &ScenarioFile) -> Result<Scenario, ScenarioError> {
        match &self.vehicle {
            Some(vehicle) => Scenario::on(vehicle.clone(), file, &self.origin, &self.folder),
            None => Scenario::checked(file, &self.origin, &self.folder),
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

    /// A scenario's error without the name of the campaign's file, which is another one on another machine.
    pub(crate) fn reason(&self, error: &ScenarioError) -> String {
        let line = error.to_string();
        line.strip_prefix(&format!("{}: ", self.origin)).map_or(line.clone(), str::to_owned)
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
