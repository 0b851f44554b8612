//! The controller before anything is known: in the image's initialised data, so that nothing has to be built at run time.

use quatrack::{FeedForward, Limits};

use super::{Controller, Settings};
use crate::builtin;
use crate::craft::{Craft, KNOWN};
use crate::guide::Bounds;
use crate::tables::{Gains, MotorGains, Table, TableId};

/// As it is when switched on: it knows no craft and keeps the motors off.
pub(crate) const CONTROLLER: Controller = {
    let [known, ..] = KNOWN;
    let [(lag_s, _), ..] = builtin::ANY_LAG;
    let Ok(gains) = MotorGains::new(&builtin::ANY, &known.airframe, lag_s) else { panic!("no lag") };
    let table =
        Table { id: TableId::ActuatorAware, gains: Gains::ActuatorAware(gains), margin: 1.0, limits: Limits::NONE };
    let bounds = Bounds { leash_m: 1.0, speed_m_s: 1.0, acceleration_m_s2: 1.0 };
    let settings = Settings { bounds, limits: Limits::NONE, feed_forward: FeedForward::With };
    Controller::new(Craft::with(known.airframe, known.vehicle, 0), table, settings)
};
