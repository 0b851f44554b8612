//! The controller: setpoints, estimates and gyroscope readings at 1 kHz in; thrust and torque, or motor forces, out at
//! 500 Hz.
//!
//! Even steps control; odd ones keep house: they publish what the last step did and take up parameters and tables. A change
//! of the table is faded over [`FADE_STEPS`] control steps, both laws stepping side by side.

use quatrack::law::ActuatorMemory;
use quatrack::mixer::{MotorLimited, Wrench};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Command, Equilibrium, FeedForward, FifthOrderSample, FlatOutput, Limits, MotorForces, MotorLaw,
    MotorReference, MotorTracker, Quaternion, Reference, RigidState, State, StepError, Tracker,
};

use crate::abi;
use crate::craft::{Craft, DECIMATION, PERIOD_S};
use crate::demand::{Demand, Flight, Horizontal, Motion, Vertical};
use crate::edge;
use crate::guide::{Bounds, Guide};
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

/// Motors off.
const OFF: Output = Output::Forces([0.0; 4]);

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
    /// Largest roll and pitch rate, and yaw rate, that the body-rate loop is asked for, rad/s.
    pub body_rates_rad_s: [f32; 2],
    /// Of the paper's laws.
    pub feed_forward: FeedForward,
    /// Time constant of the motors that the body-rate loop reckons with, s; 0 for the longest that is published.
    pub motor_lag_s: f32,
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

/// The controller of one craft.
#[derive(Clone, Debug)]
pub struct Controller {
    craft: Craft,
    table: Table,
    limits: Limits,
    memory: ActuatorMemory,
    fade: Option<Fade>,
    settings: Settings,
    setpoint: abi::Setpoint,
    flight: Option<Flight>,
    motion: Motion,
    stream: Stream,
    guide: Guide,
    last_step: Option<u32>,
    bad_states_in_a_row: u16,
    mode: Mode,
    limited: MotorLimited,
    output: Output,
    counters: Counters,
    error_m: Vector3<f32>,
    attitudes: [Quaternion; 2],
}

/// A table on its way out.
#[derive(Clone, Copy, Debug)]
struct Fade {
    table: Table,
    limits: Limits,
    memory: ActuatorMemory,
    steps: u16,
}

impl Controller {
    /// For a craft, with motors off.
    pub fn new(craft: Craft, table: Table, settings: Settings) -> Self {
        Self {
            craft: craft.with_motor_lag(settings.motor_lag_s),
            table,
            limits: tightened(&table.limits, &settings),
            memory: ActuatorMemory::hovering(&craft.airframe),
            fade: None,
            settings,
            setpoint: abi::Setpoint::default(),
            flight: None,
            motion: Motion::ZERO,
            stream: Stream::new(),
            guide: Guide::new(PERIOD_S),
            last_step: None,
            bad_states_in_a_row: 0,
            mode: Mode::Off,
            limited: MotorLimited::NOTHING,
            output: OFF,
            counters: Counters::default(),
            error_m: Vector3::new(0.0, 0.0, 0.0),
            attitudes: [Quaternion::IDENTITY; 2],
        }
    }

    /// One of the firmware's steps: the output where it is a control step, nothing where the last one holds.
    #[inline]
    pub fn step(
        &mut self,
        setpoint: &abi::Setpoint,
        sensors: &abi::SensorData,
        state: &abi::State,
        step: u32,
    ) -> Option<abi::Control> {
        if step % DECIMATION != 0 {
            return None;
        }
        let is_late = self.last_step.is_none_or(|last| step.wrapping_sub(last) > GAP_MAX_MS);
        self.last_step = Some(step);
        let (state, body_rates_rad_s) = (edge::state(state), edge::body_rates_rad_s(sensors));
        if is_late {
            self.restart();
        }
        if is_late || !edge::is_same(&self.setpoint, setpoint) {
            self.take(setpoint, &state, step);
        }
        self.limited = MotorLimited::NOTHING;
        self.output = match self.flight {
            None => OFF,
            Some(flight) => match self.fly(&flight, &RigidState { state, body_rates_rad_s }, step) {
                Ok(output) => {
                    self.bad_states_in_a_row = 0;
                    output
                }
                Err(_) => self.blind(),
            },
        };
        if self.limited.any() {
            self.counters.limited_steps = self.counters.limited_steps.wrapping_add(1);
        }
        Some(edge::control(&self.output, self.craft.airframe.figures().force_max_n))
    }

