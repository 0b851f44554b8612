//! The controller: setpoints, estimates and gyroscope readings at 1 kHz in; thrust and torque, or motor forces, out at
//! 500 Hz.
//!
//! A change of the table is faded over [`FADE_STEPS`] control steps, both laws stepping side by side. The stabilizer's
//! stack is small: what is large lies here and is written in place.

mod chores;
mod law_step;
mod outcome;
mod power_on;

use quatrack::mixer::MotorLimited;
use quatrack::nalgebra::Vector3;
use quatrack::{Command, FifthOrderSample, Handover, Heading, Memory, Quaternion, Reference, RigidState, State};

pub use self::chores::Chore;
use self::chores::Chores;
use self::law_step::{LawStep, Unflown};
pub use self::outcome::{Counters, Mode, Outcome, Settings};
pub(crate) use self::power_on::CONTROLLER;
use crate::abi;
use crate::craft::{Craft, DECIMATION, PERIOD_S};
use crate::demand::{Demand, Flight, Horizontal, Motion, Turn, Vertical};
use crate::edge;
use crate::guide::{Along, Guide};
use crate::output::Output;
use crate::stream::{Arrival, GAP_MAX_MS, Stream};
use crate::tables::Table;
use crate::turning::Turning;

/// Control steps that a change of the table takes: a quarter of a second.
pub const FADE_STEPS: u16 = 125;

/// How fast a craft goes down whose setpoint makes no sense, m/s.
const DESCENT_M_S: f32 = 0.3;

