//! The `f32` core in the loop: the crate that runs on the board, flown against the f64 plant.
//!
//! States go in rounded, as from an estimator; trajectories go in as the pieces that the board stores; commands come out
//! exactly.

use nalgebra::{Vector3, Vector4};
use quatrack::trajectory::TrajectoryError;
use quatrack::{
    Command, Controller, Law, Limits, Measured, Memory, Output, Piece, Player, Progress, Quaternion, Rate, State,
    Target,
};
use quatrack_design::model::{InputVector, StateVector, attitude, position, velocity};

use super::closed_loop::HeldCommand;

fn vector(v: &Vector3<f64>) -> Vector3<f32> {
    v.map(|value| value as f32)
}

fn quaternion(q: &Vector4<f64>) -> Quaternion {
    Quaternion::new(q[0] as f32, q[1] as f32, q[2] as f32, q[3] as f32)
}

/// A state as the core takes it.
pub fn state(x: &StateVector) -> State {
    State { position_m: vector(&position(x)), attitude: quaternion(&attitude(x)), velocity_m_s: vector(&velocity(x)) }
}

/// A command of the core as an input of the model.
pub fn input(command: &Command) -> InputVector {
    let rates = command.body_rates_rad_s.map(f64::from);
    InputVector::new(f64::from(command.thrust_m_s2), rates.x, rates.y, rates.z)
}

/// An input cut to the core's limits, and whether it was; nothing where it is not finite. An input within the limits
/// keeps its f64 digits.
pub fn saturate(input: &InputVector, limits: &Limits) -> Option<(InputVector, bool)> {
    let rates = Vector3::new(input[1], input[2], input[3]);
    let command = Command { thrust_m_s2: input[0] as f32, body_rates_rad_s: vector(&rates) };
    let (cut, limited) = limits.saturate(&command)?;
    Some(if limited.any() { (self::input(&cut), true) } else { (*input, false) })
}

/// The core's step at a rate, with the trajectory evaluated on board.
pub struct CoreLoop<'a> {
    player: Player<'a>,
    /// At twice the rate, where the input is that of half a period ahead.
    ahead: Option<Player<'a>>,
    trajectory: u32,
    controller: Controller<'a>,
    memory: Memory,
}

impl<'a> CoreLoop<'a> {
    /// A loop that flies stored pieces.
    ///
    /// # Errors
    /// [`TrajectoryError`] where the core refuses the pieces.
    pub fn new(
        pieces: &'a [Piece],
        rate: Rate,
        law: impl Into<Law<'a>>,
        limits: Limits,
    ) -> Result<Self, TrajectoryError> {
        let trajectory = quatrack::Trajectory::new(pieces)?;
        Ok(Self {
            player: Player::new(trajectory, rate),
            ahead: None,
            trajectory: trajectory.checksum(),
            controller: Controller::new(law, limits),
            memory: Memory::at_rest(),
        })
    }

    /// The same with the reference's input taken half a period ahead of its state: that of the middle of the time over
    /// which the command is held. Nothing where the core has no clock of twice the rate.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_input_ahead(
        pieces: &'a [Piece],
        rate: Rate,
        law: impl Into<Law<'a>>,
        limits: Limits,
    ) -> Result<Option<Self>, TrajectoryError> {
        let Some(double) = Rate::from_hz(2 * rate.hz()) else { return Ok(None) };
        let ahead = Player::new(quatrack::Trajectory::new(pieces)?, double);
        Ok(Some(Self { ahead: Some(ahead), ..Self::new(pieces, rate, law, limits)? }))
    }

    /// One control step.
    ///
    /// # Errors
    /// The core's own words, where it gives no command.
    pub fn step(&mut self, tick: u32, x: &StateVector) -> Result<HeldCommand, String> {
        let mut reference = self.player.reference(tick).map_err(|error| error.to_string())?;
        if let Some(player) = &mut self.ahead {
            let ahead = player.reference(2 * tick + 1).map_err(|error| error.to_string())?;
            reference = reference.with_input_of(&ahead);
        }
        let progress = Some(Progress { trajectory: self.trajectory, tick });
        let (state, target) = (state(x), Target::new(&reference).at(progress));
        match self.controller.step(&mut self.memory, Measured::new(&state), target) {
            Ok(Output::Command(step)) => Ok(HeldCommand { input: input(&step.command), limited: step.limited.any() }),
            Ok(_) => Err("the law gives motor forces, which a point with an attitude has not".to_owned()),
            Err(error) => Err(error.to_string()),
        }
    }
}
