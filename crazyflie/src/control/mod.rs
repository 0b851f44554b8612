//! The controller: setpoints, estimates and gyroscope readings at 1 kHz in; thrust and torque, or motor forces, out at
//! 500 Hz.
//!
//! A control step makes an output and does nothing else. The call between takes setpoints, lets the law's observers look, makes
//! what the next step follows, and does background work.
//!
//! A change of the table is faded over [`FADE_STEPS`] control steps, both laws stepping side by side. The stabilizer's
//! stack is small: what is large is here and is written in place.

mod ahead;
mod background;
mod flight;
mod law_step;
mod outcome;
mod power_on;

use quatrack::mixer::MotorLimited;
use quatrack::nalgebra::Vector3;
use quatrack::{CascadeMemory, Command, FifthOrderSample, Handover, Limits, Memory, Quaternion, RigidState, State};

use self::ahead::Ahead;
use self::background::Background;
pub use self::background::Work;
use self::flight::Flight;
use self::law_step::{LawStep, Unflown};
pub use self::outcome::{Counters, Mode, Outcome, Settings};
pub(crate) use self::power_on::CONTROLLER;
use crate::abi;
use crate::craft::{Craft, DECIMATION, PERIOD_S};
use crate::heading::HeadingStream;
use crate::inbox::{Change, Inbox, News};
use crate::output::Output;
use crate::shaping::{Shaped, Shaping};
use crate::stream::{Arrival, Stream};
use crate::tables::Table;
use crate::units;

/// Control steps that a change of the table takes: a quarter of a second.
pub const FADE_STEPS: u16 = 125;

/// Time without a control step after which another controller has flown, or nobody, ms.
const ABSENT_MS: u32 = 25;

/// The controller of a craft.
///
/// In this order: a load of a float reaches a kilobyte from where the controller is, and what every step looks at is to be
/// within.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Controller {
    inbox: Inbox,
    stream: Stream,
    headings: HeadingStream,
    /// The heading of the newest setpoint is still to be taken.
    is_heading_due: bool,
    ahead: Ahead,
    flight: Flight,
    shaping: Shaping,
    settings: Settings,
    outcome: Outcome,
    counters: Counters,
    /// The last control step; nothing when the controller has just been selected.
    last_step: Option<u32>,
    background: Background,
    craft: Craft,
    memory: Memory,
    table: Table,
    /// The table on its way out, and how far it is.
    before: Table,
    handover: Handover,
}

impl Controller {
    /// For a craft, with motors off.
    pub const fn new(craft: Craft, table: Table, settings: Settings) -> Self {
        Self {
            inbox: Inbox::new(),
            stream: Stream::new(),
            headings: HeadingStream::new(),
            is_heading_due: false,
            ahead: Ahead::new(),
            flight: Flight::NoCraft,
            shaping: Shaping::new(PERIOD_S),
            settings,
            outcome: Outcome::OFF,
            counters: Counters { bad_states: 0, bad_setpoints: 0, limited_steps: 0, jumps: 0 },
            last_step: None,
            background: Background::new(),
            craft,
            memory: Memory::at_rest(),
            table,
            before: table,
            handover: Handover::OVER,
        }
    }

    /// One of the firmware's steps: whether [`Self::outcome`] is new; between control steps the last one holds.
    #[inline]
    pub fn step(&mut self, setpoint: &abi::Setpoint, sensors: &abi::SensorData, state: &abi::State, step: u32) -> bool {
        if !step.is_multiple_of(DECIMATION) {
            return false;
        }
        if self.flight == Flight::NoCraft {
            self.outcome.output = Output::OFF;
            return true;
        }
        let state = RigidState { state: units::state(state), body_rates_rad_s: units::body_rates_rad_s(sensors) };
        let is_absent = self.last_step.is_none_or(|last| step.wrapping_sub(last) > ABSENT_MS);
        if self.inbox.is_urgent(setpoint, step) || is_absent {
            if is_absent {
                self.restart();
            }
            self.take(setpoint, &state.state);
        }
        self.last_step = Some(step);
        self.outcome.limited = MotorLimited::NOTHING;
        if !self.flight.is_on() {
            self.switch_off();
        } else if self.fly(&state, step).is_err() {
            self.bad_state();
        } else {
            self.outcome.is_blind = false;
        }
        if self.outcome.limited.any() {
            self.counters.limited_steps = self.counters.limited_steps.wrapping_add(1);
        }
        true
    }

