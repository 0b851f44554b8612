//! A control step of many crafts: the core's, one after the other, on as many threads as they are worth.

use std::thread::ScopedJoinHandle;

use quatrack::cascade::JerkFit;
use quatrack::nalgebra::Vector3;
use quatrack::{
    Controller, FifthOrderSample, Heading, Measured, Memory, MotorReference, Output, Rate, Reference as CoreReference,
    Target,
};

use crate::arrays::Quantity;
use crate::reference::Reference;
use crate::state::{State, single};

/// The memory of one craft.
#[derive(Clone)]
pub(crate) struct Craft {
    pub(crate) memory: Memory,
    fit: Option<Box<Fit>>,
}

/// Snap and crackle of references that end with the jerk.
#[derive(Clone, Copy)]
struct Fit {
    jerks: JerkFit,
    position: Vector3<f32>,
}

/// Farthest that two references of one motion are apart, m.
const JUMP_M: f32 = 0.05;

/// One row of a step's output; NaN where there is none.
#[derive(Clone, Copy)]
pub(crate) struct Given {
    pub(crate) forces: [f32; 4],
    pub(crate) command: [f32; 4],
    pub(crate) limited: u16,
}

/// Crafts for which a thread is worth its start.
const CRAFTS_A_THREAD: usize = 256;

/// Crafts from which on it pays to let other threads of the interpreter run.
pub(crate) const WORTH_RELEASING: usize = 32;

/// The inputs of a step.
#[derive(Clone, Copy)]
pub(crate) struct Inputs<'a> {
    pub(crate) state: &'a State,
    /// Of as many rows as there are crafts, or of one for all.
    pub(crate) reference: &'a Reference,
    pub(crate) rate: Rate,
}

impl Craft {
    /// The craft at the start of a flight.
    pub(crate) fn new(memory: Memory) -> Self {
        Self { memory, fit: None }
    }

    /// The reference of a row, with snap and crackle of its jerks where it has none of its own.
    fn sample(&mut self, reference: &Reference, row: usize, rate: Rate) -> FifthOrderSample {
        let mut sample = reference.sample(row);
        if reference.beyond.is_none() {
            let fit = self
                .fit
                .get_or_insert_with(|| Box::new(Fit { jerks: JerkFit::NONE, position: sample.flat.position_m }));
            if (sample.flat.position_m - fit.position).norm() > JUMP_M {
                fit.jerks.forget();
            }
            fit.position = sample.flat.position_m;
            fit.jerks.accept(&sample.flat.jerk_m_s3, 1.0 / rate.hz() as f32);
            [sample.snap_m_s4, sample.crackle_m_s5] = fit.jerks.snap_and_crackle();
        }
        sample
    }

    /// Its step, down to the motors where the controller knows them.
    fn step(&mut self, controller: &Controller<'_>, inputs: Inputs<'_>, row: usize) -> Result<Given, String> {
        let Inputs { state, reference, rate } = inputs;
        let estimate = state.core(row);
        let vector = |rows: &Option<Quantity<3>>| rows.as_ref().map(|rows| Vector3::from(single(rows.row(row))));
        let (rates, felt) = (vector(&state.body_rates), vector(&state.specific_force));
        let mut measured = Measured::new(&estimate);
        if let Some(rates) = &rates {
            measured = measured.with_body_rates(rates);
        }
        if let Some(felt) = &felt {
            measured = measured.with_specific_force(felt);
        }
        let law = controller.law();
        if law.follows_samples() {
            let sample = self.sample(reference, row, rate);
            let heading = Heading::from_angle(sample.flat.heading_rad);
            return carried(controller, &mut self.memory, measured, Target::with_sample(&sample, heading));
        }
        if let (true, Some(actuation)) = (law.follows_forces(), controller.actuation()) {
            let sample = self.sample(reference, row, rate);
            let motors = MotorReference::from_flat(&sample, actuation.airframe()).map_err(|error| error.to_string())?;
            return carried(controller, &mut self.memory, measured, Target::with_forces(&motors));
        }
        let mapped = CoreReference::from_flat(&reference.flat(row)).map_err(|error| error.to_string())?;
        let progress = reference.progress;
        carried(controller, &mut self.memory, measured, Target::new(&mapped).at(progress))
    }
}

fn carried(
    controller: &Controller<'_>,
    memory: &mut Memory,
    measured: Measured<'_>,
    target: Target<'_>,
) -> Result<Given, String> {
    let output = controller.step(memory, measured, target).map_err(|error| error.to_string())?;
    let command = output.command().map_or([f32::NAN; 4], |step| {
        let rates = &step.command.body_rates_rad_s;
        [step.command.thrust_m_s2, rates.x, rates.y, rates.z]
    });
    // Without body rates a command of thrust and body rates is all that there is.
    let ends_there = controller.actuation().is_none() || measured.body_rates_rad_s().is_none();
    if ends_there && matches!(output, Output::Command(_)) {
        return Ok(Given { forces: [f32::NAN; 4], command, limited: output.limited().bits() });
    }
    let motors = controller.carry(memory, &output, measured).map_err(|error| error.to_string())?;
    Ok(Given { forces: motors.forces_n, command, limited: motors.limited.bits() })
}

/// All crafts; with the first that got no answer, and why.
pub(crate) fn step(
    controller: &Controller<'_>,
    inputs: Inputs<'_>,
    threads: usize,
    crafts: &mut [Craft],
) -> (Vec<Given>, Option<(usize, String)>) {
    let none = Given { forces: [f32::NAN; 4], command: [f32::NAN; 4], limited: 0 };
    let mut given = vec![none; crafts.len()];
    let run = |from: usize, crafts: &mut [Craft], given: &mut [Given]| {
        let mut fault = None;
        for (row, (craft, given)) in (from..).zip(crafts.iter_mut().zip(given)) {
            match craft.step(controller, inputs, row) {
                Ok(step) => *given = step,
                Err(reason) => {
                    fault.get_or_insert((row, reason));
                }
            }
        }
        fault
    };
    let parts = threads.min(crafts.len().div_ceil(CRAFTS_A_THREAD)).max(1);
    if parts == 1 {
        let fault = run(0, crafts, &mut given);
        return (given, fault);
    }
    let size = crafts.len().div_ceil(parts);
    let faults: Vec<_> = std::thread::scope(|scope| {
        let shares = crafts.chunks_mut(size).zip(given.chunks_mut(size)).enumerate();
        let workers: Vec<_> =
            shares.map(|(part, (crafts, given))| scope.spawn(move || run(part * size, crafts, given))).collect();
        let ended = workers.into_iter().map(ScopedJoinHandle::join);
        ended.map(|fault| fault.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    });
    // The first fault is that of the first craft.
    let fault = faults.into_iter().flatten().next();
    (given, fault)
}
