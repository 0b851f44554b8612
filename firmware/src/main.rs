//! The image that flies, with its line on USART2: the one for the board.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
include!("app.rs");

#[cfg(target_os = "none")]
use quatrack_firmware::{
    board::{
        flash::{SECTOR_BYTES, Sectors as Flash},
        rng::Rng,
    },
    transport::usart::UsartLine as Line,
};

/// The line is the USART itself.
#[cfg(target_os = "none")]
fn line(usart: Line) -> Line {
    usart
}

/// Uploads are kept in the flash itself, each in a sector.
#[cfg(target_os = "none")]
fn flash(sectors: Flash) -> (Flash, u32) {
    (sectors, SECTOR_BYTES)
}

/// Of the board's own noise.
#[cfg(target_os = "none")]
fn nonce(rng: &Rng) -> Option<quatrack::link::Nonce> {
    rng.nonce()
}

/// On a desk there is nothing to run: the image is built with `cargo firmware`.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is the firmware of an STM32F405; build it with `cargo firmware`");
}