    /// Another controller has flown in the meantime, or nobody: nothing that was remembered holds. The motors are
    /// taken to carry the craft until a setpoint says that they are off.
    #[cold]
    fn restart(&mut self) {
        self.memory = ActuatorMemory::hovering(&self.craft.airframe);
        (self.flight, self.fade, self.bad_states_in_a_row) = (None, None, 0);
    }

    /// Forgets what it remembers, at the next control step.
    pub fn forget(&mut self) {
        self.last_step = None;
    }

    /// Takes a setpoint whose contents have changed.
    #[inline(never)]
    fn take(&mut self, setpoint: &abi::Setpoint, state: &State, now_ms: u32) {
        self.setpoint = *setpoint;
        let thrust_max_n = 4.0 * self.craft.airframe.figures().force_max_n;
        let (flight, motion) = match edge::demand(setpoint, thrust_max_n) {
            Some(Demand::Off) => {
                (self.flight, self.fade, self.mode) = (None, None, Mode::Off);
                self.memory = ActuatorMemory::at_rest();
                return;
            }
            Some(Demand::Fly(flight)) => {
                self.mode = Mode::Flying;
                (flight, edge::motion(setpoint))
            }
            None => {
                self.mode = Mode::Descending;
                self.counters.bad_setpoints = self.counters.bad_setpoints.wrapping_add(1);
                let down = Vector3::new(0.0, 0.0, -DESCENT_M_S);
                (Flight::DESCENT, Motion { velocity_m_s: down, ..Motion::ZERO })
            }
        };
        let is_another = !self.flight.is_some_and(|before| before.is_like(&flight));
        if is_another {
            self.stream = Stream::new();
            self.guide.begin(state, edge::heading_rad(&state.attitude));
            if matches!(flight.horizontal, Horizontal::Tilt(_) | Horizontal::Rates(_)) {
                self.memory.clear_integral();
            }
        }
        if (is_another || motion != self.motion) && self.stream.accept(&motion, now_ms) == Arrival::Jumped {
            self.counters.jumps = self.counters.jumps.wrapping_add(1);
        }
        (self.flight, self.motion) = (Some(flight), motion);
    }

    #[inline]
    fn fly(&mut self, flight: &Flight, rigid: &RigidState, now_ms: u32) -> Result<Output, StepError> {
        let state = &rigid.state;
        if let Horizontal::Rates([p, q]) = flight.horizontal {
            return self.turn(flight, [p, q], state, &rigid.body_rates_rad_s);
        }
        let mass_kg = self.craft.airframe.figures().mass_kg;
        let sample = self.guide.sample(flight, &self.stream, now_ms, state, mass_kg, &self.settings.bounds);
        let p = &sample.flat.position_m;
        self.error_m = Vector3::new(state.position_m.x - p.x, state.position_m.y - p.y, state.position_m.z - p.z);
        self.follow(&sample, rigid)
    }

    fn follow(&mut self, sample: &FifthOrderSample, state: &RigidState) -> Result<Output, StepError> {
        if self.fade.is_some() {
            return self.follow_fading(sample, state);
        }
        let run = Run { craft: &self.craft, sample, state, feed_forward: self.settings.feed_forward };
        let (output, limited, target) = run.of(&self.table, &self.limits, &mut self.memory)?;
        (self.limited, self.attitudes) = (limited, [target, state.state.attitude]);
        Ok(output)
    }

