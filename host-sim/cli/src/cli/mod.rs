//! The command line: one module a command, each with its `Args` and a `run`.

mod analyze;
mod campaign;
mod compare;
mod crazyflie;
mod export;
mod faults;
mod fly;
mod gains;
mod identify;
mod key_file;
mod keys;
mod limits;
mod manoeuvres;
mod measure;
mod names;
mod output;
mod picture;
mod pil;
mod plan;
mod refit;
mod report;
mod reproduce;
mod robustness;
mod scenario;
mod shell;
mod transform;
mod vehicle;

use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use quatrack_plan::quote::plain;

/// Why a command stops: one line for the user and the exit code.
#[derive(Debug)]
pub(crate) struct Failure {
    exit_code: u8,
    line: String,
}

impl Failure {
    /// Names of files and their words may hold characters that a terminal obeys: they are written as numbers.
    fn of(exit_code: u8, reason: &dyn std::fmt::Display) -> Self {
        let lines: Vec<String> = reason.to_string().split('\n').map(plain).collect();
        Self { exit_code, line: lines.join("\n") }
    }

    /// The input cannot be used: exit code 2.
    pub(crate) fn input(reason: impl std::fmt::Display) -> Self {
        Self::of(2, &reason)
    }

    /// The question was answered with no: exit code 1.
    pub(crate) fn verdict(reason: impl std::fmt::Display) -> Self {
        Self::of(1, &reason)
    }

    /// The craft was lost: exit code 3.
    pub(crate) fn lost(reason: impl std::fmt::Display) -> Self {
        Self::of(3, &reason)
    }
}

/// Trajectory tracking with a quaternion-based quadcopter model: design, plan, fly, and reproduce the paper.
#[derive(Parser)]
#[command(name = "quatrack", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
#[allow(clippy::large_enum_variant, reason = "there is one, for the length of the program")]
enum Command {
    Analyze(analyze::Args),
    Campaign(campaign::Args),
    Compare(compare::Args),
    Completions(shell::CompletionArgs),
    Crazyflie(crazyflie::Args),
    Export(export::Args),
    Faults(faults::Args),
    Fly(fly::Args),
    Gains(gains::Args),
    Identify(identify::Args),
    Keys(keys::Args),
    Man(shell::ManArgs),
    Manoeuvres(manoeuvres::Args),
    Measure(measure::Args),
    Pil(pil::Args),
    Plan(plan::Args),
    Refit(refit::Args),
    Report(report::Args),
    Reproduce(reproduce::Args),
    Robustness(robustness::Args),
}

/// Reads the arguments, runs the command, prints an error in one line.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return output::argument_error(&error),
    };
    let outcome: Result<(), Failure> = match &arguments.command {
        Command::Analyze(args) => analyze::run(args),
        Command::Campaign(args) => campaign::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Completions(args) => shell::completions(args),
        Command::Crazyflie(args) => crazyflie::run(args),
        Command::Export(args) => export::run(args),
        Command::Faults(args) => faults::run(args),
        Command::Fly(args) => fly::run(args),
        Command::Gains(args) => gains::run(args),
        Command::Identify(args) => identify::run(args),
        Command::Keys(args) => keys::run(args),
        Command::Man(args) => shell::man(args),
        Command::Manoeuvres(args) => manoeuvres::run(args),
        Command::Measure(args) => measure::run(args),
        Command::Pil(args) => pil::run(args),
        Command::Plan(args) => plan::run(args),
        Command::Refit(args) => refit::run(args),
        Command::Report(args) => report::run(args),
        Command::Reproduce(args) => reproduce::run(args),
        Command::Robustness(args) => robustness::run(args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // Nobody may be listening, which is no failure of the command.
            let _ = writeln!(io::stderr(), "quatrack: {}", failure.line);
            ExitCode::from(failure.exit_code)
        }
    }
}
