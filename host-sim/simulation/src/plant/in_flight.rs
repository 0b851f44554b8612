//! One flight's plant: a vehicle, its surroundings and its true figures in; state, wind and ideal sensor readings out.

mod converter;
mod readings;
mod start;

use nalgebra::{Vector3, Vector4};

use super::craft::{LinearWind, STEP_MAX_S};
use super::delay::DelayLine;
use super::kernel::{self, Figures, Step};
use super::supply::Supply;
use super::wind::Blowing;
use super::{Craft, RigidState};
use converter::{Acting, Converter};

/// A craft in flight. It moves by [`Self::advance`] alone; the same vehicle, figures and seed give the same bits.
///
/// ```
/// use nalgebra::{Vector3, Vector4};
/// use quatrack_simulation::plant::{Environment, Plant, RigidState, Truth, Wind};
/// use quatrack_simulation::vehicles;
///
/// let vehicle = vehicles::by_name("crazyflie-2.1").unwrap();
/// let mut environment = Environment { wind: Wind::constant(Vector3::new(1.0, 0.0, 0.0)), ..Environment::VACUUM };
/// environment.air.drag_per_s = [0.4; 3];
/// let hovering = RigidState::at_rest(Vector3::z(), vehicle.hover_thrust_n());
/// let mut plant = Plant::new(&vehicle, &environment, &Truth::as_designed(&vehicle), &hovering, 1).unwrap();
/// plant.advance(&Vector4::repeat(vehicle.hover_thrust_n()), 1.0);
/// // v = 1 - exp(-0.4 t): the wind takes it along.
/// assert!((plant.state().velocity_m_s.x - (1.0 - f64::exp(-0.4))).abs() < 1e-9);
/// ```
pub struct Plant {
    craft: Craft,
    /// The craft's figures where it is plain, and whether it has air.
    plain: Option<(Figures, bool)>,
    /// Whether commands act at once, at one voltage, in a wind that stays the same.
    steady: bool,
    wind: Blowing,
    line: DelayLine,
    supply: Supply,
    converter: Converter,
    /// The commands that acted last, for which powers have been taken; none before the first.
    acting: Option<Acting>,
    time_s: f64,
    state: RigidState,
    finite: bool,
    wind_m_s: Vector3<f64>,
}

/// A time that is flown step by step: parts between delayed commands, each in equal steps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    end_s: f64,
    from_s: f64,
    part_s: f64,
    steps: f64,
    taken: f64,
}

/// A step in which nothing but the commands is new.
#[derive(Clone, Copy, Debug)]
pub(super) struct SteadyStep {
    pub(super) from_s: f64,
    pub(super) step_s: f64,
    pub(super) goals_n: Vector4<f64>,
}

impl Plant {
    /// From here on each motor gives this share of a sound one's force; none where all are off.
    pub fn set_motor_strength(&mut self, strength: [f64; 4]) {
        self.converter.strength = strength;
    }

    /// Gives commands, N, and flies on for a time, s: Runge-Kutta 4 in steps of at most 2 ms, between which the
    /// voltage, and in which the slope of the wind stays the same. Steps end where delayed commands begin to act.
    pub fn advance(&mut self, commands_n: &Vector4<f64>, duration_s: f64) {
        let mut way = self.begin(commands_n, duration_s);
        while let Some((to_s, step)) = self.next_step(&mut way) {
            let state = match &self.plain {
                Some((figures, has_air)) => kernel::alone(figures, *has_air, &self.state, &step),
                None => self.craft.step_in_wind(&self.state, &step.goals_n, &step.wind, step.from_s, step.step_s),
            };
            self.arrive(to_s, state, state.is_finite());
        }
        self.end(&way);
    }

    /// Gives commands; the way is a time from there.
    #[inline]
    pub(super) fn begin(&mut self, commands_n: &Vector4<f64>, duration_s: f64) -> Way {
        self.line.give(self.time_s, commands_n);
        Way { end_s: self.time_s + duration_s, from_s: 0.0, part_s: 0.0, steps: 0.0, taken: 0.0 }
    }

    /// Whether nothing but the commands is new in its steps.
    pub(super) fn is_steady(&self) -> bool {
        self.steady && self.plain.is_some()
    }

