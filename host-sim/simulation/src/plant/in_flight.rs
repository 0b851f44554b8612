//! One flight's plant: a vehicle, its surroundings and its true figures in; state, wind and ideal sensor readings out.

use nalgebra::{Vector3, Vector4};
use quatrack_design::vehicle::Vehicle;

use super::craft::{LinearWind, STEP_MAX_S};
use super::delay::DelayLine;
use super::environment::{Environment, Truth};
use super::ground_effect::GroundEffect;
use super::kernel::{self, Figures, Step};
use super::refused::PlantError;
use super::supply::{ForceMap, Supply};
use super::wind::Blowing;
use super::{Airflow, Contact, Craft, Ground, Load, Motion, RigidBody, RigidState, RotorDrag};

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

/// From commands to the thrusts that the motors go to.
#[derive(Clone, Copy, Debug)]
struct Converter {
    /// Limits of the commands, N.
    limits_n: [f64; 2],
    map: Option<ForceMap>,
    strength: [f64; 4],
    factor: f64,
    factor_per_s: f64,
}

/// Commands that act, N; as the map has them, of a sound motor at full voltage, 1 or N.
#[derive(Clone, Copy, Debug)]
struct Acting {
    commands_n: Vector4<f64>,
    mapped: Vector4<f64>,
}

impl Converter {
    /// Commands within their limits, with their powers taken.
    #[inline]
    fn acting(&self, commands_n: &Vector4<f64>) -> Acting {
        Acting { commands_n: *commands_n, mapped: self.mapped(commands_n) }
    }

    #[inline(always)]
    fn mapped(&self, commands_n: &Vector4<f64>) -> Vector4<f64> {
        let [least_n, most_n] = self.limits_n;
        commands_n.map(|command_n| {
            // By comparison: a NaN becomes the least, and f64::max costs five times as much.
            let command_n = if command_n > least_n { command_n } else { least_n };
            let command_n = if command_n < most_n { command_n } else { most_n };
            self.map.map_or(command_n, |map| map.share(command_n / most_n))
        })
    }

    /// Thrusts that the motors go to at a time and a voltage, N.
    #[inline(always)]
    fn goals_n(&self, mapped: &Vector4<f64>, time_s: f64, voltage_v: f64) -> Vector4<f64> {
        let factor = (self.factor + self.factor_per_s * time_s).max(0.0);
        let all = factor * self.map.map_or(1.0, |map| map.most_n(voltage_v));
        Vector4::from_fn(|i, _| all * self.strength[i] * mapped[i])
    }
}

impl Plant {
    /// At the start, with the commands that keep the thrusts it starts with.
    ///
    /// # Errors
    /// [`PlantError`] with the first figure that is out of range.
    pub fn new(
        vehicle: &Vehicle,
        environment: &Environment,
        truth: &Truth,
        start: &RigidState,
        seed: u64,
    ) -> Result<Self, PlantError> {
        environment.check()?;
        truth.check()?;
        let mut wind = Blowing::new(&environment.wind, seed);
        let craft = craft(vehicle, environment, truth);
        Ok(Self {
            plain: kernel::figures(&craft),
            craft,
            wind_m_s: wind.at(0.0),
            steady: truth.delay_s <= 0.0 && wind.is_steady() && matches!(truth.supply, Supply::Constant(_)),
            wind,
            line: DelayLine::new(truth.delay_s),
            acting: None,
            supply: truth.supply,
            converter: Converter {
                limits_n: [vehicle.motors().thrust_min_n, vehicle.motors().thrust_max_n],
                map: truth.force_map,
                strength: truth.motor_strength,
                factor: truth.thrust_factor,
                factor_per_s: truth.thrust_factor_per_s,
            },
            time_s: 0.0,
            state: *start,
            finite: start.is_finite(),
        })
    }

    /// The same with one more load.
    pub fn with_load(mut self, load: impl Load + 'static) -> Self {
        self.craft = self.craft.with_load(load);
        self.plain = kernel::figures(&self.craft);
        self
    }

    /// The same with drag rotor by rotor, as RotorPy has it; needs [`Truth::propeller`].
    pub fn with_rotor_drag(mut self, rotors: RotorDrag) -> Self {
        self.craft.air = Some(Airflow { rotors: Some(rotors), ..self.craft.air.unwrap_or_default() });
        self.plain = kernel::figures(&self.craft);
        self
    }

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

