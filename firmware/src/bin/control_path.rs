//! The image of the control path and nothing else, linked to measure its size: states, orders and pieces that somebody
//! else writes in, commands out. It never runs.
//!
//! Holds the code of the control interrupt (`tick`, `flight`, `playback`, `control`, `timing`, the supervisor), the four
//! laws with their tables, the check and the evaluation of trajectories, and the start-up code; neither stored
//! trajectories nor drivers nor the link, and so nothing that puts an upload to use.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
include!("../every_order.rs");

/// On a desk there is nothing to run: `quatrack measure` builds the image and looks at its size.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is an image for an STM32F405; `quatrack measure` builds it for its size");
}
