//! One flight with a fault, on a plant in air over a floor.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{Unit, Vector3, Vector4};
use quatrack::cascade::{Cascade, CascadeLimits};
use quatrack::gains::cascade::{BRUSHLESS_DEFAULT, CRAZYFLIE_2_1_DEFAULT, UPGRADE_KIT_DEFAULT};
use quatrack::gains::table::BuiltInCascade;
use quatrack::supervisor::Mode;
use quatrack::{Airframe, Quaternion, State};
use quatrack_design::vehicle::Vehicle;

use super::object::Object;
use super::row::{EndState, Row};
use super::signals::{Fault, Signals, UnderTest};
use super::under_guard::UnderGuard;
use crate::flight::motor_loop::{PERIOD_S, RATE};
use crate::plant::{
    Air, Environment, Ground, Load, Plant, PlantError, RigidState, Source, Stream, Truth, Wall, Wind, Wrench,
};
use crate::vehicles;

/// When it happens, s, and how long it is flown from there.
const BEGINS_S: f64 = 2.0;
const LASTS_S: f64 = 12.0;
/// Height of the course, m.
pub const HEIGHT_M: f64 = 1.5;
/// Deviations of the estimate: position, velocity, gyroscope, accelerometer.
const NOISE: [f64; 4] = [1e-3, 1e-2, 0.02, 0.05];
/// Speed at which a craft that comes to the floor has crashed, m/s, and the cosine of its tilt.
const CRASH_M_S: f64 = 1.6;
const CRASH_UPRIGHT: f64 = 0.5;
/// A craft that is farther than this from where it should be has been lost, m.
const LOST_M: f64 = 12.0;

/// A craft with its law.
pub struct Crafts {
    vehicle: Vehicle,
    cascade: Cascade,
}

impl Crafts {
    /// One of [`super::VEHICLES`], flown with the table for a craft of which no lag is stated.
    pub fn by_name(name: &str) -> Option<Self> {
        let (airframe, built_in): (Airframe, BuiltInCascade) = match name {
            "crazyflie-2.1" => (Airframe::CRAZYFLIE_2_1, CRAZYFLIE_2_1_DEFAULT),
            "crazyflie-2.1-upgrade-kit" => (Airframe::CRAZYFLIE_2_1_UPGRADE_KIT, UPGRADE_KIT_DEFAULT),
            "crazyflie-2.1-brushless" => (Airframe::CRAZYFLIE_2_1_BRUSHLESS, BRUSHLESS_DEFAULT),
            _ => return None,
        };
        let table = built_in.table;
        let cascade = table.flown(&airframe, RATE, &CascadeLimits::STANDARD, &table.air).ok()?;
        Some(Self { vehicle: vehicles::by_name(name).ok()?, cascade })
    }
}

/// Where the craft is to be: hovering, or along x at a speed that it reaches in the first second.
fn course(t: f64, speed: f64) -> [Vector3<f64>; 3] {
    let ramp_s = 1.0;
    let up = Vector3::new(0.0, 0.0, HEIGHT_M);
    let (way, v, a) = if t < ramp_s {
        (0.5 * speed * t * t / ramp_s, speed * t / ramp_s, speed / ramp_s)
    } else {
        (speed * (t - 0.5 * ramp_s), speed, 0.0)
    };
    [up + Vector3::x() * way, Vector3::x() * v, Vector3::x() * a]
}

/// Flies a fault on a craft, by the core's cascade under its supervisor.
///
/// # Errors
/// [`PlantError`] for figures that no plant can have.
pub fn fly(fault: &Fault, craft: &Crafts) -> Result<Row, PlantError> {
    fly_by(fault, craft, &mut UnderGuard::armed(&craft.cascade))
}

/// The same by the Crazyflie object, through its C interface.
///
/// # Errors
/// [`PlantError`] for figures that no plant can have.
pub fn fly_object(fault: &Fault, craft: &Crafts) -> Result<Row, PlantError> {
    fly_by(fault, craft, &mut Object::hovering(&craft.vehicle))
}