    /// Between control steps. Until a setpoint has been taken here the one before is carried on, which leads to the same place
    /// unless it jumps. Gives the background work that there is time for.
    #[inline]
    pub fn between(
        &mut self,
        setpoint: &abi::Setpoint,
        sensors: &abi::SensorData,
        state: &abi::State,
        step: u32,
    ) -> Option<Work> {
        if self.flight == Flight::NoCraft {
            return Some(self.background.next());
        }
        // One thing at a time: a setpoint that comes with the longest look of the observers is taken a call later, and is fitted
        // another one later. It is dated by its stamp.
        let is_busy = self.observe(sensors);
        let news = if is_busy { self.inbox.glance(setpoint, step) } else { self.inbox.look(setpoint, step) };
        let has_time = news == News::Nothing && !(is_busy || self.is_heading_due || self.stream.is_due());
        match news {
            News::Nothing if is_busy || has_time => {}
            News::Nothing if self.is_heading_due => self.follow_heading(),
            News::Nothing => self.stream.catch_up(),
            News::Motion => self.follow_motion(),
            News::Other => self.take(setpoint, &units::state(state)),
        }
        self.look_ahead(state, step.wrapping_add(1));
        if has_time { Some(self.background.next()) } else { self.background.put_off() }
    }

    /// Lets the observers of the law look at the control step before; whether that took long.
    #[inline(always)]
    fn observe(&mut self, sensors: &abi::SensorData) -> bool {
        let has_stepped = matches!(self.flight, Flight::Stream | Flight::Guided(_)) && !self.outcome.is_blind;
        let Some(cascade) = self.table.as_cascade().filter(|_| has_stepped) else { return false };
        let (felt, is_long) = (units::specific_force_m_s2(sensors), self.memory.cascade().is_air_due());
        quatrack::Controller::new(cascade, Limits::NONE).observe(&mut self.memory, felt.as_ref());
        is_long
    }

    /// Takes a setpoint, and does what it asks for.
    #[inline(never)]
    fn take(&mut self, setpoint: &abi::Setpoint, state: &State) {
        match self.inbox.take(setpoint) {
            Change::Request(request) => self.begin_or_go_on(Flight::of(&request, &self.craft), state),
            Change::Off => self.turn_off(),
            Change::Bad => self.bad_setpoint(state),
        }
    }

    /// Takes one more motion of the stream. Its heading is left to the next call, so that none has to do everything: until then the
    /// one before turns on.
    #[inline(never)]
    fn follow_motion(&mut self) {
        let (newest, beyond_jerk) = (self.inbox.newest(), self.looks_beyond_jerk());
        let arrival = self.stream.accept(&newest.motion, newest.date_ms, beyond_jerk);
        self.is_heading_due = true;
        if arrival == Arrival::Jumped {
            self.counters.jumps = self.counters.jumps.wrapping_add(1);
        }
    }

    /// Takes the heading of the newest setpoint.
    #[inline(never)]
    fn follow_heading(&mut self) {
        let newest = self.inbox.newest();
        let is_differenced = self.looks_beyond_jerk() && newest.is_by_yaw;
        self.headings.accept(newest.heading, newest.heading_rate_rad_s, newest.date_ms, is_differenced);
        self.is_heading_due = false;
    }

    #[inline(never)]
    fn begin_or_go_on(&mut self, flight: Flight, state: &State) {
        if !self.flight.is_like(&flight) {
            self.begin(&flight, state);
        }
        self.flight = flight;
        self.ahead.forget();
        self.follow_motion();
        self.follow_heading();
    }

    /// Starts a flight of another kind.
    #[inline(never)]
    fn begin(&mut self, flight: &Flight, state: &State) {
        self.stream = Stream::new();
        let newest = self.inbox.newest();
        self.headings.begin(newest.heading, newest.heading_rate_rad_s, newest.date_ms);
        self.shaping.begin(state, units::heading_rad(&state.attitude));
        if matches!(self.flight, Flight::Rates { .. }) {
            // The firmware's mixer has carried the pilot's rates to the motors: what they have by now nobody has kept.
            self.memory.assume_hovering(self.craft.airframe());
        }
        if !flight.followed().across || matches!(flight, Flight::Rates { .. }) {
            self.memory.clear_integral();
        }
    }

    /// Motors off, as asked.
    #[cold]
    #[inline(never)]
    fn turn_off(&mut self) {
        (self.flight, self.handover) = (Flight::Off, Handover::OVER);
        self.ahead.forget();
        self.memory.clear_integral();
    }

