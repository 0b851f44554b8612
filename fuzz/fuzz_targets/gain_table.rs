//! Any bytes into the gain table loader, as they are and with the checksum that belongs to them: a table that comes out
//! writes the same bytes again, and flies.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quatrack::checksum::crc32c;
use quatrack::gains::table::{FORMAT_VERSION, GainTable, MAGIC, TABLE_BYTES_MAX, TableKind};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Actuation, Airframe, FeedForward, Limits, Memory, MotorReference, Output, Progress, RigidState, Settings, State,
    Target,
};

/// A sound frame around a payload, so that the search is not for a checksum.
fn framed(payload: &[u8]) -> Option<Vec<u8>> {
    let length = u16::try_from(payload.len()).ok()?;
    let mut bytes = [&MAGIC[..], &FORMAT_VERSION.to_le_bytes(), &length.to_le_bytes(), payload].concat();
    bytes.extend(crc32c(&bytes).to_le_bytes());
    Some(bytes)
}

/// Any sound table holds a hover, at any time of any trajectory.
fn load(bytes: &[u8]) {
    let Ok(table) = GainTable::from_bytes(bytes) else { return };
    assert_eq!(table.to_bytes(&mut [0; TABLE_BYTES_MAX]), Some(bytes), "one table has one encoding");
    assert_eq!(TableKind::of(bytes), Ok(table.kind()));
    let (vehicle, rate) = (table.head().vehicle, table.head().rate);
    let Ok(accepted) = table.accept_for(&vehicle, rate) else { panic!("refused by the board that it names") };
    let Ok(board) = Actuation::new(&Airframe::CRAZYFLIE_2_1, rate) else { return };
    let actuation = accepted.actuation(&board);
    let settings = Settings {
        actuation: Some(&actuation),
        feed_forward: FeedForward::With,
        ..Settings::new(Limits::NONE, rate)
    };
    let Ok(controller) = accepted.controller(&settings) else { panic!("no controller of a sound table") };
    let at = Vector3::new(0.0, 0.0, 1.0);
    let Ok(reference) = MotorReference::hover(at, 0.0, actuation.airframe()) else { panic!("hover is a reference") };
    let state = RigidState { state: State::at_rest(at), body_rates_rad_s: Vector3::zeros() };
    let trajectory = table.schedule().map_or(0, |schedule| schedule.trajectory());
    for tick in [0, 1, 1000, 1 << 20, u32::MAX] {
        let target = Target::with_forces(&reference).at(Some(Progress { trajectory, tick }));
        match controller.step(&mut Memory::hovering(actuation.airframe()), (&state).into(), target) {
            Ok(Output::Command(step)) => assert_eq!(step.command, *reference.reference().input(), "holds a hover"),
            Ok(Output::Forces(step)) => {
                assert_eq!(step.forces_n, [actuation.airframe().hover_force_n(); 4], "holds a hover");
            }
            Err(error) => panic!("{error}"),
        }
    }
}

fuzz_target!(|bytes: &[u8]| {
    load(bytes);
    if let Some(bytes) = framed(bytes) {
        load(&bytes);
    }
});
