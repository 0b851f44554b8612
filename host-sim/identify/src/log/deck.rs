//! The binary log of Bitcraze's micro SD deck, versions 1 and 2: bytes in, series out.
//!
//! Format: Bitcraze, crazyflie-firmware, `docs/functional-areas/uSD-card` and `src/deck/drivers/src/usddeck.c`. A byte 0xBC, the
//! version and the number of kinds of events (u16 each, little endian); for each kind its id (u16), its name ended by a zero
//! byte, the number of its variables (u16), and their names, each followed by its type in brackets and a zero byte. Then events: id (u16), time
//! (version 1: u32, ms; version 2: u64, us), the values one after the other. The last four bytes are the CRC-32 of all before.

use std::collections::BTreeMap;

use super::{RawLog, Series};
use crate::IdentifyError;

pub(super) const MAGIC: u8 = 0xBC;

/// A kind of event: names and types of its variables.
struct Kind {
    variables: Vec<(String, u8)>,
}

struct Cursor<'a> {
    left: &'a [u8],
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, left) = self.left.split_at_checked(count)?;
        self.left = left;
        Some(taken)
    }

    fn unsigned(&mut self, bytes: usize) -> Option<u64> {
        Some(self.take(bytes)?.iter().rev().fold(0, |value, byte| (value << 8) | u64::from(*byte)))
    }

    fn text(&mut self) -> Option<String> {
        let end = self.left.iter().position(|byte| *byte == 0)?;
        let text = String::from_utf8_lossy(self.take(end)?).into_owned();
        self.take(1)?;
        Some(text)
    }

    /// A value by its type letter, those of Python's `struct`.
    fn value(&mut self, kind: u8) -> Option<f64> {
        Some(match kind {
            b'B' => self.unsigned(1)? as f64,
            b'b' => f64::from(self.unsigned(1)? as u8 as i8),
            b'H' => self.unsigned(2)? as f64,
            b'h' => f64::from(self.unsigned(2)? as u16 as i16),
            b'I' | b'L' => self.unsigned(4)? as f64,
            b'i' | b'l' => f64::from(self.unsigned(4)? as u32 as i32),
            b'Q' => self.unsigned(8)? as f64,
            b'q' => self.unsigned(8)? as i64 as f64,
            b'f' => f64::from(f32::from_bits(self.unsigned(4)? as u32)),
            b'd' => f64::from_bits(self.unsigned(8)?),
            b'e' => half(self.unsigned(2)? as u16),
            _ => return None,
        })
    }
}

/// IEEE 754 half precision.
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    let size = match exponent {
        0 => fraction * 2_f64.powi(-24),
        31 => f64::NAN,
        _ => (1.0 + fraction / 1024.0) * 2_f64.powi(exponent - 15),
    };
    if bits >> 15 == 1 { -size } else { size }
}

pub(super) fn parse(bytes: &[u8], name: &str) -> Result<RawLog, IdentifyError> {
    let format = |reason: &str| IdentifyError::Format { path: name.to_owned(), reason: reason.to_owned() };
    let cut = || format("this log of the micro SD deck ends before its head does; copy it from the card again");
    let body = bytes.get(1..bytes.len().saturating_sub(4)).ok_or_else(cut)?;
    let mut cursor = Cursor { left: body };
    let version = cursor.unsigned(2).ok_or_else(cut)?;
    if version != 1 && version != 2 {
        return Err(format(&format!("version {version} of the micro SD deck's log is not known: 1 and 2 are")));
    }
    let kinds = cursor.unsigned(2).ok_or_else(cut)?;
    let mut by_id = BTreeMap::new();
    for _ in 0..kinds {
        let id = cursor.unsigned(2).ok_or_else(cut)?;
        cursor.text().ok_or_else(cut)?;
        let count = cursor.unsigned(2).ok_or_else(cut)?;
        let mut variables = Vec::new();
        for _ in 0..count {
            let text = cursor.text().ok_or_else(cut)?;
            let typed = text.strip_suffix(')').and_then(|text| text.rsplit_once('('));
            let (variable, kind) = typed.ok_or_else(|| format("a variable without its type in brackets"))?;
            variables.push((variable.to_owned(), kind.bytes().next().unwrap_or(b'?')));
        }
        by_id.insert(id, Kind { variables });
    }
    let mut series: BTreeMap<String, Series> = BTreeMap::new();
    // The card may have been taken out in the middle of an event: whole events count.
    while let Some((id, time_ms)) = head(&mut cursor, version) {
        let Some(kind) = by_id.get(&id) else { break };
        for (variable, letter) in &kind.variables {
            let Some(value) = cursor.value(*letter) else { break };
            let one = series.entry(variable.clone()).or_default();
            one.times.push(time_ms);
            one.values.push(value);
        }
    }
    if series.is_empty() {
        return Err(format("no event in this log of the micro SD deck"));
    }
    Ok(RawLog { name: name.to_owned(), series, timed: true })
}

fn head(cursor: &mut Cursor<'_>, version: u64) -> Option<(u64, f64)> {
    let id = cursor.unsigned(2)?;
    let time_ms = if version == 1 { cursor.unsigned(4)? as f64 } else { cursor.unsigned(8)? as f64 / 1000.0 };
    Some((id, time_ms))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_versions_are_read() {
        for version in [1_u16, 2] {
            let mut bytes = vec![MAGIC];
            bytes.extend(version.to_le_bytes());
            bytes.extend(1_u16.to_le_bytes());
            bytes.extend(7_u16.to_le_bytes());
            bytes.extend(b"fixedFrequency\0");
            bytes.extend(3_u16.to_le_bytes());
            bytes.extend(b"gyro.x(f)\0motor.m1(H)\0stateEstimateZ.x(h)\0");
            for k in 0..5_u16 {
                bytes.extend(7_u16.to_le_bytes());
                if version == 1 {
                    bytes.extend(u32::from(k * 10).to_le_bytes());
                } else {
                    bytes.extend((u64::from(k) * 10_000).to_le_bytes());
                }
                bytes.extend((0.5 * f32::from(k)).to_le_bytes());
                bytes.extend((60_000 + k).to_le_bytes());
                bytes.extend((-3_i16).to_le_bytes());
            }
            // Cut in the middle of an event, then the check sum.
            bytes.extend([7, 0, 1]);
            bytes.extend([0; 4]);
            let log = parse(&bytes, "log00").unwrap();
            assert_eq!(log.series["gyro.x"].values, [0.0, 0.5, 1.0, 1.5, 2.0]);
            assert_eq!(log.series["gyro.x"].times, [0.0, 10.0, 20.0, 30.0, 40.0]);
            assert_eq!(log.series["motor.m1"].values[4], 60_004.0);
            assert_eq!(log.series["stateEstimateZ.x"].values[0], -3.0);
        }
    }

    #[test]
    fn half_precision_is_read() {
        // IEEE 754: 0x3C00 is 1, 0xC000 is -2, 0x0001 the least, 2^-24.
        assert_eq!([half(0x3C00), half(0xC000), half(1)], [1.0, -2.0, 2_f64.powi(-24)]);
    }
}