    /// The setpoint makes no sense: what is flown instead.
    #[cold]
    #[inline(never)]
    fn bad_setpoint(&mut self, state: &State) {
        self.counters.bad_setpoints = self.counters.bad_setpoints.wrapping_add(1);
        self.begin_or_go_on(Flight::of_bad_setpoint(&self.flight), state);
    }

    /// Estimate or gyroscope are not to be flown on: motors off for this step.
    #[cold]
    #[inline(never)]
    fn bad_state(&mut self) {
        self.counters.bad_states = self.counters.bad_states.wrapping_add(1);
        self.outcome.is_blind = true;
        self.switch_off();
    }

    /// Motors off for this step. They run down with their lag: who flies on soon has the rest of their forces.
    #[cold]
    #[inline(never)]
    fn switch_off(&mut self) {
        self.outcome.output = Output::OFF;
        self.memory.run_down(self.craft.motor_lag_s / (self.craft.motor_lag_s + PERIOD_S));
    }

    /// Whether a law that is flown takes snap and crackle.
    #[inline(always)]
    fn looks_beyond_jerk(&self) -> bool {
        self.table.gives_forces() || !self.handover.is_over()
    }

    /// Makes what the next control step follows along a stream. It takes nothing from the estimate but where the leash of the
    /// paper's laws ends.
    #[inline(always)]
    fn look_ahead(&mut self, state: &abi::State, next_step: u32) {
        if self.flight != Flight::Stream {
            return;
        }
        // The cascade's sample is made at its step, which has the time.
        if !self.table.gives_forces() && self.handover.is_over() {
            let leash = &self.settings.bounds.leash;
            let way = (&self.stream, &self.headings);
            self.ahead.sample_on_leash_at(next_step, way, (leash, &units::state(state)));
            self.ahead.refer();
        }
    }

    /// Another controller has flown in the meantime, or nobody: nothing that was remembered holds. The motors are
    /// taken to carry the craft until a setpoint says that they are off.
    #[cold]
    #[inline(never)]
    fn restart(&mut self) {
        self.memory = Memory::hovering(self.craft.airframe());
        (self.flight, self.handover) = (Flight::Off, Handover::OVER);
        self.outcome.is_blind = false;
        self.ahead.forget();
    }

    /// Forgets what it remembers, at the next control step.
    pub fn forget(&mut self) {
        self.last_step = None;
    }

    #[inline(always)]
    fn fly(&mut self, state: &RigidState, now_ms: u32) -> Result<(), Unflown> {
        if let Flight::Rates { body_rates_rad_s, thrust_m_s2 } = self.flight {
            return self.turn(&Command { thrust_m_s2, body_rates_rad_s }, state);
        }
        if !self.ahead.is_for(now_ms) {
            self.shape(state, now_ms);
        }
        let (r, p) = (&state.state.position_m, &self.ahead.sample.flat.position_m);
        self.outcome.error_m = Vector3::new(r.x - p.x, r.y - p.y, r.z - p.z);
        let law_step = LawStep {
            craft: &self.craft,
            settings: &self.settings,
            sample: &self.ahead.sample,
            heading: self.ahead.heading,
            followed: self.flight.followed(),
            state,
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
            Err(Unflown::Motion) => self.fly_upright(state),
            other => other,
        }
    }

    /// What the step follows where nobody has looked ahead: the motion of a stream, or what setpoint shaping makes.
    #[inline(never)]
    fn shape(&mut self, state: &RigidState, now_ms: u32) {
        let beyond_jerk = self.looks_beyond_jerk();
        let ahead = &mut self.ahead;
        match &self.flight {
            Flight::Guided(request) => {
                let (stream, headings, thrust_max_m_s2) = (&self.stream, &self.headings, self.craft.thrust_max_m_s2);
                let shaped = Shaped { request, stream, headings, now_ms, beyond_jerk, thrust_max_m_s2 };
                ahead.heading = self.shaping.put(&shaped, &state.state, &self.settings.bounds, &mut ahead.sample);
            }
            _ => {
                self.stream.at(now_ms, beyond_jerk, &mut ahead.sample);
                ahead.heading = self.headings.at(now_ms, &mut ahead.sample);
            }
        }
        if !self.table.gives_forces() {
            let flat = &mut ahead.sample.flat;
            self.settings.bounds.leash.draw(&mut flat.position_m, &mut flat.velocity_m_s, &state.state);
        }
    }

