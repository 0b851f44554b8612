//! The map of a log's columns to quantities and their units: three maps that are built in, and anybody's own in TOML.

use serde::Deserialize;

use crate::IdentifyError;

/// A map of columns. `docs/identify.md` describes its keys with an example.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct ColumnMap {
    /// Time; absent in a micro SD deck's log, where every variable has its own.
    pub time: Option<Time>,
    /// Position, world frame, z up.
    pub position: Option<Vector>,
    /// Velocity, world frame.
    pub velocity: Option<Vector>,
    /// Attitude, body to world.
    pub attitude: Attitude,
    /// Gyroscope, body frame: x forwards, y left, z up.
    pub gyroscope: Vector,
    /// Accelerometer, body frame: at rest it shows g upwards.
    pub accelerometer: Vector,
    /// The four motor commands.
    pub motors: Motors,
    /// Voltage of the battery.
    pub voltage: Option<Scalar>,
    /// Position as the craft itself estimates it, compared with `position`.
    pub estimate: Option<Vector>,
    /// The vehicle whose arm, limits and torque per thrust are taken where no other is named.
    pub vehicle: Option<String>,
    /// The mass flown, kg, where no other is given.
    pub mass_kg: Option<f64>,
}

/// A column of times.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Its name.
    pub column: String,
    /// s, ms or us.
    pub unit: String,
}

/// Three columns.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Vector {
    /// Their names.
    pub columns: [String; 3],
    /// m, mm, m/s, mm/s, rad/s, deg/s, mrad/s, m/s^2, g or mg.
    pub unit: String,
}

/// One column.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Scalar {
    /// Its name.
    pub column: String,
    /// V or mV.
    pub unit: String,
}

/// Columns of an attitude.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Attitude {
    /// Their names, in the order of the form.
    pub columns: Vec<String>,
    /// xyzw, wxyz, or roll-pitch-yaw in degrees (`deg`) or radians (`rad`).
    pub form: String,
    /// Unit of the angles.
    pub unit: Option<String>,
    /// Of angles: true where nose up is positive, as the Crazyflie's firmware has it.
    #[serde(default)]
    pub pitch_up_positive: bool,
}

/// Columns of motor commands.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Motors {
    /// Names: front right, rear right, rear left, front left.
    pub columns: [String; 4],
    /// The value of a full command.
    pub full: f64,
}

const BUILT_IN: [(&str, &str); 3] = [
    ("nanobench", include_str!("maps/nanobench.toml")),
    ("cflib", include_str!("maps/cflib.toml")),
    ("usd", include_str!("maps/usd.toml")),
];

impl ColumnMap {
    /// nanobench, cflib or usd.
    pub fn built_in(name: &str) -> Option<Self> {
        let (_, text) = BUILT_IN.iter().find(|(built_in, _)| *built_in == name)?;
        Self::parse(text, name).ok()
    }

    /// Names of the maps that are built in.
    pub fn names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// From the text of a file.
    ///
    /// # Errors
    /// [`IdentifyError::Map`] with the line, or with the unit that is not known.
    pub fn parse(text: &str, origin: &str) -> Result<Self, IdentifyError> {
        let error = |reason: String| IdentifyError::Map { map: origin.to_owned(), reason };
        let map: Self = toml::from_str(text).map_err(|parse_error| {
            let start = parse_error.span().map_or(0, |span| span.start).min(text.len());
            let line = 1 + text.as_bytes()[..start].iter().filter(|byte| **byte == b'\n').count();
            let words: Vec<&str> = parse_error.message().split_whitespace().collect();
            error(format!("line {line}: {}", words.join(" ")))
        })?;
        let known = |unit: &str, of: &str| {
            scale(unit).map(|_| ()).ok_or_else(|| {
                error(format!(
                    "{of}: unit = \"{unit}\" is not known; s, ms, us, m, mm, m/s, mm/s, rad/s, deg/s, mrad/s, m/s^2, g, mg, V and mV are"
                ))
            })
        };
        if let Some(time) = &map.time {
            known(&time.unit, "time")?;
        }
        for (vector, of) in [(&map.position, "position"), (&map.velocity, "velocity"), (&map.estimate, "estimate")] {
            vector.as_ref().map_or(Ok(()), |vector| known(&vector.unit, of))?;
        }
        known(&map.gyroscope.unit, "gyroscope")?;
        known(&map.accelerometer.unit, "accelerometer")?;
        map.voltage.as_ref().map_or(Ok(()), |voltage| known(&voltage.unit, "voltage"))?;
        let count = match map.attitude.form.as_str() {
            "xyzw" | "wxyz" => 4,
            "roll-pitch-yaw" => 3,
            other => {
                return Err(error(format!("attitude: form = \"{other}\"; xyzw, wxyz and roll-pitch-yaw are known")));
            }
        };
        let angle = map.attitude.unit.as_deref();
        if angle.is_some_and(|unit| !["deg", "rad"].contains(&unit)) {
            return Err(error(format!("attitude: unit = \"{}\"; deg and rad are known", angle.unwrap_or_default())));
        }
        if map.attitude.columns.len() != count {
            let is = map.attitude.columns.len();
            return Err(error(format!("attitude: {is} columns; the form {} has {count}", map.attitude.form)));
        }
        if !(map.motors.full > 0.0 && map.motors.full.is_finite()) {
            return Err(error(format!("motors: full = {}; must be above 0: 65535 for a PWM", map.motors.full)));
        }
        Ok(map)
    }
}

/// SI of one such unit.
pub(crate) fn scale(unit: &str) -> Option<f64> {
    Some(match unit {
        "s" | "m" | "m/s" | "rad/s" | "m/s^2" | "V" | "rad" => 1.0,
        "ms" | "mm" | "mm/s" | "mrad/s" | "mV" => 1e-3,
        "us" => 1e-6,
        "deg/s" | "deg" => 1_f64.to_radians(),
        "g" => quatrack_design::model::GRAVITY_M_S2,
        "mg" => 1e-3 * quatrack_design::model::GRAVITY_M_S2,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_maps_are_sound_and_faults_of_others_are_named() {
        for name in ColumnMap::names() {
            assert!(ColumnMap::built_in(name).is_some(), "{name}");
        }
        let text = include_str!("maps/nanobench.toml");
        let wrong = ColumnMap::parse(&text.replace("\"rad/s\"", "\"furlong\""), "my.toml").unwrap_err().to_string();
        assert!(wrong.starts_with("my.toml: gyroscope: unit = \"furlong\""), "{wrong}");
        let wrong = ColumnMap::parse(&text.replace("xyzw", "wzyx"), "my.toml").unwrap_err().to_string();
        assert!(wrong.contains("form = \"wzyx\""), "{wrong}");
    }
}
