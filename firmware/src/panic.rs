//! Panics in, a link error out: an image links only if nothing in it can panic.

use core::panic::PanicInfo;

#[panic_handler]
#[allow(unsafe_code, reason = "naming a symbol that must not be reached; nothing is ever called")]
fn panic(_: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        safe fn the_control_path_can_panic() -> !;
    }
    the_control_path_can_panic()
}