    /// Its state.
    pub fn state(&self) -> &RigidState {
        &self.state
    }

    /// Whether every number of its state is finite.
    pub fn is_finite(&self) -> bool {
        self.finite
    }

    /// Time since the start, s.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Velocity of the air at the craft, world frame, m/s.
    pub fn wind_m_s(&self) -> &Vector3<f64> {
        &self.wind_m_s
    }

    /// Root mean square of the turbulence so far, along the mean wind, across it and upwards, m/s.
    pub fn realised_gust_rms_m_s(&self) -> Option<Vector3<f64>> {
        self.wind.realised_rms_m_s()
    }

    /// Voltage at the motors, V; 0 where nothing depends on it.
    #[inline]
    pub fn voltage_v(&self) -> f64 {
        self.supply.voltage_v(&self.state.thrusts_n)
    }

    /// Charge of the battery from 0 to 1, where there is one.
    pub fn charge(&self) -> Option<f64> {
        match self.supply {
            Supply::Constant(_) => None,
            Supply::Battery { charge, .. } => Some(charge),
        }
    }

    /// Least and most command that a motor takes, N; others are cut to them.
    pub fn command_limits_n(&self) -> [f64; 2] {
        self.converter.limits_n
    }

    /// Least and most thrust that each motor can be commanded to now, N.
    pub fn thrust_limits_n(&self) -> [Vector4<f64>; 2] {
        self.converter.limits_n.map(|limit_n| self.goals_n(Some(self.converter.acting(&Vector4::repeat(limit_n)))))
    }

    /// The reading of an accelerometer at the centre of mass, body frame, m/s^2: that of [`Self::motion`], for less.
    pub fn specific_force_m_s2(&mut self) -> Vector3<f64> {
        match &self.plain {
            Some((figures, has_air)) => kernel::felt_m_s2(figures, *has_air, &self.state, &self.wind_m_s),
            None => self.motion().specific_force_m_s2,
        }
    }

    /// Specific force at the centre of mass under the commands that act now.
    pub fn motion(&mut self) -> Motion {
        let (commands_n, _) = self.line.at(self.time_s);
        let goals_n = self.goals_n(commands_n.map(|commands_n| self.converter.acting(&commands_n)));
        let wind = LinearWind { from_s: self.time_s, from_m_s: self.wind_m_s, slope_m_s2: Vector3::zeros() };
        self.craft.motion(&self.state, &goals_n, &wind, self.time_s)
    }
}

/// The vehicle with every figure that is true of it, in its surroundings.
fn craft(vehicle: &Vehicle, environment: &Environment, truth: &Truth) -> Craft {
    let mut craft = Craft::new(vehicle);
    // The inertia has been looked at.
    craft.body = RigidBody::new(truth.mass_kg, truth.inertia_kg_m2).unwrap_or(craft.body);
    craft.motors = craft.motors.with_lag(truth.rise_lag_s, truth.fall_lag_s).around(&truth.centre_of_mass_m);
    craft.motors.propeller = truth.propeller;
    craft.motors.torque_bias_n_m = truth.torque_bias_n_m;
    for motor in &mut craft.motors.motors {
        // The plant cuts commands, by its voltage.
        (motor.thrust_min_n, motor.thrust_max_n) = (0.0, f64::INFINITY);
    }
    let air = &environment.air;
    let mass_kg = vehicle.mass_kg();
    if *air != (super::Air { wind_max_m_s: air.wind_max_m_s, ..super::Air::VACUUM }) {
        craft.air = Some(Airflow {
            drag_n_s_m: Vector3::from(air.drag_per_s) * mass_kg,
            moment_n_s: air.moment_n_m_per_m_s,
            lift_n_s2_m2: air.lift_per_m * mass_kg,
            rotors: None,
        });
    }
    if environment.floor {
        craft = craft.with_load(Ground::under(vehicle));
    }
    if let Some(radius_m) = environment.ground_effect_radius_m {
        let effect = GroundEffect::of(&craft.motors, radius_m);
        craft = craft.with_load(effect);
    }
    for wall in &environment.walls {
        let contact = Contact::new(*wall, &craft.motors, environment.guard_reach_m, truth.mass_kg);
        craft = craft.with_load(contact);
    }
    craft
}
