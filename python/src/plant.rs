//! The plant of a scenario: many crafts at once, each in its own wind.

use std::num::NonZeroUsize;

use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector4};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use quatrack_simulation::plant::{Plant as SimPlant, RigidState};
use quatrack_simulation::scenario::Scenario;

use crate::arrays::{Quantity, array};
use crate::error::refused_of;
use crate::scenario;
use crate::state::State;

/// Crafts in flight, moved by commanded motor forces, each in its own wind.
///
/// scenario: a Scenario, a path, or the keys of a file as a dictionary; its course and law count for nothing here
/// state: State of one craft or of N, where they begin
/// motor_forces: (4,) or (N, 4), the motors' forces at the start, N; at hover where left out
/// seeds: N whole numbers, where the gusts of each begin; the scenario's and those after it where left out
/// threads: at most so many for many crafts
#[pyclass(module = "quatrack")]
pub(crate) struct Plant {
    scenario: Scenario,
    crafts: Option<usize>,
    plants: Vec<SimPlant>,
    threads: usize,
}

/// Crafts for which a thread is worth its start.
const CRAFTS_A_THREAD: usize = 32;

/// A state of one craft as a start, its motors at hover or at given forces.
fn start(state: &State, row: usize, thrusts_n: Vector4<f64>) -> Result<RigidState, String> {
    // The core's check of a state.
    state.core(row).validated().map_err(|error| error.to_string())?;
    let [w, x, y, z] = state.attitude.row(row);
    Ok(RigidState {
        position_m: Vector3::from(state.position.row(row)),
        velocity_m_s: Vector3::from(state.velocity.row(row)),
        attitude: UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)),
        body_rates_rad_s: state.body_rates.as_ref().map_or_else(Vector3::zeros, |rates| Vector3::from(rates.row(row))),
        thrusts_n,
    })
}

impl Plant {
    fn one(&self, state: &State, row: usize, forces: Option<&Quantity<4>>, seed: u64) -> PyResult<SimPlant> {
        let of = self.crafts.map(|_| row);
        let scenario = &self.scenario;
        let thrusts_n = match forces {
            Some(rows) => Vector4::from(rows.row(row)),
            None => Vector4::repeat(0.25 * scenario.truth.mass_kg * quatrack_design::model::GRAVITY_M_S2),
        };
        let start = start(state, row, thrusts_n).map_err(|error| refused_of(of, error))?;
        SimPlant::new(&scenario.vehicle, &scenario.environment, &scenario.truth, &start, seed)
            .map_err(|error| refused_of(of, error))
    }

    fn seeds(&self, seeds: Option<Vec<u64>>) -> PyResult<Vec<u64>> {
        let count = self.crafts.unwrap_or(1);
        let seeds = seeds.unwrap_or_else(|| (self.scenario.seed..).take(count).collect());
        if seeds.len() == count {
            Ok(seeds)
        } else {
            Err(PyValueError::new_err(format!("seeds: {} for {count} crafts", seeds.len())))
        }
    }
}

#[pymethods]
impl Plant {
    #[new]
    #[pyo3(signature = (scenario, state, *, motor_forces=None, seeds=None, threads=None))]
    fn new(
        scenario: &Bound<'_, PyAny>,
        state: &State,
        motor_forces: Option<&Bound<'_, PyAny>>,
        seeds: Option<Vec<u64>>,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let there_are = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let mut plant = Self {
            scenario: scenario::argument(scenario)?,
            crafts: state.crafts,
            plants: Vec::new(),
            threads: threads.unwrap_or_else(there_are).max(1),
        };
        let forces = Quantity::<4>::read_or_none("motor_forces", motor_forces)?;
        if let Some(rows) = forces.as_ref().and_then(|forces| forces.crafts).filter(|rows| *rows != state.len()) {
            return Err(PyValueError::new_err(format!("motor_forces: {rows} rows for {} crafts", state.len())));
        }
        let seeds = plant.seeds(seeds)?;
        plant.plants = (0..state.len())
            .zip(seeds)
            .map(|(row, seed)| plant.one(state, row, forces.as_ref(), seed))
            .collect::<PyResult<_>>()?;
        Ok(plant)
    }

