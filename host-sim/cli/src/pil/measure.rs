//! Instructions a step on the target: the paper's flights in; least, mean and most of each part out.
//!
//! Every state is counted as it was flown and at its worst (see `worst_case`), and every command that the target
//! computes on the way is compared with the host's.

mod report;

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use quatrack::{Command, State};
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_simulation::reproduction::table::Controller;

use super::emulated::{self, Equipment, Transport};
use super::emulator::{Emulator, Folder};
use super::estimator;
use super::flights::{COURSES, HostCore, Plans, fly};
use super::image;
use super::interrupt::Interrupt;
use super::link;
use super::lock_step;
use super::worst_case;
use super::{PilError, bits};
use report::Tally;
pub use report::{Count, InstructionReport};

/// Longest time for an emulator to count all flights.
const LIMIT: Duration = Duration::from_secs(120);

/// Instructions between the two loops with which the image checks its counter.
pub(super) const LOOP_INSTRUCTIONS: u32 = 2000;

/// The images that are measured.
pub struct Images {
    /// Counts on recorded states.
    pub counting: PathBuf,
    /// The control path alone.
    pub control_path: PathBuf,
    /// The same down to the motors.
    pub motor_path: PathBuf,
    /// Counts the estimator.
    pub estimator: PathBuf,
    /// Counts the link's frames.
    pub link: PathBuf,
    /// Flies, over pipes.
    pub flying: PathBuf,
}

/// One flight as recorded on the host.
struct Recorded {
    course: PaperTrajectory,
    controller: Controller,
    steps: Vec<(State, Command)>,
}

/// All flights, or the first `limit` steps of each.
fn record(limit: Option<usize>) -> Result<Vec<Recorded>, PilError> {
    let plans = Plans::solve()?;
    let mut flights = Vec::new();
    for course in COURSES {
        for controller in Controller::ALL {
            let mut core = HostCore::new(course, controller)?;
            let mut steps = Vec::new();
            fly(plans.of(course), |tick, state| {
                if limit.is_some_and(|limit| steps.len() >= limit) {
                    return Err("as far as was asked for".to_owned());
                }
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
    let mut bytes = worst_case::head();
    for (flight, controller, is_worst) in runs(flights) {
        let controller = Controller::ALL.iter().position(|c| Some(*c) == controller).unwrap_or(Controller::ALL.len());
        for word in [flight.course as u32, controller as u32, u32::from(is_worst), flight.steps.len() as u32] {
            bytes.extend(word.to_le_bytes());
        }
        for value in flight.steps.iter().flat_map(|(state, _)| state_words(state)) {
            bytes.extend(value.to_le_bytes());
        }
    }
    bytes
}

/// The target's flights, in order: each flight as recorded and at its worst, and those of LQR-E once more at the worst of
/// the dense gain, which is no controller of the paper's.
fn runs(flights: &[Recorded]) -> impl Iterator<Item = (&Recorded, Option<Controller>, bool)> {
    flights.iter().flat_map(|flight| {
        let dense = (flight.controller == Controller::LqrE).then_some((flight, None, true));
        let own = Some(flight.controller);
        [(flight, own, false), (flight, own, true)].into_iter().chain(dense)
    })
}

/// Steps that are flown on the target for its stack.
const STACK_STEPS: u32 = 500;

/// Flies the paper's flights on the host and counts every step of them on the emulated target; the first `limit` steps of
/// each flight where one is given.
///
/// # Errors
/// [`PilError`].
pub fn count(images: &Images, limit: Option<usize>) -> Result<InstructionReport, PilError> {
    let (control_path, flying) = (image::size(&images.control_path)?, image::size(&images.flying)?);
    image::size(&images.counting)?;
    let interrupt = Interrupt::listen()?;
    let flights = record(limit)?;
    let folder = Folder::create()?;
    let states = folder.path().join("states.bin");
    fs::write(&states, states_file(&flights)).map_err(PilError::io("writing the recorded states"))?;
    Emulator::start(&images.counting, folder.path(), &["-serial", "none"])?.wait(LIMIT, &interrupt)?;
    let counts = fs::read(folder.path().join("counts.bin")).map_err(PilError::io("reading the counts"))?;
    let (words, _) = counts.as_chunks::<4>();
    let words: Vec<u32> = words.iter().copied().map(u32::from_le_bytes).collect();
    let mut report = report(&flights, &words)?;
    report.estimator = Some(estimator::count(&images.estimator, &interrupt)?);
    report.link = Some(link::count(&images.link, &interrupt)?);
    let mut client = emulated::connect(&images.flying, Transport::Pipes, Equipment::default(), interrupt)?;
    report.stack_bytes = lock_step::fly_all(&mut client, Some(STACK_STEPS), &|| {})?.stack_bytes;
    report.flash_bytes = control_path.flash_bytes;
    report.flash_to_motors_bytes = image::size(&images.motor_path)?.flash_bytes;
    (report.ram_bytes, report.image_flash_bytes) = (flying.ram_bytes, flying.flash_bytes);
    Ok(report)
}

fn report(flights: &[Recorded], words: &[u32]) -> Result<InstructionReport, PilError> {
    let too_short = || PilError::Answer("it counted fewer steps than were flown".to_owned());
    let ([_, short, long], words) = words.split_first_chunk::<3>().ok_or_else(too_short)?;
    if long.wrapping_sub(*short) != LOOP_INSTRUCTIONS {
        return Err(PilError::Miscounts { counted: long.wrapping_sub(*short), instructions: LOOP_INSTRUCTIONS });
    }
    let (rows, _) = words.as_chunks::<10>();
    let mut rows = rows.iter();
    let mut law = BTreeMap::<String, Tally>::new();
    let [mut reference, mut turning, mut tick] = [Tally::NONE; 3];
    for (flight, controller, is_worst) in runs(flights) {
        let name = controller.map_or_else(|| worst_case::ANY_TABLE.to_owned(), |controller| controller.to_string());
        let law = law.entry(name.clone()).or_insert(Tally::NONE);
        let mut host = worst_case::Host::new(flight.course, controller)?;
        for (step, (state, recorded)) in flight.steps.iter().enumerate() {
            let [of_reference, least, sum, most, of_tick, t, p, q, r, hash] = *rows.next().ok_or_else(too_short)?;
            let found = [t, p, q, r];
            let is_same = if is_worst {
                turning.add([of_reference; 3], 1);
                law.add([least, sum, most], worst_case::CALLS);
                let expected = host.step(step as u32, state)?;
                hash == expected.hash && expected.command.is_none_or(|command| found == bits::words(&command))
            } else {
                reference.add([of_reference; 3], 1);
                law.add([least, sum, most], 1);
                found == bits::words(recorded)
            };
            if !is_same {
                return Err(PilError::Answer(format!("{name}, step {step}: another command than the host's")));
            }
            // The first one takes off: it looks at more, once.
            if controller.is_some() && step > 0 {
                tick.add([of_tick; 3], 1);
            }
        }
    }
    Ok(InstructionReport {
        law: law.into_iter().map(|(name, tally)| (name, tally.count())).collect(),
        reference: reference.count(),
        reference_turning: turning.count(),
        tick: tick.count(),
        estimator: None,
        link: None,
        steps: flights.iter().map(|flight| flight.steps.len()).sum(),
        flash_bytes: 0,
        flash_to_motors_bytes: 0,
        ram_bytes: 0,
        stack_bytes: 0,
        image_flash_bytes: 0,
    })
}
