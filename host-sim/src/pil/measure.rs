//! Instructions a step on the target: the paper's flights in; least, mean and most of each part out.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use quatrack::{Command, State};
use serde::Serialize;

use super::PilError;
use super::emulated::{self, Transport};
use super::emulator::{Emulator, Folder};
use super::flights::{COURSES, HostCore, Plans, fly};
use super::image;
use super::interrupt::Interrupt;
use super::lock_step;
use crate::reproduction::table::{Controller, Course};

/// Longest time for an emulator to count all flights.
const LIMIT: Duration = Duration::from_secs(120);

/// Instructions between the two loops with which the image checks its counter.
const LOOP_INSTRUCTIONS: u32 = 2000;

/// Counts over steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Count {
    /// Least.
    pub min: u32,
    /// Mean.
    pub mean: f64,
    /// Most.
    pub max: u32,
}

impl Count {
    pub(crate) fn of(counts: &[u32]) -> Self {
        let sum: u64 = counts.iter().copied().map(u64::from).sum();
        Self {
            min: counts.iter().copied().min().unwrap_or_default(),
            mean: (sum as f64 / counts.len().max(1) as f64 * 100.0).round() / 100.0,
            max: counts.iter().copied().max().unwrap_or_default(),
        }
    }
}

/// What the control path costs.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// A step of each law, with validation, sign handling and saturation.
    pub law: BTreeMap<Controller, Count>,
    /// The reference of a tick: polynomial to jerk, and the flat map.
    pub reference: Count,
    /// A whole tick.
    pub tick: Count,
    /// Steps counted.
    pub steps: usize,
    /// Code and tables of the control path, without stored trajectories: all that its own image puts in flash, start-up
    /// code and vector table included.
    pub flash_bytes: u32,
    /// Variables of the image that flies, uploads included.
    pub ram_bytes: u32,
    /// Most stack that it used in flight.
    pub stack_bytes: u32,
    /// All of its flash.
    pub image_flash_bytes: u32,
}

/// The images that are measured.
pub struct Images {
    /// Counts on recorded states.
    pub counting: PathBuf,
    /// The control path alone.
    pub control_path: PathBuf,
    /// Flies, over pipes.
    pub flying: PathBuf,
}

/// One flight as recorded on the host.
struct Recorded {
    course: Course,
    controller: Controller,
    steps: Vec<(State, Command)>,
}

fn record() -> Result<Vec<Recorded>, PilError> {
    let plans = Plans::solve()?;
    let mut flights = Vec::new();
    for course in COURSES {
        for controller in Controller::ALL {
            let mut core = HostCore::new(course, controller)?;
            let mut steps = Vec::new();
            fly(plans.of(course), |tick, state| {
                let command = core.step(tick, state)?;
                steps.push((*state, command));
                Ok(command)
            });
            flights.push(Recorded { course, controller, steps });
        }
    }
    Ok(flights)
}

fn state_words(state: &State) -> [f32; 10] {
    let (r, q, v) = (&state.position_m, &state.attitude, &state.velocity_m_s);
    [r.x, r.y, r.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z]
}

fn states_file(flights: &[Recorded]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for flight in flights {
        let controller = Controller::ALL.iter().position(|c| *c == flight.controller).unwrap_or_default();
        for word in [flight.course as u32, controller as u32, flight.steps.len() as u32] {
            bytes.extend(word.to_le_bytes());
        }
        for value in flight.steps.iter().flat_map(|(state, _)| state_words(state)) {
            bytes.extend(value.to_le_bytes());
        }
    }
    bytes
}

/// Steps that are flown on the target for its stack.
const STACK_STEPS: u32 = 500;

