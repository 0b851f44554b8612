//! Flies a craft as the supervisor orders: setpoints, a law's table and the law's memory in; the output of a
//! step out.

mod changes;
mod ordered;

use quatrack::flatness::GRAVITY_M_S2;
use quatrack::mixer::MotorLimited;
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{self, Guard, Looked};
use quatrack::{
    CascadeMemory, Command, FifthOrderSample, Followed, Handover, Heading, Limits, Memory, Quaternion, State,
};

pub use self::changes::FADE_STEPS;
use super::ahead::Ahead;
use super::flight::Flight;
use super::law_step::{LawStep, Unflown};
use super::outcome::{Outcome, Settings};
use crate::abi;
use crate::craft::{Craft, PERIOD_S};
use crate::heading::HeadingStream;
use crate::output::Output;
use crate::shaping::{Shaped, Shaping};
use crate::stream::Stream;
use crate::tables::Table;
use crate::units;

/// Everything that flies: the fields that every step reads come first.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Flyer {
    pub(super) headings: HeadingStream,
    pub(super) ahead: Ahead,
    pub(super) outcome: Outcome,
    pub(super) stream: Stream,
    pub(super) flight: Flight,
    settings: Settings,
    shaping: Shaping,
    pub(super) craft: Craft,
    memory: Memory,
    table: Table,
    /// The table on its way out, and how far it is.
    before: Table,
    handover: Handover,
}

impl Flyer {
    /// For a craft, with motors off.
    pub(super) const fn new(craft: Craft, table: Table, settings: Settings) -> Self {
        Self {
            stream: Stream::new(),
            headings: HeadingStream::new(),
            ahead: Ahead::new(),
            flight: Flight::NoCraft,
            shaping: Shaping::new(PERIOD_S),
            settings,
            outcome: Outcome::OFF,
            craft,
            memory: Memory::at_rest(),
            table,
            before: table,
            handover: Handover::OVER,
        }
    }

    /// Lets the observers of the law look at the control step before; whether that took long.
    #[inline(always)]
    pub(super) fn observe(&mut self, sensors: &abi::SensorData) -> bool {
        let Some(cascade) = self.table.as_cascade().filter(|_| self.outcome.has_stepped) else { return false };
        let (felt, is_long) = (units::specific_force_m_s2(sensors), self.memory.cascade().is_air_due());
        quatrack::Controller::new(cascade, Limits::NONE).observe(&mut self.memory, felt.as_ref());
        is_long
    }

    /// Thrust over mass that the motors should give, m/s^2.
    #[inline(always)]
    pub(super) fn thrust_m_s2(&self) -> f32 {
        let [a, b, c, d] = self.memory.forces_n();
        (a + b + c + d) * self.craft.per_force_max_1_n * (0.25 * self.craft.thrust_max_m_s2)
    }

    /// The limits that cut the law's command in the last step; none for a pilot's command by hand and for the idling of a
    /// craft on the ground.
    #[inline(always)]
    pub(super) fn cut(&self) -> MotorLimited {
        let limited = self.outcome.limited;
        if limited.any() { self.cut_in_flight(limited) } else { MotorLimited::NOTHING }
    }

    #[cold]
    #[inline(never)]
    fn cut_in_flight(&self, limited: MotorLimited) -> MotorLimited {
        let is_by_hand = !self.flight.followed().height || matches!(self.flight, Flight::Rates { .. });
        let idles = self.memory.cascade().stands() && self.thrust_m_s2() < GRAVITY_M_S2;
        if is_by_hand || idles { MotorLimited::NOTHING } else { limited }
    }

    /// Whether a law that is flown takes snap and crackle.
    #[inline(always)]
    pub(super) fn looks_beyond_jerk(&self) -> bool {
        self.table.gives_forces() || !self.handover.is_over()
    }

    /// Makes the next control step's reference along a stream. It takes nothing from the last state that was flown on,
    /// but where the leash of the paper's laws ends.
    #[inline(always)]
    pub(super) fn look_ahead(&mut self, guard: &Guard, next_step: u32) {
        if self.flight != Flight::Stream {
            return;
        }
        // The cascade's sample is made at its step, which has the time.
        if !self.table.gives_forces() && self.handover.is_over() && guard.mode() == supervisor::Mode::Flying {
            let (leash, state) = (&self.settings.bounds.leash, guard.looked().state);
            let way = (&self.stream, &self.headings);
            self.ahead.sample_on_leash_at(next_step, way, (leash, state));
            self.ahead.refer();
        }
    }

