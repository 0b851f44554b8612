//! The image on the emulated board: every bit, twice the same, and the causes that end a flight.

use std::path::PathBuf;
use std::process::Stdio;
use std::sync::OnceLock;

use quatrack::State;
use quatrack::link::{
    FromBoard, LawChoice, NoCommand, Parameter, ParameterId, Table, ToBoard, TrajectoryCommand, TrajectoryId,
};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{Mode, Reason};
use quatrack_cli::pil::client::Client;
use quatrack_cli::pil::emulated::{self, Equipment, Transport};
use quatrack_cli::pil::image::{self, Image};
use quatrack_cli::pil::interrupt::Interrupt;
use quatrack_cli::pil::lock_step::fly_all;
use rustix::process::{Pid, Signal, kill_process};

use super::support::{Scratch, emulators, failure, has_emulator};

/// The image, built once.
pub(crate) fn pipes_image() -> PathBuf {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    IMAGE.get_or_init(|| image::build(&image::checkout().unwrap(), Image::Pipes).unwrap()).clone()
}

pub(crate) fn connected() -> Client {
    emulated::connect(&pipes_image(), Transport::Pipes, Equipment::default(), Interrupt::default()).unwrap()
}

/// A board in flight: armed, one state answered with a command.
fn flying() -> Client {
    let mut client = connected();
    client.set(Parameter::Decimation(0)).unwrap();
    client.set(Parameter::StateAgeMaxTicks(1)).unwrap();
    client.set(Parameter::LinkSilenceMaxTicks(3)).unwrap();
    client.request(&ToBoard::SelectLaw(LawChoice::new(Table::LqrE))).unwrap();
    client.request(&ToBoard::Trajectory(TrajectoryCommand::Start(TrajectoryId::Mild))).unwrap();
    client.request(&ToBoard::Arm).unwrap();
    assert!(client.step(0, &at_rest()).unwrap().result.is_ok(), "the first state of a flight has a command");
    client
}

fn at_rest() -> State {
    State::at_rest(Vector3::new(0.0, 0.0, 0.0))
}

#[test]
fn commands_have_the_bits_of_the_host_and_the_same_hash_on_every_run() {
    if !has_emulator() {
        return;
    }
    let fly = || fly_all(&mut connected(), Some(800), &|| {}).unwrap();
    let (first, second) = (fly(), fly());
    assert_eq!(first.difference, None);
    assert!(first.bit_exact);
    assert_eq!((first.steps + first.motors.steps, first.overruns), (800, 0));
    assert_eq!(first.hash, second.hash);
    assert_eq!(first.motors.difference, None);
    assert_eq!(first.motors.hash, second.motors.hash);
}

#[test]
fn a_state_that_gets_too_old_ends_the_flight() {
    if !has_emulator() {
        return;
    }
    let mut client = flying();
    // The emulated clock runs while the board works: every answer takes some of its time.
    let ended = (0..200).map(|_| client.telemetry().unwrap().mode).find(|mode| !mode.motors_allowed());
    assert_eq!(ended, Some(Mode::Stopped(Reason::StateLost)));
    let refused = client.step(2, &at_rest()).unwrap().result;
    assert_eq!(refused, Err(NoCommand::Mode(Mode::Stopped(Reason::StateLost))), "and it stays ended");
}

#[test]
fn noise_is_no_sign_of_life() {
    if !has_emulator() {
        return;
    }
    let mut client = connected();
    client.set(Parameter::Decimation(0)).unwrap();
    client.set(Parameter::LinkSilenceMaxTicks(2)).unwrap();
    client.request(&ToBoard::Arm).unwrap();
    let noise: Vec<u8> = (0..400_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    client.noise(&noise).unwrap();
    let telemetry = client.telemetry().unwrap();
    assert_eq!(telemetry.mode, Mode::Stopped(Reason::LinkLost));
    assert!(telemetry.link.rejected() > 1000, "every piece of it has been rejected and counted");
    assert_eq!(client.step(0, &at_rest()).unwrap().result.ok(), None);
}

#[test]
fn a_trajectory_is_started_paused_and_stopped_by_command() {
    if !has_emulator() {
        return;
    }
    let mut client = flying();
    client.set(Parameter::TelemetryPeriodTicks(0)).unwrap();
    let mut next = {
        let mut tick = 0;
        move |client: &mut Client| {
            tick += 2;
            client.step(tick, &at_rest()).unwrap().result
        }
    };
    client.request(&ToBoard::Trajectory(TrajectoryCommand::Pause)).unwrap();
    let (paused, again) = (next(&mut client), next(&mut client));
    assert!(paused.is_ok() && paused == again, "the same state before the same rest: {paused:?}, {again:?}");
    client.request(&ToBoard::Trajectory(TrajectoryCommand::Resume)).unwrap();
    assert!(next(&mut client).is_ok());
    client.request(&ToBoard::Trajectory(TrajectoryCommand::Stop)).unwrap();
    let stopped = Mode::Stopped(Reason::NoReference);
    assert_eq!(next(&mut client), Err(NoCommand::Mode(stopped)));
    assert_eq!(client.telemetry().unwrap().mode, stopped);
    assert!(client.request(&ToBoard::Trajectory(TrajectoryCommand::Resume)).is_err(), "there is nothing to resume");
}

#[test]
fn parameters_are_told_and_refused_in_flight() {
    if !has_emulator() {
        return;
    }
    let mut client = flying();
    let told = client.ask(&ToBoard::GetParameter(ParameterId::StateAgeMaxTicks)).unwrap();
    assert_eq!(told, FromBoard::Parameter(Parameter::StateAgeMaxTicks(1)));
    assert!(client.set(Parameter::Decimation(2)).is_err(), "not while the motors may turn");
}

#[test]
fn an_emulator_killed_in_flight_is_noticed() {
    if !has_emulator() {
        return;
    }
    let scratch = Scratch::new("killed");
    let image = scratch.path().join("image");
    std::fs::copy(pipes_image(), &image).unwrap();
    let mut command = scratch.quatrack(&["pil", "--emulator", "--image", "image"]);
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let emulator = loop {
        match emulators(scratch.path()).first() {
            Some(emulator) => break *emulator,
            None => std::thread::yield_now(),
        }
    };
    kill_process(Pid::from_raw(emulator).unwrap(), Signal::KILL).unwrap();
    let (code, text) = failure(&child.wait_with_output().unwrap());
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("the emulator ended with signal: 9"), "{text}");
    scratch.assert_clean();
}
