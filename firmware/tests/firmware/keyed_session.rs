//! A board with a key: a host without it, with another one, or with recorded frames alone, gets nothing done.

use std::cell::Cell;

use proptest::prelude::*;
use proptest::sample::Index;
use quatrack::link::{
    Encoder, FRAME_BYTES, FaultReport, FromBoard, GivenKeys, HostSession, KEY_BYTES, Key, LoopStatistics, Nonce,
    Parameter, Protection, Refusal, StateIn, ToBoard,
};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::{Fault, Mode};
use quatrack::{State, Tick};
use quatrack_firmware::flight::{CONFIG, Flight};
use quatrack_firmware::kept::NoFlash;
use quatrack_firmware::provisioned::Keys;
use quatrack_firmware::session::{Session, Shared, Uploads, Vitals};

struct Here(Flight);

impl Shared for Here {
    fn with<R>(&mut self, access: impl FnOnce(&mut Flight) -> R) -> R {
        access(&mut self.0)
    }
}

/// A tick, and nonces that are counted: another one each time.
struct At<'a>(Tick, &'a Cell<u8>);

impl Vitals for At<'_> {
    fn now(&self) -> Tick {
        self.0
    }

    fn statistics(&self) -> LoopStatistics {
        LoopStatistics::default()
    }

    fn nonce(&self) -> Option<Nonce> {
        self.1.set(self.1.get() + 1);
        Some(Nonce([self.1.get(); 16]))
    }

    fn set_decimation(&self, _decimation: u32) {}
}

/// A key that is made when the test runs.
fn random_key() -> [u8; KEY_BYTES] {
    use std::hash::{BuildHasher, Hasher, RandomState};
    let mut bytes = [0; KEY_BYTES];
    for word in bytes.as_chunks_mut::<8>().0 {
        *word = RandomState::new().build_hasher().finish().to_le_bytes();
    }
    bytes
}

struct Board {
    flight: Here,
    session: Session<NoFlash>,
    now: Tick,
    nonces: Cell<u8>,
}

impl Board {
    fn with(key: [u8; KEY_BYTES], protection: Protection, fault: Option<FaultReport>) -> Self {
        let keys = Keys::of(&GivenKeys { link: Some((key, protection)), signing: None });
        let flight = Flight::new(Box::leak(Box::default()), None);
        let session = Session::new(Box::leak(Box::new(Uploads::new())), keys, NoFlash, fault);
        Self { flight: Here(flight), session, now: 0, nonces: Cell::new(0) }
    }

    /// The frames that some bytes are answered with.
    fn hear(&mut self, bytes: &[u8]) -> Vec<u8> {
        let at = At(self.now, &self.nonces);
        let mut out = Vec::new();
        let mut buffer = [0; FRAME_BYTES];
        for byte in bytes {
            for message in self.session.push(*byte, &mut self.flight, &at).into_iter().flatten() {
                out.extend_from_slice(self.session.frame(&message, &mut buffer).unwrap_or_default());
            }
        }
        if let Some(message) = self.session.unasked(&mut self.flight, &at) {
            out.extend_from_slice(self.session.frame(&message, &mut buffer).unwrap_or_default());
        }
        out
    }

    fn mode(&self) -> Mode {
        self.flight.0.mode()
    }
}

/// A host, and every frame that went over its line, for a listener.
struct Host {
    session: HostSession,
    sent: Vec<Vec<u8>>,
}

impl Host {
    fn new(number: u32, key: [u8; KEY_BYTES], nonce: u8) -> Self {
        Self { session: HostSession::keyed(number, Key::new(&key), Nonce([nonce; 16])), sent: Vec::new() }
    }

    fn frame(&mut self, message: &ToBoard) -> Vec<u8> {
        let frame = self.session.encode(message, &mut [0; FRAME_BYTES]).unwrap().to_vec();
        self.sent.push(frame.clone());
        frame
    }

    /// The messages that the host reads from some bytes.
    fn hear(&mut self, mut bytes: &[u8]) -> Vec<FromBoard> {
        let mut messages = Vec::new();
        while let Some((received, rest)) = self.session.next(bytes) {
            messages.push(received.message);
            bytes = rest;
        }
        messages
    }

