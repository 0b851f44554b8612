//! A report in; the lines that a person reads of it out.

use std::fmt::Write as _;

use super::Report;
use crate::fit::Base;
use crate::predict::HORIZON;

impl Report {
    /// For a terminal.
    pub fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string does not fail.
        for note in &self.notes {
            let _ = writeln!(text, "note: {note}");
        }
        for stream in self.document().streams {
            let _ = write!(
                text,
                "{}: {:.1} s of flight, pose {:+.0} ms after the on-board streams",
                stream.log, stream.flight_s, stream.pose_shift_ms
            );
            if let Some(rms) = stream.estimate_rms_m {
                let _ = write!(text, ", on-board position {:.1} cm rms from it", 100.0 * rms);
            }
            text.push('\n');
        }
        let Base { name, mass_kg, .. } = &self.fit.base;
        let _ = writeln!(text, "\n{name} of {:.1} g, with 95 % intervals:", 1e3 * mass_kg);
        for (name, figure) in &self.fit.figures {
            if let Ok(e) = figure {
                let _ = writeln!(text, "  {name:<26} {:>11.4e}  {:.4e} to {:.4e}", e.value, e.low, e.high);
            }
        }
        for (name, figure) in &self.fit.figures {
            if let Err(why) = figure {
                let _ = writeln!(text, "  {name:<26} not told: {why}");
            }
        }
        let [x, y, thrust, drag_x, drag_y] = self.fit.explained;
        let _ = writeln!(
            text,
            "explained below 6 Hz: torque {x:.2}, {y:.2}; thrust {thrust:.2}; drag {drag_x:.2}, {drag_y:.2} of the variance"
        );
        match &self.prediction {
            Ok(prediction) => {
                let _ = writeln!(
                    text,
                    "\n0.5 s ahead on the last quarter of each flight, from commands, mean of {} starts:",
                    prediction.starts
                );
                for (name, course) in [
                    ("ours", &prediction.ours),
                    ("no angular acceleration", &prediction.no_angular_acceleration),
                    ("no change", &prediction.no_change),
                ] {
                    let e = course[HORIZON - 1];
                    let _ = writeln!(
                        text,
                        "  {name:<24} {:.3} m  {:.3} m/s  {:.3} rad  {:.3} rad/s",
                        e.position_m, e.velocity_m_s, e.rotation_rad, e.body_rate_rad_s
                    );
                }
            }
            Err(why) => {
                let _ = writeln!(text, "\nnothing held out: {why}");
            }
        }
        for one in &self.standings {
            let unknown = one.unknown.join(", ");
            let _ = match (one.outside.is_empty(), one.unknown.is_empty()) {
                (true, true) => writeln!(text, "table {}: the craft is inside its certified region", one.table),
                (true, false) => {
                    writeln!(text, "table {}: inside by the known figures; {unknown} not known", one.table)
                }
                (false, _) => {
                    writeln!(text, "table {}: outside its certified region: {}", one.table, one.outside.join("; "))
                }
            };
        }
        text
    }
}
