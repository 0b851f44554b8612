//! The controller: setpoints, estimates and gyroscope readings at 1 kHz in; thrust and torque, or motor forces, out at
//! 500 Hz.
//!
//! A change of the table is faded over [`FADE_STEPS`] control steps, both laws stepping side by side. The stabilizer's
//! stack is small: what is large lies here and is written in place.

use quatrack::law::ActuatorMemory;
use quatrack::mixer::{MotorLimited, Wrench};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Airframe, Command, Equilibrium, FeedForward, FifthOrderSample, FlatOutput, Limits, MotorForces, MotorLaw,
    MotorReference, MotorTracker, Quaternion, Reference, RigidState, State, StepError, Tracker,
};

use crate::abi;
use crate::craft::{Craft, DECIMATION, PERIOD_S};
use crate::demand::{Demand, Flight, Horizontal, Motion, Turn, Vertical};
use crate::edge;
use crate::guide::{Along, Bounds, Guide};
use crate::stream::{Arrival, GAP_MAX_MS, Stream};
use crate::tables::{Gains, Table};

/// Control steps that a change of the table takes: a quarter of a second.
pub const FADE_STEPS: u16 = 125;

/// Control steps without a sound estimate after which the motors count as standing still.
const BAD_STATES_MAX: u16 = 25;

/// How fast a craft goes down whose setpoint makes no sense, m/s.
const DESCENT_M_S: f32 = 0.3;

/// What a step puts out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// For the firmware's mixer.
    Wrench(Wrench),
    /// Straight to the motors, N.
    Forces(MotorForces),
}

impl Output {
    /// Motors off.
    pub const OFF: Self = Self::Forces([0.0; 4]);
}

/// How the last setpoint is flown, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Mode {
    /// Motors off, as asked.
    Off = 0,
    /// As asked.
    Flying = 1,
    /// Level and slowly down: the setpoint makes no sense.
    Descending = 2,
    /// Motors off: the estimate or the gyroscope is not to be flown on.
    Blind = 3,
    /// Motors off: the app has not said which craft this is, or there is no table for it.
    NoCraft = 4,
}

/// What the owner may change, as the steps take it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Of setpoints.
    pub bounds: Bounds,
    /// What the paper's laws may command.
    pub limits: Limits,
    /// Of the paper's laws.
    pub feed_forward: FeedForward,
}

/// What the steps have seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Steps on an estimate or gyroscope that is not to be flown on.
    pub bad_states: u16,
    /// Setpoints that make no sense.
    pub bad_setpoints: u16,
    /// Steps that gave something up.
    pub limited_steps: u16,
    /// Setpoints that were not where the ones before led.
    pub jumps: u16,
}

/// What one step gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// What is put out.
    pub output: Output,
    /// What it gave up.
    pub limited: MotorLimited,
    /// The attitude that the reference has.
    pub target: Quaternion,
    /// Measured position less asked, world frame, m.
    pub error_m: Vector3<f32>,
}

/// The controller of a craft.
#[derive(Clone, Debug)]
pub struct Controller {
    craft: Craft,
    settings: Settings,
    table: Table,
    memory: ActuatorMemory,
    /// The table on its way out, its memory, and how many steps the way still takes.
    before: Table,
    memory_before: ActuatorMemory,
    fade_left: u16,
    setpoint: abi::Setpoint,
    flight: Option<Flight>,
    motion: Motion,
    stream: Stream,
    guide: Guide,
    sample: FifthOrderSample,
    /// What the sample asks of the paper's laws at a step that is still to come.
    prepared: Option<Reference>,
    prepared_for: u32,
    last_step: u32,
    /// The controller has just been selected.
    is_selected: bool,
    bad_states_in_a_row: u16,
    mode: Mode,
    outcome: Outcome,
    counters: Counters,
}

impl Controller {
    /// For a craft, with motors off.
    pub const fn new(craft: Craft, table: Table, settings: Settings) -> Self {
        const ZERO: Vector3<f32> = Vector3::new(0.0, 0.0, 0.0);
        let (output, limited) = (Output::OFF, MotorLimited::NOTHING);
        Self {
            craft,
            settings,
            table,
            memory: ActuatorMemory::at_rest(),
            before: table,
            memory_before: ActuatorMemory::at_rest(),
            fade_left: 0,
            setpoint: abi::Setpoint::OFF,
            flight: None,
            motion: Motion::ZERO,
            stream: Stream::new(),
            guide: Guide::new(PERIOD_S),
            sample: FifthOrderSample::at_rest(ZERO, 0.0),
            prepared: None,
            prepared_for: 0,
            last_step: 0,
            is_selected: true,
            bad_states_in_a_row: 0,
            mode: Mode::NoCraft,
            outcome: Outcome { output, limited, target: Quaternion::IDENTITY, error_m: ZERO },
            counters: Counters { bad_states: 0, bad_setpoints: 0, limited_steps: 0, jumps: 0 },
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
            None => self.outcome.output = Output::OFF,
            Some(_) => match self.fly(&state, step) {
                Ok(()) => self.bad_states_in_a_row = 0,
                Err(_) => self.blind(),
            },
        }
        if self.outcome.limited.any() {
            self.counters.limited_steps = self.counters.limited_steps.wrapping_add(1);
        }
        true
    }

