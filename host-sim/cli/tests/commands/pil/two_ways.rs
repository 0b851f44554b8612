//! The two ways to fly beside the trajectories in flash: one that came over the link, and a reference beside each state.

use quatrack::link::{
    BlobKind, FromBoard, LawChoice, LimitsSetting, Parameter, Progress, StateIn, TRAJECTORY_BLOB_BYTES, Table, ToBoard,
    TrajectoryCommand, TrajectoryId, UploadBegin, encode_trajectory,
};
use quatrack::nalgebra::Vector3;
use quatrack::{Controller, FlatSample, Limits, Memory, Player, Rate, Reference, State, Step, Trajectory};
use quatrack_cli::pil::client::Client;
use quatrack_plan::plan::paper::PaperTrajectory;
use quatrack_plan::plan::stored;

use super::emulated::connected;
use super::support::has_emulator;

/// Ticks a second of the board, and between two states.
const TICK_HZ: u32 = 1000;
const TICKS_PER_STEP: u32 = 2;

/// A connected board that steps when a state comes, with limits that the host's controller has too.
fn ready() -> (Client, Controller<'static>) {
    let mut client = connected();
    client.set(Parameter::Decimation(0)).unwrap();
    client.set(Parameter::StateAgeMaxTicks(10_000)).unwrap();
    client.set(Parameter::LinkSilenceMaxTicks(10_000)).unwrap();
    let limits = LimitsSetting { thrust_min_m_s2: 0.0, thrust_max_m_s2: 16.5, body_rates_max_rad_s: [20.0; 3] };
    client.set(Parameter::Limits(limits)).unwrap();
    let law = LawChoice::new(Table::LqrE);
    client.request(&ToBoard::SelectLaw(law)).unwrap();
    let controller =
        Controller::new(law.built_in().unwrap(), Limits::new(0.0, 16.5, Vector3::new(20.0, 20.0, 20.0)).unwrap());
    (client, controller)
}

/// The command of a law that remembers nothing.
fn expected(controller: &Controller<'_>, state: &State, reference: &Reference) -> Step {
    let output = controller.step(&mut Memory::at_rest(), state.into(), reference.into()).unwrap();
    *output.command().expect("it gives a command")
}

/// Two centimetres beside a reference, and moving.
fn near(reference: &Reference) -> State {
    let mut state = *reference.state();
    state.position_m += Vector3::new(0.02, -0.01, 0.005);
    state.velocity_m_s += Vector3::new(-0.1, 0.05, 0.02);
    state
}

fn progress(client: &mut Client, message: &ToBoard) -> Progress {
    match client.ask(message).unwrap() {
        FromBoard::Upload(progress) => progress,
        other => panic!("{message:?} is answered by {other:?}"),
    }
}

#[test]
fn an_uploaded_trajectory_flies_bit_for_bit() {
    if !has_emulator() {
        return;
    }
    let (mut client, controller) = ready();
    let start = ToBoard::Trajectory(TrajectoryCommand::Start(TrajectoryId::Uploaded));
    assert!(client.request(&start).is_err(), "there is nothing to fly yet");

    let pieces = stored::pieces(PaperTrajectory::Aggressive);
    let mut buffer = [0; TRAJECTORY_BLOB_BYTES];
    let blob = encode_trajectory(pieces, &mut buffer).unwrap();
    let begin = UploadBegin::of(BlobKind::Trajectory, 7, blob).unwrap();
    let mut wanted = progress(&mut client, &ToBoard::UploadBegin(begin));
    let mut chunks = 0;
    while let Some(chunk) = wanted.next_chunk(blob) {
        // Half-way the host forgets where it was and asks.
        if chunks == 20 {
            wanted = progress(&mut client, &ToBoard::UploadQuery);
            assert_eq!(wanted.wanted_offset, chunk.offset);
            assert!(client.request(&ToBoard::UploadCommit { id: 7 }).is_err(), "half a trajectory is none");
        }
        wanted = progress(&mut client, &ToBoard::UploadChunk(chunk));
        chunks += 1;
    }
    assert!(chunks > 40, "5 kB take more than {chunks} chunks");
    client.request(&ToBoard::UploadCommit { id: 7 }).unwrap();
    client.request(&start).unwrap();
    client.request(&ToBoard::Arm).unwrap();

    let mut player = Player::new(Trajectory::new(pieces).unwrap(), Rate::from_hz(TICK_HZ).unwrap());
    for step in 0..1000 {
        let tick = step * TICKS_PER_STEP;
        let reference = player.reference(tick).unwrap();
        let state = near(&reference);
        let found = client.step(tick, &state).unwrap().result;
        assert_eq!(found, Ok(expected(&controller, &state, &reference)), "step {step}");
    }
}

#[test]
fn a_reference_beside_each_state_flies_bit_for_bit() {
    if !has_emulator() {
        return;
    }
    let (mut client, controller) = ready();
    let sample = |step: u32| {
        let t = step as f32 * 0.002;
        FlatSample {
            position_m: Vector3::new(0.5 * t, 0.0, 1.0),
            velocity_m_s: Vector3::new(0.5, 0.0, 0.0),
            // Turning all the while: the heading's sine and cosine are the board's own.
            ..FlatSample { heading_rate_rad_s: 1.0, ..FlatSample::at_rest(Vector3::zeros(), t) }
        }
    };
    let step_with = |client: &mut Client, step: u32| {
        let reference = Reference::from_flat(&sample(step)).unwrap();
        let tick = step * TICKS_PER_STEP;
        let state = near(&reference);
        let message = ToBoard::StateAndReference(StateIn { tick, state }, sample(step));
        let found = match client.ask(&message).unwrap() {
            FromBoard::Command(command) => command.result,
            other => panic!("a state is answered by {other:?}"),
        };
        (found, expected(&controller, &state, &reference))
    };
    // The first one is not flown: there was no reference to arm with.
    assert!(step_with(&mut client, 0).0.is_err());
    client.request(&ToBoard::Arm).unwrap();
    for step in 1..500 {
        let (found, wanted) = step_with(&mut client, step);
        assert_eq!(found, Ok(wanted), "step {step}");
    }
}
