//! Lock-step down to the motors: a connected board in; the paper's courses on a rigid craft under its motor forces,
//! compared bit for bit with the host's core.
//!
//! The craft takes off from the floor with motors that do not turn, as one that has just been armed. The paper's law goes
//! through the body-rate loop and the mixer, which it only survives where the motors are quick: it is given such ones.

mod host;
mod report;

use std::collections::BTreeMap;
use std::fmt;

use nalgebra::{Vector3, Vector4};
use quatrack::link::{LawChoice, LimitsSetting, Parameter, Table, ToBoard, TrajectoryCommand};
use quatrack::{Leash, Quaternion, RigidState, State};
use quatrack_design::model::position;
use quatrack_design::vehicle::Vehicle;
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_simulation::flight::closed_loop::SAMPLE_PERIOD_S;
use quatrack_simulation::flight::motor_laws::body_rate_bandwidth_rad_s;
use quatrack_simulation::flight::reference::{Exact, Reference as _};
use quatrack_simulation::plant::{Craft, Ground, RigidState as PlantState};
use quatrack_simulation::vehicles;
use serde::Serialize;

use super::PilError;
use super::bits::Fnv1a;
use super::client::Client;
use super::flights::{COURSES, PATIENCE_TICKS, Plans, RATE_HZ, share, trajectory_id};
use host::HostCore;
pub use report::{MotorDifference, MotorReport};

/// Control steps a sample of the position error.
const STEPS_A_SAMPLE: u32 = RATE_HZ / 100;

/// A law as it is flown to the motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum MotorFlight {
    /// (LQR-E) through body-rate loop and mixer, on motors of 20 ms.
    #[serde(rename = "LQR-E")]
    LqrE,
    /// The cascade, on the craft's own motors.
    #[serde(rename = "cascade")]
    Cascade,
}

impl MotorFlight {
    /// All.
    pub const ALL: [Self; 2] = [Self::LqrE, Self::Cascade];

    fn table(self) -> Table {
        match self {
            Self::LqrE => Table::LqrE,
            Self::Cascade => Table::Cascade,
        }
    }

    /// Lag of the simulated motors, s.
    fn lag_s(self, vehicle: &Vehicle) -> f64 {
        match self {
            Self::LqrE => 0.02,
            Self::Cascade => vehicle.motors().lag_s,
        }
    }

    /// The body-rate loop for that lag.
    fn bandwidth_rad_s(self, vehicle: &Vehicle) -> [f32; 3] {
        [body_rate_bandwidth_rad_s(self.lag_s(vehicle)) as f32; 3]
    }
}

impl fmt::Display for MotorFlight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::LqrE => "LQR-E",
            Self::Cascade => "cascade",
        })
    }
}

/// Flies both courses with every law; the first `limit` steps of all, spread evenly, where one is given. The board is in
/// lock-step already.
///
/// # Errors
/// [`PilError`].
pub(super) fn fly_all(
    client: &mut Client,
    plans: &Plans,
    limit: Option<u32>,
    advance: &dyn Fn(),
) -> Result<MotorReport, PilError> {
    let vehicle = vehicles::by_name("crazyflie-2.1").map_err(|error| PilError::Answer(error.to_string()))?;
    let mut report =
        MotorReport { iae: BTreeMap::new(), bit_exact: true, steps: 0, hash: String::new(), difference: None };
    let mut hash = Fnv1a::new();
    let flights = COURSES.iter().flat_map(|course| MotorFlight::ALL.map(|flight| (*course, flight)));
    for (index, (course, flight)) in flights.enumerate() {
        let share = limit.map(|limit| share(limit, index as u32, FLIGHTS));
        let iae = fly_one(client, plans, (course, flight), (&vehicle, share), (&mut report, &mut hash), advance)?;
        report.iae.entry(course).or_default().insert(flight, iae);
    }
    client.request(&ToBoard::Disarm)?;
    report.bit_exact = report.difference.is_none();
    report.hash = hash.to_string();
    Ok(report)
}

/// Flights of both courses.
pub(super) const FLIGHTS: u32 = (COURSES.len() * MotorFlight::ALL.len()) as u32;

