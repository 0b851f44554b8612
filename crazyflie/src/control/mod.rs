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
mod setpoints;
mod supervision;

use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{self, Guard};
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
use crate::inbox::Inbox;
use crate::tables::Table;

/// Time without a control step after which another controller has flown, or nobody, ms.
const ABSENT_MS: u32 = 25;

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
