//! The regions that built-in tables are certified over: is a craft inside, and if not, by which figure?

use quatrack_design::vehicle::Vehicle;
use serde::Deserialize;

use crate::fit::{Estimate, Fit};

const DESIGNS: [(&str, &str); 9] = [
    ("cascade-100ms", include_str!("../../../gains/cascade-100ms.toml")),
    ("cascade-20ms", include_str!("../../../gains/cascade-20ms.toml")),
    ("cascade-63ms", include_str!("../../../gains/cascade-63ms.toml")),
    ("cascade-brushless-110ms", include_str!("../../../gains/cascade-brushless-110ms.toml")),
    ("cascade-brushless-20ms", include_str!("../../../gains/cascade-brushless-20ms.toml")),
    ("cascade-brushless-50ms", include_str!("../../../gains/cascade-brushless-50ms.toml")),
    ("cascade-kit-100ms", include_str!("../../../gains/cascade-kit-100ms.toml")),
    ("cascade-kit-20ms", include_str!("../../../gains/cascade-kit-20ms.toml")),
    ("cascade-kit-63ms", include_str!("../../../gains/cascade-kit-63ms.toml")),
];

/// The part of a design file that is needed here.
#[derive(Deserialize)]
struct Design {
    vehicle: String,
    air: AirEntry,
    region: Option<RegionEntry>,
}

/// The air that the law is told, and which share of the identified one that is.
#[derive(Deserialize)]
struct AirEntry {
    moment_n_m_per_m_s: [f64; 2],
    share_of_identified: f64,
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

/// Without a figure of its own, a table is certified up to this much of the moment that was identified.
const CASCADE_MOMENT: f64 = 1.2;

/// A built-in table for the craft's vehicle, and the craft's figures that are outside its region.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// The table.
    pub table: &'static str,
    /// Each figure that is outside, in words.
    pub outside: Vec<String>,
    /// Figures that the flights did not tell.
    pub unknown: Vec<&'static str>,
}

/// Of every built-in table of the cascade whose design is for a vehicle.
pub(crate) fn standings(vehicle: &Vehicle, fit: &Fit) -> Vec<Standing> {
    let mut standings = Vec::new();
    for (table, text) in DESIGNS {
        let Ok(Design { vehicle: designed_for, air, region: Some(mut region) }) = toml::from_str(text) else {
            continue;
        };
        if designed_for == vehicle.name() {
            let told = air.moment_n_m_per_m_s.map(|moment| CASCADE_MOMENT * moment / air.share_of_identified);
            region.moment_n_m_per_m_s = region.moment_n_m_per_m_s.or(Some(told));
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
                let from = if least.is_finite() { format!("from {:.4} ", scale * least) } else { String::new() };
                standing.outside.push(format!(
                    "{name} {:.4} ({:.4} to {:.4}) {unit}, the region goes {from}to {:.4}",
                    scale * value,
                    scale * low,
                    scale * high,
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
        against(name, factors(region.inertia_percent).map(|factor| factor * nominal), "kg mm^2", 1e6);
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
                "{name} {:.3} (up to {:.3}) mN m per m/s, the region ends at {:.3}",
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
