//! Instructions a step of the controller's object on the emulated target: flights of the host in; counts, and whether
//! every bit that it put out is the host's, out.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use quatrack::checksum::crc32c;
use quatrack_simulation::crazyflie::{
    CONTROL_BYTES, Case, Course, Recorded, Recording, Sensors, Setpoints, Tune, fly_recorded, platform,
};
use quatrack_simulation::vehicles;
use serde::Serialize;

use super::PilError;
use super::emulator::{Emulator, Folder};
use super::image::TARGET;
use super::interrupt::Interrupt;
use super::measure::Count;

/// Longest time for the emulator to count all flights.
const LIMIT: Duration = Duration::from_secs(120);

/// Instructions between the two loops with which the image checks its counter.
const LOOP_INSTRUCTIONS: u32 = 2000;

/// Steps of each flight that are counted.
const STEPS: u32 = 3000;

/// The first step that counts: before it the craft is switched on and put on its course.
const FIRST_STEP: u32 = 200;

/// The tables that are counted, with the motors' lag (s) at which they fly.
const TABLES: [(&str, u8, f64); 5] =
    [("cascade", 0, 0.1), ("lyap-e", 1, 0.02), ("lqr-e", 2, 0.02), ("lyap-f", 3, 0.005), ("lqr-f", 4, 0.005)];

/// The forms of setpoints.
const SETPOINTS: [(Setpoints, &str); 4] = [
    (Setpoints::HighLevel, "high-level"),
    (Setpoints::HighLevelTurning, "high-level, turning"),
    (Setpoints::FullState, "full-state"),
    (Setpoints::FullStateTurning, "full-state, turning"),
];

/// Name and tables of a change of the table in flight: LQR-E to the default one for motors of 20 ms.
const CHANGE: &str = "a change";
const CHANGED: [u8; 2] = [2, 0];

/// Of one table under one kind of setpoint.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The table.
    pub table: &'static str,
    /// The kind of setpoint.
    pub setpoints: &'static str,
    /// Of the control steps, every other one of the firmware's.
    pub control_step: Count,
    /// Of the steps between, in which observers, logs and parameters are seen to.
    pub other_step: Count,
}

/// All of it.
#[derive(Clone, Debug, Serialize)]
pub struct Counts {
    /// A row for every table and kind of setpoint.
    pub rows: Vec<Row>,
    /// Steps counted, on each of which the target put out the host's bits.
    pub steps: usize,
    /// Most stack of a call, bytes.
    pub stack_bytes: u32,
}

/// Builds the object as it is shipped, links it into the counting image and counts.
///
/// # Errors
/// [`PilError`].
pub fn count(checkout: &Path) -> Result<Counts, PilError> {
    let object = build_object(checkout)?;
    let image = build_image(checkout, &object)?;
    let interrupt = Interrupt::listen()?;
    let vehicle = vehicles::by_name("crazyflie-2.1").map_err(|error| PilError::Plan(error.to_string()))?;
    let mut flights = Vec::new();
    let sensors = Sensors { gyro_noise_rad_s: 0.02, estimate_steps: 1 };
    for (table, number, lag_s) in TABLES {
        for (setpoints, name) in SETPOINTS {
            let tune = Tune::new(number, if number == 0 { 0.0 } else { lag_s });
            let case = Case { sensors, setpoints, ..Case::of_lag(lag_s) };
            let course = Course::FigureEight(if number < 3 { 1.485 } else { 0.601 });
            let recording = fly_recorded(&vehicle, &course, &tune, &case, Recorded { steps: STEPS, then: None });
            flights.push((table, name, tune, recording));
        }
    }
    let ([from, to], (setpoints, name)) = (CHANGED, SETPOINTS[1]);
    let tune = Tune::new(from, 0.02);
    let case = Case { sensors, setpoints, ..Case::of_lag(tune.motor_lag_s) };
    let recorded = Recorded { steps: STEPS, then: Some(to) };
    flights.push((CHANGE, name, tune, fly_recorded(&vehicle, &Course::FigureEight(1.485), &tune, &case, recorded)));
    let folder = Folder::create()?;
    let mut calls = Vec::new();
    for (_, _, tune, recording) in &flights {
        let p = platform(&vehicle);
        for value in [p.mass_kg, p.arm_m, p.thrust_max_n, p.torque_per_thrust_m] {
            calls.extend(value.to_le_bytes());
        }
        calls.extend(u32::from(tune.table).to_le_bytes());
        calls.extend((tune.motor_lag_s as f32).to_le_bytes());
        calls.extend((recording.steps.len() as u32).to_le_bytes());
        calls.extend(&recording.calls);
    }
    fs::write(folder.path().join("calls.bin"), calls).map_err(PilError::io("writing the recorded calls"))?;
    Emulator::start(&image, folder.path(), &["-serial", "none"])?.wait(LIMIT, &interrupt)?;
    let counted = fs::read(folder.path().join("counts.bin")).map_err(PilError::io("reading the counts"))?;
    compare(&flights, &counted)
}

