//! `quatrack gains show`: a design, or a file made of one, in; its table and its figures, for a person, out.

mod cascade;
mod plot;

use std::fmt::Write as _;
use std::path::Path;

use quatrack_simulation::crazyflie::{CRAFT_MAGIC, OwnCraft};
use quatrack_simulation::gains::{self, Signal, Table};
use serde_json::{Value, json};

use super::super::{Failure, output};
use super::{certified, figures, read};

pub(super) fn show(path: &Path, json: Option<&Path>, plot: Option<&Path>) -> Result<(), Failure> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let (text, document) = match extension.as_str() {
        "toml" => {
            let certified = certified(path)?;
            if let Some(folder) = plot {
                plot::draw(&certified, path, folder)?;
            }
            let document = gains::json_document(&certified);
            (of_document(&document), document)
        }
        "json" | "bin" if plot.is_some() => {
            return Err(Failure::input(format!("{}: --plot takes a design (.toml)", path.display())));
        }
        "json" => {
            let document: Value = serde_json::from_slice(&read(path)?)
                .map_err(|error| Failure::input(format!("{}: no JSON ({error})", path.display())))?;
            if document.get("certificate_sha256").is_none() {
                let reason = "not made by `quatrack gains design`: certificate_sha256 is missing";
                return Err(Failure::input(format!("{}: {reason}", path.display())));
            }
            (of_document(&document), document)
        }
        "bin" => {
            let bytes = read(path)?;
            let own = OwnCraft::from_bytes(&bytes);
            if own.is_none() && bytes.starts_with(&CRAFT_MAGIC) {
                let remedy = "make it again with `quatrack gains craft`";
                return Err(Failure::input(format!("{}: a craft that is damaged; {remedy}", path.display())));
            }
            let table = Table::from_bytes(own.as_ref().map_or(&bytes, |own| &own.table))
                .map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
            let craft = own.map_or_else(String::new, |own| {
                format!(
                    "a craft of {} kg, motors of {} ms, with its table; `upload.py craft` sends it\n",
                    own.mass_kg,
                    1e3 * own.motor_lag_s
                )
            });
            (craft + &of_table(&table), table_json(&table))
        }
        _ => {
            let reason = "neither a design (.toml) nor made of one (.json, .bin)";
            return Err(Failure::input(format!("{}: {reason}", path.display())));
        }
    };
    output::print(&text)?;
    json.map_or(Ok(()), |path| output::write_json(path, &output::Named::new("gains-show", &document)))
}

/// The text of a document about its design and its gains.
fn of_document(document: &Value) -> String {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let mut out = format!("{}: {}\n", text(&document["name"]), text(&document["description"]).replace('\n', " "));
    let design = &document["design"];
    let _ = writeln!(
        out,
        "  for {} (id {}) at {} Hz, {} {}",
        text(&design["vehicle"]),
        text(&design["vehicle_id"]),
        design["control_rate_hz"],
        text(&design["linearisation"]),
        text(&design["method"]),
    );
    let _ = writeln!(
        out,
        "  thrust {} m/s^2, body rates {} rad/s\n  design      {}\n  certificate {}\n",
        design["thrust_m_s2"],
        design["body_rates_max_rad_s"],
        text(&document["design_sha256"]),
        text(&document["certificate_sha256"]),
    );
    let gain = &document["gain"];
    let names = |signals: &Value| -> Vec<String> {
        signals.as_array().into_iter().flatten().map(|signal| text(&signal["name"])).collect()
    };
    let entries = |k: &Value| -> Vec<Vec<f64>> {
        let numbers = |row: &Value| row.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
        k.as_array().into_iter().flatten().map(numbers).collect()
    };
    let (rows, columns) = (names(&gain["rows"]), names(&gain["columns"]));
    let knots = &gain["knots"];
    if knots.is_object() {
        let gains: Vec<_> = gain["k"].as_array().into_iter().flatten().map(entries).collect();
        let _ = writeln!(out, "  {}", told_knots(gains.len(), &knots["steps_per_knot"], &knots["trajectory"]));
        out += &over_time(&rows, &columns, &gains);
    } else if design["method"] == "cascade" {
        let gains: Vec<f64> = entries(&gain["k"]).concat();
        out += &cascade::chains(&columns, &gains);
    } else {
        out += &matrix(&rows, &columns, &entries(&gain["k"]));
    }
    out + "\n" + &cascade::of_document(document) + &figures(document)
}

fn told_knots(count: usize, steps_per_knot: &Value, trajectory: &Value) -> String {
    let trajectory = trajectory.as_str().unwrap_or_default();
    format!("{count} knots, one in {steps_per_knot} control steps, for the trajectory {trajectory}")
}

/// The gain that is flown behind the last knot, and the one furthest from it.
fn over_time(rows: &[String], columns: &[String], gains: &[Vec<Vec<f64>>]) -> String {
    let Some(last) = gains.last() else { return String::new() };
    let distance = |gain: &[Vec<f64>]| -> f64 {
        let pairs = gain.iter().flatten().zip(last.iter().flatten());
        pairs.map(|(entry, last)| (entry - last).powi(2)).sum()
    };
    let mut out = format!("\n  the last, flown from there on\n{}", matrix(rows, columns, last));
    let furthest = gains.iter().enumerate().max_by(|(_, x), (_, y)| distance(x).total_cmp(&distance(y)));
    if let Some((knot, gain)) = furthest {
        let _ = write!(out, "\n  knot {knot}, furthest from it\n{}", matrix(rows, columns, gain));
    }
    out
}