    /// Both laws, their forces mixed in changing shares.
    #[cold]
    #[inline(never)]
    fn follow_fading(
        &mut self,
        sample: &FifthOrderSample,
        state: &RigidState,
    ) -> Result<Output, StepError> {
        let run = Run { craft: &self.craft, sample, state, feed_forward: self.settings.feed_forward };
        let (to, limited, target) = run.of(&self.table, &self.limits, &mut self.memory)?;
        (self.limited, self.attitudes) = (limited, [target, state.state.attitude]);
        let Some(fade) = &mut self.fade else { return Ok(to) };
        fade.steps += 1;
        // Where only the old law has no answer, the new one's counts at once.
        let from = run.of(&fade.table, &fade.limits, &mut fade.memory);
        let share = f32::from(fade.steps) / f32::from(FADE_STEPS);
        let over = fade.steps >= FADE_STEPS;
        let mixed = match from {
            Ok((from, _, _)) if !over => {
                let (a, b) = (forces(&self.craft, &from), forces(&self.craft, &to));
                Output::Forces(between(a, b, share))
            }
            _ => to,
        };
        if over || from.is_err() {
            self.fade = None;
        }
        Ok(mixed)
    }

    /// Manual flight by body rates: the same under every table.
    #[inline(never)]
    fn turn(
        &mut self,
        flight: &Flight,
        [p, q]: [f32; 2],
        state: &State,
        rates: &Vector3<f32>,
    ) -> Result<Output, StepError> {
        let mass_kg = self.craft.airframe.figures().mass_kg;
        let thrust_m_s2 = match flight.vertical {
            Vertical::Thrust(thrust_n) => thrust_n / mass_kg,
            // A height that is held while the craft turns over is nothing that anybody asks for.
            _ => quatrack::flatness::GRAVITY_M_S2,
        };
        let r = match flight.turn {
            crate::demand::Turn::Rate(rate) => rate,
            crate::demand::Turn::Heading { .. } => 0.0,
        };
        let command = Command { thrust_m_s2, body_rates_rad_s: Vector3::new(p, q, r) };
        let wrench = self.limits.saturate(&command).map(|(command, limited)| {
            self.limited = MotorLimited::from_bits(u16::from(limited.bits()) << 8);
            self.craft.body_rates.wrench(&command, rates)
        });
        let is_finite = |wrench: &Wrench| {
            let torque = &wrench.torque_n_m;
            (wrench.thrust_n + torque.x + torque.y + torque.z).abs() <= f32::MAX
        };
        match wrench.filter(is_finite) {
            Some(wrench) => Ok(Output::Wrench(wrench)),
            None => Err(state.validated().err().map_or(StepError::Singular, StepError::State)),
        }
    }

    /// Motors off for this step: there is nothing to level by.
    #[cold]
    #[inline(never)]
    fn blind(&mut self) -> Output {
        self.counters.bad_states = self.counters.bad_states.wrapping_add(1);
        self.bad_states_in_a_row = self.bad_states_in_a_row.saturating_add(1);
        if self.bad_states_in_a_row >= BAD_STATES_MAX {
            self.memory = ActuatorMemory::at_rest();
        }
        OFF
    }

    /// Flies another table from the next control step on; in flight over [`FADE_STEPS`] of them.
    pub fn change_table(&mut self, table: &Table) {
        let limits = tightened(&table.limits, &self.settings);
        if self.flight.is_some() {
            self.fade = Some(Fade { table: self.table, limits: self.limits, memory: self.memory, steps: 0 });
        }
        (self.table, self.limits) = (*table, limits);
    }

    /// Takes over what the owner has set.
    pub fn set(&mut self, settings: &Settings) {
        if self.settings != *settings {
            self.settings = *settings;
            self.limits = tightened(&self.table.limits, settings);
            self.craft = self.craft.with_motor_lag(settings.motor_lag_s);
        }
    }