    /// Sends a message and takes the answers.
    fn say(&mut self, board: &mut Board, message: &ToBoard) -> Vec<FromBoard> {
        let frame = self.frame(message);
        let answers = board.hear(&frame);
        self.hear(&answers)
    }

    fn greet(&mut self, board: &mut Board) -> bool {
        let hello = self.session.hello();
        matches!(self.say(board, &hello)[..], [FromBoard::Hello(_)])
    }
}

fn state() -> ToBoard {
    ToBoard::State(StateIn { tick: 0, state: State::at_rest(Vector3::zeros()) })
}

/// Armed by a pilot with the key, whose frames were all listened to.
fn armed(protection: Protection) -> (Board, Host, [u8; KEY_BYTES]) {
    let key = random_key();
    let (mut board, mut pilot) = (Board::with(key, protection, None), Host::new(1000, key, 1));
    assert!(pilot.greet(&mut board));
    pilot.say(&mut board, &state());
    assert!(matches!(pilot.say(&mut board, &ToBoard::Arm)[..], [FromBoard::Ack { .. }]));
    assert_eq!(board.mode(), Mode::Armed);
    (board, pilot, key)
}

const BOTH: [Protection; 2] = [Protection::Orders, Protection::Everything];

#[test]
fn the_pilot_arms_sets_and_disarms() {
    for protection in BOTH {
        let (mut board, mut pilot, _) = armed(protection);
        assert!(matches!(pilot.say(&mut board, &ToBoard::Disarm)[..], [FromBoard::Ack { .. }]));
        let volts = Parameter::BatteryVoltage(3.9);
        assert_eq!(pilot.say(&mut board, &ToBoard::SetParameter(volts)), [FromBoard::Parameter(volts)]);
        let hello = pilot.session.hello();
        assert!(matches!(pilot.say(&mut board, &hello)[..], [FromBoard::Hello(_)]), "asked again");
        assert!(matches!(pilot.say(&mut board, &ToBoard::Disarm)[..], [FromBoard::Ack { .. }]));
        assert_eq!(pilot.session.counters().rejected(), 0);
    }
}

#[test]
fn a_host_without_the_key_or_with_another_one_is_told_so_and_gets_nothing() {
    for protection in BOTH {
        let key = random_key();
        let mut board = Board::with(key, protection, None);
        let mut without = HostSession::new(5);
        let hello = without.encode(&ToBoard::Hello(Nonce::NONE), &mut [0; FRAME_BYTES]).unwrap().to_vec();
        let answers = board.hear(&hello);
        let (answer, _) = without.next(&answers).unwrap();
        assert_eq!(answer.message, FromBoard::Nack { sequence: 0, reason: Refusal::Key });
        let mut other = Host::new(6, random_key(), 1);
        assert!(!other.greet(&mut board), "its answer has no tag of that key");
        for message in [state(), ToBoard::Arm] {
            assert!(other.say(&mut board, &message).is_empty());
        }
        assert_eq!(board.mode(), Mode::OnGround);
        assert!(Host::new(7, key, 1).greet(&mut board), "a later session with the key");
    }
}

#[test]
fn no_host_believes_a_board_without_its_key() {
    let mut board = Board::with(random_key(), Protection::Everything, None);
    board.session = Session::new(Box::leak(Box::new(Uploads::new())), Keys::NONE, NoFlash, None);
    let mut host = Host::new(1, random_key(), 1);
    assert!(!host.greet(&mut board));
    assert_eq!(host.session.counters().unauthentic, 1);
}

