//! The controller before anything is known: in the image's initialised data, so that nothing has to be built at run time.

use quatrack::{FeedForward, Leash, Limits};

use super::{Controller, Settings};
use crate::builtin;
use crate::craft::{Craft, KNOWN};
use crate::guide::Bounds;
use crate::tables::{Table, TableId};

/// As it is when switched on: it knows no craft and keeps the motors off.
pub(crate) const CONTROLLER: Controller = {
    let ([known, ..], [[design, ..], ..], [(lag_s, _), ..]) = (KNOWN, builtin::ACTUATOR_AWARE, builtin::ANY_LAG);
    let Some(craft) = Craft::with(known.airframe, known.vehicle, 0) else { panic!("no craft") };
    let Ok(table) = Table::to_motors(TableId::ActuatorAware, design.gain, lag_s, &craft, 1.0) else { panic!("no lag") };
    let bounds = Bounds { leash: Leash { length_m: 1.0 }, speed_m_s: 1.0, acceleration_m_s2: 1.0 };
    let settings = Settings { bounds, limits: Limits::NONE, feed_forward: FeedForward::With };
    Controller::new(craft, table, settings)
};
