//! The craft's side of a flight: body rates in, motor forces out. Either the gyroscope and the motors of a board, or
//! nothing.

use embedded_hal::i2c::I2c;
use embedded_hal::pwm::SetDutyCycle;
use quatrack::MotorForces;
use quatrack::nalgebra::Vector3;

use crate::drivers::battery::CellVoltage;
use crate::drivers::bmi088::Gyro;
use crate::drivers::motors::Motors;

/// Body rates of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyRates {
    /// There is no gyroscope: those that come with a state count.
    NoGyroscope,
    /// Measured, rad/s.
    Measured(Vector3<f32>),
    /// The gyroscope does not answer.
    Failed,
}

/// Gyroscope and motors.
pub trait Craft {
    /// The newest body rates. Takes as long as the bus does.
    fn body_rates(&mut self) -> BodyRates;

    /// Drives the motors to forces, N; zeros stop them.
    fn drive(&mut self, forces_n: &MotorForces, battery: CellVoltage);
}

/// A processor without a craft.
#[derive(Debug)]
pub struct NoCraft;

impl Craft for NoCraft {
    #[inline(always)]
    fn body_rates(&mut self) -> BodyRates {
        BodyRates::NoGyroscope
    }

    #[inline(always)]
    fn drive(&mut self, _forces_n: &MotorForces, _battery: CellVoltage) {}
}

/// A board's own.
#[derive(Debug)]
pub struct BoardCraft<I, P> {
    /// The gyroscope, if one was found.
    pub gyro: Option<Gyro<I>>,
    /// The motors.
    pub motors: Motors<P>,
}

impl<I: I2c, P: SetDutyCycle> Craft for BoardCraft<I, P> {
    fn body_rates(&mut self) -> BodyRates {
        match self.gyro.as_mut().map(Gyro::body_rates_rad_s) {
            None => BodyRates::NoGyroscope,
            Some(Ok(rates)) => BodyRates::Measured(Vector3::from(rates)),
            Some(Err(_)) => BodyRates::Failed,
        }
    }

    fn drive(&mut self, forces_n: &MotorForces, battery: CellVoltage) {
        // After an error the motors are off already; the forces have been checked before.
        let _ = self.motors.drive(forces_n, battery);
    }
}
