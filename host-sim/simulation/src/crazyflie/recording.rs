//! Calls of the controller as they lie in the target's memory: structs of the host in, bytes out.
//!
//! The target's compiler gives an enum one byte, the host's four.

use quatrack_crazyflie::abi::{Attitude, Control, Modes, SensorData, Setpoint, State, Vector};

/// Bytes of a control on the target.
pub const CONTROL_BYTES: usize = 20;

/// Calls, one after the other, and the controller's output at each.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Step, the action before, setpoint, sensors, state, of every call.
    pub calls: Vec<u8>,
    /// The control after every call.
    pub controls: Vec<[u8; CONTROL_BYTES]>,
    /// The step of every call.
    pub steps: Vec<u32>,
}

/// The action before a call.
#[derive(Clone, Copy, Debug, Default)]
pub struct Before {
    /// The controller is selected.
    pub is_selected: bool,
    /// A table is asked for.
    pub table: Option<u8>,
}

impl Recording {
    /// Adds a call.
    pub fn add(
        &mut self,
        step: u32,
        before: Before,
        setpoint: &Setpoint,
        sensors: &SensorData,
        state: &State,
        control: &Control,
    ) {
        let bytes = &mut self.calls;
        word(bytes, step);
        word(bytes, u32::from(before.is_selected) | before.table.map_or(0, |table| (u32::from(table) + 1) << 8));
        setpoint_bytes(bytes, setpoint);
        for axis in [sensors.acc, sensors.gyro, sensors.mag] {
            floats(bytes, &axis);
        }
        floats(bytes, &[sensors.baro.pressure, sensors.baro.temperature, sensors.baro.asl]);
        bytes.extend(sensors.interrupt_timestamp.to_le_bytes());
        attitude(bytes, &state.attitude);
        let q = &state.attitude_quaternion;
        floats(bytes, &[q.x, q.y, q.z, q.w]);
        for v in [&state.position, &state.velocity, &state.acc] {
            vector(bytes, v);
        }
        let mut after = [0; CONTROL_BYTES];
        for (place, value) in after.chunks_exact_mut(4).zip(control.payload) {
            place.copy_from_slice(&value.to_le_bytes());
        }
        after[16] = control.control_mode as u8;
        self.controls.push(after);
        self.steps.push(step);
    }
}

fn setpoint_bytes(bytes: &mut Vec<u8>, setpoint: &Setpoint) {
    word(bytes, setpoint.timestamp);
    attitude(bytes, &setpoint.attitude);
    attitude(bytes, &setpoint.attitude_rate);
    let q = &setpoint.attitude_quaternion;
    floats(bytes, &[q.x, q.y, q.z, q.w, setpoint.thrust]);
    for v in [&setpoint.position, &setpoint.velocity, &setpoint.acceleration, &setpoint.jerk] {
        vector(bytes, v);
    }
    let Modes { x, y, z, roll, pitch, yaw, quat } = setpoint.mode;
    bytes.push(setpoint.velocity_body);
    bytes.extend([x, y, z, roll, pitch, yaw, quat].map(|mode| mode.0 as u8));
}

fn attitude(bytes: &mut Vec<u8>, attitude: &Attitude) {
    word(bytes, attitude.timestamp);
    floats(bytes, &[attitude.roll, attitude.pitch, attitude.yaw]);
}

fn vector(bytes: &mut Vec<u8>, v: &Vector) {
    word(bytes, v.timestamp);
    floats(bytes, &[v.x, v.y, v.z]);
}

fn floats(bytes: &mut Vec<u8>, values: &[f32]) {
    values.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
}

fn word(bytes: &mut Vec<u8>, value: u32) {
    bytes.extend(value.to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_has_the_targets_sizes() {
        let mut recording = Recording::default();
        let setpoint = Setpoint {
            mode: Modes { quat: quatrack_crazyflie::abi::Mode(1), ..Default::default() },
            ..Default::default()
        };
        recording.add(7, Before::default(), &setpoint, &SensorData::default(), &State::default(), &Control::default());
        assert_eq!(recording.calls.len(), 8 + 128 + 56 + 80);
        // The last byte of the setpoint is the mode of the quaternion, at 127.
        assert_eq!(recording.calls[8 + 127], 1);
    }
}
