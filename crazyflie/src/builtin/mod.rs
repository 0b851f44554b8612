//! The tables in the image with what their certificates say.

#[rustfmt::skip]
mod motor_gains;
mod paper_limits;

use quatrack::law::ActuatorAwareGain;

pub(crate) use paper_limits::{LQR_E, LQR_F, LYAP_E, LYAP_F};

/// Of a table of the paper: the factor by which all channels of the command may be off at once, from its certificate, and
/// the longest lag of the motors, s, with which it is flown.
pub(crate) type Certified = (f32, f32);

/// A gain for motor forces with what it is certified for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Design {
    /// The gain.
    pub(crate) gain: ActuatorAwareGain,
    /// Shortest and longest lag of the motors, s, that it flies with where its owner states it.
    pub(crate) stated_s: [f32; 2],
    /// The factor by which its feedback may be off.
    pub(crate) margin: f32,
}

/// For each of [`crate::craft::KNOWN`], for the shortest lags first; the last one also where none is stated.
pub(crate) static ACTUATOR_AWARE: [[Design; 3]; 3] =
    [motor_gains::CRAZYFLIE_2_1, motor_gains::CRAZYFLIE_2_1_UPGRADE_KIT, motor_gains::CRAZYFLIE_2_1_BRUSHLESS];

/// Lag (s) that the last one of each craft flies with where none is stated, and the factor by which its feedback may be off
/// then.
pub(crate) const ANY_LAG: [(f32, f32); 3] = [
    motor_gains::CRAZYFLIE_2_1_ANY,
    motor_gains::CRAZYFLIE_2_1_UPGRADE_KIT_ANY,
    motor_gains::CRAZYFLIE_2_1_BRUSHLESS_ANY,
];

/// Vehicle id of each.
pub(crate) const IDS: [u32; 3] =
    [motor_gains::CRAZYFLIE_2_1_ID, motor_gains::CRAZYFLIE_2_1_UPGRADE_KIT_ID, motor_gains::CRAZYFLIE_2_1_BRUSHLESS_ID];
