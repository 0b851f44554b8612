//! Vehicles by name or from TOML files, and the part that the core keeps of them: limits in f32 and a number that tells
//! them apart.
//!
//! The built-in ones are in `gains/vehicles`, each figure with its source beside it.

mod error;

use std::path::Path;
use std::sync::OnceLock;

use quatrack::Limits;
use quatrack::checksum::crc32c;
use quatrack_design::vehicle::{Vehicle, VehicleError, VehicleFile};
use quatrack_plan::bounded;
use quatrack_plan::quote::{line_of, one_line};

pub use error::VehicleFileError;

/// The built-in vehicles, each by its own name.
const BUILT_IN: [(&str, &str); 4] = [
    ("crazyflie-2.1", include_str!("../../../../gains/vehicles/crazyflie-2.1.toml")),
    ("crazyflie-2.1-upgrade-kit", include_str!("../../../../gains/vehicles/crazyflie-2.1-upgrade-kit.toml")),
    ("crazyflie-2.1-brushless", include_str!("../../../../gains/vehicles/crazyflie-2.1-brushless.toml")),
    ("crazyflie-2.1-brushless-45g", include_str!("../../../../gains/vehicles/crazyflie-2.1-brushless-45g.toml")),
];

/// Names of the built-in vehicles.
pub fn names() -> [&'static str; 4] {
    BUILT_IN.map(|(name, _)| name)
}

/// A built-in vehicle, by one of [`names`].
///
/// # Errors
/// [`VehicleFileError::Unknown`].
pub fn by_name(name: &str) -> Result<Vehicle, VehicleFileError> {
    let (_, text) = BUILT_IN
        .iter()
        .find(|(known, _)| *known == name)
        .ok_or_else(|| VehicleFileError::Unknown { name: name.to_owned(), known: names().join(", ") })?;
    from_toml(text)
}

/// Whether a vehicle is a built-in one: its name and all of its figures. A file under a built-in name with figures of its own is
/// another craft.
pub fn is_built_in(vehicle: &Vehicle) -> bool {
    static KNOWN: OnceLock<Vec<Vehicle>> = OnceLock::new();
    let known = KNOWN.get_or_init(|| BUILT_IN.iter().filter_map(|(_, text)| from_toml(text).ok()).collect());
    known.contains(vehicle)
}

/// A vehicle from the text of a file.
///
/// # Errors
/// [`VehicleFileError::Syntax`] for a text that is not TOML of this form; [`VehicleFileError::Refused`] for a figure out of
/// range.
pub fn from_toml(text: &str) -> Result<Vehicle, VehicleFileError> {
    let file: VehicleFile = toml::from_str(text).map_err(|error| syntax(text, &error))?;
    Ok(Vehicle::try_from(file)?)
}

/// A vehicle as the text of a file, of which [`from_toml`] makes the same vehicle to the bit.
///
/// # Errors
/// [`VehicleFileError::Unwritable`].
pub fn to_toml(vehicle: &Vehicle) -> Result<String, VehicleFileError> {
    toml::to_string(&VehicleFile::from(vehicle))
        .map_err(|error| VehicleFileError::Unwritable { reason: one_line(&error.to_string()) })
}

/// A vehicle from a file.
///
/// # Errors
/// [`VehicleFileError::Unreadable`], and [`VehicleFileError::File`] around those of [`from_toml`].
pub fn from_file(path: &Path) -> Result<Vehicle, VehicleFileError> {
    let text = bounded::read_to_string(path)
        .map_err(|error| VehicleFileError::Unreadable { path: path.to_owned(), reason: error.to_string() })?;
    from_toml(&text).map_err(|error| VehicleFileError::File { path: path.to_owned(), error: Box::new(error) })
}

/// The limits of commands of thrust and body rates on board.
///
/// # Errors
/// [`VehicleError::Value`] where a limit vanishes in the rounding to f32.
pub fn limits(vehicle: &Vehicle) -> Result<Limits, VehicleError> {
    let [min, max] = vehicle.thrust_limits_m_s2().map(|value| value as f32);
    let body_rates_rad_s = vehicle.body_rates_max_rad_s();
    Limits::new(min, max, body_rates_rad_s.map(|value| value as f32)).map_err(|_| VehicleError::Value {
        field: "limits.body_rates_rad_s".to_owned(),
        value: body_rates_rad_s.min(),
        must: "large enough for an f32".to_owned(),
    })
}

/// CRC-32C of a vehicle's name and figures, each rounded to f32, lowest byte first: mass; inertia xx, xy, xz, yy, yz, zz;
/// arm, least and most thrust, torque per thrust, lag; body rates. It tells a table whether it was made for this vehicle.
pub fn id(vehicle: &Vehicle) -> u32 {
    let (i, m, rates) = (vehicle.inertia_kg_m2(), vehicle.motors(), vehicle.body_rates_max_rad_s());
    let inertia = [i.m11, i.m12, i.m13, i.m22, i.m23, i.m33];
    let motors = [m.arm_m, m.thrust_min_n, m.thrust_max_n, m.torque_per_thrust_m, m.lag_s];
    let figures = [vehicle.mass_kg()].into_iter().chain(inertia).chain(motors).chain(rates.iter().copied());
    let mut bytes = vehicle.name().as_bytes().to_vec();
    bytes.extend(figures.flat_map(|figure| (figure as f32).to_le_bytes()));
    crc32c(&bytes)
}

fn syntax(text: &str, error: &toml::de::Error) -> VehicleFileError {
    VehicleFileError::Syntax { line: line_of(text, error), reason: one_line(error.message()) }
}
