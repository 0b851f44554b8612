//! `--limits`: a vehicle's name or three numbers in, the core's limits out.

use std::str::FromStr;

use quatrack::Limits;
use quatrack::nalgebra::Vector3;
use quatrack_simulation::vehicles;

use super::names::did_you_mean;

/// Limits by vehicle or by numbers.
#[derive(Clone, Debug)]
pub(crate) struct LimitsChoice {
    /// The name that was given.
    pub(crate) name: String,
    /// The limits of a command.
    pub(crate) limits: Limits,
}

impl LimitsChoice {
    /// Limits that cut nothing.
    pub(crate) fn none() -> Self {
        Self { name: String::from("none"), limits: Limits::NONE }
    }
}

impl FromStr for LimitsChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "none" {
            return Ok(Self::none());
        }
        let name = text.to_owned();
        if let Ok(vehicle) = vehicles::by_name(text) {
            return Ok(Self { name, limits: vehicles::limits(&vehicle).map_err(|error| error.to_string())? });
        }
        let numbers: Result<Vec<f32>, _> = text.split(',').map(|number| number.trim().parse()).collect();
        let Ok([min, max, rate]) = numbers.as_deref() else {
            return Err(format!(
                "neither a vehicle ({}), none, nor THRUST_MIN,THRUST_MAX,RATE_MAX in m/s^2 and rad/s{}",
                vehicles::names().join(", "),
                did_you_mean(text, vehicles::names())
            ));
        };
        let limits = Limits::new(*min, *max, Vector3::new(*rate, *rate, *rate)).map_err(|error| error.to_string())?;
        Ok(Self { name, limits })
    }
}