fn compare(flights: &[(&'static str, &'static str, Tune, Recording)], counted: &[u8]) -> Result<Counts, PilError> {
    let too_short = || PilError::Answer("it counted fewer steps than were flown".to_owned());
    let (head, rest) = counted.split_first_chunk::<12>().ok_or_else(too_short)?;
    let word =
        |bytes: &[u8], at: usize| bytes.get(at..at + 4).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let of_loops = word(head, 8).wrapping_sub(word(head, 4));
    if of_loops != LOOP_INSTRUCTIONS {
        return Err(PilError::Miscounts { counted: of_loops, instructions: LOOP_INSTRUCTIONS });
    }
    let (records, end) = rest.as_chunks::<{ 4 + CONTROL_BYTES }>();
    let mut records = records.iter();
    let (mut rows, mut steps) = (Vec::new(), 0);
    for (table, setpoints, _, recording) in flights {
        let (mut control_steps, mut others) = (Vec::new(), Vec::new());
        for (step, wanted) in recording.steps.iter().zip(&recording.controls) {
            let record = records.next().ok_or_else(too_short)?;
            // The three bytes behind the mode are padding.
            if record[4..21] != wanted[..17] {
                return Err(PilError::Answer(format!(
                    "{table}, {setpoints}, step {step}: another control than the host's"
                )));
            }
            steps += 1;
            if *step < FIRST_STEP {
                continue;
            }
            let counts = if step.is_multiple_of(2) { &mut control_steps } else { &mut others };
            counts.push(word(record, 0));
        }
        rows.push(Row { table, setpoints, control_step: of(&control_steps), other_step: of(&others) });
    }
    Ok(Counts { rows, steps, stack_bytes: word(end, 0) })
}

fn of(counts: &[u32]) -> Count {
    let sum: u64 = counts.iter().copied().map(u64::from).sum();
    Count {
        min: counts.iter().copied().min().unwrap_or_default(),
        mean: (sum as f64 / counts.len().max(1) as f64 * 100.0).round() / 100.0,
        max: counts.iter().copied().max().unwrap_or_default(),
    }
}

fn build_object(checkout: &Path) -> Result<PathBuf, PilError> {
    let object = checkout.join("target").join("quatrack-crazyflie.o");
    run(Command::new(checkout.join("crazyflie/build")).arg(&object).current_dir(checkout), "crazyflie/build")?;
    // Cargo links again only where an argument changes: the name has a hash of its contents.
    let bytes = fs::read(&object).map_err(PilError::io("reading the object"))?;
    let named = object.with_file_name(format!("quatrack-crazyflie-{:08x}.o", crc32c(&bytes)));
    fs::rename(&object, &named).map_err(PilError::io("naming the object"))?;
    Ok(named)
}

fn build_image(checkout: &Path, object: &Path) -> Result<PathBuf, PilError> {
    let name = "quatrack-measure-crazyflie";
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(checkout).args(["rustc", "--package", "quatrack-firmware", "--target", TARGET]);
    command.args(["--profile", "firmware", "--locked", "--bin", name, "--no-default-features"]);
    command.args(["--features", "semihosting,crazyflie-object", "--target-dir"]).arg(checkout.join("target"));
    command.arg("--").arg("-C").arg(format!("link-arg={}", object.display()));
    run(&mut command, name)?;
    Ok(checkout.join("target").join(TARGET).join("firmware").join(name))
}

fn run(command: &mut Command, name: &str) -> Result<(), PilError> {
    let status = command.status().map_err(PilError::io(format!("starting {name}")))?;
    if status.success() {
        return Ok(());
    }
    Err(PilError::Build { command: name.to_owned(), status: status.to_string() })
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "Instructions a call of the Crazyflie controller's object on the emulated Cortex-M4F, {} calls\n",
            self.steps
        )?;
        writeln!(f, "{:<37}{:^26}{:^26}", "", "control step (500 Hz)", "between (500 Hz)")?;
        writeln!(
            f,
            "{:<16}{:<21}{:>8}{:>10}{:>8}{:>8}{:>10}{:>8}",
            "table", "setpoints", "min", "mean", "max", "min", "mean", "max"
        )?;
        for Row { table, setpoints, control_step: c, other_step: o } in &self.rows {
            write!(f, "{table:<16}{setpoints:<21}{:>8}{:>10.1}{:>8}", c.min, c.mean, c.max)?;
            writeln!(f, "{:>8}{:>10.1}{:>8}", o.min, o.mean, o.max)?;
        }
        writeln!(f, "\nstack of a call, most: {} bytes", self.stack_bytes)
    }
}
