//! Frames of the link over lines that lose, alter, repeat and invent bytes: every message that comes out was sent, in
//! order, or is counted.

mod messages;
mod schema;

use std::collections::BTreeSet;

use self::messages::{from_board, to_board};
use proptest::collection::vec;
use proptest::prelude::*;
use quatrack::link::{
    Counters, Decoder, Encoder, FRAME_BYTES, Message, Nonce, PROTOCOL_VERSION, Received, Rejected, ToBoard, crc32c,
};

const SESSION: u32 = 0x5EED;

/// The frames of some messages, each on its own.
fn frames<M: Message>(messages: &[M]) -> Vec<Vec<u8>> {
    let mut encoder = Encoder::new(SESSION);
    let mut buffer = [0; FRAME_BYTES];
    messages.iter().map(|message| encoder.encode(message, &mut buffer).unwrap().to_vec()).collect()
}

/// Everything that a fresh decoder of the session makes of some bytes.
fn decode<M: Message>(bytes: &[u8]) -> (Vec<Received<M>>, Counters) {
    let mut decoder = Decoder::for_session(SESSION);
    let received = bytes.iter().filter_map(|byte| decoder.push(*byte)?.ok()).collect();
    (received, *decoder.counters())
}

/// The sequence numbers of the received messages, each message checked against the frame that was sent under its number.
/// Compared as frames: a message with NaN in it is not equal to itself.
fn numbers<M: Message>(received: &[Received<M>], sent: &[Vec<u8>]) -> Vec<usize> {
    let mut buffer = [0; FRAME_BYTES];
    received
        .iter()
        .map(|received| {
            let mut encoder = Encoder::new(SESSION);
            for _ in 0..received.sequence {
                encoder.encode(&ToBoard::UploadQuery, &mut buffer).unwrap();
            }
            let again = encoder.encode(&received.message, &mut buffer).unwrap();
            let number = received.sequence as usize;
            assert_eq!(again, &sent[number][..], "message {number} is not the one sent");
            number
        })
        .collect()
}

/// Frames in a stream, by their delimiters alone.
fn segments(bytes: &[u8]) -> u32 {
    let ended = bytes.len() - bytes.iter().rev().take_while(|byte| **byte != 0).count();
    bytes[..ended].split(|byte| *byte == 0).filter(|segment| !segment.is_empty()).count() as u32
}

/// COBS as its paper has it, for frames that the encoder would never make.
fn framed(content: &[u8]) -> Vec<u8> {
    let checksum = crc32c(content).to_le_bytes();
    let whole = [content, &checksum].concat();
    let blocks = whole.split(|byte| *byte == 0);
    blocks.flat_map(|block| [&[block.len() as u8 + 1], block].concat()).chain([0]).collect()
}

fn garbage() -> impl Strategy<Value = Vec<u8>> {
    vec(prop_oneof![4 => any::<u8>(), 1 => Just(0)], 0..300)
}