/// The same by any controller that begins at a hover at the start of the course.
///
/// # Errors
/// [`PlantError`] for what no plant can be.
pub fn fly_by(fault: &Fault, craft: &Crafts, flight: &mut impl UnderTest) -> Result<Row, PlantError> {
    let vehicle = &craft.vehicle;
    let off = &fault.craft;
    let mut truth = Truth::as_designed(vehicle);
    if let Some(motors) = &vehicle.flown().motors {
        (truth.rise_lag_s, truth.fall_lag_s, truth.delay_s) = (motors.rise_lag_s, motors.fall_lag_s, motors.delay_s);
    }
    truth.mass_kg *= off.mass;
    truth.inertia_kg_m2 *= off.inertia;
    (truth.rise_lag_s, truth.fall_lag_s) = (truth.rise_lag_s * off.lag, truth.fall_lag_s * off.lag);
    truth.centre_of_mass_m = Vector3::new(off.centre_m, -off.centre_m, 0.0);
    let walls = off.wall_m.map(|at_m| Wall {
        point_m: Vector3::new(at_m, 0.0, 0.0),
        normal: Unit::new_unchecked(-Vector3::x()),
        friction: 0.3,
    });
    let environment = Environment {
        air: Air::of(vehicle).unwrap_or(Air::VACUUM),
        wind: Wind::constant(Vector3::new(0.8 * off.wind_m_s, 0.6 * off.wind_m_s, 0.0)),
        floor: true,
        walls: walls.into_iter().collect(),
        ..Environment::VACUUM
    };
    let start = RigidState::at_rest(course(0.0, 0.0)[0], vehicle.hover_thrust_n());
    let hand = Hand::default();
    let mut plant = Plant::new(vehicle, &environment, &truth, &start, 1)?.with_load(hand.clone());
    let noise = [Source::Position, Source::Velocity, Source::Gyroscope, Source::Accelerometer];
    let mut noise = noise.map(|source| Stream::new(1, source));
    let mut past: Vec<(State, Vector3<f32>)> = Vec::new();
    let mut commands_n = start.thrusts_n;
    let mut row = Row {
        fault: fault.name,
        vehicle: vehicle.name().to_owned(),
        detected_ms: None,
        end_state: EndState(Mode::Armed),
        motors_off_ms: None,
        farthest_m: 0.0,
        crashed: false,
        recoverable: fault.recoverable,
        others: fault.others,
    };
    let first = (BEGINS_S / PERIOD_S).round() as u32;
    let (mut left_at, mut last_down) = (None::<Vector3<f64>>, 0.0_f64);
    for step in 0..((BEGINS_S + LASTS_S) / PERIOD_S).round() as u32 {
        let time_s = f64::from(step) * PERIOD_S;
        let truth = *plant.state();
        let (estimate, rates, felt) = sensed(&truth, &plant.motion().specific_force_m_s2, &mut noise);
        past.push((estimate, rates));
        let asked = course(time_s, fault.speed_m_s);
        let newest = past.len() - 1;
        let mut signals = Signals {
            state: Some(estimate),
            body_rates: rates,
            felt: Some(felt),
            asked: Some(asked.map(nalgebra::Matrix::cast)),
            heading: [0.0; 2],
            silence: 0,
            battery_v: 3.8,
            overrun: false,
            is_skipped: false,
            motors: [1.0; 4],
            push: Vector3::zeros(),
            past: &|steps| past[newest.saturating_sub(steps)],
            step: step.saturating_sub(first),
        };
        let has_begun = step >= first;
        if has_begun {
            (fault.spoil)(&mut signals);
        }
        let since_ms = 2 * step.saturating_sub(first);
        if !signals.is_skipped {
            commands_n = flight.step(2 * step, &signals).unwrap_or_default();
        }
        let mode = flight.mode();
        if has_begun && row.detected_ms.is_none() && (mode != Mode::Flying || flight.is_bridging()) {
            row.detected_ms = Some(since_ms);
        }
        if has_begun && row.motors_off_ms.is_none() && !mode.is_in_air() {
            row.motors_off_ms = Some(since_ms);
        }
        let is_off = commands_n == Vector4::zeros();
        plant.set_motor_strength(if is_off { [0.0; 4] } else { signals.motors });
        hand.push(signals.push * vehicle.hover_thrust_n() * 4.0);
        plant.advance(&commands_n, PERIOD_S);
        let state = plant.state();
        if !state.is_finite() {
            row.crashed = true;
            break;
        }
        if has_begun {
            let told = signals.asked.map_or(asked[0], |[p, ..]| p.map(f64::from));
            let wants_elsewhere = (told - asked[0]).norm() > 0.1;
            let off_m = if mode == Mode::Flying && !wants_elsewhere {
                (state.position_m - asked[0]).norm()
            } else {
                let from = left_at.get_or_insert(state.position_m);
                (state.position_m - *from).xy().norm()
            };
            // A motion that is asked for is no excursion.
            if mode != Mode::Flying || !wants_elsewhere {
                row.farthest_m = row.farthest_m.max(off_m);
            }
        }
        // At the floor: its speed of impact, and whether it is upright.
        let is_down = state.position_m.z < Ground::FOOT_DEPTH_M + 5e-3;
        let upright = (state.attitude * Vector3::z()).z;
        row.crashed |= is_down && (last_down > CRASH_M_S || upright < CRASH_UPRIGHT);
        last_down = if is_down { 0.0 } else { -state.velocity_m_s.z };
    }
    row.crashed |= row.farthest_m > LOST_M;
    row.end_state = EndState(flight.mode());
    Ok(row)
}

/// The sensors' readings of a true state.
fn sensed(truth: &RigidState, felt: &Vector3<f64>, noise: &mut [Stream; 4]) -> (State, Vector3<f32>, Vector3<f32>) {
    let [position, velocity, gyroscope, accelerometer] = noise;
    let [np, nv, nw, na] = NOISE;
    let noisy = |v: &Vector3<f64>, stream: &mut Stream, deviation: f64| {
        v.map(|value| (value + deviation * stream.normal()) as f32)
    };
    let q = truth.attitude.quaternion();
    let state = State {
        position_m: noisy(&truth.position_m, position, np),
        attitude: Quaternion::new(q.w as f32, q.i as f32, q.j as f32, q.k as f32),
        velocity_m_s: noisy(&truth.velocity_m_s, velocity, nv),
    };
    (state, noisy(&truth.body_rates_rad_s, gyroscope, nw), noisy(felt, accelerometer, na))
}

/// A force on the craft that is set from step to step, world frame, N.
#[derive(Clone, Default)]
struct Hand(Arc<Mutex<Vector3<f64>>>);

impl Hand {
    fn push(&self, force_n: Vector3<f64>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = force_n;
    }
}

impl Load for Hand {
    fn wrench(&self, _time_s: f64, _state: &RigidState) -> Wrench {
        Wrench { force_n: *self.0.lock().unwrap_or_else(PoisonError::into_inner), ..Wrench::default() }
    }
}

#[cfg(test)]
mod tests;
