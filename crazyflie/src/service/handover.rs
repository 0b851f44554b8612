//! From the app's task to the stabilizer's: a craft, a table and settings, taken over one thing a call.

use crate::control::{Controller, Mode, Settings};
use crate::craft::Craft;
use crate::tables::Table;

/// How a craft has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arrival {
    /// From the app as it starts: everything begins anew.
    Started,
    /// Over the app channel: it waits until the one before does not fly.
    Sent,
}

/// Values on their way to the stabilizer's task; those present have not been taken over yet.
pub struct Handover {
    pub(super) craft: Option<(Craft, Arrival)>,
    pub(super) table: Option<Table>,
    pub(super) settings: Option<(Settings, Craft)>,
    /// The controller has kept the table that it flew.
    is_kept: bool,
}

impl Handover {
    /// Nothing handed over.
    pub(crate) const fn new() -> Self {
        Self { craft: None, table: None, settings: None, is_kept: false }
    }

    /// The controller takes over the values that are present.
    #[inline]
    pub fn take_over(&mut self, controller: &mut Controller) {
        // The settings come last and with everything else.
        if self.settings.is_some() {
            self.hand_to(controller);
        }
    }

    /// The controller is selected: it takes over a craft that has come since, whatever it flew before.
    pub fn select(&mut self, controller: &mut Controller) {
        if let Some((_, arrival)) = &mut self.craft {
            *arrival = Arrival::Started;
            self.take_over(controller);
        }
    }

    #[inline(never)]
    fn hand_to(&mut self, controller: &mut Controller) {
        match &self.craft {
            Some((_, Arrival::Sent)) if Mode::is_flight(controller.mode() as u8) => {}
            Some((craft, _)) => {
                // The motors are off: there is time, and nothing is flown with a half of it.
                controller.change_craft(craft);
                self.craft = None;
                while self.settings.is_some() {
                    self.hand_one(controller);
                }
            }
            None => self.hand_one(controller),
        }
    }

    /// One thing a call: each takes long.
    #[inline(never)]
    fn hand_one(&mut self, controller: &mut Controller) {
        match (&self.table, &self.settings) {
            (Some(_), _) if !self.is_kept => {
                controller.keep_table();
                self.is_kept = true;
            }
            (Some(table), _) => {
                controller.change_table(table);
                (self.table, self.is_kept) = (None, false);
            }
            (None, Some((settings, craft))) => {
                controller.set(settings, craft);
                self.settings = None;
            }
            (None, None) => {}
        }
    }
}
