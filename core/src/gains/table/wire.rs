//! The bytes of a table: a frame around a payload, a payload of fields of fixed width. The page docs/gain-tables.md has
//! every offset.
//!
//! The payload is postcard's encoding of its fields, all of types that postcard writes at one width (bytes, `f32`,
//! integers as arrays of bytes): one table has one encoding, and its length tells whether it is whole. It is taken apart
//! by hand here: a derived reader takes several times the code on the target.

use nalgebra::Vector3;

use super::certificate::{Certificate, Hash, Margins, Vehicle};
use super::error::{TableError, count};
use super::name::Name;
use super::{TableHead, TableKind};
use crate::checksum::crc32c;
use crate::clock::Rate;
use crate::command::Limits;

/// The first bytes of every table, in every version.
pub const MAGIC: [u8; 4] = *b"QTGT";

/// Version of the payload. The frame (magic, version, length, checksum) is the same in all of them.
pub const FORMAT_VERSION: u16 = 2;

/// Magic, version and length before the payload.
pub(super) const PAYLOAD_OFFSET: usize = 4 + 2 + 2;

/// Bytes around the payload: the checksum is behind it.
pub(super) const FRAME_BYTES: usize = PAYLOAD_OFFSET + 4;

/// Bytes of the payload before the gains: kind and dimensions, names, id and rate, limits, hashes, figures.
pub(super) const HEAD_BYTES: usize = 3 + 2 * Name::BYTES + 2 * 4 + 5 * 4 + 2 * 32 + 7 * 4;

/// Takes fields from the start of a payload. Inlined into one place, where the length is known and no field can be cut.
pub(super) struct Reader<'b> {
    rest: &'b [u8],
    /// The error where the payload ends before a field.
    ended: TableError,
}

impl<'b> Reader<'b> {
    pub(super) const fn new(payload: &'b [u8], ended: TableError) -> Self {
        Self { rest: payload, ended }
    }

    /// The kind, if the table has its dimensions.
    #[inline(always)]
    pub(super) fn kind(&mut self) -> Result<TableKind, TableError> {
        let [found, rows, columns] = self.bytes()?;
        let kind = TableKind::numbered(found).ok_or(TableError::Kind { found })?;
        if (rows, columns) == kind.dimensions() {
            Ok(kind)
        } else {
            Err(TableError::Dimensions { kind, rows, columns })
        }
    }

    /// The fields between the kind and the gains.
    #[inline(always)]
    pub(super) fn head(&mut self) -> Result<TableHead, TableError> {
        Ok(TableHead {
            name: Name::from_padded(self.bytes()?).map_err(TableError::TableName)?,
            vehicle: Vehicle {
                name: Name::from_padded(self.bytes()?).map_err(TableError::VehicleName)?,
                id: self.u32()?,
            },
            rate: self.rate()?,
            limits: self.limits()?,
            design_hash: Hash(self.bytes()?),
            certificate: Certificate {
                hash: Hash(self.bytes()?),
                one_channel: self.margins()?,
                all_channels: self.margins()?,
                delay_max_s: self.f32()?,
                motor_lag_max_s: self.f32()?,
                f32_distance: self.f32()?,
            },
        })
    }

    #[inline(always)]
    fn rate(&mut self) -> Result<Rate, TableError> {
        let hz = self.u32()?;
        Rate::from_hz(hz).ok_or(TableError::Rate { hz })
    }

    #[inline(always)]
    fn limits(&mut self) -> Result<Limits, TableError> {
        let (thrust_min_m_s2, thrust_max_m_s2) = (self.f32()?, self.f32()?);
        let body_rates_max_rad_s = Vector3::new(self.f32()?, self.f32()?, self.f32()?);
        Limits::new(thrust_min_m_s2, thrust_max_m_s2, body_rates_max_rad_s).map_err(TableError::Limits)
    }

    #[inline(always)]
    fn margins(&mut self) -> Result<Margins, TableError> {
        Ok(Margins { gain_factor: self.f32()?, phase_rad: self.f32()? })
    }

    #[inline(always)]
    fn u32(&mut self) -> Result<u32, TableError> {
        self.bytes().map(u32::from_le_bytes)
    }

    #[inline(always)]
    fn f32(&mut self) -> Result<f32, TableError> {
        self.bytes().map(f32::from_le_bytes)
    }

    #[inline(always)]
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], TableError> {
        let (field, rest) = self.rest.split_first_chunk().ok_or(self.ended)?;
        self.rest = rest;
        Ok(*field)
    }
}

/// Puts fields at the start of a payload, in the order in which [`Reader`] takes them.
struct Writer<'b> {
    rest: &'b mut [u8],
}

impl Writer<'_> {
    fn head(&mut self, kind: TableKind, head: &TableHead) -> Option<()> {
        let TableHead { name, vehicle, rate, limits, design_hash, certificate } = head;
        let (rows, columns) = kind.dimensions();
        self.bytes(&[kind.number(), rows, columns])?;
        self.bytes(&name.padded())?;
        self.bytes(&vehicle.name.padded())?;
        self.bytes(&vehicle.id.to_le_bytes())?;
        self.bytes(&rate.hz().to_le_bytes())?;
        self.f32s(&[limits.thrust_min_m_s2(), limits.thrust_max_m_s2()])?;
        self.f32s(limits.body_rates_max_rad_s().as_slice())?;
        self.bytes(&design_hash.0)?;
        self.bytes(&certificate.hash.0)?;
        let Margins { gain_factor, phase_rad } = certificate.one_channel;
        self.f32s(&[gain_factor, phase_rad])?;
        let Margins { gain_factor, phase_rad } = certificate.all_channels;
        self.f32s(&[gain_factor, phase_rad])?;
        self.f32s(&[certificate.delay_max_s, certificate.motor_lag_max_s, certificate.f32_distance])
    }

    fn f32s(&mut self, values: &[f32]) -> Option<()> {
        values.iter().try_for_each(|value| self.bytes(&value.to_le_bytes()))
    }

    #[inline(never)]
    fn bytes(&mut self, field: &[u8]) -> Option<()> {
        let (place, rest) = core::mem::take(&mut self.rest).split_at_mut_checked(field.len())?;
        place.iter_mut().zip(field).for_each(|(place, byte)| *place = *byte);
        self.rest = rest;
        Some(())
    }
}

