//! The image that flies in an emulator, with its line on two named pipes of the host; everything else is `main.rs`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
include!("../app.rs");

#[cfg(target_os = "none")]
use quatrack_firmware::transport::{pipes::Pipes as Line, usart::UsartLine};

/// Pipes that cannot be opened end the emulator: there is nobody to talk to.
#[cfg(target_os = "none")]
fn line(_: UsartLine) -> Line {
    Line::open().unwrap_or_else(|| quatrack_firmware::semihosting::exit(false))
}

/// On a desk there is nothing to run: `quatrack pil --emulator` builds the image and starts it.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an emulated STM32F405; run it with `quatrack pil --emulator`");
}
