//! A flight of another kind, another table, craft or setting in; the flyer changed to it, and the memory that no longer holds forgotten, out.

use quatrack::mixer::MotorLimited;
use quatrack::{Handover, Memory};

use super::Flyer;
use crate::control::flight::Flight;
use crate::control::outcome::{Outcome, Settings};
use crate::craft::{Craft, PERIOD_S};
use crate::inbox::Newest;
use crate::output::Output;
use crate::stream::Stream;
use crate::tables::Table;

/// Control steps that a change of the table takes: a quarter of a second.
pub const FADE_STEPS: u16 = 125;

impl Flyer {
    /// Starts a flight of another kind.
    #[inline(never)]
    pub(in crate::control) fn begin(&mut self, flight: &Flight, newest: &Newest) {
        self.stream = Stream::new();
        self.headings.begin(newest.heading, newest.heading_rate_rad_s, newest.date_ms);
        self.shaping.begin();
        if matches!(self.flight, Flight::Rates { .. }) {
            self.take_motors_over();
        }
        if !flight.followed().across || matches!(flight, Flight::Rates { .. }) {
            self.memory.clear_integral();
        }
    }

    /// Motors off, as asked.
    #[cold]
    pub(in crate::control) fn turn_off(&mut self) {
        (self.flight, self.handover) = (Flight::Off, Handover::OVER);
        self.ahead.forget();
        self.memory.clear_integral();
    }

    /// Motors off for this step. They run down with their lag: a flight that goes on soon begins with the rest of their
    /// forces.
    #[cold]
    #[inline(never)]
    pub(in crate::control) fn switch_off(&mut self) {
        (self.outcome.output, self.outcome.limited, self.outcome.has_stepped) =
            (Output::OFF, MotorLimited::NOTHING, false);
        self.memory.run_down(self.craft.motor_lag_s / (self.craft.motor_lag_s + PERIOD_S));
    }

    /// In the air, of which nothing is known; off until a setpoint says otherwise.
    #[cold]
    pub(in crate::control) fn restart(&mut self) {
        self.memory = Memory::hovering(self.craft.airframe());
        (self.flight, self.handover) = (Flight::Off, Handover::OVER);
        self.outcome = Outcome::OFF;
        self.ahead.forget();
    }

    /// The firmware's mixer has carried commands to the motors: their forces of now have not been kept.
    pub(super) fn take_motors_over(&mut self) {
        self.memory.assume_hovering(self.craft.airframe());
    }

    /// Keeps the table that is flown, to fade it out once another one comes: in a call of its own, each copy takes long.
    #[inline(never)]
    pub(in crate::control) fn keep_table(&mut self) {
        self.handover.end();
        self.before = self.table;
    }

    /// Flies another table from the next control step on, after [`Self::keep_table`]; in flight over [`FADE_STEPS`] of them,
    /// but for a cascade that takes over from another one: their memory is the same, and their limits hold at once.
    #[inline(never)]
    pub(in crate::control) fn change_table(&mut self, table: &Table) {
        self.table = *table;
        let (old, new) = (&self.before, &self.table);
        if self.flight.is_on() && !(old.gives_forces() && new.gives_forces()) {
            if !old.gives_forces() {
                self.memory.assume_hovering(self.craft.airframe());
            }
            let feed_forward = self.settings.feed_forward;
            let (old, new) = (old.law(feed_forward), new.law(feed_forward));
            self.handover.begin_again(FADE_STEPS, &old, &new, &mut self.memory);
        }
        self.ahead.forget();
    }

    /// Starts for a craft: motors off until a setpoint comes.
    #[inline(never)]
    pub(in crate::control) fn change_craft(&mut self, craft: &Craft) {
        self.craft = *craft;
        (self.flight, self.handover) = (Flight::Off, Handover::OVER);
    }

    /// Takes over the owner's settings.
    #[inline(never)]
    pub(in crate::control) fn set(&mut self, settings: &Settings, craft: &Craft) {
        self.settings = *settings;
        self.craft.actuation = craft.actuation;
        self.craft.motor_lag_s = craft.motor_lag_s;
    }
}
