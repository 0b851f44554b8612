//! The supervisor as a product calls it: the measurements of a step in; an order, and the state to fly it on, out.
//!
//! ```text
//! state, gyroscope, accelerometer ─▶ Monitor ─▶ Supervisor ─▶ Off | Fly | Brake | Level
//!                state to be flown on    │           ▲              │ Braking, descent
//! link, reference, battery, overruns ────┼───────────┘              ▼
//!                                        └──────────────────▶  the product's law, or Cascade::level
//! ```

use super::machine::{Conditions, Config, ReferenceReport, Supervisor, UPRIGHT_LEAST, Verdict, is_at_rest, within};
use super::mode::{Action, Fault, Mode, Reason};
use super::monitor::{Looked, Monitor, MonitorConfig, Sample};
use super::way::{Asked, Levelled, Order, Way};
use crate::clock::Tick;
use crate::flatness::GRAVITY_M_S2;
use crate::mixer::MotorLimited;
use crate::motor_reference::FifthOrderSample;
use crate::quaternion::Heading;
use crate::state::State;

/// The inputs of a step beside its sample.
#[derive(Clone, Copy, Debug)]
pub struct Circumstances {
    /// Ticks since the last accepted frame; none if there never was one. 0 without a link.
    pub link_silence_ticks: Option<Tick>,
    /// The kind of flight that is asked for.
    pub asked: Asked,
    /// Whether there is a reference, and a sound one.
    pub reference: ReferenceReport,
    /// The limits that cut the last step.
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

impl Circumstances {
    /// Nothing is wrong, in flight, on a product without link, cell voltage or fence that levels.
    pub const WELL: Self = Self {
        link_silence_ticks: Some(0),
        asked: Asked::Places,
        reference: ReferenceReport::Sound,
        limited: MotorLimited::NOTHING,
        levels: true,
        starts_near: true,
        battery_v: None,
        overrun: false,
        fault: None,
    };
}

/// Monitor, state machine, and the way down. The fields that every step looks at come first, within the reach of a load.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Guard {
    monitor: Monitor,
    supervisor: Supervisor,
    way: Way,
}

/// Thrust over mass from which on motors lift a craft, m/s^2: a cut below it prevents no climb.
const CLIMB_LEAST_M_S2: f32 = 1.05 * GRAVITY_M_S2;

impl Guard {
    /// On the ground, nothing seen.
    pub const fn new() -> Self {
        Self { monitor: Monitor::new(), supervisor: Supervisor::new(), way: Way::NONE }
    }

    /// Of a product that takes over a craft in the air, nothing seen: it flies from the first sound state on, and stops where the
    /// first is none.
    pub const fn flying(now: Tick) -> Self {
        Self { supervisor: Supervisor::flying(now), ..Self::new() }
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

    /// The mode of the craft.
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

    /// The order for a step.
    #[inline(always)]
    pub fn order(
        &mut self,
        configs: (&Config, &MonitorConfig),
        sample: &Sample<'_>,
        around: &Circumstances,
    ) -> Order<'_> {
        if self.goes_on(configs, sample, around) {
            return Order::Fly(self.looked());
        }
        // Copies: on the way above nothing of it has to be in memory.
        let (sample, around) = (*sample, *around);
        if around.levels {
            return self.order_closely(configs, &sample, &around);
        }
        // A product that never levels links nothing of the ways down.
        let Self { monitor, supervisor, way } = self;
        let (verdict, looked) = judge(monitor, supervisor, false, configs, &sample, &around);
        *way = Way::NONE;
        if verdict.action == Action::Fly { Order::Fly(looked) } else { Order::Off }
    }

    /// Whether all is well and the flight goes on as asked, on [`Self::looked`]: the first half of [`Self::order`], for a product that
    /// fetches the inputs of the second half alone, [`Self::order_closely`], where it has to. The sample's specific force
    /// is not looked at; a thrust of infinity is one that nobody has looked up yet.
    #[inline(always)]
    pub fn goes_on(
        &mut self,
        (config, monitor): (&Config, &MonitorConfig),
        sample: &Sample<'_>,
        around: &Circumstances,
    ) -> bool {
        let (limited, supervisor) = (around.limited, &mut self.supervisor);
        supervisor.is_calm()
            && around.reference == ReferenceReport::Sound
            && !around.overrun
            && around.fault.is_none()
            && within(around.link_silence_ticks, config.link_silence_max_ticks)
            && config.geofence.is_none()
            && around.battery_v.is_none_or(|volts| volts >= config.battery_least_v)
            && supervisor.is_in_range(limited.any(), sample.now, config)
            && (!limited.any()
                || !cuts_thrust(limited)
                || sample.thrust_m_s2 <= CLIMB_LEAST_M_S2
                || sample.state.is_some_and(|state| !is_at_rest(&state.velocity_m_s)))
            && sample.state.is_some_and(|state| tilted(state) <= TILTED_MOST)
            && self.monitor.keeps(monitor, sample)
    }

