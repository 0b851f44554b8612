//! The controller: setpoints, estimates and gyroscope readings at 1 kHz in; thrust and torque, or motor forces, out at
//! 500 Hz.
//!
//! A control step asks the core's [`Guard`] for its order, does it, and nothing else. The call between takes setpoints,
//! lets the law's observers look, makes the next step's reference, and does background work.
//!
//! ```text
//! setpoint ─▶ Inbox ─▶ Flyer ◀── estimate, gyroscope ─▶ Guard
//!               └── bad ─────────────────────────────────▶ │
//!                     Flyer ◀── fly, brake, level, off ────┘
//! ```
//!
//! A change of the table is faded over [`FADE_STEPS`] control steps, both laws stepping side by side. The stabilizer's
//! stack is small: large values are here and are written in place.

mod ahead;
mod background;
mod flight;
mod flyer;
mod law_step;
mod outcome;
mod power_on;

use quatrack::mixer::MotorLimited;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{
    self, Circumstances, Config, Guard, MonitorConfig, Order, ReferenceReport, Sample, Soundness,
};
use quatrack::{CascadeMemory, Quaternion};

use self::background::Background;
pub use self::background::Work;
use self::flight::Flight;
pub use self::flyer::FADE_STEPS;
use self::flyer::Flyer;
pub use self::outcome::{Counters, Mode, Outcome, Settings, Why};
pub(crate) use self::power_on::CONTROLLER;
use crate::abi;
use crate::craft::{Craft, DECIMATION};
use crate::inbox::{Change, Inbox, News};
use crate::stream::Arrival;
use crate::tables::Table;
use crate::units;

/// Time without a control step after which another controller has flown, or nobody, ms.
const ABSENT_MS: u32 = 25;

/// The supervisor's limits: ticks are the firmware's steps of 1 ms.
const CONFIGS: (&Config, &MonitorConfig) = (&Config::STANDARD, &MonitorConfig::STANDARD);

/// The controller of a craft.
///
/// In this order: a load of a float reaches a kilobyte from where the controller is, and the fields that every step reads
/// are to be within.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Controller {
    guard: Guard,
    inbox: Inbox,
    /// The heading of the newest setpoint is still to be taken.
    is_heading_due: bool,
    /// The newest setpoint makes no sense.
    is_bad: bool,
    /// The last control step; nothing when the controller has just been selected.
    last_step: Option<u32>,
    counters: Counters,
    /// Why the newest flight was last left, if it was.
    why: Why,
    background: Background,
    flyer: Flyer,
}

impl Controller {
    /// For a craft, with motors off.
    pub const fn new(craft: Craft, table: Table, settings: Settings) -> Self {
        Self {
            inbox: Inbox::new(),
            is_heading_due: false,
            is_bad: false,
            last_step: None,
            guard: Guard::new(),
            flyer: Flyer::new(craft, table, settings),
            counters: Counters { bad_states: 0, bad_setpoints: 0, limited_steps: 0, jumps: 0 },
            why: Why::Nothing,
            background: Background::new(),
        }
    }

    /// One of the firmware's steps: whether [`Self::outcome`] is new; between control steps the last one holds.
    #[inline]
    pub fn step(&mut self, setpoint: &abi::Setpoint, sensors: &abi::SensorData, state: &abi::State, step: u32) -> bool {
        if !step.is_multiple_of(DECIMATION) {
            return false;
        }
        if self.flyer.flight == Flight::NoCraft {
            self.flyer.switch_off();
            return true;
        }
        let is_absent = self.last_step.is_none_or(|last| step.wrapping_sub(last) > ABSENT_MS);
        if self.inbox.is_urgent(setpoint, step) || is_absent {
            if is_absent {
                self.restart(step);
            }
            self.take(setpoint, step);
        }
        self.last_step = Some(step);
        if self.flyer.flight.is_on() {
            self.supervise(sensors, state, step);
        } else {
            self.flyer.switch_off();
        }
        if self.flyer.outcome.limited.any() {
            self.counters.limited_steps = self.counters.limited_steps.wrapping_add(1);
        }
        true
    }

