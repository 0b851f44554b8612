//! The targets of a fault: the inputs of a control step, a controller that takes them, and a craft
//! that differs from the told one.

use nalgebra::{Vector3, Vector4};
use quatrack::supervisor::Mode;
use quatrack::{State, Tick};

/// The inputs of a step, to be spoilt.
pub struct Signals<'a> {
    /// The estimate; nothing where it does not come.
    pub state: Option<State>,
    /// The gyroscope, rad/s.
    pub body_rates: Vector3<f32>,
    /// The accelerometer, m/s^2.
    pub felt: Option<Vector3<f32>>,
    /// The reference: position, velocity, acceleration; m and s.
    pub asked: Option<[Vector3<f32>; 3]>,
    /// Heading that is asked for, rad, and its rate.
    pub heading: [f32; 2],
    /// Ticks since the last frame.
    pub silence: Tick,
    /// Voltage of the cell, V.
    pub battery_v: f32,
    /// The step before has overrun.
    pub overrun: bool,
    /// The step does not take place: the motors keep their commands.
    pub is_skipped: bool,
    /// Shares of the commanded forces that the motors give.
    pub motors: [f64; 4],
    /// Force from outside over the weight.
    pub push: Vector3<f64>,
    /// The state and body rates of so many steps ago.
    pub past: &'a dyn Fn(usize) -> (State, Vector3<f32>),
    /// Steps since the fault began.
    pub step: u32,
}

impl Signals<'_> {
    /// Seconds since the fault began.
    pub fn since_s(&self) -> f64 {
        f64::from(self.step) * 0.002
    }
}

/// A controller that flies a craft through a fault.
pub trait UnderTest {
    /// Motor forces of a step at a tick, N; nothing where the motors are off.
    fn step(&mut self, now: Tick, signals: &Signals<'_>) -> Option<Vector4<f64>>;

    /// Its mode.
    fn mode(&self) -> Mode;

    /// Whether the last step was flown on a bridged state.
    fn is_bridging(&self) -> bool;
}

/// Deviations of the craft from the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Craft {
    /// True mass over the told one.
    pub mass: f64,
    /// True inertia over the told one.
    pub inertia: f64,
    /// True lag of the motors over the known one.
    pub lag: f64,
    /// Centre of mass beside the middle, m.
    pub centre_m: f64,
    /// Wind, m/s.
    pub wind_m_s: f64,
    /// A wall that is so far away along x, m.
    pub wall_m: Option<f64>,
}

/// As it is told.
pub(super) const SOUND: Craft = Craft { mass: 1.0, inertia: 1.0, lag: 1.0, centre_m: 0.0, wind_m_s: 0.0, wall_m: None };

/// A kind of fault.
#[derive(Clone, Copy)]
pub struct Fault {
    /// Its name.
    pub name: &'static str,
    /// Whether nothing may be lost.
    pub recoverable: bool,
    /// Speed of the course at which it happens, m/s; 0 hovers.
    pub speed_m_s: f64,
    /// Spoils the inputs of a step.
    pub spoil: fn(&mut Signals<'_>),
    /// Deviations of the craft from the start.
    pub craft: Craft,
    /// The answers of PX4 and of Bitcraze's firmware.
    pub others: &'static str,
}
