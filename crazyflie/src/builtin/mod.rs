//! The tables in the image with what their certificates say.

#[rustfmt::skip]
mod motor_gains;

use quatrack::law::ActuatorAwareGain;
use quatrack::{Airframe, FeedForward, Limits};

use crate::control::{Controller, Settings};
use crate::craft::{Craft, KNOWN};
use crate::guide::Bounds;
use crate::tables::{Gains, MotorGains, Table, TableId};

/// As it is when switched on: it knows no craft and keeps the motors off.
pub(crate) const CONTROLLER: Controller = {
    let [known, ..] = KNOWN;
    let Ok(gains) = MotorGains::new(&motor_gains::CRAZYFLIE_2_1, &Airframe::CRAZYFLIE_2_1, 0.126) else {
        panic!("no lag")
    };
    let table = Table { id: TableId::ActuatorAware, gains: Gains::ActuatorAware(gains), margin: 1.0 };
    let bounds = Bounds { leash_m: 1.0, speed_m_s: 1.0, acceleration_m_s2: 1.0 };
    let settings = Settings { bounds, limits: Limits::NONE, feed_forward: FeedForward::With };
    Controller::new(Craft::with(known.airframe, known.vehicle, 0), table, settings)
};

/// Of a table of the paper: the factor by which all channels of the command may be off at once, from its certificate, and
/// the longest lag of the motors, s, that the body-rate loop of this crate still makes up for at hover.
pub(crate) type Certified = (f32, f32);

/// (LYAP-E).
pub(crate) const LYAP_E: Certified = (2.4, 0.0687);
/// (LQR-E).
pub(crate) const LQR_E: Certified = (3.506, 0.0218);
/// (LYAP-F). Its position over the ground answers to no attitude: no lag is certified, this is as far as it has flown.
pub(crate) const LYAP_F: Certified = (3.714, 0.02);
/// (LQR-F), likewise.
pub(crate) const LQR_F: Certified = (14.71, 0.02);

/// A gain for where one has to stand that is not looked at.
pub(crate) static ANY: ActuatorAwareGain = motor_gains::CRAZYFLIE_2_1;

/// Gain, design lag (s) and factor for each of [`crate::craft::KNOWN`].
pub(crate) static ACTUATOR_AWARE: [(ActuatorAwareGain, f32, f32); 3] = [
    (motor_gains::CRAZYFLIE_2_1, FIGURES[0].1, FIGURES[0].2),
    (motor_gains::CRAZYFLIE_2_1_UPGRADE_KIT, FIGURES[1].1, FIGURES[1].2),
    (motor_gains::CRAZYFLIE_2_1_BRUSHLESS, FIGURES[2].1, FIGURES[2].2),
];

/// Vehicle id, design lag (s) and factor of each.
pub(crate) const FIGURES: [(u32, f32, f32); 3] = [
    motor_gains::CRAZYFLIE_2_1_FIGURES,
    motor_gains::CRAZYFLIE_2_1_UPGRADE_KIT_FIGURES,
    motor_gains::CRAZYFLIE_2_1_BRUSHLESS_FIGURES,
];
