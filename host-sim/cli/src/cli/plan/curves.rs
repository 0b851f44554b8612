//! The curves of a planned flight in; their files, JSON and TOML, out.

use quatrack_plan::plan::{PlannedFlight, PlannedLeg};
use serde::Serialize;

/// The figures of a curve in the files.
#[derive(Serialize)]
pub(super) struct Curve {
    degree: usize,
    duration_s: f64,
    control_points_m: Vec<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    heading_control_points_rad: Option<Vec<f64>>,
}

/// A flight of several.
#[derive(Serialize)]
pub(super) struct Curves {
    pub(super) curves: Vec<Curve>,
}

pub(super) fn of_leg(leg: &PlannedLeg) -> Curve {
    Curve {
        degree: leg.curve.degree(),
        duration_s: leg.plan.duration_s(),
        control_points_m: leg.curve.control_points_m().iter().map(|point| [point.x, point.y, point.z]).collect(),
        heading_control_points_rad: leg.curve.heading_control_points_rad().map(<[f64]>::to_vec),
    }
}

/// One control point a line; Rust's shortest decimals read back to the same bits.
pub(super) fn as_toml(flight: &PlannedFlight) -> String {
    let several = flight.legs.len() > 1;
    let table = |leg: &PlannedLeg| {
        let curve = of_leg(leg);
        let points = curve.control_points_m.iter().map(|[x, y, z]| format!("  [{x:?}, {y:?}, {z:?}],\n"));
        let heading = curve.heading_control_points_rad.map_or_else(String::new, |heading| {
            let lines: String = heading.iter().map(|value| format!("  {value:?},\n")).collect();
            format!("heading_control_points_rad = [\n{lines}]\n")
        });
        format!(
            "{}degree = {}\nduration_s = {:?}\ncontrol_points_m = [\n{}]\n{heading}",
            if several { "[[curves]]\n" } else { "" },
            curve.degree,
            curve.duration_s,
            points.collect::<String>()
        )
    };
    flight.legs.iter().map(table).collect::<Vec<_>>().join("\n")
}
