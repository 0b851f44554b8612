//! Lock-step: a connected board in; the paper's flights under its commands, compared bit for bit with the host's core.

use std::collections::BTreeMap;
use std::fmt;

use quatrack::link::{LawChoice, LimitsSetting, Parameter, Protection, ToBoard, TrajectoryCommand};
use quatrack::{Command, ErrorForm, Leash, State, Step};
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::plan::stored;
use quatrack_simulation::flight::metrics::Metrics;
use quatrack_simulation::reproduction::report::digits;
use quatrack_simulation::reproduction::table::Controller;
use serde::Serialize;

use super::PilError;
use super::bits::{Fnv1a, words};
use super::client::Client;
use super::flights::{COURSES, HostCore, PATIENCE_TICKS, Plans, RATE_HZ, fly, share, table, trajectory_id};
use super::motors::{self, MotorReport};

/// The result of all flights.
#[derive(Clone, Debug, Serialize)]
pub struct LockStepReport {
    /// IAE of the flights that the target commanded, m s; nothing for a flight that was cut short.
    pub iae: BTreeMap<PaperTrajectory, BTreeMap<Controller, Option<f64>>>,
    /// Whether every command and every motor force had the host's bits.
    pub bit_exact: bool,
    /// Commands compared.
    pub steps: u64,
    /// FNV-1a of all commands, in the order of flight.
    pub hash: String,
    /// The flights down to the motors.
    pub motors: MotorReport,
    /// Which frames of the link carried a tag.
    #[serde(skip)]
    pub protection: Protection,
    /// The first command that differed.
    #[serde(skip)]
    pub difference: Option<Difference>,
    /// Longest step on the target, ns.
    #[serde(skip)]
    pub worst_step_ns: u32,
    /// Most stack in use on the target, bytes.
    #[serde(skip)]
    pub stack_bytes: u32,
    /// Steps that ran past their period.
    #[serde(skip)]
    pub overruns: u32,
}

/// Two commands for one state that are not the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    course: PaperTrajectory,
    controller: Controller,
    step: u32,
    state: State,
    host: Command,
    target: Command,
}

/// Flies all flights; the first `limit` steps of them, spread evenly, where one is given. `advance` is told every step.
///
/// # Errors
/// [`PilError`].
pub fn fly_all(client: &mut Client, limit: Option<u32>, advance: &dyn Fn()) -> Result<LockStepReport, PilError> {
    let plans = Plans::solve()?;
    prepare(client)?;
    let of_commands = limit.map(|limit| limit - of_motors(limit));
    let flights = COURSES.iter().flat_map(|course| Controller::ALL.map(|controller| (*course, controller)));
    let mut comparison = Comparison { hash: Fnv1a::new(), steps: 0, difference: None };
    let mut iae: BTreeMap<PaperTrajectory, BTreeMap<Controller, Option<f64>>> = BTreeMap::new();
    for (index, (course, controller)) in flights.enumerate() {
        let share = of_commands.map(|limit| share(limit, index as u32, FLIGHTS));
        let flown = fly_one(client, &plans, (course, controller), share, &mut comparison, advance)?;
        iae.entry(course).or_default().insert(controller, flown);
    }
    let motors = motors::fly_all(client, &plans, limit.map(of_motors), advance)?;
    let telemetry = client.telemetry()?;
    Ok(LockStepReport {
        iae,
        bit_exact: comparison.difference.is_none() && motors.bit_exact,
        steps: comparison.steps,
        hash: comparison.hash.to_string(),
        motors,
        protection: client.identity().protection,
        difference: comparison.difference,
        worst_step_ns: telemetry.statistics.worst_step_ns,
        stack_bytes: telemetry.statistics.stack_bytes,
        overruns: telemetry.statistics.overruns,
    })
}

/// Of a number of steps, those down to the motors: as many in every flight.
fn of_motors(limit: u32) -> u32 {
    limit * motors::FLIGHTS / (FLIGHTS + motors::FLIGHTS)
}

/// Steps of all flights together.
pub fn step_count(limit: Option<u32>) -> u64 {
    let whole: u64 = COURSES
        .iter()
        .map(|course| stored::pieces(*course).iter().map(|piece| piece.duration_ns).sum::<u64>())
        .map(|duration_ns| duration_ns * u64::from(RATE_HZ) / 1_000_000_000 + 1)
        .sum();
    // Each course once with every law.
    let laws = (FLIGHTS + motors::FLIGHTS) / COURSES.len() as u32;
    limit.map_or(whole * u64::from(laws), u64::from)
}

/// Flights of both courses under commands.
const FLIGHTS: u32 = (COURSES.len() * Controller::ALL.len()) as u32;

