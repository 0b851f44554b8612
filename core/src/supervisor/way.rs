//! The way of a flight that does not go on as asked: a verdict and the state to fly on in; the order instead, until the
//! craft is down, out.

use nalgebra::Vector3;

use super::braking::Braking;
use super::descent;
use super::machine::Verdict;
use super::mode::{Action, Mode};
use super::monitor::Looked;
use crate::clock::Tick;
use crate::motor_reference::FifthOrderSample;
use crate::quaternion::{Heading, Quaternion};

/// How a craft is asked to fly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// To places or at velocities, which are measured.
    Places,
    /// By hand, at tilts: maybe nothing measures where it is over ground. It comes down level instead of braking.
    Tilts,
    /// By hand, at body rates: the same, and it may turn over.
    Rates,
}

/// The order for a step.
#[derive(Clone, Copy, Debug)]
pub enum Order<'a> {
    /// Zero forces.
    Off,
    /// Fly the law towards its own reference, on this state, which may be bridged.
    Fly(Looked<'a>),
    /// Fly the law towards this one.
    Brake(Looked<'a>, &'a FifthOrderSample, Heading),
    /// Fly an attitude of norm 1 and body rates (rad/s) with an acceleration beside gravity (m/s^2): [`crate::Cascade::level`].
    Level(Levelled),
}

/// The inputs of a flight by attitude alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levelled {
    /// The attitude, of norm 1.
    pub attitude: Quaternion,
    /// Body rates, rad/s.
    pub body_rates_rad_s: Vector3<f32>,
    /// Acceleration to be made beside gravity, m/s^2.
    pub acceleration_m_s2: Vector3<f32>,
}

/// For how long a craft that is told to go down has not to move until it has landed, ticks.
const GROUNDED_TICKS: Tick = 500;
/// Speed below which it does not move, m/s.
const GROUNDED_M_S: f32 = 0.1;

/// The way of a flight that does not go on as asked, from when it was left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    braking: Option<Braking>,
    /// Since when a descent has not moved.
    grounded: Option<Tick>,
    /// It has met the ground.
    hit: bool,
}

impl Way {
    pub(super) const NONE: Self = Self { braking: None, grounded: None, hit: false };

    pub(super) fn has_landed(&self, now: Tick) -> bool {
        self.hit || self.grounded.is_some_and(|since| now.wrapping_sub(since) > GROUNDED_TICKS)
    }

    /// Brakes from the state that a step was flown on, and forgets an earlier way.
    #[cold]
    pub(super) fn brake_anew(&mut self, looked: &Looked<'_>, now: Tick, tick_s: f32) -> (&FifthOrderSample, Heading) {
        *self = Self::NONE;
        let braking = self.braking.insert(Braking::begin(looked, now));
        let heading = braking.heading();
        (braking.at(now, tick_s, looked.state.position_m.z), heading)
    }

    /// The order in the place of the flight asked for: at a tick, with ticks of a length (s), and a specific force that
    /// is felt, m/s^2.
    #[cold]
    #[inline(never)]
    pub(super) fn instead<'a>(
        &'a mut self,
        verdict: Verdict,
        looked: Looked<'a>,
        (now, tick_s, felt): (Tick, f32, Option<&Vector3<f32>>),
        asked: Asked,
    ) -> Order<'a> {
        if verdict.left {
            *self = Self::NONE;
        }
        let is_down = matches!(verdict.mode, Mode::LevelAndDown(_));
        let is_still =
            is_down && looked.velocity_bridged_ticks.is_none() && looked.state.velocity_m_s.z.abs() < GROUNDED_M_S;
        let feels_ground = is_down && felt.is_some_and(descent::is_impact);
        match verdict.action {
            Action::Off | Action::Fly => {
                *self = Self::NONE;
                Order::Off
            }
            Action::Brake if asked == Asked::Places => {
                let Self { braking, grounded, .. } = self;
                let braking = braking.get_or_insert_with(|| Braking::begin(&looked, now));
                if is_down {
                    braking.descend(now);
                }
                let begun = braking.is_descending_since(now);
                let is_still = is_still && begun.is_some_and(|ticks| ticks > GROUNDED_TICKS);
                *grounded = if is_still { Some(grounded.unwrap_or(now)) } else { None };
                let heading = braking.heading();
                Order::Brake(looked, braking.at(now, tick_s, looked.state.position_m.z), heading)
            }
            Action::Brake | Action::Level => {
                // A place that comes back is a new one.
                self.braking = None;
                self.hit |= feels_ground;
                self.grounded = if is_still { Some(self.grounded.unwrap_or(now)) } else { None };
                Order::Level(Levelled::of(&looked, tick_s).asked(asked))
            }
        }
    }
}

impl Levelled {
    /// Of the state that a step is flown on, at ticks of a length (s).
    pub fn of(looked: &Looked<'_>, tick_s: f32) -> Self {
        Self {
            attitude: unit(looked.state.attitude),
            body_rates_rad_s: *looked.body_rates_rad_s,
            acceleration_m_s2: descent::acceleration(looked, tick_s),
        }
    }

    /// The same of a craft that was asked to fly so: by hand, a velocity over ground is not believed.
    pub(super) fn asked(mut self, asked: Asked) -> Self {
        if asked != Asked::Places {
            (self.acceleration_m_s2.x, self.acceleration_m_s2.y) = (0.0, 0.0);
        }
        self
    }
}

fn unit(q: Quaternion) -> Quaternion {
    q.scaled(1.0 / crate::math::sqrt(q.dot(q)))
}
