//! The regions that built-in tables are certified over: is a craft inside, and if not, by which figure?

use quatrack_design::vehicle::Vehicle;
use serde::Deserialize;

use crate::fit::{Estimate, Fit};

const DESIGNS: [(&str, &str); 9] = [
    ("actuator-aware", include_str!("../../../gains/actuator-aware.toml")),
    ("actuator-aware-63ms", include_str!("../../../gains/actuator-aware-63ms.toml")),
    ("actuator-aware-20ms", include_str!("../../../gains/actuator-aware-20ms.toml")),
    ("actuator-aware-kit", include_str!("../../../gains/actuator-aware-kit.toml")),
    ("actuator-aware-kit-63ms", include_str!("../../../gains/actuator-aware-kit-63ms.toml")),
    ("actuator-aware-kit-20ms", include_str!("../../../gains/actuator-aware-kit-20ms.toml")),
    ("actuator-aware-brushless", include_str!("../../../gains/actuator-aware-brushless.toml")),
    ("actuator-brushless-63ms", include_str!("../../../gains/actuator-brushless-63ms.toml")),
    ("actuator-brushless-20ms", include_str!("../../../gains/actuator-brushless-20ms.toml")),
];

/// What of a design is needed here.
#[derive(Deserialize)]
struct Design {
    vehicle: String,
    method: String,
    region: Option<RegionEntry>,
}

#[derive(Deserialize)]
struct RegionEntry {
    motor_lag_ms: [f64; 2],
    #[serde(default)]
    mass_percent: f64,
    #[serde(default)]
    inertia_percent: f64,
    #[serde(default)]
    delay_ms: f64,
    drag_per_s: Option<f64>,
    moment_n_m_per_m_s: Option<[f64; 2]>,
}

/// Without a figure of its own, a cascade is certified up to this much of the vehicle's identified moment, and up to this drag, 1/s.
const CASCADE_MOMENT: f64 = 1.2;
const CASCADE_DRAG_PER_S: f64 = 0.6;

/// A built-in table for the craft's vehicle, and what of the craft is outside its region.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// The table.
    pub table: &'static str,
    /// Each figure that is outside, in words.
    pub outside: Vec<String>,
    /// Figures that the flights did not tell.
    pub unknown: Vec<&'static str>,
}

/// Of every built-in table for motor forces whose design is for a vehicle.
pub(crate) fn standings(vehicle: &Vehicle, fit: &Fit) -> Vec<Standing> {
    let mut standings = Vec::new();
    for (table, text) in DESIGNS {
        let Ok(Design { vehicle: designed_for, method, region: Some(mut region) }) = toml::from_str(text) else {
            continue;
        };
        // Tables carry shorter names than designs: the kit's.
        if designed_for == vehicle.name()
            || (vehicle.name().ends_with("upgrade") && designed_for.starts_with(vehicle.name()))
        {
            if method == "cascade" {
                let air = vehicle.flown().air;
                region.drag_per_s = region.drag_per_s.or(Some(CASCADE_DRAG_PER_S));
                region.moment_n_m_per_m_s = region
                    .moment_n_m_per_m_s
                    .or(air.map(|air| air.moment_n_m_per_m_s.map(|moment| CASCADE_MOMENT * moment)));
            }
            standings.push(standing(table, &region, vehicle, fit));
        }
    }
    standings
}

fn standing(table: &'static str, region: &RegionEntry, vehicle: &Vehicle, fit: &Fit) -> Standing {
    let mut standing = Standing { table, outside: Vec::new(), unknown: Vec::new() };
    let mass = fit.base.mass_kg;
    let nominal = vehicle.mass_kg();
    let factors = |percent: f64| [1.0 - 0.01 * percent, 1.0 + 0.01 * percent];
    let [least, most] = factors(region.mass_percent).map(|factor| factor * nominal);
    if !(least..=most).contains(&mass) {
        standing.outside.push(format!(
            "mass {:.1} g, the region is {:.1} to {:.1} g",
            1e3 * mass,
            1e3 * least,
            1e3 * most
        ));
    }
    let mut against = |name: &'static str, [least, most]: [f64; 2], unit: &str, scale: f64| match fit.figures.get(name)
    {
        Some(Ok(Estimate { value, low, high })) => {
            if *low < least || *high > most {
                standing.outside.push(format!(
                    "{name} {:.4} ({:.4} to {:.4}) {unit}, the region is {:.4} to {:.4}",
                    scale * value,
                    scale * low,
                    scale * high,
                    scale * least,
                    scale * most
                ));
            }
        }
        _ => standing.unknown.push(name),
    };
    against("lag_ms", region.motor_lag_ms, "ms", 1.0);
    against("delay_ms", [f64::NEG_INFINITY, region.delay_ms], "ms", 1.0);
    let inertia = vehicle.inertia_kg_m2();
    for (name, axis) in [("inertia_x_kg_m2", 0), ("inertia_y_kg_m2", 1), ("inertia_z_kg_m2", 2)] {
        let nominal = inertia[(axis, axis)];
        against(name, factors(region.inertia_percent).map(|factor| factor * nominal), "kg mm^2", 1e9);
    }
    match region.drag_per_s {
        Some(most) => {
            against("drag_x_per_s", [f64::NEG_INFINITY, most], "1/s", 1.0);
            against("drag_y_per_s", [f64::NEG_INFINITY, most], "1/s", 1.0);
        }
        None => standing.outside.push("it is certified in vacuum, without drag and airflow moment".to_owned()),
    }
    if let Some([x, y]) = region.moment_n_m_per_m_s {
        let mut against = |name: &'static str, most: f64| match fit.figures.get(name) {
            Some(Ok(Estimate { value, high, .. })) if *high > most => standing.outside.push(format!(
                "{name} {:.3} (up to {:.3}) mN m a m/s, the region ends at {:.3}",
                1e3 * value,
                1e3 * high,
                1e3 * most
            )),
            Some(Ok(_)) => {}
            _ => standing.unknown.push(name),
        };
        against("moment_x_n_m_per_m_s", x);
        against("moment_y_n_m_per_m_s", y);
    }
    standing
}
