//! A decoder's counters: one count for every way a frame can end.

use core::fmt;

/// Why a frame is no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Rejected {
    /// The 0x00 came within a block: bytes are missing, or one of them became 0x00.
    Truncated,
    /// Longer than any message: two frames run together, or noise.
    Overlong,
    /// The checksum does not match.
    Checksum,
    /// Sound, but of another protocol version.
    Version {
        /// The sender's; ours is [`super::PROTOCOL_VERSION`].
        version: u8,
    },
    /// Sound, but of a kind that this version does not know.
    UnknownMessage {
        /// The kind's number.
        kind: u8,
    },
    /// Sound, but its fields do not decode or leave bytes over.
    Malformed,
    /// Of a session that is not open here: an earlier one, or none has been opened.
    ForeignSession {
        /// The frame's session.
        session: u32,
    },
    /// The last accepted frame again.
    Duplicate {
        /// Its sequence number.
        sequence: u32,
    },
    /// Older than the last accepted frame: late or replayed.
    Stale {
        /// Its sequence number.
        sequence: u32,
    },
    /// Without the tag of a sender that is allowed to send it.
    Unauthentic {
        /// The frame's session.
        session: u32,
        /// Its sequence number.
        sequence: u32,
    },
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated => f.write_str("frame: truncated; check the line"),
            Self::Overlong => f.write_str("frame: longer than any message; check the line and the protocol"),
            Self::Checksum => f.write_str("frame: wrong checksum; check the line"),
            Self::Version { version } => write!(
                f,
                "frame: protocol version {version}, ours is {}; use host and firmware of one release",
                super::PROTOCOL_VERSION
            ),
            Self::UnknownMessage { kind } => {
                write!(f, "frame: unknown message {kind}; use host and firmware of one release")
            }
            Self::Malformed => f.write_str("frame: fields do not decode; use host and firmware of one release"),
            Self::ForeignSession { session } => {
                write!(f, "frame: session {session} is not open; open one with a hello and a later number")
            }
            Self::Duplicate { sequence } => write!(f, "frame: {sequence} came twice"),
            Self::Stale { sequence } => write!(f, "frame: {sequence} is older than the last one accepted"),
            Self::Unauthentic { session, sequence } => {
                write!(f, "frame: {sequence} of session {session} has no tag of this key; give both ends the same key")
            }
        }
    }
}

impl core::error::Error for Rejected {}

/// Frames by how they ended, since the decoder was made; a count stays at its maximum rather than wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Delivered as messages.
    pub accepted: u32,
    /// [`Rejected::Truncated`].
    pub truncated: u32,
    /// [`Rejected::Overlong`].
    pub overlong: u32,
    /// [`Rejected::Checksum`].
    pub checksum: u32,
    /// [`Rejected::Version`].
    pub version: u32,
    /// [`Rejected::UnknownMessage`].
    pub unknown: u32,
    /// [`Rejected::Malformed`].
    pub malformed: u32,
    /// [`Rejected::ForeignSession`].
    pub foreign_session: u32,
    /// [`Rejected::Duplicate`].
    pub duplicate: u32,
    /// [`Rejected::Stale`].
    pub stale: u32,
    /// [`Rejected::Unauthentic`].
    pub unauthentic: u32,
    /// Sequence numbers that were skipped: frames that never came, or came broken. No frames of their own.
    pub lost: u32,
}

impl Counters {
    /// Nothing seen yet.
    pub const NONE: Self = Self {
        accepted: 0,
        truncated: 0,
        overlong: 0,
        checksum: 0,
        version: 0,
        unknown: 0,
        malformed: 0,
        foreign_session: 0,
        duplicate: 0,
        stale: 0,
        unauthentic: 0,
        lost: 0,
    };

    /// Frames that ended, sound or not: the accepted and every rejected one.
    pub fn frames(&self) -> u32 {
        self.accepted.saturating_add(self.rejected())
    }

    /// Frames that were rejected.
    pub fn rejected(&self) -> u32 {
        let Self {
            accepted: _,
            truncated,
            overlong,
            checksum,
            version,
            unknown,
            malformed,
            foreign_session,
            duplicate,
            stale,
            unauthentic,
            lost: _,
        } = *self;
        [truncated, overlong, checksum, version, unknown, malformed, foreign_session, duplicate, stale, unauthentic]
            .iter()
            .fold(0, |sum: u32, count| sum.saturating_add(*count))
    }

    pub(crate) fn count_accepted(&mut self, skipped: u32) {
        self.accepted = self.accepted.saturating_add(1);
        self.lost = self.lost.saturating_add(skipped);
    }

    pub(crate) fn count_rejected(&mut self, rejected: Rejected) {
        let count = match rejected {
            Rejected::Truncated => &mut self.truncated,
            Rejected::Overlong => &mut self.overlong,
            Rejected::Checksum => &mut self.checksum,
            Rejected::Version { .. } => &mut self.version,
            Rejected::UnknownMessage { .. } => &mut self.unknown,
            Rejected::Malformed => &mut self.malformed,
            Rejected::ForeignSession { .. } => &mut self.foreign_session,
            Rejected::Duplicate { .. } => &mut self.duplicate,
            Rejected::Stale { .. } => &mut self.stale,
            Rejected::Unauthentic { .. } => &mut self.unauthentic,
        };
        *count = count.saturating_add(1);
    }
}
