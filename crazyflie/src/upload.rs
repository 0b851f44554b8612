//! A table, or a craft with its table, over the app channel: packets of at most 30 bytes in, answers and, at the end, an accepted
//! table or the craft out.
//!
//! ```text
//! 1  length: u16  checksum: u32      announces either, by its own checksum: its last four bytes
//! 2  offset: u16  bytes: 1 to 27     its next bytes
//! 3                                  all sent: check it and make it the uploaded table
//! ```
//!
//! Little-endian. Every packet is answered with its own first byte, a [`Status`] and the offset of the next bytes (u16); a
//! refusal in words behind.
//! The table is the file of docs/gain-tables.md, the craft that of [`OwnCraft::to_bytes`]; nothing of either is used before all of it
//! has come and been checked.

use quatrack::gains::table::{
    CONSTANT_TABLE_BYTES_MAX, GainTable, LoadError, TABLE_BYTES_MAX, TableError, TableKind, Vehicle,
};
use quatrack::link::{BlobKind, BlobReceiver, Chunk, UploadBegin, UploadError};

use crate::craft::RATE;
use crate::own_craft::{CRAFT_BYTES, MAGIC, OwnCraft, OwnCraftError};

/// `APPCHANNEL_MTU`.
pub const PACKET_BYTES: usize = 30;

/// CRC-32C of anything that ends with its own CRC-32C, as every table does: it tells a whole table, not one from another.
const RESIDUE: u32 = 0x4867_4bc7;

/// A packet of the app channel, as our app passes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packet {
    /// Number of the bytes that count.
    pub length: u8,
    /// Its bytes.
    pub bytes: [u8; PACKET_BYTES],
}

/// The answer to a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// As it should be; after packet 3 the table is there.
    Taken = 0,
    /// No packet of this kind or length.
    Unknown = 1,
    /// Nothing has been announced.
    NotBegun = 2,
    /// Longer than any table, or empty.
    Length = 3,
    /// Not the next bytes: go on from the offset in the answer.
    Offset = 4,
    /// Not all has been sent.
    Incomplete = 5,
    /// The checksum is not the announced one: begin again.
    Checksum = 6,
    /// No sound table with a valid certificate.
    Table = 7,
    /// A table for another vehicle or another control rate.
    Vehicle = 8,
    /// The controller is busy, or has not been told which craft this is: again.
    Busy = 9,
    /// A table of gains along a trajectory: setpoints do not say which trajectory they are on, or where on it.
    Along = 10,
    /// A table of the actuator-aware law, which the cascade has taken the place of: design a cascade.
    ActuatorAware = 11,
    /// A craft while one flies: land first.
    Flying = 12,
    /// A craft whose table was made for other figures: make the file again.
    Figures = 13,
    /// Figures of no craft: make the file again.
    NoCraft = 14,
    /// A craft whose motors' lag is not among those that its table is certified for: widen the design's region.
    MotorLag = 15,
    /// A craft with another arm than the firmware was built for (`ARM_LENGTH`).
    Arm = 16,
    /// With another largest force of a motor (`THRUST_MAX`).
    ForceMax = 17,
    /// With another torque per thrust (`THRUST2TORQUE`).
    TorquePerThrust = 18,
}

impl From<OwnCraftError> for Status {
    fn from(error: OwnCraftError) -> Self {
        match error {
            OwnCraftError::Table => Self::Table,
            OwnCraftError::Figures => Self::Figures,
            OwnCraftError::NoCraft => Self::NoCraft,
            OwnCraftError::MotorLag => Self::MotorLag,
            OwnCraftError::Arm => Self::Arm,
            OwnCraftError::ForceMax => Self::ForceMax,
            OwnCraftError::TorquePerThrust => Self::TorquePerThrust,
        }
    }
}

impl Status {
    /// The words of a refusal in an answer.
    const fn words(self) -> &'static [u8] {
        match self {
            Self::Taken => b"",
            Self::Busy => b"no craft, or busy: again",
            Self::Unknown => b"no such packet",
            Self::NotBegun => b"announce the table first",
            Self::Length => b"longer than any table",
            Self::Offset => b"not the next bytes",
            Self::Incomplete => b"not all has been sent",
            Self::Checksum => b"damaged, begin again",
            Self::Table => b"no certified gain table",
            Self::Vehicle => b"for another craft or rate",
            Self::Along => b"gains along a trajectory",
            Self::ActuatorAware => b"actuator-aware: outdated",
            Self::Flying => b"motors on: land first",
            Self::Figures => b"table for other figures",
            Self::NoCraft => b"figures of no craft",
            Self::MotorLag => b"motor lag not certified",
            Self::Arm => b"firmware's arm differs",
            Self::ForceMax => b"firmware's force differs",
            Self::TorquePerThrust => b"firmware's torque differs",
        }
    }
}

const _: () = assert!(CONSTANT_TABLE_BYTES_MAX <= TABLE_BYTES_MAX && CRAFT_BYTES <= CONSTANT_TABLE_BYTES_MAX);

