//! A log in the columns of the `cflib` map, out of rows: the form in which a simulated flight enters [`crate::identify`].

use std::fmt::Write as _;

use nalgebra::{UnitQuaternion, Vector3};
use quatrack_design::model::GRAVITY_M_S2;

/// One row of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Since the start, s.
    pub time_s: f64,
    /// World frame, m.
    pub position: Vector3<f64>,
    /// World frame, m/s.
    pub velocity: Vector3<f64>,
    /// Body to world.
    pub attitude: UnitQuaternion<f64>,
    /// Body frame, rad/s.
    pub gyro: Vector3<f64>,
    /// Body frame, m/s^2.
    pub specific_force: Vector3<f64>,
    /// Commands as shares of a full one, from 0 to 1.
    pub commands: [f64; 4],
    /// V; none where nothing depends on it.
    pub voltage: Option<f64>,
}

/// CSV with the firmware's names and units: times in ms, rates in degrees a second, specific force in g, commands from 0 to 65535.
pub fn cflib_csv(rows: &[Row]) -> String {
    let mut text = String::from(
        "timestamp,stateEstimate.x,stateEstimate.y,stateEstimate.z,stateEstimate.vx,stateEstimate.vy,stateEstimate.vz,\
         stateEstimate.qx,stateEstimate.qy,stateEstimate.qz,stateEstimate.qw,gyro.x,gyro.y,gyro.z,acc.x,acc.y,acc.z,\
         motor.m1,motor.m2,motor.m3,motor.m4,pm.vbat\n",
    );
    for row in rows {
        let q = row.attitude.quaternion();
        // Writing to a string does not fail.
        let _ = write!(text, "{:.3}", 1e3 * row.time_s);
        let gyro = row.gyro.map(f64::to_degrees);
        let force = row.specific_force / GRAVITY_M_S2;
        let pose = row.position.iter().chain(row.velocity.iter()).chain([&q.i, &q.j, &q.k, &q.w]);
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
