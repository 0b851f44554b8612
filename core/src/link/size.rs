//! How long messages and frames get, from the fields of the longest ones.

use super::seal::TAG_BYTES;

/// Most bytes of a blob in one [`super::Chunk`].
pub const CHUNK_BYTES: usize = 96;

/// Most bytes of a `u32` as a varint.
const VARINT_U32: usize = 5;
const KIND: usize = 1;
const VECTOR: usize = 12;

const STATE_AND_REFERENCE: usize = {
    let state = VECTOR + 16 + VECTOR;
    let reference = 4 * VECTOR + 2 * 4;
    KIND + VARINT_U32 + state + reference
};
const UPLOAD_CHUNK: usize = KIND + 2 * VARINT_U32 + 1 + CHUNK_BYTES;
const TELEMETRY: usize = {
    let mode = 3;
    let loop_statistics = 7 * VARINT_U32;
    let counters = 12 * VARINT_U32;
    KIND + VARINT_U32 + mode + loop_statistics + counters
};

const fn max(a: usize, b: usize) -> usize {
    if a > b { a } else { b }
}

/// Longest message, bytes, before framing.
pub const MESSAGE_BYTES: usize = max(max(STATE_AND_REFERENCE, UPLOAD_CHUNK), TELEMETRY);

/// Protocol version, session, sequence.
const HEADER: usize = 1 + 2 * VARINT_U32;
const CHECKSUM: usize = 4;

/// Longest frame before COBS, bytes.
pub(crate) const RAW_FRAME_BYTES: usize = HEADER + MESSAGE_BYTES + TAG_BYTES + CHECKSUM;

/// Longest frame on the wire, bytes; a buffer of this size holds any message. COBS adds one byte to a frame this short,
/// and there is the delimiter.
pub const FRAME_BYTES: usize = RAW_FRAME_BYTES + 2;

const _: () = assert!(RAW_FRAME_BYTES < 254, "beyond that COBS adds a second byte");
const _: () = assert!(CHUNK_BYTES < 128, "a chunk's length is one byte on the wire");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Chunk, Counters, FromBoard, LoopStatistics, Message, StateIn, Telemetry, ToBoard};
    use crate::nalgebra::Vector3;
    use crate::supervisor::{Fault, Mode, Reason};
    use crate::{FlatSample, State};

    fn length<M: Message>(message: &M) -> usize {
        let mut buffer = [0; 256];
        postcard::to_slice(message, &mut buffer).unwrap().len()
    }

    #[test]
    fn the_longest_messages_have_the_stated_lengths() {
        let state = StateIn { tick: u32::MAX, state: State::at_rest(Vector3::new(1.0, 2.0, 3.0)) };
        let sample = FlatSample::at_rest(Vector3::new(1.0, 2.0, 3.0), 0.5);
        assert_eq!(length(&ToBoard::StateAndReference(state, sample)), STATE_AND_REFERENCE);

        let chunk = Chunk::new(u32::MAX, u32::MAX, &[0; CHUNK_BYTES]).unwrap();
        assert_eq!(length(&ToBoard::UploadChunk(chunk)), UPLOAD_CHUNK);

        let m = u32::MAX;
        let statistics = LoopStatistics {
            steps: m,
            steps_failed: m,
            overruns: m,
            worst_step_ns: m,
            jitter_ns: m,
            stack_bytes: m,
            bytes_dropped: m,
        };
        let link = Counters {
            accepted: m,
            truncated: m,
            overlong: m,
            checksum: m,
            version: m,
            unknown: m,
            malformed: m,
            foreign_session: m,
            duplicate: m,
            stale: m,
            unauthentic: m,
            lost: m,
        };
        let mode = Mode::Stopped(Reason::Fault(Fault::ClockStopped));
        assert_eq!(length(&FromBoard::Telemetry(Telemetry { tick: m, mode, statistics, link })), TELEMETRY);
    }

    #[test]
    fn the_number_of_kinds_is_right() {
        fn check<M: Message>() {
            let mut bytes = [0; 128];
            bytes[0] = M::KINDS - 1;
            assert!(postcard::take_from_bytes::<M>(&bytes).is_ok(), "the last kind");
            bytes[0] = M::KINDS;
            assert!(postcard::take_from_bytes::<M>(&bytes).is_err(), "one beyond");
        }
        check::<ToBoard>();
        check::<FromBoard>();
    }
}
