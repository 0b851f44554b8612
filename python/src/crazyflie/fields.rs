//! Objects with the fields of the firmware's structs, by their names, in; the structs that the object reads out.

use pyo3::prelude::*;
use quatrack_crazyflie::abi::{self, Attitude, Mode, Modes, Quaternion, SensorData, Setpoint, Vector};

fn number(of: &Bound<'_, PyAny>, field: &str) -> PyResult<f32> {
    of.getattr(field)?.extract()
}

fn vector(of: &Bound<'_, PyAny>, field: &str) -> PyResult<Vector> {
    let of = of.getattr(field)?;
    Ok(Vector { timestamp: 0, x: number(&of, "x")?, y: number(&of, "y")?, z: number(&of, "z")? })
}

fn angles(of: &Bound<'_, PyAny>, field: &str) -> PyResult<Attitude> {
    let of = of.getattr(field)?;
    Ok(Attitude { timestamp: 0, roll: number(&of, "roll")?, pitch: number(&of, "pitch")?, yaw: number(&of, "yaw")? })
}

fn quaternion(of: &Bound<'_, PyAny>, field: &str) -> PyResult<Quaternion> {
    let of = of.getattr(field)?;
    Ok(Quaternion { x: number(&of, "x")?, y: number(&of, "y")?, z: number(&of, "z")?, w: number(&of, "w")? })
}

fn modes(of: &Bound<'_, PyAny>) -> PyResult<Modes> {
    let of = of.getattr("mode")?;
    let mode = |field: &str| of.getattr(field)?.extract().map(Mode);
    Ok(Modes {
        x: mode("x")?,
        y: mode("y")?,
        z: mode("z")?,
        roll: mode("roll")?,
        pitch: mode("pitch")?,
        yaw: mode("yaw")?,
        quat: mode("quat")?,
    })
}

pub(super) fn setpoint(of: &Bound<'_, PyAny>) -> PyResult<Setpoint> {
    // The bindings of older firmware have no jerk.
    let jerk = if of.hasattr("jerk")? { vector(of, "jerk")? } else { Vector::default() };
    Ok(Setpoint {
        timestamp: of.getattr_opt("timestamp")?.map_or(Ok(0), |stamp| stamp.extract())?,
        attitude: angles(of, "attitude")?,
        attitude_rate: angles(of, "attitudeRate")?,
        attitude_quaternion: quaternion(of, "attitudeQuaternion")?,
        thrust: number(of, "thrust")?,
        position: vector(of, "position")?,
        velocity: vector(of, "velocity")?,
        acceleration: vector(of, "acceleration")?,
        jerk,
        velocity_body: u8::from(of.getattr("velocity_body")?.is_truthy()?),
        mode: modes(of)?,
    })
}

pub(super) fn state(of: &Bound<'_, PyAny>) -> PyResult<abi::State> {
    Ok(abi::State {
        attitude: angles(of, "attitude")?,
        attitude_quaternion: quaternion(of, "attitudeQuaternion")?,
        position: vector(of, "position")?,
        velocity: vector(of, "velocity")?,
        acc: vector(of, "acc")?,
    })
}

pub(super) fn sensors(of: &Bound<'_, PyAny>) -> PyResult<SensorData> {
    let axis = |field: &str| vector(of, field).map(|v| [v.x, v.y, v.z]);
    Ok(SensorData { acc: axis("acc")?, gyro: axis("gyro")?, ..SensorData::default() })
}