    /// Flies as asked where the supervisor says so, else does as it orders.
    #[inline(always)]
    fn supervise(&mut self, sensors: &abi::SensorData, state: &abi::State, step: u32) {
        let (limited, measured) = (self.flyer.outcome.limited, (sensors, state));
        let is_well = !self.is_bad && goes_on(&mut self.guard, measured, limited, step);
        if (is_well || self.is_to_fly(measured, step)) && self.flyer.fly(&self.guard.looked(), step).is_err() {
            self.rescue(step);
        }
    }

    /// The supervisor's inputs beside the measurements; link, battery and arming are the firmware's.
    fn circumstances(&self) -> Circumstances {
        let reference = if self.is_bad { ReferenceReport::Bad } else { ReferenceReport::Sound };
        Circumstances { asked: self.flyer.flight.asked(), reference, limited: self.flyer.cut(), ..Circumstances::WELL }
    }

    /// Not all is well: does as the supervisor orders, but for flying as asked, which is left to the caller.
    #[cold]
    #[inline(never)]
    fn is_to_fly(&mut self, (sensors, state): (&abi::SensorData, &abi::State), step: u32) -> bool {
        let (state, rates, felt) =
            (units::state(state), units::body_rates_rad_s(sensors), units::specific_force_m_s2(sensors));
        let sample = Sample {
            now: step,
            state: Some(&state),
            body_rates_rad_s: Some(&rates),
            specific_force_m_s2: felt.as_ref(),
            thrust_m_s2: self.flyer.thrust_m_s2(),
        };
        let around = self.circumstances();
        let order = self.guard.order_closely(CONFIGS, &sample, &around);
        if let Order::Fly(looked) | Order::Brake(looked, ..) = &order
            && looked.soundness != Soundness::Sound
        {
            self.counters.bad_states = self.counters.bad_states.wrapping_add(1);
        }
        match order {
            Order::Fly(_) => return true,
            Order::Brake(looked, sample, heading) => {
                if self.flyer.brake(&looked, sample, heading).is_err() {
                    self.rescue(step);
                }
            }
            Order::Level(levelled) => self.flyer.level(&levelled),
            Order::Off => self.flyer.switch_off(),
        }
        self.note();
        false
    }

    /// The law gives nothing: level, where that can be flown.
    #[cold]
    #[inline(never)]
    fn rescue(&mut self, step: u32) {
        let around = self.circumstances();
        match self.guard.step_failed(step, CONFIGS.1.tick_s, &around) {
            Some(levelled) => self.flyer.level(&levelled),
            None => self.flyer.switch_off(),
        }
        self.note();
    }

    /// Remembers why the craft is not flown as asked.
    #[cold]
    #[inline(never)]
    fn note(&mut self) {
        if let Some(why) = Why::of(self.guard.mode()) {
            self.why = why;
        }
    }

    /// Between control steps. Until a setpoint has been taken here the one before is carried on, which leads to the same place
    /// unless it jumps. Gives the background work that there is time for.
    #[inline]
    pub fn between(&mut self, setpoint: &abi::Setpoint, sensors: &abi::SensorData, step: u32) -> Option<Work> {
        if self.flyer.flight == Flight::NoCraft {
            return Some(self.background.next());
        }
        // One thing at a time: a setpoint that comes with the longest look of the observers is taken a call later, and is fitted
        // another one later. It is dated by its stamp.
        let is_busy = self.flyer.observe(sensors);
        let news = if is_busy { self.inbox.glance(setpoint, step) } else { self.inbox.look(setpoint, step) };
        let has_time = news == News::Nothing && !(is_busy || self.is_heading_due || self.flyer.stream.is_due());
        match news {
            News::Nothing if is_busy || has_time => {}
            News::Nothing if self.is_heading_due => self.follow_heading(),
            News::Nothing => self.flyer.stream.catch_up(),
            News::Motion => self.follow_motion(),
            News::Other => self.take(setpoint, step),
        }
        self.flyer.look_ahead(&self.guard, step.wrapping_add(1));
        if has_time { Some(self.background.next()) } else { self.background.put_off() }
    }