#[test]
fn an_armed_craft_is_not_taken_over_not_even_after_silence() {
    for protection in BOTH {
        let (mut board, mut pilot, key) = armed(protection);
        let recorded = pilot.sent.clone();
        for number in [1000, 1001, 999, u32::MAX] {
            let mut thief = Host::new(number, random_key(), 9);
            let _ = thief.greet(&mut board);
            assert!(thief.say(&mut board, &ToBoard::Disarm).is_empty());
            let mut bare = Encoder::new(number);
            let hello = bare.encode(&ToBoard::Hello(Nonce::NONE), &mut [0; FRAME_BYTES]).unwrap().to_vec();
            let disarm = bare.encode(&ToBoard::Disarm, &mut [0; FRAME_BYTES]).unwrap().to_vec();
            board.hear(&[hello, disarm].concat());
            assert_eq!(board.mode(), Mode::Armed);
        }
        // Silence. Recorded frames are sent again: they are no sign of life, and open nothing.
        board.now = CONFIG.link_silence_max_ticks + 1;
        for frame in &recorded {
            board.hear(frame);
        }
        assert!(board.flight.0.is_link_silent(board.now));
        assert_eq!(board.mode(), Mode::Armed);
        // The pilot is back, with an earlier number, say.
        let mut back = Host::new(900, key, 2);
        board.now += CONFIG.link_silence_max_ticks + 1;
        assert!(back.greet(&mut board));
        assert!(matches!(back.say(&mut board, &ToBoard::Disarm)[..], [FromBoard::Ack { .. }]));
        assert_eq!(board.mode(), Mode::OnGround);
        assert!(pilot.say(&mut board, &ToBoard::Arm).is_empty(), "the session before is over");
    }
}

#[test]
fn an_arm_that_was_recorded_arms_nothing_in_its_session_or_after_a_restart() {
    for protection in BOTH {
        let (mut board, mut pilot, key) = armed(protection);
        pilot.say(&mut board, &ToBoard::Disarm);
        pilot.say(&mut board, &state());
        for frame in &pilot.sent {
            assert!(board.hear(frame).is_empty());
        }
        assert_eq!(board.mode(), Mode::OnGround);
        // The board restarts, and hears all of it from the hello on. Its nonce is another one.
        let nonces = board.nonces.get();
        let mut board = Board::with(key, protection, None);
        board.nonces.set(nonces);
        for frame in &pilot.sent {
            board.hear(frame);
        }
        assert_eq!(board.mode(), Mode::OnGround);
        // A session that recorded frames ask for is in nobody's way.
        let mut pilot = Host::new(1001, key, 3);
        assert!(pilot.greet(&mut board));
        pilot.say(&mut board, &state());
        assert!(matches!(pilot.say(&mut board, &ToBoard::Arm)[..], [FromBoard::Ack { .. }]));
    }
}

#[test]
fn a_session_that_is_asked_for_does_not_end_the_open_one() {
    let (mut board, mut pilot, key) = armed(Protection::Everything);
    pilot.say(&mut board, &ToBoard::Disarm);
    let mut second = Host::new(1001, key, 2);
    assert!(second.greet(&mut board));
    assert!(matches!(pilot.say(&mut board, &ToBoard::TelemetryRequest)[..], [FromBoard::Telemetry(_)]));
    assert!(matches!(second.say(&mut board, &ToBoard::TelemetryRequest)[..], [FromBoard::Telemetry(_)]));
    assert!(pilot.say(&mut board, &ToBoard::TelemetryRequest).is_empty());
}

#[test]
fn states_without_a_tag_are_flown_on_a_cable_alone_and_make_no_order_late() {
    for protection in BOTH {
        let (mut board, mut pilot, _) = armed(protection);
        let before = board.flight.0.is_waiting();
        // Somebody goes on in the pilot's session, as far as numbers go.
        let mut forger = Encoder::new(1000);
        while forger.next_sequence() < Some(1_000) {
            let _ = forger.encode(&ToBoard::UploadQuery, &mut [0; FRAME_BYTES]);
        }
        for message in
            [state(), ToBoard::Disarm, ToBoard::UploadQuery, ToBoard::SetParameter(Parameter::BatteryVoltage(3.9))]
        {
            let forged = forger.encode(&message, &mut [0; FRAME_BYTES]).unwrap().to_vec();
            assert!(board.hear(&forged).is_empty());
        }
        assert!(before && board.mode() == Mode::Armed);
        assert!(matches!(pilot.say(&mut board, &ToBoard::Disarm)[..], [FromBoard::Ack { .. }]));
    }
}

