//! The controller before anything is known: in the image's initialised data, so that nothing has to be built at run time.

use quatrack::gains::Scales;
use quatrack::gains::cascade::CRAZYFLIE_2_1_DEFAULT;
use quatrack::{Air, CascadeLimits, FeedForward, Leash, Limits};

use super::{Controller, Settings};
use crate::craft::{Craft, KNOWN};
use crate::shaping::Bounds;
use crate::tables::{Table, Tuning};

/// As it is when switched on: it knows no craft and keeps the motors off.
pub(crate) const CONTROLLER: Controller = {
    let [known, ..] = KNOWN;
    let Some(craft) = Craft::with(known.airframe, &known, 0) else { panic!("no craft") };
    let tuning = Tuning { scales: Scales::ONE, air: Air::NONE, limits: CascadeLimits::STANDARD };
    let default = &CRAZYFLIE_2_1_DEFAULT.table;
    let Ok(table) = Table::of_cascade(&default.gains, default.motor_lag_s, &craft, &tuning) else { panic!("no lag") };
    let bounds = Bounds { leash: Leash::STANDARD, speed_m_s: 1.0, acceleration_m_s2: 1.0 };
    let settings = Settings { bounds, limits: Limits::NONE, feed_forward: FeedForward::With };
    Controller::new(craft, table, settings)
};
