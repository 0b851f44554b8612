//! Around the controller, in the app's task and on its stack: which craft, parameters and sent tables in; the table to
//! fly and the settings out, to be taken over between two control steps.

mod handover;
mod log;

use core::sync::atomic::Ordering::Relaxed;

use quatrack::Limits;
use quatrack::gains::table::{CascadeTable, GainTable};

use crate::control::Mode;
use crate::craft::{Craft, Platform};
use crate::own_craft::{OwnCraft, OwnCraftError};
use crate::parameters;
use crate::shared::Shared;
use crate::tables::{Brought, Refusal, Table, Tuning};
use crate::try_cell::TryCell;
use crate::upload::{Packet, Sent, Status, Uploads};
use handover::Arrival;
pub use handover::Handover;
pub use log::{log_counters, log_errors, log_learned};

/// The state of the app's task.
pub struct Service {
    /// The figures that the firmware was built with; nothing until the app has said.
    platform: Option<Platform>,
    craft: Option<Craft>,
    /// The table of a craft of the owner's.
    own: Option<CascadeTable>,
    /// The craft is new and has to be handed over.
    arrival: Option<Arrival>,
    uploads: Uploads,
    uploaded: Option<GainTable<'static>>,
    uploads_taken: u8,
    asked: Option<Asked>,
    /// Limits of the table in the air.
    limits: Limits,
}

/// The table and tuning that the owner last asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Asked {
    table: u8,
    tuning: Tuning,
    motor_lag_s: f32,
    /// Which of the sent tables, counted.
    upload: u8,
}

impl Service {
    /// Nothing known yet.
    pub(crate) const fn new() -> Self {
        Self {
            platform: None,
            craft: None,
            own: None,
            arrival: None,
            uploads: Uploads::new(),
            uploaded: None,
            uploads_taken: 0,
            asked: None,
            limits: Limits::NONE,
        }
    }

    /// Starts anew for the craft that the firmware was built for; whether there are tables for it.
    pub fn start(&mut self, platform: &Platform) -> bool {
        *self = Self::new();
        self.platform = Some(*platform);
        self.craft = Craft::of(platform);
        self.arrival = self.craft.is_some().then_some(Arrival::Started);
        self.craft.is_some()
    }

    /// Starts anew for a craft of the owner's.
    ///
    /// # Errors
    /// [`OwnCraftError`]: there is no craft then, and the motors stay off.
    pub fn start_own(&mut self, platform: &Platform, own: &OwnCraft) -> Result<(), OwnCraftError> {
        *self = Self::new();
        self.platform = Some(*platform);
        let (craft, table) = own.on(platform)?;
        (self.craft, self.own, self.arrival) = (Some(craft), Some(table), Some(Arrival::Started));
        Ok(())
    }

    /// Takes a packet of the app channel and gives the answer to it.
    pub fn packet(&mut self, packet: &Packet, shared: &Shared) -> Packet {
        let [kind, ..] = packet.bytes;
        let Some(platform) = self.platform else { return self.uploads.answer(kind, Status::Busy) };
        let (status, sent) = self.uploads.take(packet, self.craft.as_ref().map(|craft| &craft.vehicle));
        let status = match sent {
            Some(Sent::Table(table)) => {
                self.uploaded = Some(table);
                self.uploads_taken = self.uploads_taken.wrapping_add(1);
                status
            }
            Some(Sent::Craft(own)) => {
                self.change_craft(&own, &platform, shared).map_or_else(|error| error, |()| status)
            }
            None => status,
        };
        match status {
            Status::Table => refuse(shared, Refusal::Table),
            Status::Vehicle => refuse(shared, Refusal::Vehicle),
            Status::Along | Status::ActuatorAware => refuse(shared, Refusal::Law),
            _ => {}
        }
        self.uploads.answer(kind, status)
    }

    /// A craft of the owner's has been sent: it takes the place of the one before, which does not fly.
    #[inline(never)]
    fn change_craft(&mut self, own: &OwnCraft, platform: &Platform, shared: &Shared) -> Result<(), Status> {
        if Mode::is_flight(shared.log.mode.load(Relaxed)) {
            return Err(Status::Flying);
        }
        let (craft, table) = own.on(platform)?;
        if let Some(before) = &self.craft {
            parameters::replace(&shared.parameters, before, &craft);
        }
        (self.craft, self.own, self.arrival) = (Some(craft), Some(table), Some(Arrival::Sent));
        (self.uploaded, self.asked) = (None, None);
        Ok(())
    }

    /// Looks at the parameters and hands over changes; to be called a few times a second.
    pub(crate) fn apply_parameters(&mut self, shared: &Shared, handover: &TryCell<Handover>) {
        let Some(craft) = &self.craft else { return };
        if let Some(parameter) = parameters::put_back(&shared.parameters, craft)
            && self.arrival.is_none()
        {
            shared.log.put_back.fetch_add(1, Relaxed);
            shared.log.parameter.store(parameter, Relaxed);
        }
        let asked = Asked {
            table: shared.parameters.table.load(Relaxed),
            tuning: parameters::tuning(&shared.parameters, craft),
            motor_lag_s: parameters::motor_lag_s(&shared.parameters),
            upload: self.uploads_taken,
        };
        let craft = craft.with_motor_lag(asked.motor_lag_s);
        let is_asked = self.asked != Some(asked);
        let mut table = None;
        if is_asked {
            let brought = Brought { sent: self.uploaded.as_ref(), own: self.own.as_ref() };
            table = match Table::choose(asked.table, &craft, &asked.tuning, brought) {
                Ok(table) => Some(table),
                Err(refusal) => {
                    refuse(shared, refusal);
                    // There is always one to start with.
                    let first = || Table::for_published_lags(&craft, &asked.tuning, brought.own).ok();
                    if self.arrival.is_some() { first() } else { None }
                }
            };
        }
        let limits = table.as_ref().map_or(self.limits, |table| table.limits);
        let handed = handover.with(|place| {
            if let Some(arrival) = self.arrival {
                place.craft = Some((craft, arrival));
            }
            if let Some(table) = &table {
                place.table = Some(*table);
            }
            place.settings = Some((parameters::settings(&shared.parameters, &craft, &limits), craft));
        });
        if handed.is_some() {
            (self.arrival, self.asked, self.limits) = (None, Some(asked), limits);
            if let Some(table) = &table {
                show_table(shared, table);
            }
        }
    }
}

/// Says that a table is not flown.
fn refuse(shared: &Shared, refusal: Refusal) {
    shared.log.refused_tables.fetch_add(1, Relaxed);
    shared.log.refusal.store(refusal as u16, Relaxed);
}

/// The table in use, its margin and its gain.
fn show_table(shared: &Shared, table: &Table) {
    shared.log.table.store(table.id as u8, Relaxed);
    let [least, most] = table.scales;
    shared.gains.scale_min.set(least);
    shared.gains.scale_max.set(most);
    let shown = table.shown();
    shared.gains.entries.iter().zip(shown).for_each(|(to, entry)| to.set(entry));
}