    /// Where the motion asks for what no thrust does, its position and velocity alone.
    #[cold]
    #[inline(never)]
    fn fly_upright(&mut self, state: &RigidState) -> Result<(), Unflown> {
        let flat = &self.ahead.sample.flat;
        let mut sample = FifthOrderSample::at_rest(flat.position_m, 0.0);
        sample.flat.velocity_m_s = flat.velocity_m_s;
        let law_step = LawStep {
            craft: &self.craft,
            settings: &self.settings,
            sample: &sample,
            heading: self.ahead.heading,
            followed: self.flight.followed(),
            state,
        };
        self.handover = Handover::OVER;
        law_step.step(&self.table, &mut self.memory, &mut self.outcome)
    }

    /// Manual flight by body rates: the same under every table.
    #[inline(never)]
    fn turn(&mut self, command: &Command, state: &RigidState) -> Result<(), Unflown> {
        let wrench = self.settings.limits.saturate(command).map(|(command, limited)| {
            self.outcome.limited = MotorLimited::of_command(limited);
            self.craft.actuation.wrench(&command, &state.body_rates_rad_s)
        });
        match wrench {
            Some(Ok(wrench)) => {
                self.outcome.output = Output::Wrench(wrench);
                Ok(())
            }
            _ => Err(Unflown::State),
        }
    }

    /// Keeps the table that is flown, to fade it out once another one comes: in a call of its own, each copy takes long.
    #[inline(never)]
    pub fn keep_table(&mut self) {
        self.handover.end();
        self.before = self.table;
    }

    /// Flies another table from the next control step on, after [`Self::keep_table`]; in flight over [`FADE_STEPS`] of them,
    /// but for a cascade that takes over from another one: what they remember is the same, and their limits hold at once.
    #[inline(never)]
    pub fn change_table(&mut self, table: &Table) {
        self.table = *table;
        let (old, new) = (&self.before, &self.table);
        if self.flight.is_on() && !(old.gives_forces() && new.gives_forces()) {
            if !old.gives_forces() {
                // The firmware's mixer has carried its commands to the motors: what they have by now nobody has kept.
                self.memory.assume_hovering(self.craft.airframe());
            }
            let feed_forward = self.settings.feed_forward;
            if let (Ok(old), Ok(new)) = (old.law(feed_forward), new.law(feed_forward)) {
                self.handover.begin_again(FADE_STEPS, &old, &new, &mut self.memory);
            }
        }
        self.ahead.forget();
    }

    /// Starts for a craft: motors off until a setpoint comes.
    #[inline(never)]
    pub fn change_craft(&mut self, craft: &Craft) {
        self.craft = *craft;
        (self.flight, self.handover) = (Flight::Off, Handover::OVER);
        self.last_step = None;
        self.counters = Counters::default();
    }

    /// Takes over what the owner has set.
    #[inline(never)]
    pub fn set(&mut self, settings: &Settings, craft: &Craft) {
        self.settings = *settings;
        self.craft.actuation = craft.actuation;
        self.craft.motor_lag_s = craft.motor_lag_s;
    }

    /// How the last setpoint is flown.
    pub fn mode(&self) -> Mode {
        if self.flight.is_on() && self.outcome.is_blind { Mode::Blind } else { self.flight.mode() }
    }

    /// The craft.
    pub fn craft(&self) -> &Craft {
        &self.craft
    }

    /// What has been seen so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// What the last control step gave.
    pub fn outcome(&self) -> &Outcome {
        &self.outcome
    }

    /// Drag (1/s) and moment (N s) that are flown with, and what else the cascade has seen; nothing under another law.
    pub fn learned(&self) -> Option<(f32, [f32; 2], &CascadeMemory)> {
        let cascade = self.table.as_cascade()?;
        let memory = self.memory.cascade();
        let (drag_per_s, moment_n_s) = cascade.air(memory);
        Some((drag_per_s, moment_n_s, memory))
    }

    /// Rotation vector from what the last control step wanted to the craft's attitude, body frame, rad.
    pub fn rotation_error_rad(&self, attitude: Quaternion) -> Vector3<f32> {
        if self.table.gives_forces() {
            return self.memory.cascade().rotation_error_rad();
        }
        let q = self.outcome.target.conjugate() * attitude;
        q.vector() * if q.w < 0.0 { -2.0 } else { 2.0 }
    }
}
