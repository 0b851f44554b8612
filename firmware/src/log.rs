//! Log messages in; frames of defmt in a ring out, which a debug probe reads by RTT, or an emulator's image by itself.
//!
//! Nobody waits for a reader: a frame that does not fit is dropped as a whole. defmt's own loggers panic when they are
//! entered twice; this one cannot be, and holds no panic.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering::Relaxed};

use critical_section::RestoreState;

/// Bytes of the ring: some thirty messages.
const RING_BYTES: usize = 1024;

/// The first channel to the host, as SEGGER's RTT lays it out.
#[repr(C)]
struct Channel {
    name: *const u8,
    buffer: *const AtomicU8,
    size: u32,
    write: AtomicU32,
    read: AtomicU32,
    /// 0: a frame that does not fit is dropped.
    flags: u32,
}

/// RTT's control block: a debug probe finds it by its name, or by the letters that it begins with.
#[repr(C)]
struct ControlBlock {
    id: [u8; 16],
    channels_to_host: u32,
    channels_to_target: u32,
    channel: Channel,
}

#[allow(unsafe_code, reason = "its pointers are to constants and atomics, which any interrupt may use")]
// SAFETY: see the reason.
unsafe impl Sync for ControlBlock {}

static RING: [AtomicU8; RING_BYTES] = [const { AtomicU8::new(0) }; RING_BYTES];

#[allow(unsafe_code, reason = "the name by which a debug probe finds it")]
#[unsafe(no_mangle)]
static _SEGGER_RTT: ControlBlock = ControlBlock {
    id: *b"SEGGER RTT\0\0\0\0\0\0",
    channels_to_host: 1,
    channels_to_target: 0,
    channel: Channel {
        name: c"defmt".as_ptr().cast(),
        buffer: RING.as_ptr(),
        size: RING_BYTES as u32,
        write: AtomicU32::new(0),
        read: AtomicU32::new(0),
        flags: 0,
    },
};

/// The frame that is being written: defmt's encoder and how far it has come.
struct Frame {
    encoder: defmt::Encoder,
    restore: RestoreState,
    at: u32,
    fits: bool,
}

struct Shared(UnsafeCell<Frame>);

#[allow(unsafe_code, reason = "used between acquire and release only, with all interrupts held back")]
// SAFETY: see the reason.
unsafe impl Sync for Shared {}

static FRAME: Shared = Shared(UnsafeCell::new(Frame {
    encoder: defmt::Encoder::new(),
    restore: RestoreState::invalid(),
    at: 0,
    fits: true,
}));

impl Frame {
    /// Puts bytes into the ring, behind the part that readers see.
    fn put(at: &mut u32, fits: &mut bool, bytes: &[u8]) {
        let read = _SEGGER_RTT.channel.read.load(Relaxed);
        for byte in bytes {
            let next = if *at + 1 < RING_BYTES as u32 { *at + 1 } else { 0 };
            match RING.get(*at as usize) {
                Some(place) if next != read && *fits => {
                    place.store(*byte, Relaxed);
                    *at = next;
                }
                _ => *fits = false,
            }
        }
    }
}

#[defmt::global_logger]
struct Logger;

#[allow(
    unsafe_code,
    reason = "defmt's trait is unsafe: it calls these in order, each frame between acquire and release"
)]
// SAFETY: interrupts are held back from acquire to release, so that frames do not mix and the frame has one user.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        // SAFETY: released by `release` with the state that is kept here.
        let restore = unsafe { critical_section::acquire() };
        // SAFETY: interrupts are held back.
        let Frame { encoder, restore: kept, at, fits } = unsafe { &mut *FRAME.0.get() };
        (*kept, *at, *fits) = (restore, _SEGGER_RTT.channel.write.load(Relaxed), true);
        encoder.start_frame(|bytes| Frame::put(at, fits, bytes));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: interrupts are still held back.
        let Frame { encoder, restore, at, fits } = unsafe { &mut *FRAME.0.get() };
        encoder.end_frame(|bytes| Frame::put(at, fits, bytes));
        if *fits {
            _SEGGER_RTT.channel.write.store(*at, Relaxed);
        }
        // SAFETY: the state that `acquire` was given.
        unsafe { critical_section::release(*restore) };
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: interrupts are still held back.
        let Frame { encoder, at, fits, .. } = unsafe { &mut *FRAME.0.get() };
        encoder.write(bytes, |bytes| Frame::put(at, fits, bytes));
    }
}

/// Takes bytes of the log out of the ring, as a debug probe would; how many.
pub fn take(buffer: &mut [u8]) -> usize {
    let channel = &_SEGGER_RTT.channel;
    let (mut read, write) = (channel.read.load(Relaxed), channel.write.load(Relaxed));
    let mut count = 0;
    for place in buffer {
        if read == write {
            break;
        }
        *place = RING.get(read as usize).map_or(0, |byte| byte.load(Relaxed));
        read = if read + 1 < RING_BYTES as u32 { read + 1 } else { 0 };
        count += 1;
    }
    channel.read.store(read, Relaxed);
    count
}
