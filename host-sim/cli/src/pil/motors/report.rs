//! Flights down to the motors in; errors, the first difference from the host, and the verdict, as they are printed and
//! written, out.

use std::collections::BTreeMap;
use std::fmt;

use quatrack::{MotorForces, RigidState};
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_simulation::reproduction::report::digits;
use serde::Serialize;

use super::MotorFlight;

/// The result of all flights down to the motors.
#[derive(Clone, Debug, Serialize)]
pub struct MotorReport {
    /// IAE of the flights that the target drove, m s; nothing for a flight that was cut short.
    pub iae: BTreeMap<PaperTrajectory, BTreeMap<MotorFlight, Option<f64>>>,
    /// Whether every force had the host's bits.
    pub bit_exact: bool,
    /// Steps compared.
    pub steps: u64,
    /// FNV-1a of all forces, in the order of flight.
    pub hash: String,
    /// The first forces that differed.
    #[serde(skip)]
    pub difference: Option<MotorDifference>,
}

/// Two sets of forces for one state that are not the same.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorDifference {
    pub(super) course: PaperTrajectory,
    pub(super) flight: MotorFlight,
    pub(super) step: u32,
    pub(super) state: RigidState,
    pub(super) host: MotorForces,
    pub(super) target: MotorForces,
}

impl fmt::Display for MotorDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { course, flight, step, state, host, target } = self;
        writeln!(f, "first difference: {course:?}, {flight}, step {step}")?;
        writeln!(f, "  state   {state:?}")?;
        for (name, forces) in [("host", host), ("target", target)] {
            writeln!(f, "  {name:<7} {forces:?} N")?;
            writeln!(f, "          {:08x?}", forces.map(f32::to_bits))?;
        }
        Ok(())
    }
}

impl fmt::Display for MotorReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "IAE (23) of the position, m s, down to the motors, from the floor")?;
        for (course, row) in &self.iae {
            write!(f, "\n{:<14}", "")?;
            for flight in row.keys() {
                write!(f, "{flight:>16}")?;
            }
            write!(f, "\n{:<14}", format!("{course:?}"))?;
            for iae in row.values() {
                let text = iae.map_or_else(|| "-".to_owned(), |iae| digits(Some(iae)));
                write!(f, "{text:>16}")?;
            }
            writeln!(f)?;
        }
        let verdict = if self.bit_exact { "every bit as on the host" } else { "NOT as on the host" };
        writeln!(f, "\n{} times four forces, {verdict}; hash {}", self.steps, self.hash)?;
        if let Some(difference) = &self.difference {
            write!(f, "{difference}")?;
        }
        Ok(())
    }
}
