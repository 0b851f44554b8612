//! The image of the control path down to the motors and nothing else, linked to measure its size:
//! `quatrack-control-path`, and the code that carries the laws to motor forces, with the cascade and its table. It
//! never runs.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
include!("../every_order.rs");

/// On a desk there is nothing to run: `quatrack measure` builds the image and looks at its size.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an STM32F405; `quatrack measure` builds it for its size");
}
