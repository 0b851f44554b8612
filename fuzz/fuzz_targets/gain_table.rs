//! Any bytes into the gain table loader, as they are and with the checksum that belongs to them: a table that comes out
//! writes the same bytes again, and flies.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quatrack::cascade::CascadeLimits;
use quatrack::checksum::crc32c;
use quatrack::gains::table::{FORMAT_VERSION, GainTable, MAGIC, TABLE_BYTES_MAX, TableKind};
use quatrack::nalgebra::Vector3;
use quatrack::{
    Actuation, Airframe, Cascade, FeedForward, FifthOrderSample, Heading, Limits, Memory, Output, Progress, Reference,
    RigidState, Settings, State, Target,
};

/// A sound frame around a payload, so that the search is not for a checksum.
fn framed(payload: &[u8]) -> Option<Vec<u8>> {
    let length = u16::try_from(payload.len()).ok()?;
    let mut bytes = [&MAGIC[..], &FORMAT_VERSION.to_le_bytes(), &length.to_le_bytes(), payload].concat();
    bytes.extend(crc32c(&bytes).to_le_bytes());
    Some(bytes)
}

/// Any sound table holds a hover, at any time of any trajectory; one of the cascade keeps to the range of the motors.
fn load(bytes: &[u8]) {
    let Ok(table) = GainTable::from_bytes(bytes) else { return };
    assert_eq!(table.to_bytes(&mut [0; TABLE_BYTES_MAX]), Some(bytes), "one table has one encoding");
    assert_eq!(TableKind::of(bytes), Ok(table.kind()));
    assert_ne!(table.kind(), TableKind::ActuatorAware, "no board flies it");
    let (vehicle, rate) = (table.head().vehicle, table.head().rate);
    let Ok(accepted) = table.accept_for(&vehicle, rate) else { panic!("refused by the board that it names") };
    let airframe = Airframe::CRAZYFLIE_2_1;
    let Ok(board) = Actuation::new(&airframe, rate) else { return };
    let actuation = accepted.actuation(&board);
    let flown = table.cascade().map(|of| of.flown(&airframe, rate, &CascadeLimits::STANDARD, &of.air));
    let cascade: Option<Cascade> = match flown.transpose() {
        Ok(cascade) => cascade,
        Err(_) => return,
    };
    let settings = Settings {
        actuation: Some(&actuation),
        cascade: cascade.as_ref(),
        feed_forward: FeedForward::With,
        ..Settings::new(Limits::NONE, rate)
    };
    let Ok(controller) = accepted.controller(&settings) else { panic!("no controller of a sound table") };
    let at = Vector3::new(0.0, 0.0, 1.0);
    let Ok(reference) = Reference::hover(at, 0.0) else { panic!("hover is a reference") };
    let sample = FifthOrderSample::at_rest(at, 0.0);
    let state = RigidState { state: State::at_rest(at), body_rates_rad_s: Vector3::zeros() };
    let trajectory = table.schedule().map_or(0, |schedule| schedule.trajectory());
    let mut memory = Memory::hovering(&airframe);
    for tick in [0, 1, 1000, 1 << 20, u32::MAX] {
        let target = Target::new(&reference).and_sample(&sample, Heading::ZERO);
        match controller.step(&mut memory, (&state).into(), target.at(Some(Progress { trajectory, tick }))) {
            Ok(Output::Command(step)) => assert_eq!(step.command, *reference.input(), "holds a hover"),
            Ok(Output::Forces(step)) => {
                let figures = airframe.figures();
                let range = figures.force_min_n..=figures.force_max_n;
                assert!(step.forces_n.iter().all(|force| range.contains(force)), "{:?}", step.forces_n);
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
