//! Four brushed motors: forces in, duties of four PWM channels out.
//!
//! Every error turns all of them off: a force that is not finite, a channel that does not answer. Nothing is
//! ever asked of a channel beyond its full duty.

use core::fmt;

use embedded_hal::pwm::SetDutyCycle;

use super::battery::CellVoltage;
use super::thrust_curve::{Duty, ThrustCurve};

/// Forces of M1 to M4, N.
pub type Forces = [f32; 4];

/// M1 to M4, each on a channel.
#[derive(Debug)]
pub struct Motors<P> {
    channels: [P; 4],
    curve: ThrustCurve,
}

/// Whether the forces were met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driven {
    /// As they were asked for.
    Whole,
    /// The battery has less than at least one of them takes; that motor is on all the time.
    BatteryShort,
}

/// Why all motors are off. They are numbered from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotorError<E> {
    /// A force is not a finite number.
    NotFinite {
        /// The motor.
        motor: u8,
        /// Its force, N.
        force_n: f32,
    },
    /// A channel refused its duty. It may hold the last one; the others are off.
    Channel {
        /// The motor.
        motor: u8,
        /// Its error.
        error: E,
    },
}

impl<P: SetDutyCycle> Motors<P> {
    /// Four channels in the order M1 to M4, and how their motors answer. Turns all off.
    ///
    /// # Errors
    /// As [`Self::stop`].
    pub fn new(channels: [P; 4], curve: ThrustCurve) -> Result<Self, P::Error> {
        let mut motors = Self { channels, curve };
        motors.stop()?;
        Ok(motors)
    }

    /// Drives every motor to its force (N): off at and below zero, at idle up to the curve's least.
    ///
    /// # Errors
    /// [`MotorError`]; all motors are then off.
    pub fn drive(&mut self, forces_n: &Forces, battery: CellVoltage) -> Result<Driven, MotorError<P::Error>> {
        let mut duties = [Duty::OFF; 4];
        for ((motor, force_n), duty) in (1..).zip(forces_n).zip(&mut duties) {
            let Some(found) = self.curve.duty(*force_n, battery) else {
                // A channel that refuses here refuses again at the next stop.
                let _ = self.stop();
                return Err(MotorError::NotFinite { motor, force_n: *force_n });
            };
            *duty = found;
        }
        for ((motor, channel), duty) in (1..).zip(&mut self.channels).zip(&duties) {
            let counts = counts(*duty, channel.max_duty_cycle());
            if let Err(error) = channel.set_duty_cycle(counts) {
                // The first error is the one to tell.
                let _ = self.stop();
                return Err(MotorError::Channel { motor, error });
            }
        }
        Ok(if duties.iter().any(|duty| duty.is_short) { Driven::BatteryShort } else { Driven::Whole })
    }

    /// Turns every motor off, also where one of them refuses.
    ///
    /// # Errors
    /// The error of the first channel that refused; the others are off.
    pub fn stop(&mut self) -> Result<(), P::Error> {
        let mut stopped = Ok(());
        for channel in &mut self.channels {
            stopped = stopped.and(channel.set_duty_cycle_fully_off());
        }
        stopped
    }

    /// Gives the channels back, off or not.
    pub fn release(self) -> [P; 4] {
        self.channels
    }
}

/// The nearest count of a channel.
#[inline]
fn counts(duty: Duty, max: u16) -> u16 {
    // A fraction is within 0 to 1; the cast cuts.
    ((duty.fraction * f32::from(max) + 0.5) as u16).min(max)
}

impl<E: fmt::Debug> fmt::Display for MotorError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { motor, force_n } => {
                write!(f, "motor {motor}: a force of {force_n} N; all motors are off")
            }
            Self::Channel { motor, error } => {
                write!(f, "motor {motor}: its channel refused ({error:?}); the others are off")
            }
        }
    }
}

impl<E: fmt::Debug> core::error::Error for MotorError<E> {}
