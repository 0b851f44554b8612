//! Rows of a flight in; its path, errors, tilt, motor forces with their limits, and wind where some blows, as a picture out.

use std::path::Path;

use nalgebra::Vector3;
use quatrack_simulation::flight::rigid_loop::RigidSample;
use quatrack_simulation::scenario::Around;

use crate::cli::{Failure, output, picture};
use crate::figures::{Curve, FlightFigure, Quantity, Trace, TrackingFigure};

/// Writes it, .svg or .png.
pub(super) fn write(path: &Path, title: &str, law: &str, rows: &[(RigidSample, Around)]) -> Result<(), Failure> {
    let of =
        |value: &dyn Fn(&RigidSample) -> f64| -> Vec<f64> { rows.iter().map(|(sample, _)| value(sample)).collect() };
    let around =
        |value: &dyn Fn(&Around) -> f64| -> Vec<f64> { rows.iter().map(|(_, around)| value(around)).collect() };
    let line = |label, values| Trace { label, values, limit: false };
    let axes = ["x", "y", "z"];
    let motors = ["motor 1", "motor 2", "motor 3", "motor 4"];
    let limits = [around(&|around| around.thrust_limits_n[0].min()), around(&|around| around.thrust_limits_n[1].max())]
        .map(|values| Trace { label: "limits", values, limit: true });
    let tilt_deg = of(&|sample| (sample.state.attitude * Vector3::z()).angle(&Vector3::z()).to_degrees());
    let mut quantities = vec![
        Quantity {
            name: "error (m)",
            shortest: 1e-3,
            traces: (0..3).map(|i| line(axes[i], of(&|sample| sample.position_error_m()[i]))).collect(),
        },
        Quantity { name: "tilt (deg)", shortest: 1.0, traces: vec![line("of the thrust", tilt_deg)] },
        Quantity {
            name: "thrust (N)",
            shortest: 1e-3,
            traces: (0..4).map(|i| line(motors[i], of(&|sample| sample.state.thrusts_n[i]))).chain(limits).collect(),
        },
    ];
    // Still air needs no panel.
    if rows.iter().any(|(_, around)| around.wind_m_s != Vector3::zeros()) {
        quantities.push(Quantity {
            name: "wind (m/s)",
            shortest: 0.1,
            traces: (0..3).map(|i| line(axes[i], around(&|around| around.wind_m_s[i]))).collect(),
        });
    }
    let time_s = of(&|sample| sample.time_s);
    let [places, targets]: [Vec<Vector3<f64>>; 2] = [
        rows.iter().map(|(sample, _)| sample.state.position_m).collect(),
        rows.iter().map(|(sample, _)| sample.target_m).collect(),
    ];
    let tracking = TrackingFigure {
        title,
        reference: Curve { label: "course", time_s: &time_s, position_m: &targets },
        flights: vec![Curve { label: law, time_s: &time_s, position_m: &places }],
    };
    let figure = FlightFigure { tracking, quantities };
    picture::write(path, &figure.to_svg().map_err(Failure::verdict)?)?;
    output::print(&format!("wrote {}\n", path.display()))
}