    /// Between control steps: takes a setpoint that continues a flight, so that no control step has to. Whether there was
    /// one. Until then the one before is carried on, which leads to the same place unless it jumps.
    #[inline]
    pub fn between(&mut self, setpoint: &abi::Setpoint, state: &abi::State, step: u32) -> bool {
        let is_new = self.flight.is_some() && !edge::is_same(&self.setpoint, setpoint);
        if is_new {
            // It has come with the control step before.
            self.take(setpoint, &edge::state(state), step.wrapping_sub(1));
        }
        is_new
    }

    /// Between control steps: makes the reference of the next one for the paper's laws along a trajectory. It takes nothing
    /// from the estimate but where the leash ends.
    #[inline]
    pub fn prepare(&mut self, state: &abi::State, next_step: u32) {
        let is_along = |flight: &Flight| {
            matches!((&flight.horizontal, &flight.vertical), (Horizontal::Position, Vertical::Position))
                && matches!(flight.turn, Turn::Heading { .. })
        };
        let is_aware = matches!(self.table.gains, Gains::ActuatorAware(_));
        if let Some(flight) = self.flight.as_ref().filter(|flight| !is_aware && is_along(flight)) {
            let mass_kg = self.craft.airframe.figures().mass_kg;
            let along = Along { flight, stream: &self.stream, now_ms: next_step, to_fifth: false, mass_kg };
            self.guide.put(&along, &edge::state(state), &self.settings.bounds, &mut self.sample);
            self.prepared = Reference::from_flat(&self.sample.flat).ok();
            self.prepared_for = next_step;
        }
    }

    /// Another controller has flown in the meantime, or nobody: nothing that was remembered holds. The motors are
    /// taken to carry the craft until a setpoint says that they are off.
    #[cold]
    #[inline(never)]
    fn restart(&mut self) {
        self.memory = ActuatorMemory::hovering(&self.craft.airframe);
        (self.flight, self.fade_left, self.bad_states_in_a_row, self.is_selected) = (None, 0, 0, false);
        self.prepared = None;
    }

    /// Forgets what it remembers, at the next control step.
    pub fn forget(&mut self) {
        self.is_selected = true;
    }

