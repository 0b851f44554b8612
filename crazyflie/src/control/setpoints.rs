//! The firmware's setpoint, between control steps, in; a flight begun, carried on or ended, and the next step's reference,
//! out.

use super::Controller;
use super::background::Work;
use super::flight::Flight;
use super::outcome::Why;
use crate::abi;
use crate::inbox::{Change, News};
use crate::stream::Arrival;

impl Controller {
    /// Between control steps. Until a setpoint has been taken here the one before is carried on, which leads to the same place
    /// unless it jumps. Gives the background work that there is time for.
    #[inline]
    pub fn between(&mut self, setpoint: &abi::Setpoint, sensors: &abi::SensorData, step: u32) -> Option<Work> {
        if self.flyer.flight == Flight::NoCraft {
            return Some(self.background.next());
        }
        // One thing at a time: a setpoint waits for a call without the longest look of the observers, its heading for the next call,
        // its fit for the one after, and the next setpoint for all of that, however fast they come. It is dated by its stamp.
        self.inbox.note(setpoint, step);
        let is_busy = self.flyer.observe(sensors);
        let has_time = !is_busy && !self.catch_up() && !self.hear(setpoint, step);
        self.flyer.look_ahead(&self.guard, step.wrapping_add(1));
        if has_time { Some(self.background.next()) } else { self.background.put_off() }
    }

    /// The next thing that a motion has left to do, if any.
    #[inline(always)]
    fn catch_up(&mut self) -> bool {
        if self.is_heading_due {
            self.follow_heading();
            true
        } else if self.flyer.stream.is_due() {
            self.flyer.stream.catch_up();
            true
        } else {
            false
        }
    }

    /// The setpoint, if it is a new one.
    #[inline(always)]
    fn hear(&mut self, setpoint: &abi::Setpoint, step: u32) -> bool {
        let news = self.inbox.look(setpoint);
        match news {
            News::Nothing => {}
            News::Motion => self.follow_motion(),
            News::Other => self.take(setpoint, step),
        }
        news != News::Nothing
    }

    /// Takes a setpoint, and does as it asks.
    #[inline(never)]
    pub(super) fn take(&mut self, setpoint: &abi::Setpoint, now: u32) {
        match self.inbox.take(setpoint) {
            Change::Request(request) => {
                if !self.flyer.flight.is_on() {
                    self.guard.arm(now);
                    self.why = Why::Nothing;
                }
                self.is_bad = false;
                self.begin_or_go_on(Flight::of(&request, &self.flyer.craft));
            }
            Change::Off => self.turn_off(now),
            Change::Bad => self.bad_setpoint(),
        }
    }

    /// Takes one more motion of the stream. Its heading is left to the next call, so that none has to do everything: until then the
    /// one before turns on.
    #[inline(never)]
    fn follow_motion(&mut self) {
        let (newest, beyond_jerk) = (self.inbox.newest(), self.flyer.looks_beyond_jerk());
        let arrival = self.flyer.stream.accept(&newest.motion, newest.date_ms, beyond_jerk);
        self.is_heading_due = true;
        if arrival == Arrival::Jumped {
            self.counters.jumps = self.counters.jumps.wrapping_add(1);
        }
    }

    /// Takes the heading of the newest setpoint.
    #[inline(never)]
    fn follow_heading(&mut self) {
        let newest = self.inbox.newest();
        let is_differenced = self.flyer.looks_beyond_jerk() && newest.is_by_yaw;
        self.flyer.headings.accept(newest.heading, newest.heading_rate_rad_s, newest.date_ms, is_differenced);
        self.is_heading_due = false;
    }

    #[inline(never)]
    fn begin_or_go_on(&mut self, flight: Flight) {
        if !self.flyer.flight.is_like(&flight) {
            self.flyer.begin(&flight, self.inbox.newest());
        }
        self.flyer.flight = flight;
        self.flyer.ahead.forget();
        self.follow_motion();
        self.follow_heading();
    }

    /// Motors off, as asked.
    #[cold]
    #[inline(never)]
    fn turn_off(&mut self, now: u32) {
        self.guard.disarm(now);
        self.is_bad = false;
        self.flyer.turn_off();
    }

    /// The setpoint makes no sense: a flight goes on with it as the supervisor says; none begins with it.
    #[cold]
    #[inline(never)]
    fn bad_setpoint(&mut self) {
        self.counters.bad_setpoints = self.counters.bad_setpoints.wrapping_add(1);
        self.is_bad = true;
        if self.flyer.flight == Flight::Off && self.guard.mode().is_in_air() {
            self.flyer.flight = Flight::Unknown;
        }
    }
}