    /// The state and body rates that the last step was flown on.
    #[inline(always)]
    pub fn looked(&self) -> Looked<'_> {
        self.monitor.looked()
    }

    /// The order for a step that does not simply go on.
    #[cold]
    #[inline(never)]
    pub fn order_closely(
        &mut self,
        configs: (&Config, &MonitorConfig),
        sample: &Sample<'_>,
        around: &Circumstances,
    ) -> Order<'_> {
        let Self { monitor, supervisor, way } = self;
        let (verdict, looked) = judge(monitor, supervisor, way.has_landed(sample.now), configs, sample, around);
        match verdict.action {
            Action::Fly => Order::Fly(looked),
            _ if !around.levels => {
                *way = Way::NONE;
                Order::Off
            }
            _ => {
                let felt = sample.specific_force_m_s2;
                way.instead(verdict, looked, (sample.now, configs.1.tick_s, felt), around.asked)
            }
        }
    }

    /// The law has given nothing: the levelled flight instead of it in this very step, at ticks of a length (s).
    #[cold]
    pub fn step_failed(&mut self, now: Tick, tick_s: f32, around: &Circumstances) -> Option<Levelled> {
        let verdict = self.supervisor.step_failed(now, around.levels);
        if verdict.left {
            self.way = Way::NONE;
        }
        let looked = self.monitor.looked();
        (around.levels && verdict.action == Action::Level).then(|| Levelled::of(&looked, tick_s).asked(around.asked))
    }

    /// The reference turns out not to be flyable: another one in its place in this very step.
    #[cold]
    pub fn reference_failed(
        &mut self,
        now: Tick,
        tick_s: f32,
        around: &Circumstances,
    ) -> Option<(Looked<'_>, &FifthOrderSample, Heading)> {
        if self.supervisor.reference_failed(now, around.levels).action != Action::Brake || !around.levels {
            return None;
        }
        let looked = self.monitor.looked();
        let (sample, heading) = self.way.brake_anew(&looked, now, tick_s);
        Some((looked, sample, heading))
    }

    /// Stops where no step comes any more that could level the craft; whether that ended a flight.
    #[cold]
    pub fn stop(&mut self, reason: Reason, now: Tick) -> bool {
        self.supervisor.stop(reason, now).stopped
    }
}

/// The monitor's judgement of a sample, and the supervisor's verdict on it.
#[cold]
#[inline(never)]
fn judge<'m>(
    monitor: &'m mut Monitor,
    supervisor: &mut Supervisor,
    landed: bool,
    (config, monitor_config): (&Config, &MonitorConfig),
    sample: &Sample<'_>,
    around: &Circumstances,
) -> (Verdict, Looked<'m>) {
    let looked = monitor.look_closely(monitor_config, sample);
    let turns_over = around.asked == Asked::Rates && supervisor.mode() == Mode::Flying;
    let conditions = Conditions {
        now: sample.now,
        link_silence_ticks: around.link_silence_ticks,
        soundness: looked.soundness,
        upright: if turns_over { 1.0 } else { 1.0 - 2.0 * tilted(looked.state) },
        position_m: looked.state.position_m,
        velocity_m_s: looked.state.velocity_m_s,
        reference: around.reference,
        limited: around.limited.any(),
        limited_thrust: cuts_thrust(around.limited) && sample.thrust_m_s2 > CLIMB_LEAST_M_S2,
        levels: around.levels,
        starts_near: around.starts_near,
        landed,
        battery_v: around.battery_v,
        overrun: around.overrun,
        fault: around.fault,
    };
    (supervisor.step(config, &conditions), looked)
}

/// Half of the difference from 1 of the thrust axis' vertical component.
#[inline(always)]
fn tilted(state: &State) -> f32 {
    let q = state.attitude;
    q.x * q.x + q.y * q.y
}

/// The same where a craft begins to tumble.
const TILTED_MOST: f32 = 0.5 * (1.0 - UPRIGHT_LEAST);

#[inline(always)]
fn cuts_thrust(limited: MotorLimited) -> bool {
    limited.thrust() || limited.command().thrust()
}

impl Default for Guard {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;