/// Reads as many entries as there are places, from as many times four bytes.
#[inline(never)]
pub(super) fn read_entries(bytes: &[u8], entries: &mut [f32]) {
    let (fields, _) = bytes.as_chunks();
    entries.iter_mut().zip(fields).for_each(|(entry, field)| *entry = f32::from_le_bytes(*field));
}

/// The payload of a frame that is whole and of this version.
pub(super) fn open(bytes: &[u8]) -> Result<&[u8], TableError> {
    let short = TableError::Length { bytes: count(bytes.len()), wanted: count(FRAME_BYTES) };
    let (magic, rest) = bytes.split_first_chunk::<4>().ok_or(short)?;
    if *magic != MAGIC {
        return Err(TableError::Magic { found: *magic });
    }
    let (version, rest) = rest.split_first_chunk::<2>().ok_or(short)?;
    let (length, rest) = rest.split_first_chunk::<2>().ok_or(short)?;
    let (payload, checksum) = rest.split_last_chunk::<4>().ok_or(short)?;
    let length = usize::from(u16::from_le_bytes(*length));
    if payload.len() != length {
        return Err(wrong_length(bytes, length));
    }
    let (stated, found) = (u32::from_le_bytes(*checksum), crc32c(bytes.strip_suffix(checksum).unwrap_or_default()));
    if stated != found {
        return Err(TableError::Checksum { stated, found });
    }
    match u16::from_le_bytes(*version) {
        FORMAT_VERSION => Ok(payload),
        found => Err(TableError::Version { found }),
    }
}

/// The error for `bytes` that should have a payload of another length.
pub(super) fn wrong_length(bytes: &[u8], payload: usize) -> TableError {
    TableError::Length { bytes: count(bytes.len()), wanted: count(payload.saturating_add(FRAME_BYTES)) }
}

/// Writes a table over the start of `buffer` and returns that part; nothing if it is too short. `fields` are a kind's
/// own, between the head and the gains.
pub(super) fn write<'b>(
    buffer: &'b mut [u8],
    kind: TableKind,
    head: &TableHead,
    fields: &[u8],
    entries: impl ExactSizeIterator<Item = f32>,
) -> Option<&'b [u8]> {
    let length = HEAD_BYTES + fields.len() + 4 * entries.len();
    let (frame, _) = buffer.split_at_mut_checked(FRAME_BYTES + length)?;
    let length = u16::try_from(length).ok()?;
    let (content, checksum) = frame.split_last_chunk_mut()?;
    let mut writer = Writer { rest: content };
    writer.bytes(&MAGIC)?;
    writer.bytes(&FORMAT_VERSION.to_le_bytes())?;
    writer.bytes(&length.to_le_bytes())?;
    writer.head(kind, head)?;
    writer.bytes(fields)?;
    for entry in entries {
        writer.bytes(&entry.to_le_bytes())?;
    }
    *checksum = crc32c(content).to_le_bytes();
    Some(frame)
}

#[cfg(all(test, feature = "link"))]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::gains::table::{GainTable, Rows, TABLE_BYTES_MAX};

    #[test]
    fn the_payload_is_postcards_output() {
        let rows = *crate::gains::paper::LQR_E.gain().rows();
        let margins = Margins { gain_factor: 2.0, phase_rad: 0.75 };
        let certificate = Certificate {
            hash: Hash([7; 32]),
            one_channel: margins,
            all_channels: margins,
            delay_max_s: 0.05,
            motor_lag_max_s: 0.025,
            f32_distance: 1e-8,
        };
        let (name, craft) = (Name::literal("lqr-e"), Name::literal("craft"));
        let head = TableHead {
            name,
            vehicle: Vehicle { name: craft, id: 0x8899_AABB },
            rate: Rate::from_hz(1000).unwrap(),
            limits: Limits::new(1.0, 16.0, Vector3::new(20.0, 21.0, 5.0)).unwrap(),
            design_hash: Hash([9; 32]),
            certificate,
        };
        let names = (name.padded(), craft.padded(), 0x8899_AABB_u32.to_le_bytes(), 1000_u32.to_le_bytes());
        let figures = [2.0_f32, 0.75, 2.0, 0.75, 0.05, 0.025, 1e-8];
        let fields =
            ((1_u8, 4_u8, 9_u8), names, [1.0_f32, 16.0, 20.0, 21.0, 5.0], [9_u8; 32], [7_u8; 32], figures, rows);
        let expected: Vec<u8> = postcard::to_slice(&fields, &mut [0; TABLE_BYTES_MAX]).unwrap().to_vec();

        let mut buffer = [0; TABLE_BYTES_MAX];
        let bytes = GainTable::new(head, &Rows::Equilibrium(rows)).unwrap().to_bytes(&mut buffer).unwrap();
        assert_eq!(open(bytes), Ok(&expected[..]));
    }
}