/// Flies the paper's flights on the host and counts every step of them on the emulated target.
///
/// # Errors
/// [`PilError`].
pub fn count(images: &Images) -> Result<Report, PilError> {
    let (control_path, flying) = (image::size(&images.control_path)?, image::size(&images.flying)?);
    image::size(&images.counting)?;
    let interrupt = Interrupt::listen()?;
    let flights = record()?;
    let folder = Folder::create()?;
    let states = folder.path().join("states.bin");
    fs::write(&states, states_file(&flights)).map_err(PilError::io("writing the recorded states"))?;
    Emulator::start(&images.counting, folder.path(), &["-serial", "none"])?.wait(LIMIT, &interrupt)?;
    let counts = fs::read(folder.path().join("counts.bin")).map_err(PilError::io("reading the counts"))?;
    let (words, _) = counts.as_chunks::<4>();
    let words: Vec<u32> = words.iter().copied().map(u32::from_le_bytes).collect();
    let mut report = report(&flights, &words)?;
    let mut client = emulated::connect(&images.flying, Transport::Pipes, None, interrupt)?;
    report.stack_bytes = lock_step::fly_all(&mut client, Some(STACK_STEPS), &|| {})?.stack_bytes;
    report.flash_bytes = control_path.flash_bytes;
    (report.ram_bytes, report.image_flash_bytes) = (flying.ram_bytes, flying.flash_bytes);
    Ok(report)
}

fn report(flights: &[Recorded], words: &[u32]) -> Result<Report, PilError> {
    let too_short = || PilError::Answer("it counted fewer steps than were flown".to_owned());
    let ([_, short, long], words) = words.split_first_chunk::<3>().ok_or_else(too_short)?;
    if long.wrapping_sub(*short) != LOOP_INSTRUCTIONS {
        return Err(PilError::Miscounts { counted: long.wrapping_sub(*short), instructions: LOOP_INSTRUCTIONS });
    }
    let (rows, _) = words.as_chunks::<7>();
    let flown: Vec<(Controller, &Command)> =
        flights.iter().flat_map(|f| f.steps.iter().map(|(_, command)| (f.controller, command))).collect();
    if rows.len() != flown.len() {
        return Err(too_short());
    }
    let (mut law, mut reference, mut tick) = (BTreeMap::<_, Vec<u32>>::new(), Vec::new(), Vec::new());
    for (step, ((controller, command), row)) in flown.iter().zip(rows).enumerate() {
        let [of_reference, of_law, of_tick, bits @ ..] = *row;
        if bits != lock_step::words(command) {
            return Err(PilError::Answer(format!("{controller}, step {step}: another command than the host's")));
        }
        law.entry(*controller).or_default().push(of_law);
        reference.push(of_reference);
        tick.push(of_tick);
    }
    Ok(Report {
        law: law.iter().map(|(controller, counts)| (*controller, Count::of(counts))).collect(),
        reference: Count::of(&reference),
        tick: Count::of(&tick),
        steps: rows.len(),
        flash_bytes: 0,
        ram_bytes: 0,
        stack_bytes: 0,
        image_flash_bytes: 0,
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "Instructions on the emulated Cortex-M4F (target-cpu=cortex-m4, opt-level 3), {} steps of the paper's flights",
            self.steps
        )?;
        writeln!(f, "\n{:<24}{:>8}{:>10}{:>8}", "", "min", "mean", "max")?;
        let mut row =
            |name: &str, count: &Count| writeln!(f, "{name:<24}{:>8}{:>10.1}{:>8}", count.min, count.mean, count.max);
        for (controller, count) in &self.law {
            row(&format!("law, {controller}"), count)?;
        }
        row("reference", &self.reference)?;
        row("whole tick", &self.tick)?;
        writeln!(f, "\ncontrol path   flash {:>6} bytes, without stored trajectories", self.flash_bytes)?;
        let Self { image_flash_bytes, ram_bytes, stack_bytes, .. } = self;
        writeln!(
            f,
            "whole image    flash {image_flash_bytes:>6} bytes, RAM {ram_bytes} bytes, stack {stack_bytes} bytes"
        )
    }
}