/// The text of a binary table.
fn of_table(table: &Table) -> String {
    let (head, certificate) = (table.head(), &table.head().certificate);
    let rates = head.limits.body_rates_max_rad_s();
    let (one, all) = (&certificate.one_channel, &certificate.all_channels);
    let mut out = format!(
        "{}: {} table for {} at {} Hz\n\
         \x20 thrust {} to {} m/s^2, body rates {} {} {} rad/s\n\
         \x20 design      {}\n\x20 certificate {}\n\n",
        head.name,
        table.kind(),
        head.vehicle,
        head.rate.hz(),
        head.limits.thrust_min_m_s2(),
        head.limits.thrust_max_m_s2(),
        rates.x,
        rates.y,
        rates.z,
        head.design_hash,
        certificate.hash,
    );
    let (rows, columns) = gains::signals(table.kind());
    let names = |signals: &[Signal]| signals.iter().map(|signal| signal.name.to_owned()).collect::<Vec<_>>();
    let (rows, columns) = (names(rows), names(columns));
    let entries: Vec<Vec<f64>> =
        table.by_rows().iter().map(|row| row.iter().map(|k| f64::from(*k)).collect()).collect();
    if let Some(table) = table.along() {
        let trajectory = format!("{:08x}", table.trajectory).into();
        let _ = writeln!(out, "  {}", told_knots(table.gains.len(), &table.steps_per_knot.into(), &trajectory));
        let gains: Vec<_> = entries.chunks(rows.len()).map(<[_]>::to_vec).collect();
        out += &over_time(&rows, &columns, &gains);
    } else if table.cascade().is_some() {
        out += &cascade::chains(&columns, &entries.concat());
    } else {
        out += &matrix(&rows, &columns, &entries);
    }
    if let Some(table) = table.cascade() {
        out += &cascade::of_table(table);
    }
    let _ = write!(
        out,
        "\n  gain margin of one channel                     {:>16}\n\
         \x20 phase margin of one channel, deg               {:>16.3}\n\
         \x20 gain margin of all channels at once            {:>16}\n\
         \x20 phase margin of all channels at once, deg      {:>16.3}\n\
         \x20 largest delay, ms                              {:>16}\n\
         \x20 largest motor lag, ms                          {:>16}\n\
         \x20 distance from the f64 gains                    {:>16e}\n",
        one.gain_factor,
        one.phase_rad.to_degrees(),
        all.gain_factor,
        all.phase_rad.to_degrees(),
        certificate.delay_max_s * 1e3,
        certificate.motor_lag_max_s * 1e3,
        certificate.f32_distance,
    );
    out
}

fn table_json(table: &Table) -> Value {
    let (head, certificate) = (table.head(), &table.head().certificate);
    let rates = head.limits.body_rates_max_rad_s();
    let mut document = json!({
        "name": head.name.as_str(),
        "kind": table.kind().to_string(),
        "vehicle": head.vehicle.name.as_str(),
        "vehicle_id": format!("{:08x}", head.vehicle.id),
        "control_rate_hz": head.rate.hz(),
        "thrust_m_s2": [head.limits.thrust_min_m_s2(), head.limits.thrust_max_m_s2()],
        "body_rates_max_rad_s": [rates.x, rates.y, rates.z],
        "design_sha256": head.design_hash.to_string(),
        "certificate_sha256": certificate.hash.to_string(),
        "one_channel": {
            "gain_factor": certificate.one_channel.gain_factor, "phase_rad": certificate.one_channel.phase_rad,
        },
        "all_channels": {
            "gain_factor": certificate.all_channels.gain_factor, "phase_rad": certificate.all_channels.phase_rad,
        },
        "delay_max_s": certificate.delay_max_s,
        "motor_lag_max_s": certificate.motor_lag_max_s,
        "f32_distance": certificate.f32_distance,
        "motor_lag_s": table.motor_lag_s(),
        "k_f32": table.by_rows(),
    });
    if let Some(table) = table.cascade() {
        document["air"] = cascade::air_json(table);
        document["certified"] = cascade::range_json(table);
    }
    if let Some(table) = table.along() {
        document["k_f32"] = json!(table.gains);
        document["steps_per_knot"] = json!(table.steps_per_knot);
        document["trajectory"] = json!(format!("{:08x}", table.trajectory));
    }
    document
}

/// A matrix with a line for each row; zeros as dots, so that its structure shows.
fn matrix(rows: &[String], columns: &[String], entries: &[Vec<f64>]) -> String {
    let mut out = format!("  {:<8}", "");
    for column in columns {
        let _ = write!(out, "{column:>10}");
    }
    out.push('\n');
    for (name, row) in rows.iter().zip(entries) {
        let _ = write!(out, "  {name:<8}");
        for value in row {
            let cell = if *value == 0.0 { ".".to_owned() } else { format!("{value:.4}") };
            let _ = write!(out, "{cell:>10}");
        }
        out.push('\n');
    }
    out
}
