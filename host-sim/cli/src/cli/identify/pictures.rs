//! Identified figures as pictures: prediction against flight, the residual of the torque balance, the lag curve.

use std::path::Path;

use nalgebra::Vector3;
use quatrack_identify::Report;
use quatrack_identify::fit::Balance;
use quatrack_identify::predict::{Errors, Example, Prediction};

use crate::cli::{Failure, output, picture};
use crate::figures::{ChartFigure, Curve, FigureError, FlightFigure, Marks, Quantity, Trace, TrackingFigure};

/// Writes prediction, ahead, residuals and lag, each as .svg and .png, to a folder.
pub(super) fn write(dir: &Path, report: &Report) -> Result<(), Failure> {
    output::create_dir(dir)?;
    let save = |name, svg: Result<String, FigureError>| picture::write_both(dir, name, &svg.map_err(Failure::verdict)?);
    if let Ok(found) = &report.prediction {
        if let Some(example) = &found.example {
            save("prediction", prediction(example))?;
        }
        save("ahead", ahead(found))?;
    }
    if let Some(balance) = &report.fit.balance {
        save("residuals", residuals(balance))?;
    }
    save("lag", lag(report))
}

fn line<'a>(label: &'a str, values: Vec<f64>) -> Trace<'a> {
    Trace { label, values, limit: false }
}

/// What a prediction is held against, in the stroke that it has in space.
fn flight(values: Vec<f64>) -> Trace<'static> {
    Trace { label: "flown", values, limit: true }
}

/// A file's name without its folders.
fn short(path: &str) -> &str {
    Path::new(path).file_name().and_then(|name| name.to_str()).unwrap_or(path)
}

fn prediction(example: &Example) -> Result<String, FigureError> {
    let title = format!("{}, held out: predicted from commands, a new start every 0.5 s", short(&example.flight));
    // A line breaks where a prediction starts anew.
    let starts = quatrack_identify::predict::HORIZON;
    let broken = |values: Vec<f64>| -> Vec<f64> {
        values.into_iter().enumerate().map(|(i, v)| if i % starts == 0 { f64::NAN } else { v }).collect()
    };
    let predicted: Vec<Vector3<f64>> = example
        .predicted_m
        .iter()
        .enumerate()
        .map(|(i, p)| if i % starts == 0 { Vector3::repeat(f64::NAN) } else { *p })
        .collect();
    let axis = |values: &[Vector3<f64>], k: usize| -> Vec<f64> { values.iter().map(|v| v[k]).collect() };
    let [flown, ours] = &example.rates_rad_s;
    let quantities = (0..3)
        .map(|k| Quantity {
            name: ["x (m)", "y (m)", "z (m)"][k],
            shortest: 0.05,
            traces: vec![
                flight(axis(&example.position_m, k)),
                line("predicted", broken(axis(&example.predicted_m, k))),
            ],
        })
        .chain((0..2).map(|k| Quantity {
            name: ["p (rad/s)", "q (rad/s)"][k],
            shortest: 0.1,
            traces: vec![flight(axis(flown, k)), line("predicted", broken(axis(ours, k)))],
        }))
        .collect();
    FlightFigure {
        tracking: TrackingFigure {
            title: &title,
            reference: Curve { label: "flown", time_s: &example.times_s, position_m: &example.position_m },
            flights: vec![Curve { label: "predicted", time_s: &example.times_s, position_m: &predicted }],
        },
        quantities,
    }
    .to_svg()
}

fn ahead(prediction: &Prediction) -> Result<String, FigureError> {
    let places: Vec<f64> = (1..=prediction.ours.len()).map(|k| 0.01 * k as f64).collect();
    let quantity = |name, of: fn(&Errors) -> f64| Quantity {
        name,
        shortest: 1e-3,
        traces: vec![
            line("ours", prediction.ours.iter().map(of).collect()),
            line("no angular acceleration", prediction.no_angular_acceleration.iter().map(of).collect()),
            line("no change", prediction.no_change.iter().map(of).collect()),
        ],
    };
    ChartFigure {
        title: "Mean error on the quarter held out",
        axis_name: "ahead (s)",
        places: &places,
        marks: None,
        quantities: vec![
            quantity("position (m)", |e| e.position_m),
            quantity("velocity (m/s)", |e| e.velocity_m_s),
            quantity("rotation (rad)", |e| e.rotation_rad),
            quantity("rate (rad/s)", |e| e.body_rate_rad_s),
        ],
    }
    .to_svg()
}

fn residuals(balance: &Balance) -> Result<String, FigureError> {
    let title = format!("{}: torques below 6 Hz", short(&balance.flight));
    let milli = |values: &[f64]| -> Vec<f64> { values.iter().map(|v| 1e3 * v).collect() };
    let left = |axis: usize| -> Vec<f64> {
        balance.motors[axis].iter().zip(&balance.explained[axis]).map(|(m, e)| 1e3 * (m - e)).collect()
    };
    let quantities = (0..2)
        .map(|axis| Quantity {
            name: ["about x (mN m)", "about y (mN m)"][axis],
            shortest: 1e-3,
            traces: vec![
                line("motors, lagged", milli(&balance.motors[axis])),
                line("inertia and airflow", milli(&balance.explained[axis])),
                line("left over", left(axis)),
            ],
        })
        .collect();
    ChartFigure { title: &title, axis_name: "time (s)", places: &balance.times_s, marks: None, quantities }.to_svg()
}

fn lag(report: &Report) -> Result<String, FigureError> {
    let curve = &report.fit.lag_curve;
    let places: Vec<f64> = curve.iter().map(|point| 1e3 * point.lag_s).collect();
    let of = |axis: usize| -> Vec<f64> { curve.iter().map(|point| point.explained[axis]).collect() };
    let (title, marks) = match report.fit.figures.get("lag_ms") {
        Some(Ok(lag)) => (
            format!("Lag of the motors: {:.1} ms, 95 % {:.1} to {:.1} ms", lag.value, lag.low, lag.high),
            Some(Marks { label: "identified, and its interval", places: vec![lag.low, lag.value, lag.high] }),
        ),
        _ => ("Lag of the motors: not told by these flights".to_owned(), None),
    };
    ChartFigure {
        title: &title,
        axis_name: "lag (ms)",
        places: &places,
        marks,
        quantities: vec![Quantity {
            name: "explained share of the motors' torque",
            shortest: 0.05,
            traces: vec![line("about x", of(0)), line("about y", of(1))],
        }],
    }
    .to_svg()
}