fn prepare(client: &mut Client) -> Result<(), PilError> {
    client.request(&ToBoard::Disarm)?;
    // Lock-step, with limits and leash off as in the reproduction of the paper.
    client.set(Parameter::Decimation(0))?;
    client.set(Parameter::Limits(LimitsSetting {
        thrust_min_m_s2: f32::MIN,
        thrust_max_m_s2: f32::MAX,
        body_rates_max_rad_s: [f32::MAX; 3],
    }))?;
    client.set(Parameter::Leash(Leash::NONE.length_m))?;
    client.set(Parameter::StateAgeMaxTicks(PATIENCE_TICKS))?;
    client.set(Parameter::LinkSilenceMaxTicks(PATIENCE_TICKS))
}

/// One flight's IAE.
fn fly_one(
    client: &mut Client,
    plans: &Plans,
    (course, controller): (PaperTrajectory, Controller),
    limit: Option<u32>,
    comparison: &mut Comparison,
    advance: &dyn Fn(),
) -> Result<Option<f64>, PilError> {
    let mut host = HostCore::new(course, controller)?;
    client.request(&ToBoard::Disarm)?;
    client.request(&ToBoard::SelectLaw(law(controller)))?;
    client.request(&ToBoard::Trajectory(TrajectoryCommand::Start(trajectory_id(course))))?;
    client.request(&ToBoard::Arm)?;
    let ticks_per_step = client.identity().tick_rate_hz / RATE_HZ;
    let mut failed = None;
    let flight = fly(plans.of(course), |step, state| {
        if limit.is_some_and(|limit| step >= limit) {
            return Err("as far as was asked for".to_owned());
        }
        let expected = host.step(step, state)?;
        let answer = client.step(step * ticks_per_step, state).and_then(|answer| {
            answer.result.map_err(|reason| PilError::NoCommand {
                flight: format!("{course:?}, {controller}"),
                step,
                reason: reason.to_string(),
            })
        });
        match answer {
            Ok(Step { command, .. }) => {
                comparison.compare((course, controller, step), state, &expected, &command);
                advance();
                Ok(command)
            }
            Err(error) => {
                failed = Some(error);
                Err("no command".to_owned())
            }
        }
    });
    match failed {
        Some(error) => Err(error),
        None => Ok(Metrics::of(&flight).iae_m_s),
    }
}

fn law(controller: Controller) -> LawChoice {
    LawChoice { error_form: ErrorForm::Paper, ..LawChoice::new(table(controller)) }
}

struct Comparison {
    hash: Fnv1a,
    steps: u64,
    difference: Option<Difference>,
}

impl Comparison {
    fn compare(&mut self, at: (PaperTrajectory, Controller, u32), state: &State, host: &Command, target: &Command) {
        self.steps += 1;
        for word in words(target) {
            self.hash.add(word);
        }
        if words(host) != words(target) && self.difference.is_none() {
            let (course, controller, step) = at;
            self.difference =
                Some(Difference { course, controller, step, state: *state, host: *host, target: *target });
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { course, controller, step, state, host, target } = self;
        writeln!(f, "first difference: {course:?}, {controller}, step {step}")?;
        writeln!(f, "  state   {state:?}")?;
        for (name, command) in [("host", host), ("target", target)] {
            writeln!(f, "  {name:<7} {command:?}")?;
            writeln!(f, "          {:08x?}", words(command))?;
        }
        Ok(())
    }
}

impl fmt::Display for LockStepReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "IAE (23) of the position, m s, commanded by the target at {RATE_HZ} Hz")?;
        for (course, row) in &self.iae {
            write!(f, "\n{:<14}", "")?;
            for controller in row.keys() {
                write!(f, "{controller:>12}")?;
            }
            write!(f, "\n{:<14}", format!("{course:?}"))?;
            for iae in row.values() {
                let text = iae.map_or_else(|| "-".to_owned(), |iae| digits(Some(iae)));
                write!(f, "{text:>12}")?;
            }
            writeln!(f)?;
        }
        let verdict = if self.difference.is_none() { "every bit as on the host" } else { "NOT as on the host" };
        writeln!(f, "\n{} commands, {verdict}; hash {}", self.steps, self.hash)?;
        if let Some(difference) = &self.difference {
            write!(f, "{difference}")?;
        }
        writeln!(f, "\n{}", self.motors)?;
        let (step_us, stack, overruns) = (f64::from(self.worst_step_ns) / 1e3, self.stack_bytes, self.overruns);
        writeln!(f, "on the target: longest step {step_us} us, stack {stack} bytes, {overruns} overruns")?;
        writeln!(f, "the link is {}", self.protection)
    }
}