    /// As asked.
    #[inline(always)]
    pub(super) fn fly(&mut self, looked: &Looked<'_>, now_ms: u32) -> Result<(), Unflown> {
        if let Flight::Rates { body_rates_rad_s, thrust_m_s2 } = self.flight {
            return self.turn(&Command { thrust_m_s2, body_rates_rad_s }, looked.body_rates_rad_s);
        }
        if !self.ahead.is_for(now_ms) {
            self.shape(looked.state, now_ms);
        }
        let (r, p) = (&looked.state.position_m, &self.ahead.sample.flat.position_m);
        self.outcome.error_m = Vector3::new(r.x - p.x, r.y - p.y, r.z - p.z);
        let law_step = LawStep {
            craft: &self.craft,
            settings: &self.settings,
            sample: &self.ahead.sample,
            heading: self.ahead.heading,
            followed: self.flight.followed(),
            looked,
        };
        if let Some(reference) = self.ahead.reference_for(now_ms) {
            return law_step.follow(&self.table, reference, &mut self.memory, &mut self.outcome);
        }
        let step = if self.handover.is_over() {
            law_step.step(&self.table, &mut self.memory, &mut self.outcome)
        } else {
            let tables = (&self.before, &self.table);
            law_step.hand_over(&mut self.handover, tables, &mut self.memory, &mut self.outcome)
        };
        match step {
            Err(Unflown::Motion) => self.fly_upright(looked),
            other => other,
        }
    }

    /// The step's reference where none was made ahead: the motion of a stream, or that of setpoint shaping.
    #[inline(never)]
    fn shape(&mut self, state: &State, now_ms: u32) {
        let beyond_jerk = self.looks_beyond_jerk();
        let ahead = &mut self.ahead;
        match &self.flight {
            Flight::Guided(request) => {
                let (stream, headings, thrust_max_m_s2) = (&self.stream, &self.headings, self.craft.thrust_max_m_s2);
                let shaped = Shaped { request, stream, headings, now_ms, beyond_jerk, thrust_max_m_s2 };
                ahead.heading = self.shaping.put(&shaped, state, &self.settings.bounds, &mut ahead.sample);
            }
            _ => {
                self.stream.at(now_ms, beyond_jerk, &mut ahead.sample);
                ahead.heading = self.headings.at(now_ms, &mut ahead.sample);
            }
        }
        if !self.table.gives_forces() {
            let flat = &mut ahead.sample.flat;
            self.settings.bounds.leash.draw(&mut flat.position_m, &mut flat.velocity_m_s, state);
        }
    }

    /// Where no thrust gives the motion's acceleration, its position and velocity alone.
    #[cold]
    #[inline(never)]
    fn fly_upright(&mut self, looked: &Looked<'_>) -> Result<(), Unflown> {
        let flat = &self.ahead.sample.flat;
        let mut sample = FifthOrderSample::at_rest(flat.position_m, 0.0);
        sample.flat.velocity_m_s = flat.velocity_m_s;
        self.handover = Handover::OVER;
        self.fly_towards(looked, &sample, self.ahead.heading, self.flight.followed())
    }

    /// The law of the table towards a sample that is no flight's own.
    #[inline(never)]
    fn fly_towards(
        &mut self,
        looked: &Looked<'_>,
        sample: &FifthOrderSample,
        heading: Heading,
        followed: Followed,
    ) -> Result<(), Unflown> {
        let (r, p) = (&looked.state.position_m, &sample.flat.position_m);
        self.outcome.error_m = Vector3::new(r.x - p.x, r.y - p.y, r.z - p.z);
        let (craft, settings) = (&self.craft, &self.settings);
        let law_step = LawStep { craft, settings, sample, heading, followed, looked };
        law_step.step(&self.table, &mut self.memory, &mut self.outcome)
    }

    /// Manual flight by body rates: the same under every table.
    #[inline(never)]
    fn turn(&mut self, command: &Command, body_rates_rad_s: &Vector3<f32>) -> Result<(), Unflown> {
        let wrench = self.settings.limits.saturate(command).map(|(command, limited)| {
            self.outcome.limited = MotorLimited::of_command(limited);
            self.craft.actuation.wrench(&command, body_rates_rad_s)
        });
        match wrench {
            Some(Ok(wrench)) => {
                (self.outcome.output, self.outcome.has_stepped) = (Output::Wrench(wrench), false);
                Ok(())
            }
            _ => Err(Unflown::State),
        }
    }

    /// Drag (1/s) and moment (N s) that are flown with, and the cascade's memory; nothing under another law.
    pub(super) fn learned(&self) -> Option<(f32, [f32; 2], &CascadeMemory)> {
        let cascade = self.table.as_cascade()?;
        let memory = self.memory.cascade();
        let (drag_per_s, moment_n_s) = cascade.air(memory);
        Some((drag_per_s, moment_n_s, memory))
    }

    /// Rotation vector from the attitude that the last control step wanted to the craft's, body frame, rad.
    pub(super) fn rotation_error_rad(&self, attitude: Quaternion) -> Vector3<f32> {
        if self.table.gives_forces() {
            return self.memory.cascade().rotation_error_rad();
        }
        let q = self.outcome.target.conjugate() * attitude;
        q.vector() * if q.w < 0.0 { -2.0 } else { 2.0 }
    }
}
