//! A scenario's file with distributions in; a campaign, every distribution's ends and every law looked at, out.

use std::path::Path;

use quatrack_plan::bounded;
use quatrack_simulation::scenario::file::ScenarioFile;
use quatrack_simulation::scenario::{CourseChoice, Scenario, ScenarioError};
use toml::{Table, Value};

use super::{Asked, Campaign, Trajectories};
use crate::error::CampaignError;
use crate::vary::{self, Varied};

impl Campaign {
    /// From a scenario's file.
    ///
    /// # Errors
    /// [`CampaignError`], also for a distribution that reaches beyond a scenario's range.
    pub fn read(path: &Path, asked: &Asked, trajectories: Trajectories<'_>) -> Result<Self, CampaignError> {
        let text =
            bounded::read_to_string(path).map_err(|error| CampaignError::file(path, "cannot be read", &error))?;
        Self::of_text(&text, path, asked, trajectories)
    }

    /// The same from the text of such a file; the path says where it lies.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn of_text(
        text: &str,
        path: &Path,
        asked: &Asked,
        trajectories: Trajectories<'_>,
    ) -> Result<Self, CampaignError> {
        let origin = path.display().to_string();
        // For its line numbers.
        let file = ScenarioFile::parse(text, &origin)?;
        if let Some(seed) = file.seed.filter(|seed| i64::try_from(*seed).is_err()) {
            let reason = format!("seed = {seed}: must be at most {} for a campaign", i64::MAX);
            return Err(CampaignError::Asked(format!("{origin}: {reason}")));
        }
        let mut whole: Table = toml::from_str(text).map_err(|error| CampaignError::Vary {
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

    /// Every figure at both its ends and in its middle, or at every number of a choice: every draw has to be one that a scenario
    /// takes. The others are in their middles; or, if that is refused, as the file has them.
    fn look_at_bounds(&self) -> Result<(), CampaignError> {
        let mut middles = self.nominal.clone();
        for varied in self.varied.iter().filter(|varied| !varied.relative) {
            // There was a place for it, or its own turn says why not.
            let _ = varied.put(&mut middles, varied.kind.middle());
        }
        for varied in &self.varied {
            for number in varied.kind.to_look_at() {
                self.look_at(varied, number, &middles)
                    .or_else(|fault| self.look_at(varied, number, &self.nominal).map_err(|_| fault))?;
            }
        }
        Ok(())
    }

    /// One figure at one number, beside the others.
    fn look_at(&self, varied: &Varied, number: f64, others: &Table) -> Result<(), CampaignError> {
        let refused =
            |key: &Varied, reason| CampaignError::Vary { origin: self.origin.clone(), key: key.name(), reason };
        let mut table = others.clone();
        varied.put(&mut table, number).map_err(|reason| refused(varied, reason))?;
        let file = Self::file(table).map_err(|reason| refused(varied, reason))?;
        let Err(error) = self.checked_file(&file) else { return Ok(()) };
        let why = self.reason(&error);
        // Another one in its middle may be at fault.
        let blamed =
            self.varied.iter().find(|other| why.starts_with(&format!("{} = ", other.name()))).unwrap_or(varied);
        let drawn = if blamed == varied { number } else { blamed.kind.middle() };
        Err(refused(blamed, format!("can draw {drawn}: {why}; {}", blamed.kind.remedy())))
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
        let bytes = if key == "course" { with_its_vehicle(&path, bytes, origin, &mut files)? } else { bytes };
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

/// The name of the vehicle's file that bounds a course.
const OF_COURSE: &str = "course-vehicle.toml";

/// A course with the vehicle's file that bounds it under a name of its own beside it, if it is a plan with one; else as it is.
fn with_its_vehicle(
    path: &Path,
    bytes: Vec<u8>,
    origin: &str,
    files: &mut Vec<(String, Vec<u8>)>,
) -> Result<Vec<u8>, ScenarioError> {
    let Some(mut plan) = std::str::from_utf8(&bytes).ok().and_then(|text| text.parse::<Table>().ok()) else {
        return Ok(bytes);
    };
    let vehicle = plan.get_mut("bounds").and_then(|bounds| bounds.get_mut("vehicle"));
    let Some((vehicle, name)) =
        vehicle.and_then(|vehicle| vehicle.as_str().map(str::to_owned).map(|name| (vehicle, name)))
    else {
        return Ok(bytes);
    };
    let there = path.with_file_name(&name);
    if there.extension().is_none_or(|end| end != "toml") {
        return Ok(bytes);
    }
    let of_vehicle = bounded::read(&there).map_err(|error| ScenarioError::Named {
        origin: origin.to_owned(),
        key: "course",
        reason: format!("{}: bounds.vehicle = {name:?}: cannot be read ({error})", path.display()),
    })?;
    files.push((OF_COURSE.to_owned(), of_vehicle));
    *vehicle = Value::String(OF_COURSE.to_owned());
    Ok(plan.to_string().into_bytes())
}
