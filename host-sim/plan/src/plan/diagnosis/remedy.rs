//! Limits of a plan with the least values that would do, in; the words that a user reads, out.

use std::fmt;

/// Something that bounds a flight and can be relaxed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limit {
    /// `bounds.speed_max_m_s`.
    Speed,
    /// `bounds.acceleration_max_m_s2`.
    Acceleration,
    /// `bounds.tilt_max_deg`.
    Tilt,
    /// `bounds.thrust_min_m_s2`.
    ThrustMin,
    /// `bounds.thrust_max_m_s2`.
    ThrustMax,
    /// `bounds.body_rate_max_deg_s`.
    BodyRate,
    /// One of `[[corridors]]`, from 0.
    Corridor(usize),
    /// `tolerance_m` of every waypoint between start and end.
    Waypoints,
    /// `duration_s`.
    Duration,
}

/// A limit and the least value that would do instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedy {
    /// The limit.
    pub limit: Limit,
    /// Its value, SI; 0 for corridors and waypoints.
    pub given: f64,
    /// A value that would do, SI; for corridors and waypoints how many metres more on every side.
    pub enough: f64,
}

/// The limits that are too tight, as far as they can be told: every entry is one way out, and relaxes all it lists and
/// nothing else. Empty if none was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Infeasibility {
    /// The ways out.
    pub ways_out: Vec<Vec<Remedy>>,
}

impl Remedy {
    /// Whether a plan file may say so.
    pub(super) fn is_readable(&self) -> bool {
        let most = match self.limit {
            Limit::Tilt => 90_f64.to_radians() * (1.0 - 1e-9),
            Limit::BodyRate => 1e6_f64.to_radians(),
            Limit::Waypoints | Limit::Corridor(_) => 1e5,
            _ => 1e6,
        };
        self.enough >= 0.0 && self.enough <= most
    }
}

impl fmt::Display for Infeasibility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no curve meets the plan: ")?;
        if self.ways_out.is_empty() {
            return f.write_str(
                "no values of its bounds and no duration_s were found with which one does; move waypoints, or raise spans",
            );
        }
        let way = |remedies: &Vec<Remedy>| remedies.iter().map(ToString::to_string).collect::<Vec<_>>().join(" and ");
        write!(f, "{}; the rest kept", self.ways_out.iter().map(way).collect::<Vec<_>>().join(", or "))
    }
}

impl fmt::Display for Remedy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (key, [given, enough]) = match self.limit {
            Limit::Speed => ("speed_max_m_s", [self.given, self.enough]),
            Limit::Acceleration => ("acceleration_max_m_s2", [self.given, self.enough]),
            Limit::Duration => {
                let [given, enough] = [self.given, self.enough].map(|value| (value * 1e9).round() / 1e9);
                return write!(f, "duration_s = {given} is too short (duration_s = {enough} would do)");
            }
            Limit::Tilt => ("tilt_max_deg", [self.given, self.enough].map(f64::to_degrees)),
            Limit::ThrustMin => ("thrust_min_m_s2", [self.given, self.enough]),
            Limit::ThrustMax => ("thrust_max_m_s2", [self.given, self.enough]),
            Limit::BodyRate => ("body_rate_max_deg_s", [self.given, self.enough].map(f64::to_degrees)),
            Limit::Corridor(index) => {
                return write!(
                    f,
                    "corridor {} is too tight (every side {} m further out would do)",
                    index + 1,
                    self.enough
                );
            }
            Limit::Waypoints => {
                return write!(f, "the waypoints' tolerance_m is too tight ({} m more for each would do)", self.enough);
            }
        };
        // Degrees from radians are a rounding off.
        let [given, enough] = [given, enough].map(|value| (value * 1e9).round() / 1e9);
        write!(f, "{key} = {given} is too tight ({enough} would do)")
    }
}

/// A value to four digits, rounded away from 0.
pub(super) fn outwards(value: f64) -> f64 {
    let digits = 3.0 - value.abs().max(1e-9).log10().floor();
    let scale = 10_f64.powf(digits);
    // A value of four digits is not moved by its own rounding.
    (value.abs() * scale * (1.0 - 1e-12)).ceil() / scale * value.signum()
}