#[test]
fn a_fault_is_told_once_the_session_is_open() {
    let key = random_key();
    let fault = FaultReport { fault: Fault::HardFault, tick: 0, address: 0x0800_0000 };
    let (mut board, mut host) = (Board::with(key, Protection::Everything, Some(fault)), Host::new(1, key, 1));
    assert!(host.greet(&mut board), "the identity alone: a message with it could not have a tag yet");
    let answers = host.say(&mut board, &ToBoard::TelemetryRequest);
    assert!(matches!(answers[..], [FromBoard::Telemetry(_), FromBoard::Fault(found)] if found == fault), "{answers:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// Any part of the recorded frames, in any order, as often as you like, cut and altered: nothing that the pilot did
    /// not want happens.
    #[test]
    fn nothing_that_was_heard_arms_again(
        everything in any::<bool>(),
        order in prop::collection::vec((any::<Index>(), 0..4_u8, any::<Index>()), 1..60),
    ) {
        let protection = if everything { Protection::Everything } else { Protection::Orders };
        let (mut board, mut pilot, _) = armed(protection);
        pilot.say(&mut board, &ToBoard::Disarm);
        pilot.say(&mut board, &state());
        for (frame, change, at) in order {
            let mut frame = frame.get(&pilot.sent).clone();
            match change {
                0 => frame = frame[..at.index(frame.len())].to_vec(),
                1 => {
                    let at = at.index(frame.len());
                    frame[at] ^= 1;
                }
                _ => {}
            }
            frame.push(0);
            board.hear(&frame);
            prop_assert_eq!(board.mode(), Mode::OnGround);
        }
        let answers = pilot.say(&mut board, &ToBoard::Arm);
        prop_assert!(matches!(answers[..], [FromBoard::Ack { .. }]), "the pilot goes on: {answers:?}");
    }
}

/// A frame of the pilot whose tag is cut, filled up, or of another frame, with the checksum that belongs to it.
#[test]
fn a_tag_that_is_cut_or_of_another_frame_is_none() {
    let (mut board, mut pilot, _) = armed(Protection::Everything);
    let (disarm, query) = (pilot.frame(&ToBoard::Disarm), pilot.frame(&ToBoard::UploadQuery));
    let (disarm, query) = (unframed(&disarm), unframed(&query));
    let (message, tag) = disarm.split_at(disarm.len() - 16);
    let (_, other) = query.split_at(query.len() - 16);
    let mut damaged = tag.to_vec();
    for bytes in 0..16 {
        assert!(board.hear(&framed(&[message, &tag[..bytes]].concat())).is_empty(), "{bytes} bytes of it");
        damaged[bytes] ^= 0x80;
        assert!(board.hear(&framed(&[message, &damaged].concat())).is_empty(), "byte {bytes} altered");
        damaged[bytes] ^= 0x80;
    }
    assert!(board.hear(&framed(&[message, other].concat())).is_empty());
    assert!(board.hear(&framed(&[message, tag, &[0]].concat())).is_empty());
    assert_eq!(board.mode(), Mode::Armed);
    board.hear(&framed(&[message, tag].concat()));
    assert_eq!(board.mode(), Mode::OnGround, "the frame itself");
}

/// The bytes of a frame before its checksum.
fn unframed(frame: &[u8]) -> Vec<u8> {
    let (mut bytes, mut rest) = (Vec::new(), frame);
    while let Some((&code @ 1.., after)) = rest.split_first() {
        let (block, left) = after.split_at(usize::from(code) - 1);
        if !bytes.is_empty() || rest.len() < frame.len() {
            bytes.push(0);
        }
        bytes.extend_from_slice(block);
        rest = left;
    }
    bytes.truncate(bytes.len() - 4);
    bytes
}

/// A frame of some bytes, as its paper has COBS.
fn framed(content: &[u8]) -> Vec<u8> {
    let whole = [content, &quatrack::link::crc32c(content).to_le_bytes()].concat();
    let blocks = whole.split(|byte| *byte == 0);
    blocks.flat_map(|block| [&[block.len() as u8 + 1], block].concat()).chain([0]).collect()
}