proptest! {
    #[test]
    fn every_message_to_the_board_comes_out_as_it_went_in(sent in vec(to_board(), 1..8)) {
        let sent = frames(&sent);
        let (received, counters) = decode::<ToBoard>(&sent.concat());
        prop_assert_eq!(numbers(&received, &sent), (0..sent.len()).collect::<Vec<_>>());
        prop_assert_eq!(counters, Counters { accepted: sent.len() as u32, ..Counters::NONE });
    }

    #[test]
    fn every_message_from_the_board_comes_out_as_it_went_in(sent in vec(from_board(), 1..8)) {
        let sent = frames(&sent);
        let (received, counters) = decode::<quatrack::link::FromBoard>(&sent.concat());
        prop_assert_eq!(numbers(&received, &sent), (0..sent.len()).collect::<Vec<_>>());
        prop_assert_eq!(counters, Counters { accepted: sent.len() as u32, ..Counters::NONE });
    }

    #[test]
    fn a_frame_fits_and_holds_one_zero_at_its_end(message in to_board()) {
        let frame = frames(&[message]).concat();
        prop_assert!(frame.len() <= FRAME_BYTES);
        prop_assert_eq!(frame.iter().position(|byte| *byte == 0), Some(frame.len() - 1));
    }

    #[test]
    fn any_chunks_are_as_good_as_the_whole(
        sent in vec(to_board(), 1..6), noise in garbage(), lengths in vec(1_usize..40, 1..20)
    ) {
        let bytes = [noise, vec![0], frames(&sent).concat()].concat();
        let (whole, counters) = decode::<ToBoard>(&bytes);
        let mut decoder = Decoder::<ToBoard>::for_session(SESSION);
        let (mut rest, mut in_chunks) = (&bytes[..], 0);
        for length in lengths.iter().cycle() {
            let (mut chunk, left) = rest.split_at(rest.len().min(*length));
            while let Some((_, after)) = decoder.next(chunk) {
                in_chunks += 1;
                chunk = after;
            }
            rest = left;
            if rest.is_empty() {
                break;
            }
        }
        prop_assert_eq!(in_chunks, whole.len());
        prop_assert_eq!(whole.len(), sent.len());
        prop_assert_eq!(*decoder.counters(), counters);
    }

    #[test]
    fn noise_between_frames_costs_none_of_them(sent in vec((garbage(), to_board()), 1..6)) {
        let (noise, sent): (Vec<_>, Vec<_>) = sent.into_iter().unzip();
        let sent = frames(&sent);
        let bytes: Vec<u8> = noise.iter().zip(&sent).flat_map(|(noise, frame)| [noise, &[0][..], frame].concat()).collect();
        let (received, counters) = decode::<ToBoard>(&bytes);
        prop_assert_eq!(numbers(&received, &sent), (0..sent.len()).collect::<Vec<_>>());
        prop_assert_eq!(counters.frames(), segments(&bytes), "every frame and every burst of noise is counted once");
    }

    #[test]
    fn noise_alone_is_never_a_message(noise in vec(prop_oneof![4 => any::<u8>(), 1 => Just(0)], 0..4000)) {
        let (received, counters) = decode::<ToBoard>(&noise);
        prop_assert!(received.is_empty());
        prop_assert_eq!((counters.accepted, counters.lost), (0, 0));
        prop_assert_eq!(counters.rejected(), segments(&noise));
    }

    #[test]
    fn lost_frames_are_counted(sent in vec((to_board(), any::<bool>()), 1..20)) {
        let (sent, arrives): (Vec<_>, Vec<_>) = sent.into_iter().unzip();
        let sent = frames(&sent);
        let arriving: Vec<usize> = (0..sent.len()).filter(|i| arrives[*i]).collect();
        let bytes: Vec<u8> = arriving.iter().flat_map(|i| sent[*i].clone()).collect();
        let (received, counters) = decode::<ToBoard>(&bytes);
        let up_to_the_last = arriving.last().map_or(0, |last| last + 1);
        prop_assert_eq!(counters.lost as usize, up_to_the_last - arriving.len());
        prop_assert_eq!(numbers(&received, &sent), arriving);
    }

    #[test]
    fn out_of_order_and_repeated_frames_are_rejected(
        sent in vec(to_board(), 1..10), order in vec(any::<prop::sample::Index>(), 1..30)
    ) {
        let sent = frames(&sent);
        let order: Vec<usize> = order.iter().map(|index| index.index(sent.len())).collect();
        let bytes: Vec<u8> = order.iter().flat_map(|i| sent[*i].clone()).collect();
        let (received, counters) = decode::<ToBoard>(&bytes);
        // A message is taken if it is later than everything before it.
        let (mut taken, mut duplicates) = (BTreeSet::new(), 0);
        let expected: Vec<usize> = order
            .iter()
            .copied()
            .filter(|i| {
                duplicates += u32::from(taken.last() == Some(i));
                taken.last().is_none_or(|last| i > last) && taken.insert(*i)
            })
            .collect();
        prop_assert_eq!(counters.duplicate, duplicates);
        prop_assert_eq!((counters.duplicate + counters.stale) as usize, order.len() - expected.len());
        prop_assert_eq!(numbers(&received, &sent), expected);
        prop_assert_eq!(counters.frames() as usize, order.len());
    }

    #[test]
    fn a_replayed_stream_gives_nothing(sent in vec(to_board(), 1..10)) {
        let bytes = frames(&sent).concat();
        let (received, counters) = decode::<ToBoard>(&[&bytes[..], &bytes[..]].concat());
        prop_assert_eq!(received.len(), sent.len());
        prop_assert_eq!((counters.duplicate + counters.stale) as usize, sent.len());
    }
}

