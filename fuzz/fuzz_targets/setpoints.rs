//! Any setpoints, states and gyroscope into the Crazyflie's controller: its output is finite and within the motors'
//! range.
#![no_main]

use std::sync::atomic::Ordering::Relaxed;

use libfuzzer_sys::fuzz_target;
use quatrack_crazyflie::abi::{Attitude, Control, Mode, Modes, Quaternion, SensorData, Setpoint, State, Vector};
use quatrack_crazyflie::ffi;
use quatrack_simulation::crazyflie::{Firmware, Sensors, Tune};
use quatrack_simulation::vehicles;

/// Bytes to take from.
struct Source<'b>(&'b [u8]);

impl Source<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (byte, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*byte)
    }

    /// Hundredths, or any bits.
    fn number(&mut self, any: bool) -> Option<f32> {
        if any {
            let (bytes, rest) = self.0.split_first_chunk()?;
            self.0 = rest;
            return Some(f32::from_le_bytes(*bytes));
        }
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(f32::from(i16::from_le_bytes(*bytes)) / 100.0)
    }

    fn vector(&mut self, any: bool) -> Option<Vector> {
        Some(Vector { timestamp: 0, x: self.number(any)?, y: self.number(any)?, z: self.number(any)? })
    }

    fn angles(&mut self, any: bool) -> Option<Attitude> {
        Some(Attitude { timestamp: 0, roll: self.number(any)?, pitch: self.number(any)?, yaw: self.number(any)? })
    }

    fn quaternion(&mut self, any: bool) -> Option<Quaternion> {
        Some(Quaternion { x: self.number(any)?, y: self.number(any)?, z: self.number(any)?, w: self.number(any)? })
    }

    fn modes(&mut self) -> Option<Modes> {
        let mut mode = || self.byte().map(|byte| Mode((byte % 4).into()));
        Some(Modes { x: mode()?, y: mode()?, z: mode()?, roll: mode()?, pitch: mode()?, yaw: mode()?, quat: mode()? })
    }
}

fn fly(bytes: &[u8]) -> Option<()> {
    let mut source = Source(bytes);
    let names = ["crazyflie-2.1", "crazyflie-2.1-upgrade-kit", "crazyflie-2.1-brushless"];
    let vehicle = vehicles::by_name(names[usize::from(source.byte()? % 3)]).ok()?;
    let _alone = Firmware::start(&vehicle, &Tune::new(0, 0.0), Sensors { gyro_noise_rad_s: 0.0, estimate_steps: 1 });
    let most_n = 4.0 * vehicle.motors().thrust_max_n as f32 * 1.000_1;
    let (mut control, mut step) = (Control::default(), 10_u32);
    while let Some(bits) = source.byte() {
        let any = bits & 1 == 1;
        let setpoint = Setpoint {
            timestamp: if bits & 2 == 0 { step } else { 0 },
            mode: source.modes()?,
            position: source.vector(any)?,
            velocity: source.vector(any)?,
            acceleration: source.vector(any)?,
            jerk: source.vector(any)?,
            attitude: source.angles(any)?,
            attitude_rate: source.angles(any)?,
            attitude_quaternion: source.quaternion(any)?,
            thrust: source.number(any)?,
            velocity_body: (bits >> 2) & 1,
        };
        let state = State {
            position: source.vector(any)?,
            velocity: source.vector(any)?,
            attitude_quaternion: source.quaternion(any)?,
            ..State::default()
        };
        let gyro = [source.number(any)?, source.number(any)?, source.number(any)?];
        let sensors = SensorData { gyro, ..SensorData::default() };
        ffi::quatrack.parameters.table.store(source.byte()? % 8, Relaxed);
        ffi::quatrackService();
        for _ in 0..=bits >> 3 {
            ffi::controllerOutOfTree(&mut control, &setpoint, &sensors, &state, step);
            step = step.wrapping_add(1);
            assert!(control.payload.iter().all(|value| value.is_finite()), "{control:?}");
            match control.control_mode {
                Control::FORCE => assert!(control.payload.iter().all(|force| (0.0..=1.0).contains(force)), "{control:?}"),
                Control::FORCE_TORQUE => assert!((0.0..=most_n).contains(&control.payload[0]), "{control:?}"),
                _ => panic!("{control:?}"),
            }
        }
    }
    Some(())
}

fuzz_target!(|bytes: &[u8]| {
    // Where the bytes end.
    let _ = fly(bytes);
});
