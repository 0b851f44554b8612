//! The measurements of a step in, with the bounds of sound ones; the state and body rates that the step may be flown on,
//! and how sound they are, out.

use nalgebra::Vector3;

use crate::clock::Tick;
use crate::state::State;

/// The bounds of a sound sample, and for how long the rest is bridged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonitorConfig {
    /// Length of a tick, s.
    pub tick_s: f32,
    /// How long a position, velocity or attitude is bridged before it counts as lost, ticks.
    pub bridge_ticks: Tick,
    /// How long the gyroscope alone may carry an attitude on, ticks.
    pub attitude_ticks: Tick,
    /// How long body rates may be the attitude's differences, ticks.
    pub body_rates_ticks: Tick,
    /// How long an estimate may stay the same, bit by bit, while the gyroscope moves; and a gyroscope while the attitude
    /// does.
    pub frozen_ticks: Tick,
    /// Velocity that no craft has, m/s.
    pub speed_max_m_s: f32,
    /// Farthest position, m.
    pub position_max_m: f32,
    /// Body rate beyond the gyroscope's range, rad/s.
    pub body_rate_max_rad_s: f32,
}

impl MonitorConfig {
    /// Ticks of 1 ms; half a second of bridging, five on the gyroscope alone, and a range of 2000 degrees a second.
    pub const STANDARD: Self = Self {
        tick_s: 1e-3,
        bridge_ticks: 500,
        attitude_ticks: 5000,
        body_rates_ticks: 600,
        frozen_ticks: 100,
        speed_max_m_s: 30.0,
        position_max_m: 10_000.0,
        body_rate_max_rad_s: 34.9,
    };
}

/// The soundness of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Soundness {
    /// As it was given, or with its quaternion scaled to norm 1.
    Sound,
    /// In parts the last sound one, carried on.
    Bridged,
    /// A position, velocity or attitude has been missing for too long: the rest is good for staying level.
    AttitudeOnly,
    /// There is no attitude.
    AttitudeLost,
    /// There are no body rates.
    BodyRatesLost,
}

/// The state and body rates that a step may be flown on.
#[derive(Clone, Copy, Debug)]
pub struct Looked<'a> {
    /// Its soundness.
    pub soundness: Soundness,
    /// The state; of finite numbers and an attitude, unless that is lost.
    pub state: &'a State,
    /// The body rates, rad/s.
    pub body_rates_rad_s: &'a Vector3<f32>,
    /// How long the velocity has been bridged, ticks; none while it is measured.
    pub velocity_bridged_ticks: Option<Tick>,
}

/// The measurements of a step.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// The tick.
    pub now: Tick,
    /// The estimate; nothing where the newest is too old.
    pub state: Option<&'a State>,
    /// The gyroscope's body rates, rad/s; nothing where there is none. One that has failed gives NaN.
    pub body_rates_rad_s: Option<&'a Vector3<f32>>,
    /// The accelerometer's specific force in the body frame, m/s^2.
    pub specific_force_m_s2: Option<&'a Vector3<f32>>,
    /// Thrust over mass that the motors should give, m/s^2: it carries a velocity on where there is no accelerometer.
    pub thrust_m_s2: f32,
}
