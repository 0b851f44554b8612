//! The state machine's inputs, the bounds of a flight and the conditions of a step; and its answer, the verdict.

use nalgebra::Vector3;

use crate::clock::Tick;
use crate::supervisor::mode::{Action, Fault, Mode};
use crate::supervisor::monitor::Soundness;

/// A box that a flight keeps to, world frame, m.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Geofence {
    /// Its lowest corner.
    pub least_m: [f32; 3],
    /// Its highest one.
    pub most_m: [f32; 3],
}

impl Geofence {
    pub(super) fn holds(&self, p: &Vector3<f32>) -> bool {
        let ([x, y, z], [fx, fy, fz]) = (self.least_m, self.most_m);
        p.x >= x && p.x <= fx && p.y >= y && p.y <= fy && p.z >= z && p.z <= fz
    }
}

/// Bounds that the supervisor holds a flight to; apart from its state, so that they can be set without touching it. A tick is 1 ms
/// of the product's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config {
    /// Oldest state that is taken for one, ticks since it came.
    pub state_age_max_ticks: Tick,
    /// Longest time without any accepted frame, ticks.
    pub link_silence_max_ticks: Tick,
    /// Overruns in a row that a flight survives; with 0 the first one ends it.
    pub overruns_tolerated: u32,
    /// How long a craft that brakes stays where it comes to rest, ticks from when it began to.
    pub hold_ticks: Tick,
    /// Longest way down, ticks.
    pub down_max_ticks: Tick,
    /// How long all has to be well again before a flight goes on as asked, ticks.
    pub recovery_ticks: Tick,
    /// How long the thrust axis may be more than 60 degrees from the vertical, ticks.
    pub tilt_max_ticks: Tick,
    /// How long it may point downwards, ticks.
    pub upside_down_max_ticks: Tick,
    /// How long the motors may give all that they have while the craft does not move, ticks.
    pub no_climb_max_ticks: Tick,
    /// How long motors may be at their limits without a break, ticks.
    pub saturation_max_ticks: Tick,
    /// Voltage of a cell below which it is empty, V.
    pub battery_least_v: f32,
    /// How long it has to be below, ticks.
    pub battery_low_ticks: Tick,
    /// The space that a flight keeps to, if it is told one.
    pub geofence: Option<Geofence>,
}

impl Config {
    /// 50 ms without a state, half a second without a frame, two overruns; stays for a second and a half where it has braked, and
    /// looks for the ground for half a minute.
    pub const STANDARD: Self = Self {
        state_age_max_ticks: 50,
        link_silence_max_ticks: 500,
        overruns_tolerated: 2,
        hold_ticks: 1500,
        down_max_ticks: 30_000,
        recovery_ticks: 100,
        tilt_max_ticks: 1000,
        upside_down_max_ticks: 600,
        no_climb_max_ticks: 1500,
        saturation_max_ticks: 3000,
        battery_least_v: 3.0,
        battery_low_ticks: 2000,
        geofence: None,
    };
}

/// Whether there is a reference, and a sound one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReferenceReport {
    /// There is none, or it is too old.
    Missing,
    /// Something that cannot be flown.
    Bad,
    /// Something that can.
    Sound,
}

/// The conditions of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// The tick.
    pub now: Tick,
    /// Ticks since the last accepted frame; none if there never was one. 0 without a link.
    pub link_silence_ticks: Option<Tick>,
    /// How sound the state is that can be flown on.
    pub soundness: Soundness,
    /// Vertical component of the thrust axis: the cosine of the tilt.
    pub upright: f32,
    /// Position of the craft, world frame, m.
    pub position_m: Vector3<f32>,
    /// Velocity, m/s, world frame.
    pub velocity_m_s: Vector3<f32>,
    /// Whether there is a reference, and a sound one.
    pub reference: ReferenceReport,
    /// Whether the last step cut something to the motors' range.
    pub limited: bool,
    /// Whether it cut the thrust.
    pub limited_thrust: bool,
    /// Whether the craft can be levelled by attitude: there are body rates and motors.
    pub levels: bool,
    /// Whether it is near enough to where its reference begins; looked at while it is armed.
    pub starts_near: bool,
    /// Whether it has come to the ground.
    pub landed: bool,
    /// Voltage of a cell, V, where it is known.
    pub battery_v: Option<f32>,
    /// Whether this step or the one before ran past its period.
    pub overrun: bool,
    /// A fault, from the step on which it is found.
    pub fault: Option<Fault>,
}

/// The verdict of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// The mode of the craft from here on.
    pub mode: Mode,
    /// The action on its motors.
    pub action: Action,
    /// Whether this step ended a flight or the readiness for one.
    pub stopped: bool,
    /// Whether it is the first that does not fly as asked, after one that did.
    pub left: bool,
}
