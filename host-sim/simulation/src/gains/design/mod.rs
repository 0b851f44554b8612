//! A design: the entries of its file in; a problem whose numbers are in range and belong together out.

mod actuator_aware;
mod along;
mod cascade;
mod entry;
mod method;
mod problem;
mod region;
mod weights;

use std::path::Path;

use quatrack::gains::table::Name;
use quatrack::nalgebra::Vector3;
use quatrack::{Limits, Rate};

pub use problem::{IdentifiedBound, Method, Problem};

use entry::{check, positive};
use quatrack_design::certify::Minimum;
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::bounded;

use super::GainsError;
use super::file::{self, DesignFile, LimitsEntry, MinimumEntry};
use crate::vehicles;

/// A design that has been read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Name of the design and of its table: that of the file.
    pub name: Name,
    /// Its purpose, in its author's words.
    pub description: String,
    /// The vehicle that it is for.
    pub vehicle: Vehicle,
    /// Model, method and their numbers.
    pub problem: Problem,
    /// Rate of the control loop.
    pub rate: Rate,
    /// Gain of the vehicle's body rate loop, 1/s, for lag limits behind it.
    pub rate_loop_gain_1_s: Option<f64>,
    /// The limits of commands.
    pub limits: Limits,
    /// The least that its certificate must show.
    pub minimum: Minimum,
}

impl Design {
    /// Reads a design; paths in it are relative to its folder.
    ///
    /// # Errors
    /// [`GainsError`], with the key, its value and its range.
    pub fn from_file(path: &Path) -> Result<Self, GainsError> {
        let text =
            bounded::read_to_string(path).map_err(|error| GainsError::Unreadable { reason: error.to_string() })?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        Self::from_toml(&name, &text, path.parent().unwrap_or(Path::new("")))
    }

    /// A design from the text of its file; paths in it are relative to `folder`.
    ///
    /// # Errors
    /// As [`Self::from_file`].
    pub fn from_toml(name: &str, text: &str, folder: &Path) -> Result<Self, GainsError> {
        let file = file::read(text)?;
        let name = Name::new(name).map_err(GainsError::Name)?;
        let vehicle = vehicle(&file.vehicle, folder)?;
        Self::of(&file, name, vehicle, folder)
    }

    /// A design from the text of one, for this vehicle instead of the one that the text names; the table has the
    /// vehicle's name.
    ///
    /// # Errors
    /// As [`Self::from_file`].
    pub fn for_vehicle(vehicle: &Vehicle, text: &str) -> Result<Self, GainsError> {
        let name = Name::new(vehicle.name()).map_err(GainsError::VehicleName)?;
        Self::of(&file::read(text)?, name, vehicle.clone(), Path::new(""))
    }

    fn of(file: &DesignFile, name: Name, vehicle: Vehicle, folder: &Path) -> Result<Self, GainsError> {
        let rate = Rate::from_hz(file.control_rate_hz).ok_or_else(|| {
            let must = format!("from {} to {} control steps a second", Rate::MIN_HZ, Rate::MAX_HZ);
            GainsError::Value { key: "control_rate_hz".into(), value: file.control_rate_hz.to_string(), must }
        })?;
        if let Some(gain) = file.rate_loop_gain_1_s {
            positive("rate_loop_gain_1_s", gain)?;
        }
        Ok(Self {
            name,
            description: file.description.trim().to_owned(),
            problem: method::problem(file, &vehicle, folder, rate)?,
            limits: limits(&file.limits, &vehicle, &file.vehicle)?,
            vehicle,
            rate,
            rate_loop_gain_1_s: file.rate_loop_gain_1_s,
            minimum: minimum(&file.minimum)?,
        })
    }
}

fn vehicle(written: &str, folder: &Path) -> Result<Vehicle, GainsError> {
    let refused = |reason: String| GainsError::Vehicle { vehicle: written.to_owned(), reason };
    let vehicle = if written.ends_with(".toml") {
        vehicles::from_file(&folder.join(written))
    } else {
        vehicles::by_name(written)
    }
    .map_err(|error| refused(error.to_string()))?;
    Name::new(vehicle.name()).map_err(|error| refused(format!("its {error}")))?;
    Ok(vehicle)
}

/// The vehicle's limits, or tighter ones.
fn limits(entry: &LimitsEntry, vehicle: &Vehicle, written: &str) -> Result<Limits, GainsError> {
    let refused = |reason: String| GainsError::Vehicle { vehicle: written.to_owned(), reason };
    let whole = vehicles::limits(vehicle).map_err(|error| refused(error.to_string()))?;
    let (least, most) = (f64::from(whole.thrust_min_m_s2()), f64::from(whole.thrust_max_m_s2()));
    let min = entry.thrust_min_m_s2.unwrap_or(least);
    let max = entry.thrust_max_m_s2.unwrap_or(most);
    let hover = quatrack_design::model::GRAVITY_M_S2;
    check((least..hover).contains(&min), "limits.thrust_min_m_s2", min, format!("from {least} to below g = {hover}"))?;
    check(max > hover && max <= most, "limits.thrust_max_m_s2", max, format!("above g = {hover}, up to {most}"))?;
    let held = whole.body_rates_max_rad_s().map(f64::from);
    let rates = entry.body_rates_max_rad_s.map_or(held, Vector3::from);
    for (rate, most) in rates.iter().zip(held.iter()) {
        check(*rate > 0.0 && rate <= most, "limits.body_rates_max_rad_s", *rate, format!("above 0, up to {most}"))?;
    }
    Limits::new(min as f32, max as f32, rates.map(|rate| rate as f32)).map_err(|error| refused(error.to_string()))
}

fn minimum(entry: &MinimumEntry) -> Result<Minimum, GainsError> {
    let within = |key: &str, value: Option<f64>, above: f64, most: f64| {
        value.map_or(Ok(()), |value| {
            let must = format!("above {above}, up to {most}; leave it out to ask for nothing");
            check(value > above && value <= most, &format!("minimum.{key}"), value, must)
        })
    };
    within("gain_factor_each", entry.gain_factor_each, 1.0, 1e3)?;
    within("gain_factor_all", entry.gain_factor_all, 1.0, 1e3)?;
    within("phase_each_deg", entry.phase_each_deg, 0.0, 180.0)?;
    within("phase_all_deg", entry.phase_all_deg, 0.0, 180.0)?;
    within("delay_ms", entry.delay_ms, 0.0, 1e4)?;
    within("motor_lag_ms", entry.motor_lag_ms, 0.0, 1e4)?;
    within("decay_1_s", entry.decay_1_s, 0.0, 1e4)?;
    Ok(Minimum {
        gain_factor_each: entry.gain_factor_each,
        gain_factor_all: entry.gain_factor_all,
        phase_each_rad: entry.phase_each_deg.map(f64::to_radians),
        phase_all_rad: entry.phase_all_deg.map(f64::to_radians),
        delay_s: entry.delay_ms.map(|value| value * 1e-3),
        lag_s: entry.motor_lag_ms.map(|value| value * 1e-3),
        decay_1_s: entry.decay_1_s,
        ..Minimum::default()
    })
}
