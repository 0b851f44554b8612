//! How long messages and frames get, from the fields of the longest ones.

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
    let mode = 2;
    let loop_statistics = 7 * VARINT_U32;
    let counters = 11 * VARINT_U32;
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
pub(crate) const RAW_FRAME_BYTES: usize = HEADER + MESSAGE_BYTES + CHECKSUM;

/// COBS adds a byte for every 254 begun, and there is the delimiter.
const COBS: usize = RAW_FRAME_BYTES.div_ceil(254);

/// Longest frame on the wire, delimiter included, bytes; a buffer of this size holds any message.
pub const FRAME_BYTES: usize = RAW_FRAME_BYTES + COBS + 1;
