//! The robustness flights: a vehicle in; how closely each certified law follows an eight on craft that are not quite the
//! one it was designed for, out.
//!
//! A law flies only where its certificate holds: an actuator-aware table for a known lag from half to one and a half of
//! that lag, the default table over all of [`Region::of_any_crazyflie`], one of the paper's, fed forward, behind the core's
//! body-rate loop only if it tolerates that lag. Flights that are lost are listed with the figure that keeps it on the
//! ground.
//!
//! The flight is `x = sin(w t)`, `y = 1/2 sin(2 w t)` at 1 m with `w = 1.485 rad/s` (2.1 m/s), 12 s, from a start on the
//! reference; the fast one has `w = 2.19 rad/s` (3.1 m/s). The f32 core runs at 500 Hz on the rigid plant.

use quatrack::law::EquilibriumGain;
use quatrack::{Equilibrium, FeedForward};
use quatrack_design::certify::Region;
use quatrack_design::design::actuator_aware::ActuatorAwareWeights;
use quatrack_design::design::codegen::rounded;
use quatrack_design::design::synthesis::{EquilibriumWeights, PAPER_MU, lqr_equilibrium, lyapunov_equilibrium};
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::trajectory::fifth_order::{Eight, FlatTrajectory as _};
use serde::Serialize;

use super::motor_laws::{
    self, AwareTable, CraftLaw, FlightError, body_rate_bandwidth_rad_s, default_lag_s, paper_law_limit_s,
};
use super::motor_loop::{self, STEPS_A_SAMPLE};
use super::noise::Noise;
use super::rigid_loop::{Conditions, RigidFlight};
use crate::plant::Craft;

/// Angular frequency of the eight, rad/s.
pub const RATE_RAD_S: f64 = 1.485;
/// That of the fast one, rad/s.
pub const FAST_RATE_RAD_S: f64 = 2.19;
/// Length of the flights, s.
pub const DURATION_S: f64 = 12.0;
/// The errors of an estimator with a motion capture system.
pub const NOISE: Noise = Noise { position_m: 1e-3, velocity_m_s: 1e-2, body_rates_rad_s: 0.02, seed: 1 };

/// The differences from the design.
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
    /// Delay of the commands, s.
    pub delay_s: f64,
    /// Inertia over that of the vehicle.
    pub inertia_factor: f64,
    /// The errors of measurements.
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

/// Lags for which tables are designed, s: the shortest and the longest published for a brushed Crazyflie.
pub const LAGS_S: [f64; 2] = [0.0635, 0.126];

/// One flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The law.
    pub law: &'static str,
    /// The case.
    pub case: &'static str,
    /// Lag that the case starts from, ms: that of the design, but for the default table.
    pub lag_ms: f64,
    /// Sum of the position error's norm over samples of 10 ms, times 10 ms, m s; absent for a flight that was lost.
    pub iae_m_s: Option<f64>,
    /// Largest position error, m.
    pub max_error_m: f64,
    /// Control steps in which a motor was cut to its limits.
    pub saturated_steps: u64,
}

/// A law that is not certified for the vehicle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Grounded {
    /// The law.
    pub law: &'static str,
    /// Lag, ms.
    pub lag_ms: f64,
    /// Why not.
    pub reason: String,
}

/// All flights.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobustnessReport {
    /// Name of the vehicle.
    pub vehicle: String,
    /// Lag that the default table is designed for, ms.
    pub default_lag_ms: f64,
    /// One row a flight.
    pub rows: Vec<Row>,
    /// Laws that did not fly.
    pub not_certified: Vec<Grounded>,
}