    /// Whether a time is one step.
    #[inline]
    pub(super) fn is_one_step(duration_s: f64) -> bool {
        duration_s / STEP_MAX_S - 1e-9 <= 1.0
    }

    /// That step of a steady plant: the same as [`Self::begin`] and [`Self::next_step`] together, for less.
    #[inline(always)]
    pub(super) fn steady_step(&mut self, commands_n: &Vector4<f64>, duration_s: f64) -> SteadyStep {
        self.line.give_at_once(commands_n);
        let mapped = match &self.acting {
            // Cheaper to compute than to compare with those kept.
            _ if self.converter.map.is_none() => self.converter.mapped(commands_n),
            Some(acting) if acting.commands_n == *commands_n => acting.mapped,
            _ => {
                let acting = self.converter.acting(commands_n);
                self.acting = Some(acting);
                acting.mapped
            }
        };
        let end_s = self.time_s + duration_s;
        let to_s = self.time_s + (end_s - self.time_s);
        let goals_n = self.converter.goals_n(&mapped, self.time_s, self.voltage_v());
        SteadyStep { from_s: self.time_s, step_s: to_s - self.time_s, goals_n }
    }

    /// Where a steady step of a time is written to.
    #[inline]
    pub(super) fn arrive_steadily(&mut self, duration_s: f64) -> (&mut RigidState, &mut bool) {
        self.time_s += duration_s;
        (&mut self.state, &mut self.finite)
    }

    /// The next step on the way, and when it ends; none at its end.
    #[inline]
    pub(super) fn next_step(&mut self, way: &mut Way) -> Option<(f64, Step)> {
        if way.taken >= way.steps {
            if self.time_s >= way.end_s - 1e-9 {
                return None;
            }
            let (commands_n, until_s) = self.line.at(self.time_s);
            if self.acting.map(|acting| acting.commands_n) != commands_n {
                self.acting = commands_n.map(|commands_n| self.converter.acting(&commands_n));
            }
            way.part_s = until_s.min(way.end_s) - self.time_s;
            let steps = way.part_s / STEP_MAX_S - 1e-9;
            way.steps = if steps <= 1.0 { 1.0 } else { steps.ceil() };
            way.from_s = self.time_s;
            way.taken = 0.0;
        }
        way.taken += 1.0;
        let to_s = way.from_s + way.part_s * way.taken / way.steps;
        let step_s = to_s - self.time_s;
        let goals_n = self.goals_n(self.acting);
        let from_m_s = self.wind_m_s;
        self.wind_m_s = self.wind.at(to_s);
        let steady = self.wind_m_s == from_m_s;
        let slope_m_s2 = if steady { Vector3::zeros() } else { (self.wind_m_s - from_m_s) / step_s };
        let wind = LinearWind { from_s: self.time_s, from_m_s, slope_m_s2 };
        self.supply.drain(&self.state.thrusts_n, step_s);
        Some((to_s, Step { goals_n, wind, from_s: self.time_s, step_s }))
    }

    /// Takes the state after a step, and whether it is finite.
    #[inline]
    pub(super) fn arrive(&mut self, to_s: f64, state: RigidState, finite: bool) {
        (self.state, self.finite) = (state, finite);
        self.time_s = to_s;
    }

    /// Whether a way ends where its last step did.
    #[inline]
    pub(super) fn is_at_end(&self, way: &Way) -> bool {
        way.taken >= way.steps && self.time_s >= way.end_s - 1e-9
    }

    /// At the end of the way.
    #[inline]
    pub(super) fn end(&mut self, way: &Way) {
        self.time_s = way.end_s;
    }

    /// Whether its steps can be taken beside those of others.
    pub(super) fn is_plain(&self) -> bool {
        self.plain.is_some()
    }

    /// Its figures where it is plain, and whether it has air.
    pub(super) fn plain(&self) -> Option<(Figures, bool)> {
        self.plain
    }

    /// Before the first command acts, the thrusts stay.
    #[inline]
    fn goals_n(&self, acting: Option<Acting>) -> Vector4<f64> {
        acting.map_or(self.state.thrusts_n, |acting| {
            self.converter.goals_n(&acting.mapped, self.time_s, self.voltage_v())
        })
    }
}
