//! The robustness flights: a vehicle in; how closely each certified law follows an eight on craft that are not quite the
//! one it was designed for, out.
//!
//! The flight is `x = sin(w t)`, `y = 1/2 sin(2 w t)` at 1 m with `w = 1.485 rad/s` (2.1 m/s), 12 s, from a start on the
//! reference; the fast one has `w = 2.19 rad/s` (3.1 m/s). The f32 core runs at 500 Hz on the rigid plant.

use nalgebra::Vector4;
use quatrack::{MotorLaw, MotorTracker};
use serde::Serialize;

use super::motor_loop::{self, MotorLoop, STEPS_A_SAMPLE};
use super::noise::Noise;
use super::rigid_loop::{Conditions, RigidFlight, fly_rigid};
use crate::plant::{Craft, RigidState};
use crate::trajectory::fifth_order::{Course, Eight};
use crate::vehicle::Vehicle;

/// Angular frequency of the eight, rad/s.
pub const RATE_RAD_S: f64 = 1.485;
/// That of the fast one, rad/s.
pub const FAST_RATE_RAD_S: f64 = 2.19;
/// Length of the flights, s.
pub const DURATION_S: f64 = 12.0;
/// What an estimator with a motion capture system is off by.
pub const NOISE: Noise = Noise { position_m: 1e-3, velocity_m_s: 1e-2, body_rates_rad_s: 0.02, seed: 1 };

/// What is different from the design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Its name.
    pub name: &'static str,
    /// Angular frequency of the eight, rad/s.
    pub rate_rad_s: f64,
    /// Mass over that of the vehicle.
    pub mass_factor: f64,
    /// True lag over the assumed one.
    pub lag_factor: f64,
    /// How late commands act, s.
    pub delay_s: f64,
    /// Inertia over that of the vehicle.
    pub inertia_factor: f64,
    /// What measurements are off by.
    pub noise: Option<Noise>,
}

/// The cases, in the order of the table.
pub const CASES: [Case; 10] = {
    const NOMINAL: Case = Case {
        name: "nominal",
        rate_rad_s: RATE_RAD_S,
        mass_factor: 1.0,
        lag_factor: 1.0,
        delay_s: 0.0,
        inertia_factor: 1.0,
        noise: None,
    };
    [
        NOMINAL,
        Case { name: "fast", rate_rad_s: FAST_RATE_RAD_S, ..NOMINAL },
        Case { name: "mass+10", mass_factor: 1.1, ..NOMINAL },
        Case { name: "mass-10", mass_factor: 0.9, ..NOMINAL },
        Case { name: "lag*1.5", lag_factor: 1.5, ..NOMINAL },
        Case { name: "lag*0.5", lag_factor: 0.5, ..NOMINAL },
        Case { name: "delay4ms", delay_s: 0.004, ..NOMINAL },
        Case { name: "delay10ms", delay_s: 0.010, ..NOMINAL },
        Case { name: "inertia+30", inertia_factor: 1.3, ..NOMINAL },
        Case { name: "noise", noise: Some(NOISE), ..NOMINAL },
    ]
};

/// Flies `course` with a law from a state, with the motors at the thrusts of that state.
pub fn fly(
    tracker: MotorTracker<'_>,
    craft: &Craft,
    start: &RigidState,
    course: &dyn Course,
    conditions: &Conditions,
) -> RigidFlight {
    let mut control = MotorLoop::new(tracker, &start.thrusts_n);
    fly_rigid(
        craft,
        start,
        conditions,
        |t_s| course.at(t_s).position[0],
        |tick, measured| {
            let t_s = f64::from(tick) * motor_loop::PERIOD_S;
            control
                .as_mut()
                .ok_or_else(|| "the motors' thrusts are not finite".to_owned())?
                .step(measured, &course.at(t_s))
        },
    )
}
