//! Flights with something wrong under an emulated board: a fault in; its row of the fault table, as on the bench, out.
//!
//! In lock-step a step's state and body rates come in one frame, so that the board sees a fault of them, and of the craft around it.
//! Its reference stays where the craft hovers: a reference comes with states that have no body rates.

use nalgebra::Vector4;
use quatrack::link::{FromBoard, LawChoice, NoCommand, Parameter, StateIn, Table, ToBoard};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::Mode;
use quatrack::{FlatSample, RigidState, State, Tick};
use quatrack_simulation::faults::{Crafts, Fault, HEIGHT_M, Row, Signals, UnderTest, fly_by};

use super::PilError;
use super::client::Client;
use super::flights::PATIENCE_TICKS;

/// The craft that the image is for.
pub const VEHICLE: &str = "crazyflie-2.1";

/// The worst of the faults that a board sees over its link, in lock-step and at a hover.
pub const WORST: [&str; 12] = [
    "state: NaN one sample in two",
    "state: NaN for 500 ms",
    "state: NaN position for good",
    "state: NaN velocity for good",
    "state: zero quaternion for 300 ms",
    "state: stands still for good",
    "state: jumps by 10 m",
    "gyro: NaN for good",
    "gyro: dead",
    "gyro: wrong in sign",
    "motor: one dead",
    "motor: one at 0.7",
];

/// Steps between two questions for the board's mode: ten milliseconds, by which a fault is seen late at most.
const ASKED_EVERY: u32 = 5;

/// A board in the place of the bench's law.
struct Board<'c> {
    client: &'c mut Client,
    mode: Mode,
    steps: u32,
    failed: Option<PilError>,
}

/// Flies a fault at a hover.
///
/// # Errors
/// [`PilError`] where the board does not answer, or does not take off.
pub fn fly(client: &mut Client, fault: &Fault) -> Result<Row, PilError> {
    let craft = Crafts::by_name(VEHICLE).ok_or_else(|| PilError::Answer(format!("no craft is called {VEHICLE}")))?;
    take_off(client)?;
    let mut board = Board { client, mode: Mode::Armed, steps: 0, failed: None };
    let hovering = Fault { speed_m_s: 0.0, ..*fault };
    let row = fly_by(&hovering, &craft, &mut board).map_err(|error| PilError::Answer(error.to_string()));
    board.failed.map_or(row, Err)
}

/// In lock-step, armed, with a hover to follow, under the cascade.
fn take_off(client: &mut Client) -> Result<(), PilError> {
    client.request(&ToBoard::Disarm)?;
    client.set(Parameter::Decimation(0))?;
    client.set(Parameter::StateAgeMaxTicks(PATIENCE_TICKS))?;
    client.set(Parameter::LinkSilenceMaxTicks(PATIENCE_TICKS))?;
    client.request(&ToBoard::SelectLaw(LawChoice::new(Table::Cascade)))?;
    let at_m = Vector3::new(0.0, 0.0, HEIGHT_M as f32);
    let state = StateIn { tick: 0, state: State::at_rest(at_m) };
    match client.ask(&ToBoard::StateAndReference(state, FlatSample::at_rest(at_m, 0.0)))? {
        FromBoard::Command(_) => {}
        other => return Err(PilError::Answer(format!("a state is answered by {other:?}"))),
    }
    client.request(&ToBoard::Arm)
}

impl Board<'_> {
    fn forces_n(&mut self, now: Tick, signals: &Signals<'_>) -> Result<Option<Vector4<f64>>, PilError> {
        // In lock-step a board without a state does not step.
        let Some(state) = signals.state else { return Ok(None) };
        let rigid = RigidState { state, body_rates_rad_s: signals.body_rates };
        let answer = self.client.step_rigid(now, &rigid)?;
        if self.steps.is_multiple_of(ASKED_EVERY) {
            self.mode = self.client.telemetry()?.mode;
        }
        self.steps += 1;
        match answer.result {
            Ok(step) => Ok(Some(Vector4::from(step.forces_n.map(f64::from)))),
            Err(NoCommand::Mode(mode)) => {
                self.mode = mode;
                Ok(None)
            }
            Err(_) => Ok(None),
        }
    }
}

impl UnderTest for Board<'_> {
    fn step(&mut self, now: Tick, signals: &Signals<'_>) -> Option<Vector4<f64>> {
        if self.failed.is_some() {
            return None;
        }
        self.forces_n(now, signals).unwrap_or_else(|error| {
            self.failed = Some(error);
            None
        })
    }

    fn mode(&self) -> Mode {
        self.mode
    }

    /// It does not say.
    fn is_bridging(&self) -> bool {
        false
    }
}
