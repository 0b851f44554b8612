//! The paper's flights as the board flies them: both courses, four controllers, 500 Hz; states and commands out.

use quatrack::link::{Table, TrajectoryId};
use quatrack::{Command, Controller as CoreController, Limits, Measured, Memory, Player, Rate, State, Target};
use quatrack_design::model::StateVector;
use quatrack_plan::plan;
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::plan::stored;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;
use quatrack_simulation::flight::closed_loop::{Flight, HeldCommand, REPRODUCED_LOST_M, fly_sampled};
use quatrack_simulation::flight::core_loop;
use quatrack_simulation::flight::reference::Exact;
use quatrack_simulation::reproduction::table::{Controller, core_law};

use super::PilError;

/// Control steps a second.
pub const RATE_HZ: u32 = 500;

/// Both courses.
pub const COURSES: [PaperTrajectory; 2] = [PaperTrajectory::Mild, PaperTrajectory::Aggressive];

/// Ages beyond which the board ends a flight, ticks. A host that is held up for seconds is no danger here.
pub(super) const PATIENCE_TICKS: u32 = 10_000;

/// The board's name for a course.
pub(super) fn trajectory_id(course: PaperTrajectory) -> TrajectoryId {
    match course {
        PaperTrajectory::Mild => TrajectoryId::Mild,
        PaperTrajectory::Aggressive => TrajectoryId::Aggressive,
    }
}

/// The board's name for a controller's gains.
pub(super) fn table(controller: Controller) -> Table {
    match controller {
        Controller::LyapF => Table::LyapF,
        Controller::LyapE => Table::LyapE,
        Controller::LqrF => Table::LqrF,
        Controller::LqrE => Table::LqrE,
    }
}

/// The share of one of several flights in a number of steps.
pub(super) fn share(limit: u32, index: u32, flights: u32) -> u32 {
    limit / flights + u32::from(index < limit % flights)
}

/// The planned trajectories, against which errors are taken.
pub struct Plans {
    mild: PiecewisePolynomial,
    aggressive: PiecewisePolynomial,
}

impl Plans {
    /// Plans both.
    ///
    /// # Errors
    /// [`PilError::Plan`], which the paper's own plans do not meet.
    pub fn solve() -> Result<Self, PilError> {
        let solve = |plan: Result<plan::Plan, plan::PlanError>| {
            let curve = plan.and_then(|plan| plan.solve()).map_err(|error| PilError::Plan(error.to_string()))?;
            PiecewisePolynomial::from_bspline(&curve).map_err(|error| PilError::Plan(error.to_string()))
        };
        Ok(Self { mild: solve(plan::paper::mild())?, aggressive: solve(plan::paper::aggressive())? })
    }

    /// One of them.
    pub fn of(&self, course: PaperTrajectory) -> &PiecewisePolynomial {
        match course {
            PaperTrajectory::Mild => &self.mild,
            PaperTrajectory::Aggressive => &self.aggressive,
        }
    }
}

/// The core on the host with the board's stored table and trajectory.
pub struct HostCore {
    controller: CoreController<'static>,
    player: Player<'static>,
}

impl HostCore {
    /// The core at the start of a flight.
    ///
    /// # Errors
    /// [`PilError::Answer`] where the core refuses them.
    pub fn new(course: PaperTrajectory, controller: Controller) -> Result<Self, PilError> {
        let trajectory = quatrack::Trajectory::new(stored::pieces(course))
            .map_err(|error| PilError::Answer(format!("the stored {course:?} trajectory: {error}")))?;
        let rate = Rate::from_hz(RATE_HZ).ok_or_else(|| PilError::Answer(format!("no rate of {RATE_HZ} Hz")))?;
        Ok(Self {
            controller: CoreController::new(core_law(controller), Limits::NONE),
            player: Player::new(trajectory, rate),
        })
    }

    /// The command of a tick.
    ///
    /// # Errors
    /// The core's own words.
    pub fn step(&mut self, tick: u32, state: &State) -> Result<Command, String> {
        let reference = self.player.reference(tick).map_err(|error| error.to_string())?;
        // None of these laws remembers anything.
        let memory = &mut Memory::at_rest();
        let output = self.controller.step(memory, Measured::new(state), Target::new(&reference));
        let output = output.map_err(|error| error.to_string())?;
        output.command().map(|step| step.command).ok_or_else(|| "the law gives motor forces".to_owned())
    }
}

/// Flies a course under the commands of `control`, which is given the tick and the state as the board gets it.
pub fn fly(plan: &PiecewisePolynomial, mut control: impl FnMut(u32, &State) -> Result<Command, String>) -> Flight {
    fly_sampled(&Exact(plan), RATE_HZ, REPRODUCED_LOST_M, |tick, _, x: &StateVector| {
        let command = control(tick, &core_loop::state(x))?;
        Ok(HeldCommand { input: core_loop::input(&command), limited: false })
    })
}
