//! Panics in, an undefined symbol out: the object is whole only if nothing in it can panic.

use core::panic::PanicInfo;

#[panic_handler]
#[allow(unsafe_code, reason = "naming a symbol that must not be reached; nothing is ever called")]
fn panic(_: &PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        safe fn the_controller_can_panic() -> !;
    }
    the_controller_can_panic()
}
