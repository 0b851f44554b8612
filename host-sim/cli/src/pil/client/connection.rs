//! A line to a board in; a client that has greeted it, with a session where the board has a key, out.

use std::time::{SystemTime, UNIX_EPOCH};

use quatrack::link::{FromBoard, HostSession, Identity, Key, Nonce, Protection, Refusal};

use super::Client;
use crate::pil::PilError;
use crate::pil::emulator::Emulator;
use crate::pil::interrupt::Interrupt;
use crate::pil::line::Line;

impl Client {
    /// Opens a session, with the board's key where it has one. The emulator, where there is one, lives as long as the connection.
    ///
    /// # Errors
    /// [`PilError::Silent`] where nobody answers in the protocol's version, or with this key; [`PilError::Refused`] where the
    /// board has a key and none is given.
    pub fn connect(
        line: Line,
        emulator: Option<Emulator>,
        key: Option<Key>,
        interrupt: Interrupt,
    ) -> Result<Self, PilError> {
        // Later than any session before it, as the board wants it.
        let session = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs() as u32;
        Self::open(session, line, emulator, key, interrupt)
    }

    fn open(
        number: u32,
        line: Line,
        emulator: Option<Emulator>,
        key: Option<Key>,
        interrupt: Interrupt,
    ) -> Result<Self, PilError> {
        let session = match key.clone() {
            Some(key) => HostSession::keyed(number, key, nonce()?),
            None => HostSession::new(number),
        };
        let mut client =
            Self { line, emulator, interrupt, session, key, received: Vec::new(), identity: NOBODY, fault: None };
        // Ends any noise before it.
        client.line.send(&[quatrack::link::DELIMITER])?;
        let hello = client.session.hello();
        let answer = client.exchange(&hello, "the board does not say hello", |answer, _| match answer {
            FromBoard::Hello(identity) => Some(Ok(*identity)),
            FromBoard::Nack { reason: reason @ (Refusal::Key | Refusal::NoNonce), .. } => Some(Err(*reason)),
            _ => None,
        })?;
        client.identity = answer
            .map_err(|reason| PilError::Refused { request: "the hello".to_owned(), reason: reason.to_string() })?;
        Ok(client)
    }

    /// Opens a new session with the same board, which may have restarted.
    ///
    /// # Errors
    /// As [`Client::connect`].
    pub fn reconnect(self) -> Result<Self, PilError> {
        let number = self.session.session().wrapping_add(1);
        Self::open(number, self.line, self.emulator, self.key, self.interrupt)
    }
}

/// The identity of a board that has not answered yet.
const NOBODY: Identity = Identity {
    firmware: quatrack::link::Version { major: 0, minor: 0, patch: 0 },
    control_image: 0,
    tick_rate_hz: 0,
    decimation: 0,
    trajectory_pieces: 0,
    protection: Protection::CableOnly,
    signed_tables: false,
    nonce: Nonce::NONE,
};

/// Sixteen bytes of the system's random numbers.
fn nonce() -> Result<Nonce, PilError> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|error| PilError::io("taking random numbers")(error.into()))?;
    Ok(Nonce(bytes))
}
