//! The stack: painted at start-up, its paint looked at since; the high-water mark and whether the bound holds out.
//!
//! The linker puts the stack at the top of the RAM and leaves it all that the variables do not take. Of this the image
//! may use [`MAX_BYTES`]: the words at that depth are looked at every tick, and one without its paint is a fault, long
//! before a variable is overwritten.

use core::ptr;

use cortex_m_rt::STACK_PAINT_VALUE;

/// Most stack that the image may use, bytes: about four times its use.
pub const MAX_BYTES: usize = 8 * 1024;

/// Words looked at at that depth.
const GUARD_WORDS: usize = 2;

const WORD: usize = size_of::<u32>();

#[allow(unsafe_code, reason = "the linker's symbols: only their addresses are used")]
mod symbols {
    unsafe extern "C" {
        pub(super) safe static _stack_start: u32;
        pub(super) safe static _stack_end: u32;
    }
}

fn top() -> usize {
    &raw const symbols::_stack_start as usize
}

fn bottom() -> usize {
    &raw const symbols::_stack_end as usize
}

#[allow(unsafe_code, reason = "reads memory below the stack pointer, which is nobody's variable")]
fn is_painted(address: usize) -> bool {
    // SAFETY: an aligned address between the linker's ends of the stack.
    unsafe { ptr::read_volatile(address as *const u32) == STACK_PAINT_VALUE }
}

/// Whether the stack has stayed above its bound.
pub fn is_within_bound() -> bool {
    let guard = top().saturating_sub(MAX_BYTES);
    (0..GUARD_WORDS).all(|word| is_painted(guard + word * WORD))
}

/// Most bytes of stack in use since start-up, as far as the paint tells.
pub fn high_water_bytes() -> u32 {
    let touched = (bottom()..top()).step_by(WORD).find(|address| !is_painted(*address));
    touched.map_or(0, |address| (top() - address) as u32)
}

/// How far below a caller's stack [`paint_below`] paints, bytes.
const BELOW_BYTES: usize = 4 * 1024;

/// Left out right below the caller: the frame of the function that paints and looks, bytes.
const OWN_BYTES: usize = 64;

/// Paints the stack that a function will use which is called next.
#[inline(never)]
#[allow(unsafe_code, reason = "writes memory below the stack pointer, which is nobody's variable")]
pub fn paint_below() {
    let here = 0_u32;
    let top = (&raw const here as usize) - OWN_BYTES;
    for address in (top - BELOW_BYTES..top).step_by(WORD) {
        // SAFETY: an aligned address below every frame in use, and above the variables: the stack's bound is larger.
        unsafe { ptr::write_volatile(address as *mut u32, STACK_PAINT_VALUE) };
    }
}

/// Bytes of it that the function has used, as far as the paint tells.
#[inline(never)]
pub fn used_below() -> u32 {
    let here = 0_u32;
    let top = (&raw const here as usize) - OWN_BYTES;
    let touched = (top - BELOW_BYTES..top).step_by(WORD).find(|address| !is_painted(*address));
    touched.map_or(0, |address| (top - address + OWN_BYTES) as u32)
}