    /// Gives commanded motor forces, N, of shape (4,) or (N, 4), and flies on for a time, s.
    fn advance(&mut self, py: Python<'_>, commands: &Bound<'_, PyAny>, duration: f64) -> PyResult<()> {
        let commands = Quantity::<4>::read("commands", commands)?;
        if let Some(rows) = commands.crafts.filter(|rows| *rows != self.plants.len()) {
            return Err(PyValueError::new_err(format!("commands: {rows} rows for {} crafts", self.plants.len())));
        }
        if !(duration > 0.0 && duration <= 10.0) {
            return Err(PyValueError::new_err(format!("duration: {duration}; must be above 0 and at most 10 s")));
        }
        if let Some((row, forces)) =
            (0..).zip(commands.rows()).find(|(_, row)| row.iter().any(|force| !force.is_finite()))
        {
            let of = commands.crafts.map(|_| row);
            return Err(refused_of(of, format!("commands: {forces:?}; must be finite")));
        }
        let commands = &commands;
        let run = |from: usize, plants: &mut [SimPlant]| {
            for (row, plant) in (from..).zip(plants) {
                plant.advance(&Vector4::from(commands.row(row)), duration);
            }
        };
        let parts = self.threads.min(self.plants.len().div_ceil(CRAFTS_A_THREAD)).max(1);
        let size = self.plants.len().div_ceil(parts).max(1);
        let plants = &mut self.plants;
        py.detach(|| {
            if parts == 1 {
                return run(0, plants);
            }
            std::thread::scope(|scope| {
                for (part, plants) in plants.chunks_mut(size).enumerate() {
                    scope.spawn(move || run(part * size, plants));
                }
            });
        });
        Ok(())
    }

    /// Where the crafts are, with the readings of gyroscope and accelerometer without noise.
    #[getter]
    fn state(&mut self) -> State {
        let felt = self.plants.iter_mut().map(|plant| plant.motion().specific_force_m_s2.into());
        let specific_force = Some(Quantity::of_rows(self.crafts, felt));
        State { specific_force, ..State::of_rigid(self.crafts, self.plants.iter().map(SimPlant::state)) }
    }

    /// Forces of the motors, N; shape (4,) or (N, 4).
    #[getter]
    fn motor_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows: Vec<[f64; 4]> = self.plants.iter().map(|plant| plant.state().thrusts_n.into()).collect();
        array(py, self.crafts, rows)
    }

    /// Velocity of the air at the crafts, m/s; shape (3,) or (N, 3).
    #[getter]
    fn wind<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows: Vec<[f64; 3]> = self.plants.iter().map(|plant| (*plant.wind_m_s()).into()).collect();
        array(py, self.crafts, rows)
    }

    /// Time since each started, s; shape () or (N,).
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows: Vec<[f64; 1]> = self.plants.iter().map(|plant| [plant.time_s()]).collect();
        array(py, self.crafts, rows)
    }

    /// Starts crafts anew where a mask of shape (N,) is true: from their rows of a state, with their seeds.
    #[pyo3(signature = (mask, state, *, seeds=None))]
    fn restart(&mut self, mask: Vec<bool>, state: &State, seeds: Option<Vec<u64>>) -> PyResult<()> {
        if mask.len() != self.plants.len() || state.len() != self.plants.len() {
            return Err(PyValueError::new_err(format!(
                "mask: {} rows, state: {} rows, for {} crafts",
                mask.len(),
                state.len(),
                self.plants.len()
            )));
        }
        let seeds = self.seeds(seeds)?;
        for (row, (_, seed)) in mask.into_iter().zip(seeds).enumerate().filter(|(_, (is_reset, _))| *is_reset) {
            self.plants[row] = self.one(state, row, None, seed)?;
        }
        Ok(())
    }

    /// How many crafts there are; None for one.
    #[getter]
    fn crafts(&self) -> Option<usize> {
        self.crafts
    }
}
