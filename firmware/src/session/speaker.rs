//! Frames to the host: messages in; frames of the open session, or of one that is being opened, out, with their tags
//! where there is a key.

use quatrack::link::{
    Encoder, FRAME_BYTES, FromBoard, Key, Message as _, Nonce, Protection, Refusal, Rejected, Seal, SessionSeals,
};

/// Numbers and seals of one session.
struct Conversation {
    encoder: Encoder,
    host: Nonce,
    board: Nonce,
    seals: Option<SessionSeals>,
}

/// The open session, and the one that a host has asked for.
pub(super) struct Speaker {
    link: Option<(Key, Protection)>,
    open: Option<Conversation>,
    /// Somebody with the key has asked for it; its first frame opens it. Without a key there is none.
    proposed: Option<Conversation>,
    /// The session that the next identity is for.
    greeting: u32,
    /// The session of a host that is refused for its key.
    stranger: Encoder,
}

/// The answer to a hello.
pub(super) struct Greeted {
    /// The board's.
    pub(super) nonce: Nonce,
    /// Checks the tags of incoming frames, of a session that is not open yet.
    pub(super) to_board: Option<Seal>,
}

impl Speaker {
    pub(super) const fn new(link: Option<(Key, Protection)>) -> Self {
        Self { link, open: None, proposed: None, greeting: 0, stranger: Encoder::new(0) }
    }

    pub(super) const fn has_key(&self) -> bool {
        self.link.is_some()
    }

    pub(super) fn protection(&self) -> Protection {
        self.link.as_ref().map_or(Protection::CableOnly, |(_, protection)| *protection)
    }

    pub(super) const fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Takes a hello. The same one again gets the same nonce.
    pub(super) fn greet(
        &mut self,
        session: u32,
        host: Nonce,
        fresh: impl FnOnce() -> Option<Nonce>,
    ) -> Result<Greeted, Refusal> {
        self.greeting = session;
        let Some((key, _)) = &self.link else {
            if self.open.as_ref().is_none_or(|open| open.encoder.session() != session) {
                let encoder = Encoder::new(session);
                self.open = Some(Conversation { encoder, host, board: Nonce::NONE, seals: None });
            }
            return Ok(Greeted { nonce: Nonce::NONE, to_board: None });
        };
        let is_it = |talk: &&Conversation| talk.encoder.session() == session && talk.host == host;
        if let Some(open) = self.open.as_ref().filter(is_it) {
            return Ok(Greeted { nonce: open.board, to_board: None });
        }
        let known = self.proposed.as_ref().filter(is_it).map(|proposed| proposed.board);
        let Some(board) = known.or_else(fresh) else {
            self.stranger = Encoder::new(session);
            return Err(Refusal::NoNonce);
        };
        let seals = key.session(session, &host, &board);
        let to_board = Some(seals.to_board.clone());
        match &mut self.proposed {
            Some(proposed) if known.is_some() => proposed.seals = Some(seals),
            proposed => {
                let encoder = Encoder::new(session);
                *proposed = Some(Conversation { encoder, host, board, seals: Some(seals) });
            }
        }
        Ok(Greeted { nonce: board, to_board })
    }

    /// Takes the session of a frame that was accepted; whether it is the first one of the session.
    pub(super) fn goes_over_to(&mut self, session: u32) -> bool {
        let proposed = self.proposed.take_if(|proposed| proposed.encoder.session() == session);
        let is_first = proposed.is_some();
        if is_first {
            self.open = proposed;
        }
        is_first
    }

    /// The answer to a hello without the right tag. Every frame with a wrong tag that is of no open session is such a
    /// hello.
    pub(super) fn turned_away(&mut self, rejected: Rejected) -> Option<FromBoard> {
        let Rejected::Unauthentic { session, sequence } = rejected else { return None };
        if self.open.as_ref().is_some_and(|open| open.encoder.session() == session) {
            return None;
        }
        self.stranger = Encoder::new(session);
        Some(FromBoard::Nack { sequence, reason: Refusal::Key })
    }

    pub(super) fn frame<'b>(&mut self, message: &FromBoard, buffer: &'b mut [u8; FRAME_BYTES]) -> Option<&'b [u8]> {
        let protection = self.protection();
        let Self { link, open, proposed, greeting, stranger } = self;
        match message {
            FromBoard::Nack { reason: Refusal::Key | Refusal::NoNonce, .. } => stranger.encode(message, buffer).ok(),
            FromBoard::Hello(_) => {
                let talk = [proposed, open].into_iter().flatten().find(|talk| talk.encoder.session() == *greeting)?;
                let seal = link.as_ref().map(|(key, _)| key.answer(&talk.host));
                talk.encoder.encode_sealed(message, seal.as_ref(), buffer).ok()
            }
            _ => {
                let talk = open.as_mut()?;
                let seals = talk.seals.as_ref().filter(|_| protection.covers(message.tagging()));
                talk.encoder.encode_sealed(message, seals.map(|seals| &seals.from_board), buffer).ok()
            }
        }
    }
}
