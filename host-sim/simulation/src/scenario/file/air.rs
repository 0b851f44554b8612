//! The air of a scenario's file: `"vehicle"` or a table in; whose figures, and those that go over them, out.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor, value::MapAccessDeserializer};

/// `air = "vehicle"`, or a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Air {
    /// The air of the vehicle's file, but for the figures that are given.
    Vehicle(OwnAir),
    /// Figures of one's own.
    Own(OwnAir),
}

/// Figures of the air.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct OwnAir {
    /// The air that these figures go over; vacuum where absent.
    pub of: Option<AirOf>,
    /// Linear drag over mass along body x, y, z, 1/s.
    pub drag_per_s: Option<[f64; 3]>,
    /// Airflow moment `c_x, c_y`: `tau_x = c_x v_y`, `tau_y = -c_y v_x`, N m per m/s.
    pub moment_n_m_per_m_s: Option<[f64; 2]>,
    /// Steady wind, world frame, m/s.
    pub wind_m_s: Option<[f64; 3]>,
    /// Root mean square of a gust's horizontal component, m/s.
    pub gust_rms_m_s: Option<f64>,
}

/// The air that figures go over.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum AirOf {
    /// The vehicle's own.
    Vehicle,
}

impl<'de> Deserialize<'de> for Air {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Air;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("\"vehicle\" or a table")
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Air, E> {
                let other = || E::invalid_value(serde::de::Unexpected::Str(text), &self);
                (text == "vehicle").then(|| Air::Vehicle(OwnAir::default())).ok_or_else(other)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Air, A::Error> {
                let own = OwnAir::deserialize(MapAccessDeserializer::new(map))?;
                Ok(if own.of == Some(AirOf::Vehicle) { Air::Vehicle(own) } else { Air::Own(own) })
            }
        }
        deserializer.deserialize_any(Either)
    }
}