    /// Takes a setpoint, and does as it asks.
    #[inline(never)]
    fn take(&mut self, setpoint: &abi::Setpoint, now: u32) {
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

    /// Another controller has flown in the meantime, or nobody: nothing that was remembered holds. The motors are
    /// taken to carry the craft until a setpoint says that they are off.
    #[cold]
    #[inline(never)]
    fn restart(&mut self, now: u32) {
        self.guard = Guard::flying(now);
        (self.is_bad, self.why) = (false, Why::Nothing);
        self.flyer.restart();
    }

    /// Forgets the flight so far, at the next control step.
    pub fn forget(&mut self) {
        self.last_step = None;
    }

    /// Keeps the table that is flown, to fade it out once another one comes: in a call of its own, each copy takes long.
    pub fn keep_table(&mut self) {
        self.flyer.keep_table();
    }

    /// Flies another table from the next control step on, after [`Self::keep_table`]; in flight over [`FADE_STEPS`] of them,
    /// but for a cascade that takes over from another one: their memory is the same, and their limits hold at once.
    pub fn change_table(&mut self, table: &Table) {
        self.flyer.change_table(table);
    }

    /// Starts for a craft: motors off until a setpoint comes.
    #[inline(never)]
    pub fn change_craft(&mut self, craft: &Craft) {
        self.guard = Guard::new();
        self.flyer.change_craft(craft);
        self.last_step = None;
        self.counters = Counters::default();
    }

    /// Takes over the owner's settings.
    pub fn set(&mut self, settings: &Settings, craft: &Craft) {
        self.flyer.set(settings, craft);
    }

    /// How the last setpoint is flown.
    pub fn mode(&self) -> Mode {
        match self.flyer.flight {
            Flight::NoCraft => Mode::NoCraft,
            Flight::Off => Mode::Off,
            _ => match self.guard.mode() {
                supervisor::Mode::Flying => Mode::Flying,
                supervisor::Mode::Holding(_) | supervisor::Mode::LevelAndDown(_) => Mode::Descending,
                _ => Mode::Stopped,
            },
        }
    }

    /// Why the newest flight was last left, if it was.
    pub fn why(&self) -> Why {
        self.why
    }

    /// The craft.
    pub fn craft(&self) -> &Craft {
        &self.flyer.craft
    }

    /// The counts so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// The result of the last control step.
    pub fn outcome(&self) -> &Outcome {
        &self.flyer.outcome
    }

    /// Drag (1/s) and moment (N s) that are flown with, and the cascade's memory; nothing under another law.
    pub fn learned(&self) -> Option<(f32, [f32; 2], &CascadeMemory)> {
        self.flyer.learned()
    }

    /// Rotation vector from the attitude that the last control step wanted to the craft's, body frame, rad.
    pub fn rotation_error_rad(&self, attitude: Quaternion) -> Vector3<f32> {
        self.flyer.rotation_error_rad(attitude)
    }
}

/// Whether all measurements of a step are sound.
#[inline(always)]
fn goes_on(
    guard: &mut Guard,
    (sensors, state): (&abi::SensorData, &abi::State),
    limited: MotorLimited,
    step: u32,
) -> bool {
    let (state, rates) = (units::state(state), units::body_rates_rad_s(sensors));
    let sample = Sample {
        now: step,
        state: Some(&state),
        body_rates_rad_s: Some(&rates),
        specific_force_m_s2: None,
        thrust_m_s2: f32::INFINITY,
    };
    guard.goes_on(CONFIGS, &sample, &Circumstances { limited, ..Circumstances::WELL })
}
