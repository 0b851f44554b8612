//! Flies a craft as the supervisor orders: setpoints, a law's table and the law's memory in; the output of a
//! step out.

use quatrack::flatness::GRAVITY_M_S2;
use quatrack::mixer::MotorLimited;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{self, Guard, Levelled, Looked, Soundness};
use quatrack::{
    CascadeMemory, Command, FifthOrderSample, Followed, Handover, Heading, Limits, Memory, Quaternion, State,
};

use super::ahead::Ahead;
use super::flight::Flight;
use super::law_step::{LawStep, Unflown};
use super::outcome::{Outcome, Settings};
use crate::abi;
use crate::craft::{Craft, PERIOD_S};
use crate::heading::HeadingStream;
use crate::inbox::Newest;
use crate::output::Output;
use crate::shaping::{Shaped, Shaping};
use crate::stream::Stream;
use crate::tables::Table;
use crate::units;

/// Control steps that a change of the table takes: a quarter of a second.
pub const FADE_STEPS: u16 = 125;

/// Everything that flies: the fields that every step reads come first.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Flyer {
    pub(super) headings: HeadingStream,
    pub(super) ahead: Ahead,
    pub(super) outcome: Outcome,
    pub(super) stream: Stream,
    pub(super) flight: Flight,
    settings: Settings,
    shaping: Shaping,
    pub(super) craft: Craft,
    memory: Memory,
    table: Table,
    /// The table on its way out, and how far it is.
    before: Table,
    handover: Handover,
}

impl Flyer {
    /// For a craft, with motors off.
    pub(super) const fn new(craft: Craft, table: Table, settings: Settings) -> Self {
        Self {
            stream: Stream::new(),
            headings: HeadingStream::new(),
            ahead: Ahead::new(),
            flight: Flight::NoCraft,
            shaping: Shaping::new(PERIOD_S),
            settings,
            outcome: Outcome::OFF,
            craft,
            memory: Memory::at_rest(),
            table,
            before: table,
            handover: Handover::OVER,
        }
    }

    /// Lets the observers of the law look at the control step before; whether that took long.
    #[inline(always)]
    pub(super) fn observe(&mut self, sensors: &abi::SensorData) -> bool {
        let Some(cascade) = self.table.as_cascade().filter(|_| self.outcome.has_stepped) else { return false };
        let (felt, is_long) = (units::specific_force_m_s2(sensors), self.memory.cascade().is_air_due());
        quatrack::Controller::new(cascade, Limits::NONE).observe(&mut self.memory, felt.as_ref());
        is_long
    }

