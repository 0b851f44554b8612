//! The supervisor as a product calls it: what a step measures in; what is to be flown, out.
//!
//! ```text
//! state, gyroscope, accelerometer ─▶ Monitor ─▶ Supervisor ─▶ Off | Fly | Brake | Level
//!                 what can be flown on   │           ▲              │ Braking, descent
//! link, reference, battery, overruns ────┼───────────┘              ▼
//!                                        └──────────────────▶  the product's law, or Cascade::level
//! ```

use nalgebra::Vector3;

use super::braking::Braking;
use super::descent;
use super::machine::{Conditions, Config, ReferenceReport, Supervisor};
use super::mode::{Action, Fault, Mode, Reason};
use super::monitor::{Looked, Monitor, MonitorConfig, Sample, Soundness};
use crate::clock::Tick;
use crate::flatness::GRAVITY_M_S2;
use crate::mixer::MotorLimited;
use crate::motor_reference::FifthOrderSample;
use crate::quaternion::{Heading, Quaternion};
use crate::state::State;

/// What a step has beside its sample.
#[derive(Clone, Copy, Debug)]
pub struct Circumstances {
    /// Ticks since the last accepted frame; none if there never was one. 0 without a link.
    pub link_silence_ticks: Option<Tick>,
    /// What there is to be followed.
    pub reference: ReferenceReport,
    /// What the last step cut.
    pub limited: MotorLimited,
    /// Whether the craft can be levelled by attitude: there are body rates and motors.
    pub levels: bool,
    /// Whether the craft is near enough to where its reference begins; looked at while it is armed.
    pub starts_near: bool,
    /// Voltage of a cell, V, where it is known.
    pub battery_v: Option<f32>,
    /// Whether this step or the one before ran past its period.
    pub overrun: bool,
    /// A fault, from the step on which it is found.
    pub fault: Option<Fault>,
}

/// What is to be done in a step.
#[derive(Clone, Copy, Debug)]
pub enum Order<'a> {
    /// Zero forces.
    Off,
    /// Fly the law towards its own reference, on this state, which may be bridged.
    Fly(Looked<'a>),
    /// Fly the law towards this one.
    Brake(Looked<'a>, FifthOrderSample, Heading),
    /// Fly an attitude of norm 1 and body rates (rad/s) with an acceleration beside gravity (m/s^2): [`crate::Cascade::level`].
    Level(Levelled),
}

/// What levelling takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levelled {
    /// The attitude, of norm 1.
    pub attitude: Quaternion,
    /// Body rates, rad/s.
    pub body_rates_rad_s: Vector3<f32>,
    /// Acceleration to be made beside gravity, m/s^2.
    pub acceleration_m_s2: Vector3<f32>,
}

/// Monitor, state machine, and the way down.
#[derive(Clone, Copy, Debug)]
pub struct Guard {
    monitor: Monitor,
    supervisor: Supervisor,
    braking: Option<Braking>,
    /// Since when a descent has not moved.
    grounded: Option<Tick>,
    /// It has met the ground.
    hit: bool,
}

/// Thrust over mass from which on motors lift a craft, m/s^2: what is cut below is no climb.
const CLIMB_LEAST_M_S2: f32 = 1.05 * GRAVITY_M_S2;

/// For how long a craft that is told to go down has not to move until it has landed, ticks.
const GROUNDED_TICKS: Tick = 500;
/// Speed below which it does not move, m/s.
const GROUNDED_M_S: f32 = 0.1;

impl Guard {
    /// On the ground, nothing seen.
    pub const fn new() -> Self {
        Self { monitor: Monitor::new(), supervisor: Supervisor::new(), braking: None, grounded: None, hit: false }
    }

    /// Of a board that has started again because of a fault.
    #[cold]
    pub fn faulted(fault: Fault) -> Self {
        let mut guard = Self::new();
        guard.fail(fault, 0);
        guard
    }

    /// Takes a fault between two steps: motors off until a restart.
    #[cold]
    pub fn fail(&mut self, fault: Fault, now: Tick) {
        self.supervisor.fail(fault, now);
    }

    /// What the craft is doing.
    pub const fn mode(&self) -> Mode {
        self.supervisor.mode()
    }

    /// Arms, where the caller has looked whether that may be.
    pub fn arm(&mut self, now: Tick) {
        self.supervisor.arm(now);
    }

    /// Motors off from the next step on.
    pub fn disarm(&mut self, now: Tick) {
        self.supervisor.disarm(now);
    }

