//! The image that flies, with its line on USART2: the one for the board.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
include!("app.rs");

#[cfg(target_os = "none")]
use quatrack_firmware::transport::usart::UsartLine as Line;

/// The line is the USART itself.
#[cfg(target_os = "none")]
fn line(usart: Line) -> Line {
    usart
}

/// On a desk there is nothing to run: the image is built with `cargo firmware`.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is the firmware of an STM32F405; build it with `cargo firmware`");
}
