//! The session as several hosts use it, over a cable.

use quatrack::State;
use quatrack::link::{Encoder, StateIn};
use quatrack::nalgebra::Vector3;
use quatrack::supervisor::Mode;

use super::*;
use crate::flight::{CONFIG, Flight};
use crate::kept::NoFlash;

struct Here(Flight);

impl Shared for Here {
    fn with<R>(&mut self, access: impl FnOnce(&mut Flight) -> R) -> R {
        access(&mut self.0)
    }
}

struct At(Tick);

impl Vitals for At {
    fn now(&self) -> Tick {
        self.0
    }

    fn statistics(&self) -> LoopStatistics {
        LoopStatistics::default()
    }

    fn nonce(&self) -> Option<Nonce> {
        Some(Nonce([0xB0; 16]))
    }

    fn set_decimation(&self, _decimation: u32) {}
}

struct Board {
    flight: Here,
    session: Session<NoFlash>,
    now: Tick,
}

impl Board {
    fn new() -> Self {
        let flight = Flight::new(Box::leak(Box::default()), None);
        let session = Session::new(Box::leak(Box::new(Uploads::new())), Keys::NONE, NoFlash, None);
        Self { flight: Here(flight), session, now: 0 }
    }

    /// Whether somebody's message was taken.
    fn hears(&mut self, from: &mut Encoder, message: &ToBoard) -> bool {
        let mut buffer = [0; FRAME_BYTES];
        let frame = from.encode(message, &mut buffer).unwrap().to_vec();
        let at = At(self.now);
        frame.iter().any(|byte| self.session.push(*byte, &mut self.flight, &at).is_some())
    }

    /// Armed by a pilot.
    fn armed() -> (Self, Encoder) {
        let (mut board, mut pilot) = (Self::new(), Encoder::new(1000));
        let state = StateIn { tick: 0, state: State::at_rest(Vector3::new(0.0, 0.0, 0.0)) };
        for message in [ToBoard::Hello(Nonce::NONE), ToBoard::State(state), ToBoard::Arm] {
            assert!(board.hears(&mut pilot, &message));
        }
        assert_eq!(board.flight.0.mode(), Mode::Armed);
        (board, pilot)
    }
}

#[test]
fn nobody_takes_over_an_armed_craft_but_the_pilot_goes_on() {
    let (mut board, mut pilot) = Board::armed();
    for number in [1001, 2000, 999, u32::MAX] {
        let mut thief = Encoder::new(number);
        assert!(!board.hears(&mut thief, &ToBoard::Hello(Nonce::NONE)) && !board.hears(&mut thief, &ToBoard::Disarm));
    }
    assert_eq!(board.flight.0.mode(), Mode::Armed);
    assert!(board.hears(&mut pilot, &ToBoard::Disarm));
    assert!(board.hears(&mut Encoder::new(1001), &ToBoard::Hello(Nonce::NONE)), "a later session, on the ground");
    assert!(!board.hears(&mut Encoder::new(999), &ToBoard::Hello(Nonce::NONE)), "an earlier one has been replayed");
}

#[test]
fn after_silence_a_hello_of_any_number_is_taken() {
    for number in [0, 999, 1001, 1000_u32.wrapping_sub(1 << 31)] {
        let (mut board, _) = Board::armed();
        board.now = CONFIG.link_silence_max_ticks;
        assert!(!board.hears(&mut Encoder::new(number), &ToBoard::Hello(Nonce::NONE)), "not yet");
        board.now += 1;
        assert!(board.hears(&mut Encoder::new(number), &ToBoard::Hello(Nonce::NONE)));
    }
}

#[test]
fn a_frame_is_not_taken_twice() {
    let (mut board, mut pilot) = Board::armed();
    let mut buffer = [0; FRAME_BYTES];
    let frame = pilot.encode(&ToBoard::Disarm, &mut buffer).unwrap().to_vec();
    let at = At(0);
    let hear = |board: &mut Board| frame.iter().any(|byte| board.session.push(*byte, &mut board.flight, &at).is_some());
    assert!(hear(&mut board) && !hear(&mut board));
}