    /// What is to be done in a step.
    #[inline(always)]
    pub fn order<'a>(
        &'a mut self,
        (config, monitor): (&Config, &MonitorConfig),
        sample: &Sample<'a>,
        around: &Circumstances,
    ) -> Order<'a> {
        let Self { monitor: seen, supervisor, braking, grounded, hit } = self;
        let looked = seen.look(monitor, sample);
        let q = looked.state.attitude;
        let conditions = Conditions {
            now: sample.now,
            link_silence_ticks: around.link_silence_ticks,
            soundness: looked.soundness,
            upright: 1.0 - 2.0 * (q.x * q.x + q.y * q.y),
            position_m: looked.state.position_m,
            velocity_m_s: looked.state.velocity_m_s,
            reference: around.reference,
            limited: around.limited.any(),
            limited_thrust: (around.limited.thrust() || around.limited.command().thrust())
                && sample.thrust_m_s2 > CLIMB_LEAST_M_S2,
            levels: around.levels,
            starts_near: around.starts_near,
            landed: grounded.is_some_and(|since| sample.now.wrapping_sub(since) > GROUNDED_TICKS) || *hit,
            battery_v: around.battery_v,
            overrun: around.overrun,
            fault: around.fault,
        };
        let verdict = supervisor.step(config, &conditions);
        match verdict.action {
            Action::Fly => Order::Fly(looked),
            // A product that never levels links nothing of what follows.
            _ if !around.levels => {
                (*braking, *grounded, *hit) = (None, None, false);
                Order::Off
            }
            action => instead(action, verdict.mode, looked, (monitor, sample), (braking, grounded, hit)),
        }
    }

    /// The law has given nothing: what is to be done instead in this very step.
    #[cold]
    pub fn step_failed(&mut self, now: Tick, rescue: &Rescue, tick_s: f32, levels: bool) -> Option<Levelled> {
        let verdict = self.supervisor.step_failed(now, levels);
        (levels && verdict.action == Action::Level).then(|| rescue.level(tick_s))
    }

    /// What is to be followed turns out not to be flyable: what is to be followed instead in this very step.
    #[cold]
    pub fn reference_failed(
        &mut self,
        now: Tick,
        rescue: &Rescue,
        tick_s: f32,
        levels: bool,
    ) -> Option<(FifthOrderSample, Heading)> {
        if self.supervisor.reference_failed(now, levels).action != Action::Brake || !levels {
            return None;
        }
        let braking = self.braking.insert(Braking::begin(&rescue.looked(), now));
        Some((braking.at(now, tick_s, rescue.state.position_m.z), braking.heading()))
    }

    /// Stops where no step comes any more that could level the craft; whether that ended a flight.
    #[cold]
    pub fn stop(&mut self, reason: Reason, now: Tick) -> bool {
        self.supervisor.stop(reason, now).stopped
    }
}

impl Default for Guard {
    fn default() -> Self {
        Self::new()
    }
}

/// What a step that fails is rescued by: the state that it was to be flown on.
#[derive(Clone, Copy, Debug)]
pub struct Rescue {
    state: State,
    body_rates_rad_s: Vector3<f32>,
    velocity_bridged_ticks: Option<Tick>,
}

impl Rescue {
    /// Of what a step was given.
    pub const fn of(looked: &Looked<'_>) -> Self {
        let Looked { state, body_rates_rad_s, velocity_bridged_ticks, .. } = *looked;
        Self { state: *state, body_rates_rad_s: *body_rates_rad_s, velocity_bridged_ticks }
    }

    /// What is flown by attitude alone from here, at ticks of a length (s).
    pub fn level(&self, tick_s: f32) -> Levelled {
        levelled(&self.looked(), tick_s)
    }

    /// The state as a step takes it.
    pub const fn looked(&self) -> Looked<'_> {
        Looked {
            soundness: Soundness::Bridged,
            state: &self.state,
            body_rates_rad_s: &self.body_rates_rad_s,
            velocity_bridged_ticks: self.velocity_bridged_ticks,
        }
    }
}

fn levelled(looked: &Looked<'_>, tick_s: f32) -> Levelled {
    Levelled {
        attitude: unit(looked.state.attitude),
        body_rates_rad_s: *looked.body_rates_rad_s,
        acceleration_m_s2: descent::acceleration(looked, tick_s),
    }
}

fn unit(q: Quaternion) -> Quaternion {
    q.scaled(1.0 / crate::math::sqrt(q.dot(q)))
}

/// What is done instead of what was asked.
#[cold]
#[inline(never)]
fn instead<'a>(
    action: Action,
    mode: Mode,
    looked: Looked<'a>,
    (config, sample): (&MonitorConfig, &Sample<'_>),
    (braking, grounded, hit): (&mut Option<Braking>, &mut Option<Tick>, &mut bool),
) -> Order<'a> {
    let now = sample.now;
    let is_down = matches!(mode, Mode::LevelAndDown(_));
    let is_still =
        is_down && looked.velocity_bridged_ticks.is_none() && looked.state.velocity_m_s.z.abs() < GROUNDED_M_S;
    let feels_ground = is_down && sample.specific_force_m_s2.is_some_and(descent::is_impact);
    match action {
        Action::Off | Action::Fly => {
            (*braking, *grounded, *hit) = (None, None, false);
            Order::Off
        }
        Action::Brake => {
            let braking = braking.get_or_insert_with(|| Braking::begin(&looked, now));
            if is_down {
                braking.descend(now);
            }
            let begun = braking.is_descending_since(now);
            let is_still = is_still && begun.is_some_and(|ticks| ticks > GROUNDED_TICKS);
            *grounded = if is_still { Some(grounded.unwrap_or(now)) } else { None };
            let reference = braking.at(now, config.tick_s, looked.state.position_m.z);
            let heading = braking.heading();
            Order::Brake(looked, reference, heading)
        }
        Action::Level => {
            // A place that comes back is a new one.
            *braking = None;
            *hit |= feels_ground;
            *grounded = if is_still { Some(grounded.unwrap_or(now)) } else { None };
            Order::Level(levelled(&looked, config.tick_s))
        }
    }
}
