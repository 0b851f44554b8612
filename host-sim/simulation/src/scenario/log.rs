//! The log that a craft would have recorded of a flight: a recording, or rows, in; CSV in cflib's columns out.

use std::fmt::Write as _;

use quatrack_design::model::GRAVITY_M_S2;

use super::recording::Recording;
use crate::control_law::Estimate;

/// One row of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogRow {
    /// Since the start, s.
    pub time_s: f64,
    /// The law's estimate, with its sensors.
    pub estimate: Estimate,
    /// Commands as shares of a full one, from 0 to 1.
    pub commands: [f64; 4],
    /// V; none where nothing depends on it.
    pub voltage: Option<f64>,
}

impl Recording {
    /// As the text of such a log; `full_n`: the force of a full command, N.
    pub fn to_log(&self, full_n: f64) -> String {
        cflib_csv(&self.log_rows(full_n))
    }

    /// The law's estimate, and its commands as shares of a full one of `full_n`, N.
    pub fn log_rows(&self, full_n: f64) -> Vec<LogRow> {
        (self.flight.samples.iter().zip(&self.around))
            .map(|(sample, around)| LogRow {
                time_s: sample.time_s,
                estimate: around.estimate,
                commands: [0, 1, 2, 3].map(|motor| sample.commands_n[motor] / full_n),
                voltage: Some(around.voltage_v).filter(|volts| *volts > 0.0),
            })
            .collect()
    }
}

/// CSV with the firmware's names and units: times in ms, rates in degrees a second, specific force in g, commands from 0 to 65535.
pub fn cflib_csv(rows: &[LogRow]) -> String {
    let mut text = String::from(
        "timestamp,stateEstimate.x,stateEstimate.y,stateEstimate.z,stateEstimate.vx,stateEstimate.vy,stateEstimate.vz,\
         stateEstimate.qx,stateEstimate.qy,stateEstimate.qz,stateEstimate.qw,gyro.x,gyro.y,gyro.z,acc.x,acc.y,acc.z,\
         motor.m1,motor.m2,motor.m3,motor.m4,pm.vbat\n",
    );
    for row in rows {
        let Estimate { position_m, velocity_m_s, attitude, body_rates_rad_s, specific_force_m_s2 } = &row.estimate;
        let q = attitude.quaternion();
        // Writing to a string does not fail.
        let _ = write!(text, "{:.3}", 1e3 * row.time_s);
        let gyro = body_rates_rad_s.map(f64::to_degrees);
        let force = specific_force_m_s2 / GRAVITY_M_S2;
        let pose = position_m.iter().chain(velocity_m_s.iter()).chain([&q.i, &q.j, &q.k, &q.w]);
        for value in pose.chain(gyro.iter()).chain(force.iter()) {
            let _ = write!(text, ",{value:.7}");
        }
        for command in row.commands {
            let _ = write!(text, ",{:.0}", 65535.0 * command.clamp(0.0, 1.0));
        }
        match row.voltage {
            Some(voltage) => {
                let _ = writeln!(text, ",{voltage:.4}");
            }
            None => text.push_str(",\n"),
        }
    }
    text
}