    /// The craft.
    pub fn craft(&self) -> &Craft {
        &self.craft
    }

    /// The table in use.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// How the last setpoint is flown.
    pub fn mode(&self) -> Mode {
        if self.flight.is_some() && self.bad_states_in_a_row > 0 { Mode::Blind } else { self.mode }
    }

    /// What has been seen so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// What the last control step gave up.
    pub fn limited(&self) -> MotorLimited {
        self.limited
    }

    /// Position error of the last control step, world frame, m.
    pub fn error_m(&self) -> Vector3<f32> {
        self.error_m
    }

    /// Rotation vector from the reference's attitude to the measured one at the last control step, body frame, rad.
    pub fn rotation_error_rad(&self) -> Vector3<f32> {
        let [target, measured] = self.attitudes;
        let q = target.conjugate() * measured;
        q.vector() * if q.w < 0.0 { -2.0 } else { 2.0 }
    }

    /// What the last control step put out.
    pub fn output(&self) -> &Output {
        &self.output
    }
}

/// One law's step.
struct Run<'a> {
    craft: &'a Craft,
    sample: &'a FifthOrderSample,
    state: &'a RigidState,
    feed_forward: FeedForward,
}

impl Run<'_> {
    /// Output, what it gave up, and the attitude that it wants.
    #[inline]
    fn of(
        &self,
        table: &Table,
        limits: &Limits,
        memory: &mut ActuatorMemory,
    ) -> Result<(Output, MotorLimited, Quaternion), StepError> {
        match &table.gains {
            Gains::ActuatorAware(motors) => {
                let airframe = &motors.airframe;
                let reference = match MotorReference::from_flat(self.sample, airframe) {
                    Ok(reference) => reference,
                    Err(_) => MotorReference::from_flat(&self.upright(), airframe).map_err(|_| StepError::Singular)?,
                };
                let tracker = MotorTracker::new(MotorLaw::ActuatorAware(motors.law()), airframe);
                let step = tracker.step(memory, self.state, &reference)?;
                Ok((Output::Forces(step.forces_n), step.limited, reference.state().attitude))
            }
            Gains::Equilibrium(gain) => {
                let law = Equilibrium { feed_forward: self.feed_forward, ..Equilibrium::new(gain) };
                self.through_rates(&Tracker::new(law, *limits))
            }
            Gains::FlatOutput(gain) => {
                let law = FlatOutput { gain, feed_forward: self.feed_forward };
                self.through_rates(&Tracker::new(law, *limits))
            }
        }
    }

    #[inline]
    fn through_rates(&self, tracker: &Tracker<'_>) -> Result<(Output, MotorLimited, Quaternion), StepError> {
        let reference = match Reference::from_flat(&self.sample.flat) {
            Ok(reference) => reference,
            Err(_) => Reference::from_flat(&self.upright().flat).map_err(|_| StepError::Singular)?,
        };
        let step = tracker.step(&self.state.state, &reference)?;
        let wrench = self.craft.body_rates.wrench(&step.command, &self.state.body_rates_rad_s);
        let torque = &wrench.torque_n_m;
        if !((torque.x + torque.y + torque.z).abs() <= f32::MAX) {
            return Err(StepError::Singular);
        }
        let limited = MotorLimited::from_bits(u16::from(step.limited.bits()) << 8);
        Ok((Output::Wrench(wrench), limited, reference.state().attitude))
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

/// A table's limits within the owner's.
fn tightened(limits: &Limits, settings: &Settings) -> Limits {
    let most = limits.body_rates_max_rad_s();
    let [roll_pitch, yaw] = settings.body_rates_rad_s;
    let least = |a: f32, b: f32| if a < b { a } else { b };
    let rates = Vector3::new(least(roll_pitch, most.x), least(roll_pitch, most.y), least(yaw, most.z));
    Limits::new(limits.thrust_min_m_s2(), limits.thrust_max_m_s2(), rates).unwrap_or(*limits)
}
