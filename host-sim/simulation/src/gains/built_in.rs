//! The source of the core's own tables of the cascade: their designs in; `core/src/gains/cascade.rs` out.

use std::fmt::Write as _;
use std::path::Path;

use quatrack::gains::table::Certificate;
use thiserror::Error;

use super::GainsError;
use super::artifacts::cascade_source;
use super::design::Design;

/// A craft: the name of its array, its name in words, the place of its default, and its designs with the constant of
/// each, for the shortest lags first.
struct Craft {
    constant: &'static str,
    called: &'static str,
    default: usize,
    designs: [(&'static str, &'static str); 3],
}

const CRAFTS: [Craft; 3] = [
    Craft {
        constant: "BRUSHLESS",
        called: "the Crazyflie 2.1 Brushless",
        default: 1,
        designs: [
            ("BRUSHLESS_20_MS", "cascade-brushless-20ms"),
            ("BRUSHLESS_50_MS", "cascade-brushless-50ms"),
            ("BRUSHLESS_110_MS", "cascade-brushless-110ms"),
        ],
    },
    Craft {
        constant: "CRAZYFLIE_2_1",
        called: "the Crazyflie 2.1",
        default: 2,
        designs: [
            ("CRAZYFLIE_2_1_20_MS", "cascade-20ms"),
            ("CRAZYFLIE_2_1_63_MS", "cascade-63ms"),
            ("CRAZYFLIE_2_1_100_MS", "cascade-100ms"),
        ],
    },
    Craft {
        constant: "UPGRADE_KIT",
        called: "the Crazyflie 2.1 with the thrust upgrade kit",
        default: 2,
        designs: [
            ("UPGRADE_KIT_20_MS", "cascade-kit-20ms"),
            ("UPGRADE_KIT_63_MS", "cascade-kit-63ms"),
            ("UPGRADE_KIT_100_MS", "cascade-kit-100ms"),
        ],
    },
];

/// A design of a built-in table gives none.
#[derive(Debug, Error)]
#[error("gains/{name}.toml: {}", .error.as_ref().map_or_else(|| "not a design of the cascade".to_owned(), ToString::to_string))]
pub struct BuiltInError {
    /// Its name.
    pub name: &'static str,
    /// The reason why it is refused; nothing where it is for another law.
    pub error: Option<GainsError>,
}

/// The source of `core/src/gains/cascade.rs`, of the designs in a folder.
///
/// # Errors
/// [`BuiltInError`] names the design.
pub fn built_in_source(folder: &Path) -> Result<String, BuiltInError> {
    let mut source = String::from(
        "//! The core's own tables of the cascade: made by `cargo gains generate` of the designs in `gains/` and not edited by hand.\n\
         //!\n\
         //! Each is named by craft and by the motor lag that it is designed for. Of a craft, [`CascadeRange::holds_lag`] tells which is\n\
         //! certified for a lag that is stated; the default is for a craft of which none is.\n\
         //!\n\
         //! [`CascadeRange::holds_lag`]: crate::gains::table::CascadeRange::holds_lag\n\n\
         use crate::cascade::{Air, CascadeGains};\n\
         use crate::gains::table::{BuiltInCascade, CascadeRange, CascadeTable, Margins, Name, Vehicle};\n",
    );
    for Craft { constant, called, default, designs } in &CRAFTS {
        // Writing to a string does not fail.
        for (name, design) in designs {
            source += &table(name, design, folder)?;
        }
        let names: Vec<&str> = designs.iter().map(|(name, _)| *name).collect();
        let _ = write!(
            source,
            "\n/// Of {called}, for the shortest lags first.\npub const {constant}: [BuiltInCascade; 3] = [{}];\n\
             \n/// Of {called} where no lag is stated.\npub const {constant}_DEFAULT: BuiltInCascade = {};\n",
            names.join(", "),
            names[*default]
        );
    }
    Ok(source)
}

fn table(constant: &str, name: &'static str, folder: &Path) -> Result<String, BuiltInError> {
    let failed = |error| BuiltInError { name, error: Some(error) };
    let design = Design::from_file(&folder.join(name).with_extension("toml")).map_err(failed)?;
    let certified = design.certify().map_err(failed)?;
    let other = BuiltInError { name, error: None };
    let Some((table, cascade)) = certified.table.as_ref().and_then(|table| Some((table, table.cascade()?))) else {
        return Err(other);
    };
    let vehicle = table.head().vehicle;
    let Certificate { one_channel, delay_max_s, motor_lag_max_s, .. } = table.head().certificate;
    let first = design.description.lines().next().unwrap_or_default();
    let written = cascade_source(cascade, "").replace('\n', "\n    ");
    Ok(format!(
        "\n/// {first}\n/// From `gains/{name}.toml`.\n\
         pub const {constant}: BuiltInCascade = BuiltInCascade {{\n    \
             vehicle: Vehicle {{ name: Name::literal(\"{}\"), id: 0x{:08x} }},\n    \
             table: {written},\n    \
             margins: Margins {{ gain_factor: {:?}, phase_rad: {:?} }},\n    \
             delay_max_s: {delay_max_s:?},\n    \
             motor_lag_max_s: {motor_lag_max_s:?},\n}};\n",
        vehicle.name, vehicle.id, one_channel.gain_factor, one_channel.phase_rad,
    ))
}
