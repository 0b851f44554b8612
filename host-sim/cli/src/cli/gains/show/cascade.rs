//! A table of the cascade as text: gains chain by chain, the air that is told, and its certified region.

use std::fmt::Write as _;

use quatrack::gains::table::{CascadeRange, CascadeTable};
use serde_json::{Value, json};

/// Each chain's gains among the 16.
const CHAINS: [(&str, std::ops::Range<usize>); 4] =
    [("height", 0..3), ("y, roll", 3..8), ("x, pitch", 8..13), ("yaw", 13..16)];

/// A line for each chain, its gains below their names.
pub(super) fn chains(names: &[String], gains: &[f64]) -> String {
    let mut out = String::new();
    for (chain, range) in CHAINS {
        let (Some(names), Some(gains)) = (names.get(range.clone()), gains.get(range)) else { continue };
        let _ = write!(out, "  {:<9}", "");
        for name in names {
            let _ = write!(out, "{name:>10}");
        }
        let _ = write!(out, "\n  {chain:<9}");
        for gain in gains {
            let _ = write!(out, "{gain:>10.5}");
        }
        out.push('\n');
    }
    out
}

/// Figures of the told air and the region, in the units that designs have them in.
struct Told {
    lag_ms: f64,
    drag_per_s: f64,
    moment_n_s: [f64; 2],
    gust: f64,
    learn: bool,
}

struct Certified {
    lag_ms: [f64; 2],
    mass_percent: f64,
    inertia_percent: f64,
    /// About yaw, where it is another.
    yaw_inertia_percent: Option<f64>,
    force_percent: [f64; 2],
    delay_ms: f64,
    drag_per_s: f64,
    moment_n_s: [f64; 2],
}

fn lines(told: &Told, certified: &Certified) -> String {
    let Told { lag_ms, drag_per_s, moment_n_s: [x, y], gust, learn } = told;
    let learned = if *learn { "and learned in flight" } else { "and not learned" };
    let c = certified;
    let [shortest, longest] = c.lag_ms;
    let ([least, most], [most_x, most_y]) = (c.force_percent, c.moment_n_s);
    let yaw = c.yaw_inertia_percent.map_or_else(String::new, |yaw| format!(", about yaw {yaw:.0} %"));
    format!(
        "  designed for {lag_ms:.1} ms of motor lag\n\
         \x20 told of the air, where its owner states nothing, {learned}: drag {drag_per_s:.3} 1/s, moment {x:.2e} and {y:.2e} N m \
         per m/s,\n\x20   {:.0} % of the wind's moment fed forward\n\
         \x20 certified, all at once, for\n\
         \x20   motor lag            {shortest:.1} to {longest:.1} ms\n\
         \x20   mass                 {:.0} % more or less than told\n\
         \x20   inertia              {:.0} % more or less than told{yaw}\n\
         \x20   force over command   {least:.0} to {most:.0} %\n\
         \x20   delay                up to {:.1} ms\n\
         \x20   drag                 up to {:.2} 1/s\n\
         \x20   moment of the air    up to {most_x:.2e} and {most_y:.2e} N m per m/s\n",
        100.0 * gust,
        c.mass_percent,
        c.inertia_percent,
        c.delay_ms,
        c.drag_per_s,
    )
}

pub(super) fn of_table(table: &CascadeTable) -> String {
    let wide = |pair: [f32; 2], by: f64| pair.map(|value| by * f64::from(value));
    let (air, c) = (&table.air, &table.certified);
    let told = Told {
        lag_ms: 1e3 * f64::from(table.motor_lag_s),
        drag_per_s: air.drag_per_s.into(),
        moment_n_s: wide(air.moment_n_s, 1.0),
        gust: air.gust.into(),
        learn: air.learn,
    };
    let certified = Certified {
        lag_ms: wide(c.motor_lag_s, 1e3),
        mass_percent: 100.0 * f64::from(c.mass_share),
        inertia_percent: 100.0 * f64::from(c.inertia_share),
        yaw_inertia_percent: None,
        force_percent: wide(c.force_share, 100.0),
        delay_ms: 1e3 * f64::from(c.delay_s),
        drag_per_s: c.drag_per_s.into(),
        moment_n_s: wide(c.moment_n_s, 1.0),
    };
    format!("\n{}", lines(&told, &certified))
}