    /// Takes a setpoint whose contents have changed.
    #[inline(never)]
    fn take(&mut self, setpoint: &abi::Setpoint, state: &State, now_ms: u32) {
        self.setpoint = *setpoint;
        self.prepared = None;
        let thrust_max_n = 4.0 * self.craft.airframe.figures().force_max_n;
        let flight = match edge::demand(setpoint, thrust_max_n) {
            Some(Demand::Off) => {
                (self.flight, self.fade_left, self.mode) = (None, 0, Mode::Off);
                self.memory = ActuatorMemory::at_rest();
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
        let motion = match self.mode {
            Mode::Descending => Motion { velocity_m_s: Vector3::new(0.0, 0.0, -DESCENT_M_S), ..Motion::ZERO },
            _ => edge::motion(setpoint),
        };
        if (is_another || motion != self.motion) && self.stream.accept(&motion, now_ms) == Arrival::Jumped {
            self.counters.jumps = self.counters.jumps.wrapping_add(1);
        }
        (self.flight, self.motion) = (Some(flight), motion);
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
    fn fly(&mut self, state: &RigidState, now_ms: u32) -> Result<(), StepError> {
        let Some(flight) = &self.flight else { return Ok(()) };
        if let Horizontal::Rates([p, q]) = flight.horizontal {
            return self.turn([p, q], state);
        }
        let is_prepared = self.prepared.is_some() && self.prepared_for == now_ms && self.fade_left == 0;
        if !is_prepared {
            let to_fifth = matches!(self.table.gains, Gains::ActuatorAware(_)) || self.fade_left > 0;
            let mass_kg = self.craft.airframe.figures().mass_kg;
            let along = Along { flight, stream: &self.stream, now_ms, to_fifth, mass_kg };
            self.guide.put(&along, &state.state, &self.settings.bounds, &mut self.sample);
        }
        let (r, p) = (&state.state.position_m, &self.sample.flat.position_m);
        self.outcome.error_m = Vector3::new(r.x - p.x, r.y - p.y, r.z - p.z);
        let run = Run { craft: &self.craft, settings: &self.settings, sample: &self.sample, state };
        if let Some(reference) = self.prepared.as_ref().filter(|_| is_prepared) {
            return run.follow(&self.table, reference, &mut self.outcome);
        }
        run.step(&self.table, &mut self.memory, &mut self.outcome)?;
        if self.fade_left > 0 { self.mix_in_the_one_before(state) } else { Ok(()) }
    }

    /// Both laws, their forces mixed in changing shares.
    #[cold]
    #[inline(never)]
    fn mix_in_the_one_before(&mut self, state: &RigidState) -> Result<(), StepError> {
        self.fade_left -= 1;
        let run = Run { craft: &self.craft, settings: &self.settings, sample: &self.sample, state };
        let mut before = self.outcome;
        // Where only the old law has no answer, the new one's counts at once.
        if run.step(&self.before, &mut self.memory_before, &mut before).is_err() {
            self.fade_left = 0;
        }
        if self.fade_left > 0 {
            let share = f32::from(self.fade_left) / f32::from(FADE_STEPS);
            let (from, to) = (forces(&self.craft, &before.output), forces(&self.craft, &self.outcome.output));
            self.outcome.output = Output::Forces(between(to, from, share));
        }
        Ok(())
    }

    /// Manual flight by body rates: the same under every table.
    #[inline(never)]
    fn turn(&mut self, [p, q]: [f32; 2], state: &RigidState) -> Result<(), StepError> {
        let mass_kg = self.craft.airframe.figures().mass_kg;
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
            self.outcome.limited = MotorLimited::from_bits(u16::from(limited.bits()) << 8);
            self.craft.body_rates.wrench(&command, &state.body_rates_rad_s)
        });
        match wrench.filter(is_finite) {
            Some(wrench) => {
                self.outcome.output = Output::Wrench(wrench);
                Ok(())
            }
            None => Err(StepError::Singular),
        }
    }

    /// Motors off for this step: there is nothing to level by.
    #[cold]
    #[inline(never)]
    fn blind(&mut self) {
        self.counters.bad_states = self.counters.bad_states.wrapping_add(1);
        self.bad_states_in_a_row = self.bad_states_in_a_row.saturating_add(1);
        if self.bad_states_in_a_row >= BAD_STATES_MAX {
            self.memory = ActuatorMemory::at_rest();
        }
        self.outcome.output = Output::OFF;
    }

    /// Flies another table from the next control step on; in flight over [`FADE_STEPS`] of them.
    #[inline(never)]
    pub fn change_table(&mut self, table: &Table) {
        if self.flight.is_some() {
            self.before = self.table;
            (self.memory_before, self.fade_left) = (self.memory, FADE_STEPS);
        }
        self.table = *table;
        self.prepared = None;
    }

    /// Starts for a craft: motors off until a setpoint comes.
    #[inline(never)]
    pub fn change_craft(&mut self, craft: &Craft) {
        self.craft = *craft;
        (self.mode, self.flight, self.fade_left, self.is_selected) = (Mode::Off, None, 0, true);
        self.counters = Counters::default();
    }

    /// Takes over what the owner has set.
    #[inline(never)]
    pub fn set(&mut self, settings: &Settings, craft: &Craft) {
        self.settings = *settings;
        self.craft.body_rates = craft.body_rates;
    }

    /// How the last setpoint is flown.
    pub fn mode(&self) -> Mode {
        if self.flight.is_some() && self.bad_states_in_a_row > 0 { Mode::Blind } else { self.mode }
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

/// One law's step.
struct Run<'a> {
    craft: &'a Craft,
    settings: &'a Settings,
    sample: &'a FifthOrderSample,
    state: &'a RigidState,
}

impl Run<'_> {
    #[inline(always)]
    fn step(&self, table: &Table, memory: &mut ActuatorMemory, outcome: &mut Outcome) -> Result<(), StepError> {
        let feed_forward = self.settings.feed_forward;
        match &table.gains {
            // References are looked at where they lie: to move one out costs as much as the product with a gain.
            Gains::ActuatorAware(motors) => {
                let airframe = &motors.airframe;
                let tracker = MotorTracker::new(MotorLaw::ActuatorAware(motors.law()), airframe);
                match &MotorReference::from_flat(self.sample, airframe) {
                    Ok(reference) => self.straight(&tracker, reference, memory, outcome),
                    Err(_) => self.straight_up(&tracker, airframe, memory, outcome),
                }
            }
            Gains::Equilibrium(gain) => {
                let law = Equilibrium { feed_forward, ..Equilibrium::new(gain) };
                self.through_rates(&Tracker::new(law, self.settings.limits), outcome)
            }
            Gains::FlatOutput(gain) => {
                let law = FlatOutput { gain, feed_forward };
                self.through_rates(&Tracker::new(law, self.settings.limits), outcome)
            }
        }
    }

    /// A law of the paper on a reference that is there.
    #[inline(always)]
    fn follow(&self, table: &Table, reference: &Reference, outcome: &mut Outcome) -> Result<(), StepError> {
        let feed_forward = self.settings.feed_forward;
        let tracker = match &table.gains {
            Gains::Equilibrium(gain) => {
                Tracker::new(Equilibrium { feed_forward, ..Equilibrium::new(gain) }, self.settings.limits)
            }
            Gains::FlatOutput(gain) => Tracker::new(FlatOutput { gain, feed_forward }, self.settings.limits),
            Gains::ActuatorAware(_) => return Err(StepError::Singular),
        };
        self.wrench(&tracker, reference, outcome)
    }

    #[inline(always)]
    fn straight(
        &self,
        tracker: &MotorTracker<'_>,
        reference: &MotorReference,
        memory: &mut ActuatorMemory,
        outcome: &mut Outcome,
    ) -> Result<(), StepError> {
        let step = tracker.step(memory, self.state, reference)?;
        outcome.output = Output::Forces(step.forces_n);
        (outcome.limited, outcome.target) = (step.limited, reference.state().attitude);
        Ok(())
    }

    #[inline(always)]
    fn through_rates(&self, tracker: &Tracker<'_>, outcome: &mut Outcome) -> Result<(), StepError> {
        match &Reference::from_flat(&self.sample.flat) {
            Ok(reference) => self.wrench(tracker, reference, outcome),
            Err(_) => self.up_through_rates(tracker, outcome),
        }
    }

    #[inline(always)]
    fn wrench(&self, tracker: &Tracker<'_>, reference: &Reference, outcome: &mut Outcome) -> Result<(), StepError> {
        let step = tracker.step(&self.state.state, reference)?;
        let wrench = self.craft.body_rates.wrench(&step.command, &self.state.body_rates_rad_s);
        if !is_finite(&wrench) {
            return Err(StepError::Singular);
        }
        outcome.output = Output::Wrench(wrench);
        outcome.limited = MotorLimited::from_bits(u16::from(step.limited.bits()) << 8);
        outcome.target = reference.state().attitude;
        Ok(())
    }

    // Apart, so that no step pays for their stack.

    #[cold]
    #[inline(never)]
    fn straight_up(
        &self,
        tracker: &MotorTracker<'_>,
        airframe: &Airframe,
        memory: &mut ActuatorMemory,
        outcome: &mut Outcome,
    ) -> Result<(), StepError> {
        let upright = MotorReference::from_flat(&self.upright(), airframe).map_err(|_| StepError::Singular)?;
        self.straight(tracker, &upright, memory, outcome)
    }

    #[cold]
    #[inline(never)]
    fn up_through_rates(&self, tracker: &Tracker<'_>, outcome: &mut Outcome) -> Result<(), StepError> {
        let upright = Reference::from_flat(&self.upright().flat).map_err(|_| StepError::Singular)?;
        self.wrench(tracker, &upright, outcome)
    }

    /// Where the motion asks for what no thrust does (free fall, upside down): its position and velocity alone.
    #[cold]
    #[inline(never)]
    fn upright(&self) -> FifthOrderSample {
        let flat = &self.sample.flat;
        let mut sample = FifthOrderSample::at_rest(flat.position_m, flat.heading_rad);
        sample.flat.velocity_m_s = flat.velocity_m_s;
        sample
    }
}

/// The gyroscope's readings come in here; the thrust has been looked at.
#[inline]
fn is_finite(wrench: &Wrench) -> bool {
    let torque = &wrench.torque_n_m;
    (torque.x + torque.y + torque.z).abs() <= f32::MAX
}

/// An output as forces.
fn forces(craft: &Craft, output: &Output) -> MotorForces {
    match output {
        Output::Forces(forces) => *forces,
        Output::Wrench(wrench) => craft.airframe.mix(wrench).map_or([0.0; 4], |(forces, _)| forces),
    }
}

/// `share` of the way from one to another.
fn between([a1, a2, a3, a4]: MotorForces, [b1, b2, b3, b4]: MotorForces, share: f32) -> MotorForces {
    [a1 + (b1 - a1) * share, a2 + (b2 - a2) * share, a3 + (b3 - a3) * share, a4 + (b4 - a4) * share]
}
