//! Lines: bytes in and out, the same frames on all of them.

#[cfg(all(feature = "log", feature = "semihosting"))]
pub mod pipes;
pub mod usart;

/// A line to the host, as the link's loop uses it.
pub trait Line {
    /// Bytes that have come, up to the buffer's length; how many.
    fn receive(&mut self, buffer: &mut [u8]) -> usize;
    /// Sends all of a frame.
    fn send(&mut self, frame: &[u8]);
    /// Waits until something may have come: a byte, or an interrupt.
    fn wait(&mut self);
}
