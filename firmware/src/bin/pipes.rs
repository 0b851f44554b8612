//! The image that flies in an emulator: the same as `main.rs`, with its line on two named pipes of the host.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
include!("../app.rs");

#[cfg(target_os = "none")]
use quatrack_firmware::{
    board::{flash::Sectors, rng::Rng},
    semihosting::flash::{FileFlash as Flash, SLOT_BYTES},
    transport::{pipes::Pipes as Line, usart::UsartLine},
};

/// Pipes that cannot be opened end the emulator: there is nobody to talk to.
#[cfg(target_os = "none")]
fn line(_: UsartLine) -> Line {
    Line::open().unwrap_or_else(|| quatrack_firmware::semihosting::exit(false))
}

/// The emulator cannot write its flash: a file of the host keeps uploads.
#[cfg(target_os = "none")]
fn flash(_: Sectors) -> (Flash, u32) {
    (Flash::open(), SLOT_BYTES)
}

/// The emulator has no noise of its own: the host's.
#[cfg(target_os = "none")]
fn nonce(_: &Rng) -> Option<quatrack::link::Nonce> {
    use quatrack_firmware::semihosting::{File, Mode};
    let mut bytes = [0; 16];
    let read = File::open(c"/dev/urandom", Mode::Read)?.read(&mut bytes);
    (read == bytes.len()).then_some(quatrack::link::Nonce(bytes))
}

/// On a desk there is nothing to run: `quatrack pil --emulator` builds the image and starts it.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an emulated STM32F405; run it with `quatrack pil --emulator`");
}
