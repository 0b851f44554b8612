//! Any bytes into the gain table loader, as they are and with the checksum that belongs to them: what comes out writes
//! the same bytes again, and flies.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quatrack::checksum::crc32c;
use quatrack::gains::table::{
    ACTUATOR_TABLE_BYTES, ActuatorTable, GainTable, MAGIC, SCHEDULE_BYTES_MAX, ScheduleRows, ScheduleTable,
    TABLE_BYTES_MAX, TableKind,
};
use quatrack::nalgebra::Vector3;
use quatrack::{ActuatorMemory, Airframe, MotorLaw, MotorReference, MotorTracker, RigidState};
use quatrack::{Controller, ErrorForm, FeedForward, FlightLaw, Limits, Memory, Progress, Reference, State};

/// A sound frame around a payload, so that the search is not for a checksum.
fn framed(payload: &[u8]) -> Option<Vec<u8>> {
    let length = u16::try_from(payload.len()).ok()?;
    let mut bytes = [&MAGIC[..], &[1, 0], &length.to_le_bytes(), payload].concat();
    bytes.extend(crc32c(&bytes).to_le_bytes());
    Some(bytes)
}

/// Any sound table holds a hover, at any time of any trajectory.
fn hover<'a>(law: impl Into<FlightLaw<'a>>, limits: Limits, progress: Option<Progress>) {
    let Ok(reference) = Reference::hover(Vector3::new(0.0, 0.0, 1.0), 0.0) else { panic!("hover is a reference") };
    let state = State::at_rest(Vector3::new(0.0, 0.0, 1.0));
    let step = Controller::new(law, limits).step(&mut Memory::new(), progress, &state, &reference);
    assert!(step.is_ok_and(|step| step.command == *reference.input()), "holds a hover");
}

fn load(bytes: &[u8]) {
    match GainTable::from_bytes(bytes) {
        Ok(table) => {
            assert_eq!(table.to_bytes(&mut [0; TABLE_BYTES_MAX]), Some(bytes), "one table has one encoding");
            assert_eq!(TableKind::of(bytes), Ok(table.kind()));
            let (vehicle, rate) = (table.head().vehicle, table.head().rate);
            let Ok(table) = table.accept_for(&vehicle, rate) else { panic!("refused by the board that it names") };
            hover(table.law(FeedForward::With, ErrorForm::HeadingFrame), table.limits(), None);
        }
        Err(_) => load_schedule(bytes),
    }
}

fn load_schedule(bytes: &[u8]) {
    let Ok(table) = ScheduleTable::from_bytes(bytes) else { return load_actuator(bytes) };
    let (head, schedule) = (*table.head(), *table.schedule());
    let gains: Vec<_> = (0..).map_while(|knot| schedule.gain(knot)).collect();
    let (trajectory, steps_per_knot) = (schedule.trajectory(), schedule.steps_per_knot());
    let rows = ScheduleRows { trajectory, steps_per_knot, gains: &gains };
    let mut buffer = [0; SCHEDULE_BYTES_MAX];
    let again = ScheduleTable::write(&mut buffer, &head, &rows);
    assert_eq!(again.map(|table| table.bytes()), Ok(bytes), "one table has one encoding");
    let Ok(table) = table.accept_for(&head.vehicle, head.rate) else { panic!("refused by the board that it names") };
    for tick in [0, 1, u32::from(steps_per_knot), 1 << 20, u32::MAX] {
        let law = table.law(head.rate, FeedForward::With);
        hover(law, table.limits(), Some(Progress { trajectory, tick }));
    }
}

fn load_actuator(bytes: &[u8]) {
    let Ok(table) = ActuatorTable::from_bytes(bytes) else { return };
    assert_eq!(table.to_bytes(&mut [0; ACTUATOR_TABLE_BYTES]), Some(bytes), "one table has one encoding");
    let (vehicle, rate) = (table.head().vehicle, table.head().rate);
    let Ok(table) = table.accept_for(&vehicle, rate) else { panic!("refused by the board that it names") };
    let airframe = table.airframe(&Airframe::CRAZYFLIE_2_1);
    let tracker = MotorTracker::new(MotorLaw::ActuatorAware(table.law(&airframe)), &airframe);
    let at = Vector3::new(0.0, 0.0, 1.0);
    let Ok(reference) = MotorReference::hover(at, 0.0, &airframe) else { panic!("hover is a reference") };
    let state = RigidState { state: State::at_rest(at), body_rates_rad_s: Vector3::zeros() };
    let step = tracker.step(&mut ActuatorMemory::hovering(&airframe), &state, &reference);
    assert!(step.is_ok_and(|step| step.forces_n == [airframe.hover_force_n(); 4]), "holds a hover");
}

fuzz_target!(|bytes: &[u8]| {
    load(bytes);
    if let Some(bytes) = framed(bytes) {
        load(&bytes);
    }
});
