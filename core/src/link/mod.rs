//! The serial link between a host and the board: bytes in, messages out, and back. One schema for both ends.
//!
//! A frame on the wire is `COBS(header, message, CRC-32C)` and a closing 0x00:
//!
//! ```text
//! version   u8       PROTOCOL_VERSION; stays the first byte in every version
//! session   varint   the host's number for this connection; the board echoes it
//! sequence  varint   counts the sender's frames in this session, from 0
//! message   postcard ToBoard or FromBoard: one byte that says which, then its fields
//! tag       16 bytes of the sender's key ([`Key`]), where there is one; otherwise absent
//! checksum  u32 LE   CRC-32C of all of the above
//! ```
//!
//! [`Encoder`] writes frames into a caller's buffer, [`Decoder`] reads them from any chunks of bytes, rejects and counts
//! unsound frames ([`Counters`]), and finds back at the next 0x00. The end that opens the line sends one 0x00 first, so
//! that noise before it does not spoil the first frame. A reply may be lost: requests carry no state between frames and
//! can be sent again.
//!
//! Session and sequence rule: within a session only a sequence number above the last accepted one is taken, so that
//! duplicates, late and replayed frames are rejected; gaps are counted as lost. The board opens a session on
//! [`ToBoard::Hello`] with a session number ahead of the current one (in serial-number arithmetic), the host on its own
//! choice: a restarted host takes a later number, the seconds since 1970 say, and is not locked out. Which hellos open
//! another session is the receiver's to say ([`Admission`]): nothing while a craft is armed, anything once its link has
//! been silent. A session ends with its last sequence number, after 49 days at 1 kHz.
//!
//! Without a key none of this authenticates: anybody with access to the line can fly. With one ([`Protection`]) a hello and its answer
//! carry tags of the key, and bring a nonce each; from both follows the session's own key, whose tags the other frames carry. The
//! hello alone opens nothing: the session that was open goes on until the first frame of the new one with a right tag, so that a hello
//! which is replayed neither takes a craft nor keeps a lost link alive. Frames without a tag have sequence numbers of
//! their own, so that nothing without a tag makes an order late.
//!
//! On the target, [`BlobReceiver`] and [`TrajectoryStore`] are best statics of their own: they start as zeros and take
//! no flash.

mod blob_receiver;
mod counters;
mod decoder;
mod encoder;
mod from_board;
mod gain_store;
mod guard;
mod host_session;
mod key_slot;
mod law_choice;
mod seal;
mod signed;
mod size;
mod to_board;
mod trajectory_store;
mod upload;
mod window;

pub use crate::checksum::{Crc32c, crc32c};
pub use blob_receiver::BlobReceiver;
pub use counters::{Counters, Rejected};
pub use decoder::{Decoder, Received};
pub use encoder::{EncodeError, Encoder};
pub use from_board::{
    CommandOut, FaultReport, ForcesOut, FromBoard, Identity, LoopStatistics, NoCommand, Refusal, Telemetry, Version,
};
pub use gain_store::GainStore;
pub use host_session::HostSession;
pub use key_slot::{GivenKeys, KEY_SLOT_BYTES, KEY_SLOT_MAGIC};
pub use law_choice::{LawChoice, Table};
pub use seal::{KEY_BYTES, Key, Nonce, Protection, Seal, SessionSeals, TAG_BYTES, Tagging};
pub use signed::{SIGNATURE_BYTES, signature, signed_with, unsigned};
pub use size::{CHUNK_BYTES, FRAME_BYTES, MESSAGE_BYTES};
pub use to_board::{
    LimitsSetting, Parameter, ParameterId, RigidStateIn, StateIn, ToBoard, TrajectoryCommand, TrajectoryId,
};
pub use trajectory_store::{
    BlobError, TRAJECTORY_BLOB_BYTES, TRAJECTORY_PIECES, TrajectorySlot, TrajectoryStore, encode_trajectory,
};
pub use upload::{BlobKind, Chunk, Progress, UploadBegin, UploadError};
pub use window::Admission;

/// Version of the frame layout and of every message in it. A changed message is a changed version.
pub const PROTOCOL_VERSION: u8 = 5;

/// Bytes of the longest blob of any kind.
pub const BLOB_BYTES_MAX: usize = {
    let (trajectory, table) = (TRAJECTORY_BLOB_BYTES, crate::gains::table::TABLE_BYTES_MAX + SIGNATURE_BYTES);
    if trajectory > table { trajectory } else { table }
};

/// Ends every frame and is nowhere else in it.
pub const DELIMITER: u8 = 0;

/// A message that can be framed: [`ToBoard`] or [`FromBoard`]. Sealed: the schema is this module's.
pub trait Message: serde::Serialize + serde::de::DeserializeOwned + private::Sealed {
    /// Number of kinds.
    const KINDS: u8;

    /// Whether this message opens a session at its receiver.
    fn opens_session(&self) -> bool;

    /// Its rule of tagging.
    fn tagging(&self) -> Tagging;
}

mod private {
    /// Keeps messages of other schemas out.
    pub trait Sealed {}
    impl Sealed for super::ToBoard {}
    impl Sealed for super::FromBoard {}
}
