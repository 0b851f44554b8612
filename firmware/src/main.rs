//! The control path on an STM32F405, linked without a single panic path.
//!
//! A state in, a stored piece played by ticks, a command out, through every law of the core. Drivers, clocks and the
//! link to a host are not here yet: the state is the one in memory and the command goes nowhere. What the image shows
//! is that the core runs without an operating system, an allocator, or anything that could panic: its panic handler
//! calls a function that does not exist, so that it links only if the handler is unreachable.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod control;

#[cfg(target_os = "none")]
mod image {
    use core::panic::PanicInfo;

    use cortex_m_rt::entry;

    #[entry]
    fn main() -> ! {
        super::control::run()
    }

    #[panic_handler]
    #[allow(unsafe_code, reason = "naming a symbol that must not be reached; nothing is ever called")]
    fn panic(_: &PanicInfo<'_>) -> ! {
        unsafe extern "C" {
            safe fn the_control_path_can_panic() -> !;
        }
        the_control_path_can_panic()
    }
}

/// On a desk there is nothing to run: the image is built with `cargo firmware`.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is the firmware of an STM32F405; build it with `cargo firmware`");
}