fn prepare(
    client: &mut Client,
    course: PaperTrajectory,
    flight: MotorFlight,
    vehicle: &Vehicle,
) -> Result<(), PilError> {
    let limits = vehicles::limits(vehicle).map_err(|error| PilError::Answer(error.to_string()))?;
    let [thrust_min_m_s2, thrust_max_m_s2] = vehicle.thrust_limits_m_s2().map(|value| value as f32);
    let body_rates_max_rad_s = vehicle.body_rates_max_rad_s().map(|value| value as f32).into();
    let setting = LimitsSetting { thrust_min_m_s2, thrust_max_m_s2, body_rates_max_rad_s };
    debug_assert_eq!(setting.check(), Ok(limits));
    client.request(&ToBoard::Disarm)?;
    client.set(Parameter::Limits(setting))?;
    client.set(Parameter::BodyRateBandwidth(flight.bandwidth_rad_s(vehicle)))?;
    client.set(Parameter::StateAgeMaxTicks(PATIENCE_TICKS))?;
    client.set(Parameter::Leash(Leash::NONE.length_m))?;
    client.request(&ToBoard::SelectLaw(LawChoice::new(flight.table())))?;
    client.request(&ToBoard::Trajectory(TrajectoryCommand::Start(trajectory_id(course))))?;
    client.request(&ToBoard::Arm)
}

/// One flight's IAE.
fn fly_one(
    client: &mut Client,
    plans: &Plans,
    (course, flight): (PaperTrajectory, MotorFlight),
    (vehicle, limit): (&Vehicle, Option<u32>),
    (report, hash): (&mut MotorReport, &mut Fnv1a),
    advance: &dyn Fn(),
) -> Result<Option<f64>, PilError> {
    let mut host = HostCore::new(course, flight, vehicle)?;
    prepare(client, course, flight, vehicle)?;
    let mut craft = Craft::new(vehicle).with_load(Ground::under(vehicle));
    let lag_s = flight.lag_s(vehicle);
    craft.motors = craft.motors.with_lag(lag_s, lag_s);
    let plan = Exact(plans.of(course));
    let steps = (plan.duration_s() * f64::from(RATE_HZ)).round() as u32 + 1;
    let ticks_per_step = client.identity().tick_rate_hz / RATE_HZ;
    let mut state = PlantState::at_rest(Vector3::new(0.0, 0.0, Ground::standing_height_m()), 0.0);
    let mut iae_m_s = 0.0;
    for step in 0..limit.map_or(steps, |limit| limit.min(steps)) {
        let no_forces = |reason: String| PilError::NoCommand { flight: format!("{course:?}, {flight}"), step, reason };
        let measured = core_state(&state);
        let expected = host.step(step, &measured).map_err(no_forces)?;
        let answer = client.step_rigid(step * ticks_per_step, &measured)?;
        let target = answer.result.map_err(|reason| no_forces(reason.to_string()))?.forces_n;
        report.steps += 1;
        target.iter().for_each(|force| hash.add(force.to_bits()));
        if target.map(f32::to_bits) != expected.map(f32::to_bits) && report.difference.is_none() {
            let host = expected;
            report.difference = Some(MotorDifference { course, flight, step, state: measured, host, target });
        }
        advance();
        let time_s = f64::from(step) / f64::from(RATE_HZ);
        if step % STEPS_A_SAMPLE == 0 {
            iae_m_s += SAMPLE_PERIOD_S * (state.position_m - position(&plan.at(time_s).state)).norm();
        }
        let commands_n = Vector4::from(target.map(f64::from));
        state = craft.hold(&state, &commands_n, time_s, 1.0 / f64::from(RATE_HZ));
    }
    Ok(limit.is_none().then_some(iae_m_s))
}

/// A plant's state as the board gets it.
fn core_state(state: &PlantState) -> RigidState {
    let q = state.attitude.quaternion();
    let [q0, q1, q2, q3] = [q.w, q.i, q.j, q.k].map(|value| value as f32);
    RigidState {
        state: State {
            position_m: state.position_m.map(|value| value as f32),
            attitude: Quaternion::new(q0, q1, q2, q3),
            velocity_m_s: state.velocity_m_s.map(|value| value as f32),
        },
        body_rates_rad_s: state.body_rates_rad_s.map(|value| value as f32),
    }
}
