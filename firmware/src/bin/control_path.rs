//! The control path and nothing else, for its size: states, orders and pieces that somebody else writes in, commands
//! out.
//!
//! Holds what the control interrupt runs (`tick`, `flight`, `playback`, `control`, `timing`, the supervisor), the four
//! laws with their tables, the check and the evaluation of trajectories, and the start-up code; neither stored
//! trajectories nor drivers nor the link, and so nothing that puts an upload to use. It is linked,
//! never run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
include!("../weighed.rs");

/// On a desk there is nothing to run: `quatrack measure` builds the image and looks at its size.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an STM32F405; `quatrack measure` builds it for its size");
}
