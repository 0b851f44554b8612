//! The controller before anything is known: in the image's initialised data, so that nothing has to be built at run time.

use quatrack::gains::{Scales, cascade};
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
    let Ok(table) = Table::of_cascade(&cascade::CRAZYFLIE_2_1_100_MS, 0.1, &craft, &tuning) else { panic!("no lag") };
    let bounds = Bounds { leash: Leash { length_m: 1.0 }, speed_m_s: 1.0, acceleration_m_s2: 1.0 };
    let settings = Settings { bounds, limits: Limits::NONE, feed_forward: FeedForward::With };
    Controller::new(craft, table, settings)
};
