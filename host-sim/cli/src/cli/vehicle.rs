//! `--vehicle`: a built-in name or a TOML file in, the vehicle out.

use std::path::Path;
use std::str::FromStr;

use quatrack_design::vehicle::Vehicle;
use quatrack_simulation::vehicles;

use super::names::did_you_mean;

/// A vehicle as it was asked for.
#[derive(Clone, Debug)]
pub(crate) struct VehicleChoice(pub(crate) Vehicle);

impl FromStr for VehicleChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let path = Path::new(text);
        let found = if path.extension().is_some_and(|end| end == "toml") {
            vehicles::from_file(path)
        } else {
            vehicles::by_name(text)
        };
        found.map(Self).map_err(|error| format!("{error}{}", did_you_mean(text, vehicles::names())))
    }
}
