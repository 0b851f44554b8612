//! A hello in; the board's name and version, with the keys of a session where it has one, out.

use quatrack::link::{FromBoard, Identity, Nonce, Received, TRAJECTORY_PIECES, ToBoard, Version};

use super::{Answers, Session, Shared, Vitals};
use crate::flight::TICK_RATE_HZ;
use crate::kept::Keep;

/// Identifies the control path: a checksum of the sources that compute commands, by the build script.
const CONTROL_IMAGE: u32 = include!(concat!(env!("OUT_DIR"), "/control_image.rs"));

impl<K: Keep> Session<K> {
    pub(super) fn greet(
        &mut self,
        hello: &Received<ToBoard>,
        host: Nonce,
        flight: &mut impl Shared,
        vitals: &impl Vitals,
        answers: &mut Answers,
    ) -> Option<FromBoard> {
        let Received { session, sequence, .. } = *hello;
        let greeted = match self.speaker.greet(session, host, || vitals.nonce()) {
            Ok(greeted) => greeted,
            Err(reason) => return Some(FromBoard::Nack { sequence, reason }),
        };
        if let Some(seal) = greeted.to_board {
            self.decoder.propose(session, sequence, seal);
        }
        let identity = Identity {
            firmware: version(),
            control_image: CONTROL_IMAGE,
            tick_rate_hz: TICK_RATE_HZ,
            decimation: flight.with(|flight| flight.decimation()),
            trajectory_pieces: TRAJECTORY_PIECES as u32,
            protection: self.speaker.protection(),
            signed_tables: self.signatures.are_asked_for(),
            nonce: greeted.nonce,
        };
        // There is room for two.
        let _ = answers.push(FromBoard::Hello(identity));
        if self.speaker.has_key() {
            // Told once the session is open.
            return None;
        }
        self.fault_told = true;
        self.fault.map(FromBoard::Fault)
    }
}

/// The package's version.
fn version() -> Version {
    let number = |text: &str| {
        text.bytes().fold(0_u16, |sum, digit| sum.wrapping_mul(10).wrapping_add(u16::from(digit.wrapping_sub(b'0'))))
    };
    Version {
        major: number(env!("CARGO_PKG_VERSION_MAJOR")),
        minor: number(env!("CARGO_PKG_VERSION_MINOR")),
        patch: number(env!("CARGO_PKG_VERSION_PATCH")),
    }
}
