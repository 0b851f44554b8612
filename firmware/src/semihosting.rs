//! Files of the machine that emulates or debugs this one: a name in, bytes in and out.
//!
//! Every call is a BKPT that the emulator or debugger answers; without one it is a hard fault.

pub mod flash;

use core::ffi::CStr;

use cortex_m_semihosting::{debug, nr, syscall};

/// An open file of the host.
#[derive(Debug)]
pub struct File {
    handle: usize,
}

/// The access to a file; the numbers are `fopen`'s modes in the semihosting specification.
#[derive(Clone, Copy)]
pub enum Mode {
    /// `rb`.
    Read = 1,
    /// `r+b`.
    Update = 3,
    /// `wb`.
    Write = 5,
}

impl File {
    /// Opens a file in the folder in which the host runs; nothing where the host refuses.
    #[allow(unsafe_code, reason = "SYS_OPEN is given a name that ends in zero and its length, as specified")]
    pub fn open(name: &CStr, mode: Mode) -> Option<Self> {
        // SAFETY: the name outlives the call and its length is without the final zero.
        let handle = unsafe { syscall(nr::OPEN, &[name.as_ptr() as usize, mode as usize, name.count_bytes()]) };
        (handle != usize::MAX).then_some(Self { handle })
    }

    /// Reads up to the length of `bytes`; how many were read, 0 at the end. Blocks where the host's file does.
    #[allow(unsafe_code, reason = "SYS_READ fills at most the buffer whose length it is given")]
    pub fn read(&mut self, bytes: &mut [u8]) -> usize {
        // SAFETY: pointer and length are one borrowed buffer's.
        let missing = unsafe { syscall(nr::READ, &[self.handle, bytes.as_mut_ptr() as usize, bytes.len()]) };
        bytes.len().saturating_sub(missing)
    }

    /// Goes to a place from the start, at which the next read or write begins; whether there is one.
    #[allow(unsafe_code, reason = "SYS_SEEK takes two numbers")]
    pub fn seek(&mut self, offset: usize) -> bool {
        // SAFETY: no memory but the two numbers is looked at.
        unsafe { syscall(nr::SEEK, &[self.handle, offset]) == 0 }
    }

    /// Writes all of `bytes`; whether the host took them.
    #[allow(unsafe_code, reason = "SYS_WRITE reads only the buffer whose length it is given")]
    pub fn write(&mut self, bytes: &[u8]) -> bool {
        // SAFETY: pointer and length are one borrowed buffer's.
        let missing = unsafe { syscall(nr::WRITE, &[self.handle, bytes.as_ptr() as usize, bytes.len()]) };
        missing == 0
    }
}

impl Drop for File {
    #[allow(unsafe_code, reason = "SYS_CLOSE takes a number")]
    fn drop(&mut self) {
        // SAFETY: nobody else has the handle.
        let _ = unsafe { syscall(nr::CLOSE, &[self.handle]) };
    }
}

/// Ends the emulator with success or failure.
pub fn exit(success: bool) -> ! {
    loop {
        debug::exit(if success { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    }
}