/// The controller of a craft.
///
/// In this order: a load of a float reaches a kilobyte from where the controller lies, and what every step looks at is to be
/// within.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Controller {
    /// The newest one taken, but for the motion of those that only went on.
    setpoint: abi::Setpoint,
    stream: Stream,
    sample: FifthOrderSample,
    heading: Heading,
    /// What the sample asks of the paper's laws, and at which step that is still to come.
    prepared: Option<Reference>,
    prepared_for: Option<u32>,
    flight: Option<Flight>,
    /// When the newest setpoint came that continued it, ms.
    came_ms: u32,
    turning: Turning,
    guide: Guide,
    settings: Settings,
    outcome: Outcome,
    last_step: u32,
    is_handing_over: bool,
    counters: Counters,
    mode: Mode,
    /// The flight goes along the stream.
    is_along: bool,
    /// The heading of the newest setpoint is still to be taken.
    is_turn_due: bool,
    /// The controller has just been selected.
    is_selected: bool,
    /// The last control step could not be flown.
    is_blind: bool,
    chores: Chores,
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
        const ZERO: Vector3<f32> = Vector3::new(0.0, 0.0, 0.0);
        Self {
            setpoint: abi::Setpoint::OFF,
            stream: Stream::new(),
            sample: FifthOrderSample::at_rest(ZERO, 0.0),
            heading: Heading::ZERO,
            prepared: None,
            prepared_for: None,
            flight: None,
            came_ms: 0,
            turning: Turning::new(),
            guide: Guide::new(PERIOD_S),
            settings,
            outcome: Outcome::OFF,
            last_step: 0,
            is_handing_over: false,
            counters: Counters { bad_states: 0, bad_setpoints: 0, limited_steps: 0, jumps: 0 },
            mode: Mode::NoCraft,
            is_along: false,
            is_turn_due: false,
            is_selected: true,
            is_blind: false,
            chores: Chores::new(),
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
        if self.mode == Mode::NoCraft {
            self.outcome.output = Output::OFF;
            return true;
        }
        let state = RigidState { state: edge::state(state), body_rates_rad_s: edge::body_rates_rad_s(sensors) };
        let is_late = step.wrapping_sub(self.last_step) > GAP_MAX_MS || self.is_selected;
        self.last_step = step;
        if is_late {
            self.restart();
        }
        if is_late || edge::is_urgent(&self.setpoint, setpoint) {
            self.take(setpoint, &state.state, step);
        }
        self.outcome.limited = MotorLimited::NOTHING;
        match self.flight {
            None => self.switch_off(),
            Some(_) => {
                self.is_blind = self.fly(&state, step).is_err();
                if self.is_blind {
                    self.counters.bad_states = self.counters.bad_states.wrapping_add(1);
                    self.switch_off();
                }
            }
        }
        if self.outcome.limited.any() {
            self.counters.limited_steps = self.counters.limited_steps.wrapping_add(1);
        }
        true
    }

    /// Between control steps: takes a setpoint that continues a flight, so that no control step has to; until then the one
    /// before is carried on, which leads to the same place unless it jumps. Where there is none, gives what there is time
    /// for.
    #[inline]
    pub fn between(&mut self, setpoint: &abi::Setpoint, state: &abi::State, step: u32) -> Option<Chore> {
        let is_new = if self.is_along {
            !edge::is_same_along(&self.setpoint, self.stream.newest(), setpoint)
        } else {
            self.flight.is_some() && !edge::is_same(&self.setpoint, setpoint)
        };
        if is_new {
            // It has come with the control step before.
            let since_ms = step.wrapping_sub(1);
            if !(self.is_along && self.go_on(setpoint, since_ms)) {
                self.take(setpoint, &edge::state(state), since_ms);
            }
        } else if self.is_turn_due {
            if !self.turn_on(setpoint) {
                self.take(setpoint, &edge::state(state), step);
            }
        } else {
            return Some(self.chores.next());
        }
        self.chores.put_off()
    }

    /// Takes one more setpoint of a flight along a trajectory, of which only figures are new; whether it is one. Its heading is
    /// left to the next call, so that no call has to do everything: till then the last one turns on.
    #[inline(always)]
    fn go_on(&mut self, setpoint: &abi::Setpoint, since_ms: u32) -> bool {
        let is_turned = !self.is_turn_due || self.turn_on(setpoint);
        if !(edge::goes_on(&self.setpoint, setpoint) && is_turned) {
            return false;
        }
        if setpoint.timestamp == self.setpoint.timestamp {
            // The same one, as collision avoidance has changed it.
            self.stream.divert(&edge::motion(setpoint));
            return true;
        }
        (self.setpoint.timestamp, self.is_turn_due) = (setpoint.timestamp, true);
        if self.looks_beyond_jerk() {
            self.accept(setpoint, since_ms);
        } else {
            let arrival = self.stream.accept_to_jerk(&edge::motion(setpoint), since_ms);
            self.count(arrival);
        }
        self.came_ms = since_ms;
        true
    }

    /// Takes the heading of the setpoint whose motion was taken before; whether it has one.
    #[inline(never)]
    fn turn_on(&mut self, setpoint: &abi::Setpoint) -> bool {
        self.is_turn_due = false;
        let Some(rate) = edge::turn_on(self.turning.heading_mut(), &self.setpoint, setpoint) else { return false };
        let is_differenced = self.looks_beyond_jerk() && edge::is_by_yaw(setpoint);
        self.turning.go_on(rate, self.came_ms, is_differenced);
        self.setpoint.attitude.yaw = setpoint.attitude.yaw;
        true
    }

    /// Takes the motion of a setpoint, or the one that is flown instead.
    #[inline(never)]
    fn accept(&mut self, setpoint: &abi::Setpoint, since_ms: u32) {
        let motion = match self.mode {
            Mode::Descending => Motion { velocity_m_s: Vector3::new(0.0, 0.0, -DESCENT_M_S), ..Motion::ZERO },
            _ => edge::motion(setpoint),
        };
        let arrival = if self.looks_beyond_jerk() {
            self.stream.accept(&motion, since_ms)
        } else {
            self.stream.accept_to_jerk(&motion, since_ms)
        };
        self.count(arrival);
    }

    #[inline(always)]
    fn count(&mut self, arrival: Arrival) {
        if arrival == Arrival::Jumped {
            self.counters.jumps = self.counters.jumps.wrapping_add(1);
        }
    }

    /// Whether a law that is flown takes snap and crackle.
    #[inline(always)]
    fn looks_beyond_jerk(&self) -> bool {
        self.table.gain.gives_forces() || self.is_handing_over
    }

    /// Between control steps: makes the reference of the next one for the paper's laws along a trajectory. It takes nothing
    /// from the estimate but where the leash ends.
    #[inline]
    pub fn prepare(&mut self, state: &abi::State, next_step: u32) {
        let Some(flight) = self.flight.as_ref().filter(|_| self.is_along && !self.looks_beyond_jerk()) else { return };
        let mass_kg = self.craft.airframe().figures().mass_kg;
        let (stream, turning) = (&self.stream, &self.turning);
        let along = Along { flight, stream, turning, now_ms: next_step, to_fifth: false, mass_kg };
        self.heading = along.put(&edge::state(state), &self.settings.bounds, &mut self.sample);
        let flat = &self.sample.flat;
        let is_there = match &mut self.prepared {
            Some(reference) => reference.move_to_finite_flat(flat, self.heading).is_ok(),
            None => {
                self.prepared = Reference::from_flat_at(flat, self.heading).ok();
                self.prepared.is_some()
            }
        };
        self.prepared_for = is_there.then_some(next_step);
    }

    /// Another controller has flown in the meantime, or nobody: nothing that was remembered holds. The motors are
    /// taken to carry the craft until a setpoint says that they are off.
    #[cold]
    #[inline(never)]
    fn restart(&mut self) {
        self.memory = Memory::hovering(self.craft.airframe());
        (self.flight, self.is_along, self.is_handing_over) = (None, false, false);
        (self.is_blind, self.is_selected) = (false, false);
        self.prepared_for = None;
    }

    /// Forgets what it remembers, at the next control step.
    pub fn forget(&mut self) {
        self.is_selected = true;
    }

    /// Takes a setpoint whose contents have changed.
    #[inline(never)]
    fn take(&mut self, setpoint: &abi::Setpoint, state: &State, now_ms: u32) {
        self.setpoint = *setpoint;
        (self.prepared_for, self.is_turn_due) = (None, false);
        let thrust_max_n = 4.0 * self.craft.airframe().figures().force_max_n;
        let flight = match edge::demand(setpoint, thrust_max_n) {
            Some(Demand::Off) => {
                (self.flight, self.is_along, self.is_handing_over, self.mode) = (None, false, false, Mode::Off);
                self.memory.clear_integral();
                return;
            }
            Some(Demand::Fly(flight)) => {
                self.mode = Mode::Flying;
                flight
            }
            None => {
                self.mode = Mode::Descending;
                self.counters.bad_setpoints = self.counters.bad_setpoints.wrapping_add(1);
                Flight::DESCENT
            }
        };
        let is_another = !self.flight.is_some_and(|before| before.is_like(&flight));
        if is_another {
            self.begin(&flight, state);
        }
        self.accept(setpoint, now_ms);
        if let Turn::Heading { heading, rate_rad_s } = flight.turn {
            self.turning.begin(heading, rate_rad_s, now_ms);
        }
        (self.is_along, self.flight) = (flight.is_along(), Some(flight));
    }

    /// Starts a flight of another kind.
    #[inline(never)]
    fn begin(&mut self, flight: &Flight, state: &State) {
        self.stream = Stream::new();
        self.guide.begin(state, edge::heading_rad(&state.attitude));
        if matches!(flight.horizontal, Horizontal::Tilt(_) | Horizontal::Rates(_)) {
            self.memory.clear_integral();
        }
    }

    #[inline]
    fn fly(&mut self, state: &RigidState, now_ms: u32) -> Result<(), Unflown> {
        let Some(flight) = &self.flight else { return Ok(()) };
        if let Horizontal::Rates([p, q]) = flight.horizontal {
            return self.turn([p, q], state);
        }
        let reference = self.prepared.as_ref().filter(|_| self.prepared_for == Some(now_ms));
        if reference.is_none() {
            let to_fifth = self.looks_beyond_jerk();
            let mass_kg = self.craft.airframe().figures().mass_kg;
            let (stream, turning) = (&self.stream, &self.turning);
            let along = Along { flight, stream, turning, now_ms, to_fifth, mass_kg };
            self.heading = self.guide.put(&along, &state.state, &self.settings.bounds, &mut self.sample);
        }
        let (r, p) = (&state.state.position_m, &self.sample.flat.position_m);
        self.outcome.error_m = Vector3::new(r.x - p.x, r.y - p.y, r.z - p.z);
        let mut is_upright = false;
        loop {
            let (craft, settings, sample, heading) = (&self.craft, &self.settings, &self.sample, self.heading);
            let law_step = LawStep { craft, settings, sample, heading, state };
            if let Some(reference) = reference {
                return law_step.follow(&self.table, reference, &mut self.memory, &mut self.outcome);
            }
            let step = if self.is_handing_over {
                let step = law_step.hand_over(
                    &mut self.handover,
                    (&self.before, &self.table),
                    &mut self.memory,
                    &mut self.outcome,
                );
                self.is_handing_over = !self.handover.is_over();
                step
            } else {
                law_step.step(&self.table, &mut self.memory, &mut self.outcome)
            };
            match step {
                Err(Unflown::Motion) if !is_upright => make_upright(&mut self.sample),
                other => return other,
            }
            is_upright = true;
        }
    }

    /// Manual flight by body rates: the same under every table.
    #[inline(never)]
    fn turn(&mut self, [p, q]: [f32; 2], state: &RigidState) -> Result<(), Unflown> {
        let mass_kg = self.craft.airframe().figures().mass_kg;
        let (vertical, turn) = match &self.flight {
            Some(flight) => (flight.vertical, flight.turn),
            None => return Ok(()),
        };
        let thrust_m_s2 = match vertical {
            Vertical::Thrust(thrust_n) => thrust_n / mass_kg,
            // A height that is held while the craft turns over is nothing that anybody asks for.
            _ => quatrack::flatness::GRAVITY_M_S2,
        };
        let r = match turn {
            Turn::Rate(rate) => rate,
            Turn::Heading { .. } => 0.0,
        };
        let command = Command { thrust_m_s2, body_rates_rad_s: Vector3::new(p, q, r) };
        let wrench = self.settings.limits.saturate(&command).map(|(command, limited)| {
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

    /// Motors off for this step. They run down with their lag: who flies on soon has the rest of their forces.
    #[cold]
    #[inline(never)]
    fn switch_off(&mut self) {
        self.outcome.output = Output::OFF;
        self.memory.run_down(self.craft.motor_lag_s / (self.craft.motor_lag_s + PERIOD_S));
    }

    /// Flies another table from the next control step on; in flight over [`FADE_STEPS`] of them.
    #[inline(never)]
    pub fn change_table(&mut self, table: &Table) {
        if self.flight.is_some() {
            self.before = self.table;
            if !self.before.gain.gives_forces() {
                // The firmware's mixer has carried its commands to the motors: what they have by now nobody has kept.
                self.memory.assume_hovering(self.craft.airframe());
            }
            let feed_forward = self.settings.feed_forward;
            let (old, new) = (self.before.law(feed_forward), table.law(feed_forward));
            if let (Ok(old), Ok(new)) = (old, new) {
                self.handover = Handover::begin(FADE_STEPS, &old, &new, &mut self.memory);
            }
            self.is_handing_over = !self.handover.is_over();
        }
        self.table = *table;
        self.prepared_for = None;
    }

    /// Starts for a craft: motors off until a setpoint comes.
    #[inline(never)]
    pub fn change_craft(&mut self, craft: &Craft) {
        self.craft = *craft;
        (self.flight, self.is_along, self.is_handing_over) = (None, false, false);
        (self.mode, self.is_selected) = (Mode::Off, true);
        self.counters = Counters::default();
    }

    /// Takes over what the owner has set.
    #[inline(never)]
    pub fn set(&mut self, settings: &Settings, craft: &Craft) {
        self.settings = *settings;
        self.craft.actuation = craft.actuation;
    }

    /// How the last setpoint is flown.
    pub fn mode(&self) -> Mode {
        if self.flight.is_some() && self.is_blind { Mode::Blind } else { self.mode }
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

    /// Rotation vector from the last control step's reference to an attitude, body frame, rad.
    pub fn rotation_error_rad(&self, attitude: Quaternion) -> Vector3<f32> {
        let q = self.outcome.target.conjugate() * attitude;
        q.vector() * if q.w < 0.0 { -2.0 } else { 2.0 }
    }
}

/// Where the motion asks for what no thrust does, its position and velocity alone.
#[cold]
#[inline(never)]
fn make_upright(sample: &mut FifthOrderSample) {
    let flat = &sample.flat;
    let mut upright = FifthOrderSample::at_rest(flat.position_m, 0.0);
    upright.flat.velocity_m_s = flat.velocity_m_s;
    *sample = upright;
}
