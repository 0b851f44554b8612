//! The symbols of the object: what the firmware calls, what our app calls, and the variables behind its parameters.
//!
//! Everything takes C pointers that are never null as references. The stabilizer task calls the `controller` functions,
//! the app's task the others; they meet in cells that turn the second visitor away.
#![allow(unsafe_code, reason = "names for the linker; nothing below them is unsafe")]
#![allow(non_upper_case_globals, non_snake_case, reason = "names of C")]

use core::sync::atomic::Ordering::Relaxed;

use quatrack::gains::table::AcceptedTable;
use quatrack::gains::table::Vehicle;

use crate::abi::{Control, SensorData, Setpoint, State};
use crate::craft::{Craft, DECIMATION, Platform};
use crate::cycles;
use crate::service::{self, Service};
use crate::shared::Shared;
use crate::tables::Refusal;
use crate::try_cell::TryCell;
use crate::upload::{Packet, Status, Uploads};

/// Parameters and log variables; `quatrack.h` has the same struct.
#[unsafe(no_mangle)]
pub static quatrack: Shared = Shared::new();

static SERVICE: TryCell<Service> = TryCell::new(Service::new());
static UPLOADS: TryCell<(Uploads, Option<Vehicle>)> = TryCell::new((Uploads::new(), None));
static CRAFT: TryCell<Option<Craft>> = TryCell::new(None);
static TABLE: TryCell<Option<AcceptedTable>> = TryCell::new(None);

/// The firmware selects this controller: what it remembers of an earlier flight no longer holds.
#[unsafe(no_mangle)]
pub extern "C" fn controllerOutOfTreeInit() {
    SERVICE.with(Service::restart);
}

/// Whether the controller can be selected: always. Without a known craft it keeps the motors off.
#[unsafe(no_mangle)]
pub extern "C" fn controllerOutOfTreeTest() -> bool {
    true
}

/// One step of the stabilizer at 1 kHz; leaves `control` as it is between control steps.
#[unsafe(no_mangle)]
pub extern "C" fn controllerOutOfTree(
    control: &mut Control,
    setpoint: &Setpoint,
    sensors: &SensorData,
    state: &State,
    step: u32,
) {
    let begun = cycles::now();
    let output = SERVICE.with(|service| {
        if step % DECIMATION != 0 {
            take_what_the_app_has(service);
        }
        service.step(&quatrack, setpoint, sensors, state, step)
    });
    if let Some(Some(output)) = output {
        *control = output;
        quatrack.log.cycles.store(cycles::since(begun), Relaxed);
    }
}

/// The app says which craft the firmware was built for. Starts the controller anew, motors off.
///
/// Returns whether there are tables for it.
#[unsafe(no_mangle)]
pub extern "C" fn quatrackPlatform(platform: &Platform) -> bool {
    let Some(craft) = Craft::of(platform) else { return false };
    let told = UPLOADS.with(|(_, vehicle)| *vehicle = Some(craft.vehicle));
    told.is_some() && CRAFT.with(|place| *place = Some(craft)).is_some()
}

/// The app passes a packet of the app channel and gets the answer to send back.
#[unsafe(no_mangle)]
pub extern "C" fn quatrackPacket(packet: &Packet, answer: &mut Packet) {
    let busy = |uploads: &Uploads| uploads.answer(packet.bytes[0], Status::Busy);
    let taken = UPLOADS.with(|(uploads, vehicle)| {
        let Some(vehicle) = vehicle else { return busy(uploads) };
        let (answer, table) = uploads.take(packet, vehicle);
        match table {
            Some(table) if TABLE.with(|place| *place = Some(table)).is_none() => busy(uploads),
            None if answer.bytes[1] >= Status::Table as u8 => {
                service::refuse(&quatrack, Refusal::Table);
                answer
            }
            _ => answer,
        }
    });
    *answer = taken.unwrap_or(Packet { length: 0, ..*packet });
}

/// A craft or a table that the app's task has put down.
#[inline]
fn take_what_the_app_has(service: &mut Service) {
    if let Some(Some(craft)) = CRAFT.with(Option::take) {
        service.start(&craft, &quatrack);
    }
    if let Some(Some(table)) = TABLE.with(Option::take) {
        service.upload(&table);
    }
}