proptest! {
    // Each case tries every bit or every cut of a frame.
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_single_wrong_bit_gives_a_wrong_message(sent in vec(to_board(), 4)) {
        let sent = frames(&sent);
        for bit in 0..sent[1].len() * 8 {
            let mut stream = sent.clone();
            stream[1][bit / 8] ^= 1 << (bit % 8);
            let (received, counters) = decode::<ToBoard>(&stream.concat());
            let numbers = numbers(&received, &sent);
            // The delimiter's bits run frames 1 and 2 together.
            let expected: &[usize] = if bit / 8 == sent[1].len() - 1 { &[0, 3] } else { &[0, 2, 3] };
            prop_assert_eq!(numbers, expected, "bit {}", bit);
            prop_assert!(counters.rejected() >= 1, "bit {} went uncounted", bit);
            prop_assert_eq!(counters.accepted + counters.lost, 4);
            prop_assert_eq!(counters.frames(), segments(&stream.concat()));
        }
    }

    #[test]
    fn no_missing_byte_and_no_cut_gives_a_wrong_message(sent in vec(to_board(), 4)) {
        let sent = frames(&sent);
        for at in 0..sent[1].len() - 1 {
            let mut missing = sent.clone();
            missing[1].remove(at);
            let mut cut = sent.clone();
            cut[1].drain(at..sent[1].len() - 1);
            for stream in [missing, cut] {
                let (received, counters) = decode::<ToBoard>(&stream.concat());
                prop_assert_eq!(numbers(&received, &sent), vec![0, 2, 3], "byte {}", at);
                prop_assert_eq!(counters.accepted + counters.lost, 4);
                prop_assert_eq!(counters.frames(), segments(&stream.concat()));
            }
            // Without its delimiter the rest of the frame spoils the next one.
            let mut open = sent.clone();
            open[1].truncate(at + 1);
            let (received, counters) = decode::<ToBoard>(&open.concat());
            prop_assert_eq!(numbers(&received, &sent), vec![0, 3], "cut after byte {}", at);
            prop_assert_eq!((counters.accepted, counters.rejected(), counters.lost), (2, 1, 2));
        }
    }
}

#[test]
fn sound_frames_that_are_not_understood_are_counted_apart() {
    // Version, session and sequence 0, then the message.
    let whole = |message: &[u8]| framed(&[&[PROTOCOL_VERSION, 0, 0], message].concat());
    let cases: [(Vec<u8>, Rejected); 9] = [
        (framed(&[PROTOCOL_VERSION + 1, 0, 0, 0]), Rejected::Version { version: PROTOCOL_VERSION + 1 }),
        (framed(&[0, 1, 2, 3]), Rejected::Version { version: 0 }),
        (framed(&[PROTOCOL_VERSION, 0x80]), Rejected::Malformed),
        (whole(&[]), Rejected::Malformed),
        (whole(&[ToBoard::KINDS]), Rejected::UnknownMessage { kind: ToBoard::KINDS }),
        (whole(&[5, 0]), Rejected::Malformed),
        (whole(&[1, 7]), Rejected::Malformed),
        (framed(&[1; 150]), Rejected::Overlong),
        (framed(&[]), Rejected::Malformed),
    ];
    for (bytes, rejected) in cases {
        let mut decoder = Decoder::<ToBoard>::for_session(0);
        let end = bytes.iter().find_map(|byte| decoder.push(*byte));
        assert_eq!(end.map(|end| end.map(|_| ())), Some(Err(rejected)), "{bytes:02x?}");
        assert_eq!(decoder.counters().rejected(), 1);
        // Nothing of it stays: the same decoder takes the next sound frame.
        let arm = whole(&[5]);
        let end = arm.iter().find_map(|byte| decoder.push(*byte));
        assert!(matches!(end, Some(Ok(Received { message: ToBoard::Arm, .. }))), "after {rejected}: {end:?}");
    }
}

#[test]
fn a_restarted_host_is_heard_again_and_its_past_is_not() {
    let mut buffer = [0; FRAME_BYTES];
    let mut frame = |encoder: &mut Encoder, message| encoder.encode(&message, &mut buffer).unwrap().to_vec();
    let mut board = Decoder::<ToBoard>::new();
    let mut hear = |bytes: &[u8]| bytes.iter().find_map(|byte| board.push(*byte)).unwrap().map(|r| r.message);

    let (mut first, mut second) = (Encoder::new(100), Encoder::new(101));
    let early = frame(&mut first, ToBoard::Arm);
    assert_eq!(hear(&early), Err(Rejected::ForeignSession { session: 100 }), "nothing before a hello");
    let old_hello = frame(&mut first, ToBoard::Hello(Nonce::NONE));
    assert_eq!(hear(&old_hello), Ok(ToBoard::Hello(Nonce::NONE)));
    assert_eq!(hear(&early), Err(Rejected::Stale { sequence: 0 }), "not even after it");
    let old = [frame(&mut first, ToBoard::Arm), frame(&mut first, ToBoard::Arm)];
    assert_eq!(hear(&old[0]), Ok(ToBoard::Arm));

    assert_eq!(
        hear(&frame(&mut second, ToBoard::Hello(Nonce::NONE))),
        Ok(ToBoard::Hello(Nonce::NONE)),
        "the restarted host"
    );
    assert_eq!(hear(&old[1]), Err(Rejected::ForeignSession { session: 100 }), "a late frame");
    assert_eq!(hear(&old_hello), Err(Rejected::ForeignSession { session: 100 }), "a replayed hello");
    assert_eq!(
        hear(&frame(&mut second, ToBoard::Hello(Nonce::NONE))),
        Ok(ToBoard::Hello(Nonce::NONE)),
        "asked again for lack of an answer"
    );
    assert_eq!(hear(&frame(&mut second, ToBoard::Disarm)), Ok(ToBoard::Disarm));
}
