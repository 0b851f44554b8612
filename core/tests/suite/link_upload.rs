//! Uploads over a line that loses, alters, repeats and delays frames, in both directions: the trajectory that arrives is
//! the one that was sent, and until it is whole and sound the one before it stays in use.

use proptest::collection::vec;
use proptest::prelude::*;
use quatrack::link::{
    BlobKind, BlobReceiver, Decoder, Encoder, FRAME_BYTES, FromBoard, Nonce, Refusal, TRAJECTORY_BLOB_BYTES,
    TRAJECTORY_PIECES, ToBoard, TrajectoryStore, UploadBegin, UploadError, encode_trajectory,
};
use quatrack::{Piece, Player, Rate, Trajectory};

/// The line's effect on a frame.
#[derive(Clone, Copy, Debug)]
enum Fate {
    Arrives,
    Lost,
    Twice,
    /// Arrives after the next one.
    Late,
    /// With this bit flipped, counted from its start.
    Altered(usize),
}

fn fate() -> impl Strategy<Value = Fate> {
    prop_oneof![
        6 => Just(Fate::Arrives),
        1 => Just(Fate::Lost),
        1 => Just(Fate::Twice),
        1 => Just(Fate::Late),
        1 => any::<prop::sample::Index>().prop_map(|bit| Fate::Altered(bit.index(FRAME_BYTES * 8)))
    ]
}

/// One direction of the line: frames go in, bytes come out.
struct Line {
    fates: Box<dyn Iterator<Item = Fate>>,
    late: Vec<u8>,
}

impl Line {
    fn new(fates: Vec<Fate>) -> Self {
        Self { fates: Box::new(fates.into_iter().cycle()), late: Vec::new() }
    }

    fn carry(&mut self, frame: &[u8]) -> Vec<u8> {
        let mut frame = frame.to_vec();
        let before = std::mem::take(&mut self.late);
        match self.fates.next() {
            Some(Fate::Lost) => frame.clear(),
            Some(Fate::Twice) => frame = frame.repeat(2),
            Some(Fate::Late) => self.late = std::mem::take(&mut frame),
            Some(Fate::Altered(bit)) => {
                let bit = bit % (frame.len() * 8);
                frame[bit / 8] ^= 1 << (bit % 8);
            }
            Some(Fate::Arrives) | None => {}
        }
        frame.extend(before);
        frame
    }
}

struct Board {
    decoder: Decoder<ToBoard>,
    encoder: Encoder,
    receiver: BlobReceiver<TRAJECTORY_BLOB_BYTES>,
    store: TrajectoryStore<TRAJECTORY_PIECES>,
}

impl Board {
    fn hear(&mut self, mut bytes: &[u8]) -> Vec<Vec<u8>> {
        let mut frames = Vec::new();
        let mut buffer = [0; FRAME_BYTES];
        while let Some((received, rest)) = self.decoder.next(bytes) {
            bytes = rest;
            self.encoder.follow(received.session);
            let sequence = received.sequence;
            let answer = self.answer(sequence, &received.message);
            let answer = answer.unwrap_or_else(|reason| FromBoard::Nack { sequence, reason });
            frames.push(self.encoder.encode(&answer, &mut buffer).unwrap().to_vec());
        }
        frames
    }

    fn answer(&mut self, sequence: u32, message: &ToBoard) -> Result<FromBoard, Refusal> {
        let progress = match message {
            ToBoard::Hello(_) => return Ok(FromBoard::Ack { sequence }),
            ToBoard::UploadBegin(begin) => self.receiver.begin(begin),
            ToBoard::UploadChunk(chunk) => self.receiver.chunk(chunk),
            ToBoard::UploadQuery => self.receiver.progress(),
            ToBoard::UploadCommit { id } => {
                let (_, blob) = self.receiver.finish(*id).map_err(Refusal::Upload)?;
                self.store.commit(blob).map_err(Refusal::Blob)?;
                return Ok(FromBoard::Ack { sequence });
            }
            other => panic!("the host sends no {other:?}"),
        };
        progress.map(FromBoard::Upload).map_err(Refusal::Upload)
    }

    fn duration_ns(&self) -> Option<u64> {
        self.store.active().trajectory().map(|trajectory| trajectory.duration_ns())
    }
}

/// A host that sends one request at a time, and on silence asks for its progress.
struct Host {
    encoder: Encoder,
    decoder: Decoder<FromBoard>,
    blob: Vec<u8>,
    begin: UploadBegin,
}

impl Host {
    /// The next frame after the answer to the last request, or after none.
    fn next(&self, answer: Option<FromBoard>) -> Option<ToBoard> {
        Some(match answer {
            Some(FromBoard::Upload(progress)) => progress
                .next_chunk(&self.blob)
                .map_or(ToBoard::UploadCommit { id: self.begin.id }, ToBoard::UploadChunk),
            Some(FromBoard::Nack { reason: Refusal::Upload(UploadError::NotBegun), .. }) => {
                ToBoard::UploadBegin(self.begin)
            }
            Some(FromBoard::Ack { .. }) => return None,
            _ => ToBoard::UploadQuery,
        })
    }

