//! The craft that this image flies: a Crazyflie 2.1 by its figures in `gains/vehicles/crazyflie-2.1.toml`.

use quatrack::gains::table::{Name, Vehicle};
use quatrack::nalgebra::Vector3;
use quatrack::{Actuation, Airframe, MotorForces, Rate};

use crate::rates::{DECIMATION, TICK_RATE_HZ};

/// The vehicle whose gain tables are accepted.
pub const VEHICLE: Vehicle = Vehicle { name: Name::literal("crazyflie-2.1"), id: 0x8983_3c06 };

/// The craft.
pub const AIRFRAME: Airframe = Airframe::CRAZYFLIE_2_1;

/// Largest body rates that its rate loop follows, rad/s.
pub const BODY_RATES_MAX_RAD_S: Vector3<f32> = Vector3::new(20.0, 20.0, 10.0);

/// Farthest that a flight begins from its reference, m: the range in which the linear laws hold.
pub const START_MAX_M: f32 = 1.0;

/// Forces that stop the motors.
pub const STOPPED: MotorForces = [0.0; 4];

/// Control steps a second that the tables in the image are made for.
pub const STEP_RATE: Rate = match Rate::from_hz(TICK_RATE_HZ / DECIMATION) {
    Some(rate) => rate,
    None => panic!("the core does not step at this rate"),
};

/// The craft's way to its motors at that rate.
pub const ACTUATION: Actuation = match Actuation::new(&AIRFRAME, STEP_RATE) {
    Ok(actuation) => actuation,
    Err(_) => panic!("the motors are too fast for this rate"),
};
