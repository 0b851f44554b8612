//! The bytes of a table: a frame around a payload, a payload of fields of fixed width. The page docs/gain-tables.md has
//! every offset.
//!
//! The payload is postcard, of types that postcard writes at one width only (bytes, `f32`, fixed integers): one table
//! has one encoding, and a length tells whether it is whole.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::certificate::{Certificate, Hash, Margins, Vehicle};
use super::error::{TableError, count};
use super::name::Name;
use super::{TableHead, TableKind};
use crate::checksum::crc32c;
use crate::clock::Rate;
use crate::command::Limits;

/// What every table starts with, in every version.
pub const MAGIC: [u8; 4] = *b"QTGT";

/// Version of the payload. The frame (magic, version, length, checksum) is the same in all of them.
pub const FORMAT_VERSION: u16 = 1;

/// Magic, version and length before the payload, checksum behind it.
pub(super) const FRAME_BYTES: usize = 4 + 2 + 2 + 4;

/// Bytes of [`Wire`].
pub(super) const HEAD_BYTES: usize = 3 + 2 * Name::BYTES + 2 * 4 + 5 * 4 + 2 * 32 + 7 * 4;

/// The fields before the gains, as they stand.
#[derive(Serialize, Deserialize)]
pub(super) struct Wire {
    pub(super) kind: u8,
    pub(super) rows: u8,
    pub(super) columns: u8,
    name: [u8; Name::BYTES],
    vehicle_name: [u8; Name::BYTES],
    #[serde(with = "postcard::fixint::le")]
    vehicle_id: u32,
    #[serde(with = "postcard::fixint::le")]
    rate_hz: u32,
    thrust_min_m_s2: f32,
    thrust_max_m_s2: f32,
    body_rates_max_rad_s: [f32; 3],
    design_hash: [u8; 32],
    certificate_hash: [u8; 32],
    one_channel_gain: f32,
    one_channel_phase_rad: f32,
    all_channels_gain: f32,
    all_channels_phase_rad: f32,
    delay_max_s: f32,
    motor_lag_max_s: f32,
    f32_distance: f32,
}

impl Wire {
    pub(super) fn of(kind: TableKind, head: &TableHead) -> Self {
        let TableHead { name, vehicle, rate, limits, design_hash, certificate } = head;
        let (rows, columns) = kind.dimensions();
        Self {
            kind: kind.number(),
            rows,
            columns,
            name: name.padded(),
            vehicle_name: vehicle.name.padded(),
            vehicle_id: vehicle.id,
            rate_hz: rate.hz(),
            thrust_min_m_s2: limits.thrust_min_m_s2(),
            thrust_max_m_s2: limits.thrust_max_m_s2(),
            body_rates_max_rad_s: limits.body_rates_max_rad_s().into(),
            design_hash: design_hash.0,
            certificate_hash: certificate.hash.0,
            one_channel_gain: certificate.one_channel.gain_factor,
            one_channel_phase_rad: certificate.one_channel.phase_rad,
            all_channels_gain: certificate.all_channels.gain_factor,
            all_channels_phase_rad: certificate.all_channels.phase_rad,
            delay_max_s: certificate.delay_max_s,
            motor_lag_max_s: certificate.motor_lag_max_s,
            f32_distance: certificate.f32_distance,
        }
    }

    /// The kind, if the table has its dimensions.
    pub(super) fn table_kind(&self) -> Result<TableKind, TableError> {
        let &Self { kind, rows, columns, .. } = self;
        let kind = TableKind::numbered(kind).ok_or(TableError::Kind { found: kind })?;
        if (rows, columns) == kind.dimensions() {
            Ok(kind)
        } else {
            Err(TableError::Dimensions { kind, rows, columns })
        }
    }

    /// The fields as types that hold nothing wrong.
    pub(super) fn head(&self) -> Result<TableHead, TableError> {
        let [p, q, r] = self.body_rates_max_rad_s;
        Ok(TableHead {
            name: Name::from_padded(self.name).map_err(TableError::TableName)?,
            vehicle: Vehicle {
                name: Name::from_padded(self.vehicle_name).map_err(TableError::VehicleName)?,
                id: self.vehicle_id,
            },
            rate: Rate::from_hz(self.rate_hz).ok_or(TableError::Rate { hz: self.rate_hz })?,
            limits: Limits::new(self.thrust_min_m_s2, self.thrust_max_m_s2, Vector3::new(p, q, r))
                .map_err(TableError::Limits)?,
            design_hash: Hash(self.design_hash),
            certificate: Certificate {
                hash: Hash(self.certificate_hash),
                one_channel: Margins { gain_factor: self.one_channel_gain, phase_rad: self.one_channel_phase_rad },
                all_channels: Margins { gain_factor: self.all_channels_gain, phase_rad: self.all_channels_phase_rad },
                delay_max_s: self.delay_max_s,
                motor_lag_max_s: self.motor_lag_max_s,
                f32_distance: self.f32_distance,
            },
        })
    }
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

/// What to say of `bytes` that should have a payload of another length.
pub(super) fn wrong_length(bytes: &[u8], payload: usize) -> TableError {
    TableError::Length { bytes: count(bytes.len()), wanted: count(payload.saturating_add(FRAME_BYTES)) }
}

/// Writes the frame of a payload of `length` bytes, which `payload` writes, over the start of `buffer`.
pub(super) fn seal(buffer: &mut [u8], length: u16, payload: impl FnOnce(&mut [u8]) -> Option<()>) -> Option<&[u8]> {
    let (frame, _) = buffer.split_at_mut_checked(FRAME_BYTES + usize::from(length))?;
    let (content, checksum) = frame.split_last_chunk_mut::<4>()?;
    let (magic, rest) = content.split_first_chunk_mut::<4>()?;
    let (version, rest) = rest.split_first_chunk_mut::<2>()?;
    let (stated, rest) = rest.split_first_chunk_mut::<2>()?;
    *magic = MAGIC;
    *version = FORMAT_VERSION.to_le_bytes();
    *stated = length.to_le_bytes();
    payload(rest)?;
    *checksum = crc32c(content).to_le_bytes();
    Some(frame)
}