    fn hear(&mut self, mut bytes: &[u8], asked: u32) -> Option<FromBoard> {
        let mut last = None;
        while let Some((received, rest)) = self.decoder.next(bytes) {
            bytes = rest;
            // An acknowledgement of another request says nothing about this one.
            let stray = matches!(received.message, FromBoard::Ack { sequence } if sequence != asked);
            last = if stray { last } else { Some(received.message) };
        }
        last
    }
}

/// Straight from height to height, a second each.
fn pieces(heights_m: &[f32]) -> Vec<Piece> {
    let next = heights_m.iter().skip(1).chain(heights_m.last());
    heights_m
        .iter()
        .zip(next)
        .map(|(from, to)| {
            let mut z = [0.0; 8];
            (z[0], z[1]) = (*from, to - from);
            Piece { duration_ns: 1_000_000_000, x: [0.0; 8], y: [0.0; 8], z, heading: [0.0; 8] }
        })
        .collect()
}

fn blob_of(pieces: &[Piece]) -> Vec<u8> {
    let mut buffer = vec![0; TRAJECTORY_BLOB_BYTES];
    encode_trajectory(pieces, &mut buffer).unwrap().to_vec()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn an_upload_over_a_bad_line_ends_with_the_sent_blob(
        heights in vec(0.5_f32..2.0, 1..=TRAJECTORY_PIECES), there in vec(fate(), 50), back in vec(fate(), 50)
    ) {
        // A line that lets nothing through for ever is no line.
        prop_assume!([&there, &back].iter().all(|f| f.iter().filter(|f| matches!(f, Fate::Arrives)).count() > 20));
        let sent = pieces(&heights);
        let blob = blob_of(&sent);
        let begin = UploadBegin::of(BlobKind::Trajectory, 7, &blob).unwrap();
        let mut host = Host { encoder: Encoder::new(1), decoder: Decoder::for_session(1), blob, begin };
        let mut board = Board {
            decoder: Decoder::new(),
            encoder: Encoder::new(0),
            receiver: BlobReceiver::new(),
            store: TrajectoryStore::new(),
        };
        board.store.commit(&blob_of(&pieces(&[1.0; TRAJECTORY_PIECES]))).unwrap();
        let before_ns = board.duration_ns();
        let hello = host.encoder.encode(&ToBoard::Hello(Nonce::NONE), &mut [0; FRAME_BYTES]).unwrap().to_vec();
        board.hear(&hello);

        let (mut there, mut back) = (Line::new(there), Line::new(back));
        let mut request = Some(ToBoard::UploadBegin(begin));
        let mut requests = 0;
        while let Some(message) = request {
            requests += 1;
            prop_assert!(requests < 4000, "the upload does not end");
            let asked = host.encoder.next_sequence().unwrap();
            let frame = host.encoder.encode(&message, &mut [0; FRAME_BYTES]).unwrap().to_vec();
            let committing = matches!(message, ToBoard::UploadCommit { .. });
            let answers = board.hear(&there.carry(&frame));
            let bytes: Vec<u8> = answers.iter().flat_map(|frame| back.carry(frame)).collect();
            let answer = host.hear(&bytes, asked);
            request = host.next(answer);
            if !committing && board.receiver.progress().is_ok_and(|p| p.wanted_offset < p.length) {
                prop_assert_eq!(board.duration_ns(), before_ns, "the one before is in use until the commit");
            }
        }

        let arrived = board.store.active().trajectory();
        prop_assert_eq!(arrived, Some(Trajectory::new(&sent).unwrap()));
        // And flown, bit for bit.
        let rate = Rate::from_hz(100).unwrap();
        let mut expected = Player::new(Trajectory::new(&sent).unwrap(), rate);
        let mut player = Player::new(arrived.unwrap(), rate);
        for tick in 0..player.end_tick() {
            prop_assert_eq!(player.at(tick), expected.at(tick));
        }
    }

    #[test]
    fn a_damaged_blob_is_never_put_to_use(heights in vec(0.5_f32..2.0, 1..8), noise in vec(any::<u8>(), 1..100)) {
        let mut store = TrajectoryStore::<8>::new();
        let in_use = pieces(&heights);
        store.commit(&blob_of(&in_use)).unwrap();
        let blob = blob_of(&in_use);
        let damaged = [
            noise.clone(),
            blob[..blob.len() - noise.len().min(blob.len())].to_vec(),
            [&blob[..], &noise[..]].concat(),
        ];
        for bytes in damaged {
            prop_assert!(store.commit(&bytes).is_err());
            prop_assert_eq!(store.active().trajectory(), Some(Trajectory::new(&in_use).unwrap()));
        }
    }
}