/// An upload that has come whole.
#[allow(clippy::large_enum_variant, reason = "there is no heap to put the larger one on")]
pub enum Sent {
    /// A table that is accepted for the craft.
    Table(GainTable<'static>),
    /// A craft with its table, not looked at yet.
    Craft(OwnCraft),
}

/// The receiving end.
pub struct Uploads {
    receiver: BlobReceiver<CONSTANT_TABLE_BYTES_MAX>,
}

impl Uploads {
    /// Nothing announced.
    pub(crate) const fn new() -> Self {
        Self { receiver: BlobReceiver::new() }
    }

    /// Takes a packet; with the last one comes the table for a vehicle, or a craft.
    pub fn take(&mut self, packet: &Packet, vehicle: Option<&Vehicle>) -> (Status, Option<Sent>) {
        let bytes = packet.bytes.get(..usize::from(packet.length)).unwrap_or_default();
        match bytes {
            [1, l0, l1, c0, c1, c2, c3] => {
                let checksum = u32::from_le_bytes([*c0, *c1, *c2, *c3]);
                let length = u32::from(u16::from_le_bytes([*l0, *l1]));
                let begin = UploadBegin { kind: BlobKind::GainTable, id: checksum, length, checksum: RESIDUE };
                let begun = self.receiver.begin(&begin).map_or_else(status_of, |_| Status::Taken);
                // Only gains along a trajectory are as long as that.
                let is_along = begun == Status::Length && (1..=TABLE_BYTES_MAX as u32).contains(&length);
                (if is_along { Status::Along } else { begun }, None)
            }
            [2, o0, o1, bytes @ ..] => (self.chunk(u16::from_le_bytes([*o0, *o1]), bytes), None),
            [3] => self.commit(vehicle),
            _ => (Status::Unknown, None),
        }
    }

    /// The answer to a packet of some kind.
    pub fn answer(&self, kind: u8, status: Status) -> Packet {
        let wanted = self.receiver.progress().map_or(0, |progress| progress.wanted_offset);
        let [w0, w1] = u16::try_from(wanted).unwrap_or(u16::MAX).to_le_bytes();
        let mut bytes = [0; PACKET_BYTES];
        let [b0, b1, b2, b3, rest @ ..] = &mut bytes;
        (*b0, *b1, *b2, *b3) = (kind, status as u8, w0, w1);
        let words = status.words();
        rest.iter_mut().zip(words).for_each(|(to, byte)| *to = *byte);
        Packet { length: 4 + words.len() as u8, bytes }
    }

    fn chunk(&mut self, offset: u16, bytes: &[u8]) -> Status {
        let Ok(progress) = self.receiver.progress() else { return Status::NotBegun };
        let Some(chunk) = Chunk::new(progress.id, u32::from(offset), bytes) else { return Status::Unknown };
        self.receiver.chunk(&chunk).map_or_else(status_of, |_| Status::Taken)
    }

    fn commit(&mut self, vehicle: Option<&Vehicle>) -> (Status, Option<Sent>) {
        let Ok(progress) = self.receiver.progress() else { return (Status::NotBegun, None) };
        let blob = match self.receiver.finish(progress.id) {
            Ok((_, blob)) => blob,
            Err(error) => return (status_of(error), None),
        };
        if blob.starts_with(&MAGIC) {
            let own = OwnCraft::from_bytes(blob);
            return (own.map_or(Status::Table, |_| Status::Taken), own.map(Sent::Craft));
        }
        let Some(vehicle) = vehicle else { return (Status::Busy, None) };
        match read(blob, vehicle) {
            Ok(Some(table)) => (Status::Taken, Some(Sent::Table(table))),
            Ok(None) => (Status::Along, None),
            Err(LoadError::Table(TableError::ActuatorAware)) => (Status::ActuatorAware, None),
            Err(LoadError::Accept(_)) => (Status::Vehicle, None),
            Err(_) => (Status::Table, None),
        }
    }
}

/// A table for this craft; nothing for gains along a trajectory.
fn read(blob: &[u8], vehicle: &Vehicle) -> Result<Option<GainTable<'static>>, LoadError> {
    let table = GainTable::from_bytes(blob)?;
    if table.kind() == TableKind::AlongTrajectory {
        return Ok(None);
    }
    table.accept_for(vehicle, RATE)?;
    Ok(table.owned())
}

fn status_of(error: UploadError) -> Status {
    match error {
        UploadError::NotBegun | UploadError::OtherBlob { .. } => Status::NotBegun,
        UploadError::Length { .. } => Status::Length,
        UploadError::Offset { .. } => Status::Offset,
        UploadError::ChunkLength { .. } => Status::Unknown,
        UploadError::Incomplete { .. } => Status::Incomplete,
        UploadError::Checksum { .. } => Status::Checksum,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use quatrack::checksum::crc32c;

    #[test]
    fn the_residue_is_that_of_any_bytes() {
        for bytes in [&b""[..], b"table", &[7; 300]] {
            assert_eq!(crc32c(&[bytes, &crc32c(bytes).to_le_bytes()].concat()), RESIDUE);
        }
    }
}