/// Certifies every law for a vehicle and flies those that are, in every case.
///
/// # Errors
/// [`FlightError`] where a design has no solution or the core refuses the vehicle.
pub fn report(vehicle: &Vehicle) -> Result<RobustnessReport, FlightError> {
    let weights = &ActuatorAwareWeights::STANDARD;
    let default_lag_s = default_lag_s(vehicle);
    let default = AwareTable::new(vehicle, default_lag_s, weights, &Region::of_any_crazyflie())?;
    let mut report = RobustnessReport {
        vehicle: vehicle.name().to_owned(),
        default_lag_ms: 1e3 * default_lag_s,
        rows: Vec::new(),
        not_certified: Vec::new(),
    };
    let paper = [
        ("lqr-e", lqr_equilibrium(&EquilibriumWeights::paper())?.gain),
        ("lyap-e", lyapunov_equilibrium(PAPER_MU)?.gain),
    ];
    for lag_s in LAGS_S {
        let known = AwareTable::new(vehicle, lag_s, weights, &Region::around_lag(lag_s))?;
        for (law, table) in [("actuator-aware", &known), ("actuator-aware-robust", &default)] {
            if table.certificate.spectral_radius < 1.0 {
                for case in &CASES {
                    report.rows.push(row(vehicle, law, &table.craft_law()?, lag_s, case)?);
                }
            } else {
                let (radius, worst) = (table.certificate.spectral_radius, table.certificate.worst);
                let reason = format!("its spectral radius is {radius:.5} at {worst}");
                report.not_certified.push(Grounded { law, lag_ms: 1e3 * lag_s, reason });
            }
        }
        for (law, gain) in &paper {
            let limit_s = paper_law_limit_s(gain, lag_s)?;
            if limit_s >= lag_s {
                let gain = EquilibriumGain::new(rounded(gain))?;
                let fed_forward = Equilibrium { feed_forward: FeedForward::With, ..Equilibrium::new(&gain) };
                let craft_law = CraftLaw::by_body_rates(vehicle, fed_forward, lag_s)?;
                for case in &CASES {
                    report.rows.push(row(vehicle, law, &craft_law, lag_s, case)?);
                }
            } else {
                let reason = format!(
                    "behind the rate loop for such motors, {:.1} 1/s, it is stable up to {:.1} ms of motor lag",
                    body_rate_bandwidth_rad_s(lag_s),
                    1e3 * limit_s
                );
                report.not_certified.push(Grounded { law, lag_ms: 1e3 * lag_s, reason });
            }
        }
    }
    Ok(report)
}

fn row(
    vehicle: &Vehicle,
    law: &'static str,
    craft_law: &CraftLaw<'_>,
    lag_s: f64,
    case: &Case,
) -> Result<Row, FlightError> {
    let true_lag_s = lag_s * case.lag_factor;
    let mut craft = Craft::new(vehicle);
    craft.motors = craft.motors.with_lag(true_lag_s, true_lag_s);
    craft.body = craft.body.scaled(case.mass_factor, case.inertia_factor);
    let flight = fly_case(&craft, craft_law, case)?;
    Ok(Row {
        law,
        case: case.name,
        lag_ms: 1e3 * lag_s,
        iae_m_s: flight.iae_m_s(),
        max_error_m: flight.max_error_m(),
        saturated_steps: flight.saturated_steps,
    })
}

/// Flies the eight at 2.1 m/s with a law on the vehicle, its motors at the lag `lag_s`.
///
/// # Errors
/// [`FlightError::Start`] where the eight cannot be flown from its start.
pub fn fly_eight(vehicle: &Vehicle, law: &CraftLaw<'_>, lag_s: f64) -> Result<RigidFlight, FlightError> {
    let mut craft = Craft::new(vehicle);
    craft.motors = craft.motors.with_lag(lag_s, lag_s);
    fly_case(&craft, law, &CASES[0])
}

/// Flies a case's eight with a craft.
fn fly_case(craft: &Craft, law: &CraftLaw<'_>, case: &Case) -> Result<RigidFlight, FlightError> {
    let course = Eight { rate_rad_s: case.rate_rad_s, duration_s: DURATION_S };
    let start = motor_loop::state_on(&course.at(0.0), law.airframe())?;
    let conditions =
        Conditions { duration_s: DURATION_S, steps_a_sample: STEPS_A_SAMPLE, delay_s: case.delay_s, noise: case.noise };
    Ok(motor_laws::fly(law, craft, &start, &course, &conditions))
}