    /// Starts a flight of another kind.
    #[inline(never)]
    pub(super) fn begin(&mut self, flight: &Flight, newest: &Newest) {
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
    pub(super) fn turn_off(&mut self) {
        (self.flight, self.handover) = (Flight::Off, Handover::OVER);
        self.ahead.forget();
        self.memory.clear_integral();
    }

    /// Motors off for this step. They run down with their lag: a flight that goes on soon begins with the rest of their
    /// forces.
    #[cold]
    #[inline(never)]
    pub(super) fn switch_off(&mut self) {
        (self.outcome.output, self.outcome.limited, self.outcome.has_stepped) =
            (Output::OFF, MotorLimited::NOTHING, false);
        self.memory.run_down(self.craft.motor_lag_s / (self.craft.motor_lag_s + PERIOD_S));
    }

    /// In the air, of which nothing is known; off until a setpoint says otherwise.
    #[cold]
    pub(super) fn restart(&mut self) {
        self.memory = Memory::hovering(self.craft.airframe());
        (self.flight, self.handover) = (Flight::Off, Handover::OVER);
        self.outcome = Outcome::OFF;
        self.ahead.forget();
    }

    /// The firmware's mixer has carried commands to the motors: their forces of now have not been kept.
    fn take_motors_over(&mut self) {
        self.memory.assume_hovering(self.craft.airframe());
    }

    /// Thrust over mass that the motors should give, m/s^2.
    #[inline(always)]
    pub(super) fn thrust_m_s2(&self) -> f32 {
        let [a, b, c, d] = self.memory.forces_n();
        (a + b + c + d) * self.craft.per_force_max_1_n * (0.25 * self.craft.thrust_max_m_s2)
    }

    /// The limits that cut the law's command in the last step; none for a pilot's command by hand and for the idling of a
    /// craft on the ground.
    #[inline(always)]
    pub(super) fn cut(&self) -> MotorLimited {
        let limited = self.outcome.limited;
        if limited.any() { self.cut_in_flight(limited) } else { MotorLimited::NOTHING }
    }

    #[cold]
    #[inline(never)]
    fn cut_in_flight(&self, limited: MotorLimited) -> MotorLimited {
        let is_by_hand = !self.flight.followed().height || matches!(self.flight, Flight::Rates { .. });
        let idles = self.memory.cascade().stands() && self.thrust_m_s2() < GRAVITY_M_S2;
        if is_by_hand || idles { MotorLimited::NOTHING } else { limited }
    }

    /// Whether a law that is flown takes snap and crackle.
    #[inline(always)]
    pub(super) fn looks_beyond_jerk(&self) -> bool {
        self.table.gives_forces() || !self.handover.is_over()
    }

    /// Makes the next control step's reference along a stream. It takes nothing from the last state that was flown on,
    /// but where the leash of the paper's laws ends.
    #[inline(always)]
    pub(super) fn look_ahead(&mut self, guard: &Guard, next_step: u32) {
        if self.flight != Flight::Stream {
            return;
        }
        // The cascade's sample is made at its step, which has the time.
        if !self.table.gives_forces() && self.handover.is_over() && guard.mode() == supervisor::Mode::Flying {
            let (leash, state) = (&self.settings.bounds.leash, guard.looked().state);
            let way = (&self.stream, &self.headings);
            self.ahead.sample_on_leash_at(next_step, way, (leash, state));
            self.ahead.refer();
        }
    }

    /// To a standstill, and down, along a sample at a heading.
    #[cold]
    #[inline(never)]
    pub(super) fn brake(
        &mut self,
        looked: &Looked<'_>,
        sample: &FifthOrderSample,
        heading: Heading,
    ) -> Result<(), Unflown> {
        self.leave();
        self.fly_towards(looked, sample, heading, Followed::ALL)
    }

    /// Level, by attitude alone: the cascade by its own way, the paper's laws at a place where nothing is off.
    #[cold]
    #[inline(never)]
    pub(super) fn level(&mut self, levelled: &Levelled) {
        self.leave();
        let outcome = &mut self.outcome;
        (outcome.has_stepped, outcome.error_m) = (false, Vector3::new(0.0, 0.0, 0.0));
        let is_flown = match self.table.as_cascade() {
            Some(cascade) => match self.memory.level(cascade, levelled) {
                Some((forces_n, limited)) => {
                    (outcome.output, outcome.limited) = (Output::Forces(forces_n), limited);
                    true
                }
                None => false,
            },
            None => self.level_at_rest(levelled).is_ok(),
        };
        if !is_flown {
            self.switch_off();
        }
    }

    #[inline(never)]
    fn level_at_rest(&mut self, levelled: &Levelled) -> Result<(), Unflown> {
        let place = Vector3::new(0.0, 0.0, 0.0);
        let state = State { attitude: levelled.attitude, ..State::at_rest(place) };
        let looked = Looked {
            soundness: Soundness::AttitudeOnly,
            state: &state,
            body_rates_rad_s: &levelled.body_rates_rad_s,
            velocity_bridged_ticks: None,
        };
        let mut sample = FifthOrderSample::at_rest(place, 0.0);
        sample.flat.acceleration_m_s2 = levelled.acceleration_m_s2;
        let Quaternion { w, z, .. } = levelled.attitude;
        let heading = if w * w + z * z > 1e-6 { Heading::from_half(w, z) } else { Heading::ZERO };
        self.fly_towards(&looked, &sample, heading, Followed::ALL)
    }

    /// Forgets the state that a flight as asked would go on from.
    fn leave(&mut self) {
        self.handover = Handover::OVER;
        self.ahead.forget();
        self.shaping.begin();
        if self.table.gives_forces() && matches!(self.outcome.output, Output::Wrench(_)) {
            self.take_motors_over();
        }
    }

    /// As asked.
    #[inline(always)]
    pub(super) fn fly(&mut self, looked: &Looked<'_>, now_ms: u32) -> Result<(), Unflown> {
        if let Flight::Rates { body_rates_rad_s, thrust_m_s2 } = self.flight {
            return self.turn(&Command { thrust_m_s2, body_rates_rad_s }, looked.body_rates_rad_s);
        }
        if !self.ahead.is_for(now_ms) {
            self.shape(looked.state, now_ms);
        }
        let (r, p) = (&looked.state.position_m, &self.ahead.sample.flat.position_m);
        self.outcome.error_m = Vector3::new(r.x - p.x, r.y - p.y, r.z - p.z);
        let law_step = LawStep {
            craft: &self.craft,
            settings: &self.settings,
            sample: &self.ahead.sample,
            heading: self.ahead.heading,
            followed: self.flight.followed(),
            looked,
        };
        if let Some(reference) = self.ahead.reference_for(now_ms) {
            return law_step.follow(&self.table, reference, &mut self.memory, &mut self.outcome);
        }
        let step = if self.handover.is_over() {
            law_step.step(&self.table, &mut self.memory, &mut self.outcome)
        } else {
            let tables = (&self.before, &self.table);
            law_step.hand_over(&mut self.handover, tables, &mut self.memory, &mut self.outcome)
        };
        match step {
            Err(Unflown::Motion) => self.fly_upright(looked),
            other => other,
        }
    }

    /// The step's reference where none was made ahead: the motion of a stream, or that of setpoint shaping.
    #[inline(never)]
    fn shape(&mut self, state: &State, now_ms: u32) {
        let beyond_jerk = self.looks_beyond_jerk();
        let ahead = &mut self.ahead;
        match &self.flight {
            Flight::Guided(request) => {
                let (stream, headings, thrust_max_m_s2) = (&self.stream, &self.headings, self.craft.thrust_max_m_s2);
                let shaped = Shaped { request, stream, headings, now_ms, beyond_jerk, thrust_max_m_s2 };
                ahead.heading = self.shaping.put(&shaped, state, &self.settings.bounds, &mut ahead.sample);
            }
            _ => {
                self.stream.at(now_ms, beyond_jerk, &mut ahead.sample);
                ahead.heading = self.headings.at(now_ms, &mut ahead.sample);
            }
        }
        if !self.table.gives_forces() {
            let flat = &mut ahead.sample.flat;
            self.settings.bounds.leash.draw(&mut flat.position_m, &mut flat.velocity_m_s, state);
        }
    }

    /// Where no thrust gives the motion's acceleration, its position and velocity alone.
    #[cold]
    #[inline(never)]
    fn fly_upright(&mut self, looked: &Looked<'_>) -> Result<(), Unflown> {
        let flat = &self.ahead.sample.flat;
        let mut sample = FifthOrderSample::at_rest(flat.position_m, 0.0);
        sample.flat.velocity_m_s = flat.velocity_m_s;
        self.handover = Handover::OVER;
        self.fly_towards(looked, &sample, self.ahead.heading, self.flight.followed())
    }

    /// The law of the table towards a sample that is no flight's own.
    #[inline(never)]
    fn fly_towards(
        &mut self,
        looked: &Looked<'_>,
        sample: &FifthOrderSample,
        heading: Heading,
        followed: Followed,
    ) -> Result<(), Unflown> {
        let (r, p) = (&looked.state.position_m, &sample.flat.position_m);
        self.outcome.error_m = Vector3::new(r.x - p.x, r.y - p.y, r.z - p.z);
        let (craft, settings) = (&self.craft, &self.settings);
        let law_step = LawStep { craft, settings, sample, heading, followed, looked };
        law_step.step(&self.table, &mut self.memory, &mut self.outcome)
    }

    /// Manual flight by body rates: the same under every table.
    #[inline(never)]
    fn turn(&mut self, command: &Command, body_rates_rad_s: &Vector3<f32>) -> Result<(), Unflown> {
        let wrench = self.settings.limits.saturate(command).map(|(command, limited)| {
            self.outcome.limited = MotorLimited::of_command(limited);
            self.craft.actuation.wrench(&command, body_rates_rad_s)
        });
        match wrench {
            Some(Ok(wrench)) => {
                (self.outcome.output, self.outcome.has_stepped) = (Output::Wrench(wrench), false);
                Ok(())
            }
            _ => Err(Unflown::State),
        }
    }

    /// Keeps the table that is flown, to fade it out once another one comes: in a call of its own, each copy takes long.
    #[inline(never)]
    pub(super) fn keep_table(&mut self) {
        self.handover.end();
        self.before = self.table;
    }

    /// Flies another table from the next control step on, after [`Self::keep_table`]; in flight over [`FADE_STEPS`] of them,
    /// but for a cascade that takes over from another one: their memory is the same, and their limits hold at once.
    #[inline(never)]
    pub(super) fn change_table(&mut self, table: &Table) {
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
    pub(super) fn change_craft(&mut self, craft: &Craft) {
        self.craft = *craft;
        (self.flight, self.handover) = (Flight::Off, Handover::OVER);
    }

    /// Takes over the owner's settings.
    #[inline(never)]
    pub(super) fn set(&mut self, settings: &Settings, craft: &Craft) {
        self.settings = *settings;
        self.craft.actuation = craft.actuation;
        self.craft.motor_lag_s = craft.motor_lag_s;
    }

    /// Drag (1/s) and moment (N s) that are flown with, and the cascade's memory; nothing under another law.
    pub(super) fn learned(&self) -> Option<(f32, [f32; 2], &CascadeMemory)> {
        let cascade = self.table.as_cascade()?;
        let memory = self.memory.cascade();
        let (drag_per_s, moment_n_s) = cascade.air(memory);
        Some((drag_per_s, moment_n_s, memory))
    }

    /// Rotation vector from the attitude that the last control step wanted to the craft's, body frame, rad.
    pub(super) fn rotation_error_rad(&self, attitude: Quaternion) -> Vector3<f32> {
        if self.table.gives_forces() {
            return self.memory.cascade().rotation_error_rad();
        }
        let q = self.outcome.target.conjugate() * attitude;
        q.vector() * if q.w < 0.0 { -2.0 } else { 2.0 }
    }
}
