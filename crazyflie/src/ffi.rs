//! The symbols of the object: the functions that the firmware and our app call, and the variables behind the app's
//! parameters.
//!
//! Everything takes C pointers that are never null as references. The stabilizer task calls the `controller` functions,
//! the app's task the others; they meet in cells that turn the second visitor away.
#![allow(unsafe_code, reason = "names for the linker; nothing below them is unsafe")]
#![allow(non_upper_case_globals, non_snake_case, reason = "names of C")]

use core::ffi::{CStr, c_char};
use core::ptr;
use core::sync::atomic::Ordering::Relaxed;

use crate::abi::{Control, SensorData, Setpoint, State};
use crate::control::{self, Controller, Work};
use crate::craft::Platform;
use crate::cycles;
use crate::own_craft::OwnCraft;
use crate::service::{self, Handover, Service};
use crate::shared::Shared;
use crate::try_cell::TryCell;
use crate::units;
use crate::upload::Packet;

/// Parameters and log variables; `quatrack.h` has the same struct.
#[unsafe(no_mangle)]
pub static quatrack: Shared = Shared::new();

/// The stabilizer task's.
static CONTROLLER: TryCell<Controller> = TryCell::new(control::CONTROLLER);
/// The app task's.
static SERVICE: TryCell<Service> = TryCell::new(Service::new());
/// From the one to the other.
static HANDOVER: TryCell<Handover> = TryCell::new(Handover::new());

/// The firmware selects this controller: its memory of an earlier flight no longer holds.
#[unsafe(no_mangle)]
pub extern "C" fn controllerOutOfTreeInit() {
    CONTROLLER.with(|controller| {
        controller.forget();
        HANDOVER.with(|handover| handover.select(controller));
    });
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
    CONTROLLER.with(|controller| {
        if controller.step(setpoint, sensors, state, step) {
            units::put(&controller.outcome().output, controller.craft(), control);
            quatrack.log.cycles.store(cycles::since(begun), Relaxed);
            return;
        }
        match controller.between(setpoint, sensors, step) {
            None => {}
            Some(Work::LogErrors) => service::log_errors(&quatrack, controller, state),
            Some(Work::LogCounters) => service::log_counters(&quatrack, controller),
            Some(Work::LogLearned) => service::log_learned(&quatrack, controller),
            Some(Work::TakeOver) => {
                HANDOVER.with(|handover| handover.take_over(controller));
            }
        }
    });
}

/// The app says which craft the firmware was built for, before anything else. Starts everything anew, motors off.
///
/// Returns whether there are tables for it.
#[unsafe(no_mangle)]
pub extern "C" fn quatrackPlatform(platform: &Platform) -> bool {
    SERVICE.with(|service| service.start(platform)).unwrap_or(false)
}

/// The app says that the firmware flies a craft of the owner's, instead of [`quatrackPlatform`]. Starts everything anew, motors off.
///
/// Returns null where it flies, and why it does not, in words, where it does not.
#[unsafe(no_mangle)]
pub extern "C" fn quatrackCraft(platform: &Platform, craft: &OwnCraft) -> *const c_char {
    match SERVICE.with(|service| service.start_own(platform, craft)) {
        Some(Ok(())) => ptr::null(),
        Some(Err(error)) => error.words().as_ptr(),
        None => CStr::as_ptr(c"the controller is busy: again"),
    }
}

/// The app passes a packet of the app channel and gets the answer to send back.
#[unsafe(no_mangle)]
pub extern "C" fn quatrackPacket(packet: &Packet, answer: &mut Packet) {
    if let Some(taken) = SERVICE.with(|service| service.packet(packet, &quatrack)) {
        *answer = taken;
    }
}

/// The app lets the parameters be looked at, a few times a second: a change of the table or of a scale is flown from then
/// on.
#[unsafe(no_mangle)]
pub extern "C" fn quatrackService() {
    SERVICE.with(|service| service.apply_parameters(&quatrack, &HANDOVER));
}
