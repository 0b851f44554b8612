//! The control path down to the motors and nothing else, for its size: that of `quatrack-control-path`, and what carries
//! the laws to motor forces, the actuator-aware one with its table included. It is linked, never run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
include!("../weighed.rs");

/// On a desk there is nothing to run: `quatrack measure` builds the image and looks at its size.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an STM32F405; `quatrack measure` builds it for its size");
}