/// Which bounds of a region are intervals of the vehicle's file: a line for each.
fn identified(taken: &Value) -> String {
    let mut out = String::new();
    for bound in taken.as_array().into_iter().flatten() {
        let text = |key: &str| bound[key].as_str().unwrap_or_default();
        let number = |key: &str| bound[key].as_f64().unwrap_or(f64::NAN);
        if out.is_empty() {
            out.push_str("  of these, by the 95 % intervals in the vehicle's file\n");
        }
        let _ = writeln!(
            out,
            "    {:<20} {} {:.5} to {:.5} ({})",
            text("key"),
            text("figure"),
            number("low"),
            number("high"),
            text("source")
        );
    }
    out
}

/// The same of a document of the cascade, with the spectral radius of each chain over the region; nothing of another.
pub(super) fn of_document(document: &Value) -> String {
    let parameters = &document["design"]["parameters"];
    if document["design"]["method"] != "cascade" {
        return String::new();
    }
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let pair = |value: &Value, by: f64| [0, 1].map(|i| by * number(&value[i]));
    let (air, region) = (&parameters["air"], &parameters["region"]);
    let told = Told {
        lag_ms: 1e3 * number(&parameters["motor_lag_s"]),
        drag_per_s: number(&air["drag_per_s"]),
        moment_n_s: pair(&air["moment_n_s"], 1.0),
        gust: number(&air["gust"]),
        learn: air["learn"].as_bool().unwrap_or_default(),
    };
    let certified = Certified {
        lag_ms: pair(&region["lag_s"], 1e3),
        mass_percent: 100.0 * number(&region["mass_share"]),
        inertia_percent: 100.0 * number(&region["inertia_share"]),
        yaw_inertia_percent: region["yaw_inertia_share"].as_f64().map(|share| 100.0 * share),
        force_percent: pair(&region["force_share"], 100.0),
        delay_ms: 1e3 * number(&region["delay_s"]),
        drag_per_s: number(&region["drag_per_s"]),
        moment_n_s: pair(&region["moment_n_s"], 1.0),
    };
    let mut out = lines(&told, &certified) + &identified(&parameters["region_from"]);
    for (found, when) in [("seen", "its motors seen"), ("unseen", "before, inertia as told")] {
        let radii: Vec<String> = (0..4)
            .map(|i| {
                let chain = &document["region"][found][i];
                format!("{} {:.5}", chain["chain"].as_str().unwrap_or_default(), number(&chain["spectral_radius"]))
            })
            .collect();
        let _ = writeln!(out, "    largest spectral radius, {when}: {}", radii.join(", "));
    }
    out + "\n"
}

pub(super) fn air_json(table: &CascadeTable) -> Value {
    let air = &table.air;
    json!({
        "drag_per_s": air.drag_per_s,
        "drag_along_share": air.drag_along_share,
        "moment_n_m_per_m_s": air.moment_n_s,
        "gust": air.gust,
        "learn": air.learn,
    })
}

pub(super) fn range_json(table: &CascadeTable) -> Value {
    let CascadeRange { motor_lag_s, mass_share, inertia_share, force_share, delay_s, drag_per_s, moment_n_s } =
        table.certified;
    json!({
        "motor_lag_s": motor_lag_s,
        "mass_share": mass_share,
        "inertia_share": inertia_share,
        "force_share": force_share,
        "delay_s": delay_s,
        "drag_per_s": drag_per_s,
        "moment_n_m_per_m_s": moment_n_s,
    })
}
