//! Any bytes into both decoders of the link, whole and in two parts: the same messages come out, and each is encoded
//! and decoded again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quatrack::link::{Decoder, Encoder, FRAME_BYTES, FromBoard, Message, ToBoard};

fn messages<M: Message>(decoder: &mut Decoder<M>, mut bytes: &[u8], out: &mut Vec<M>) {
    while let Some((received, rest)) = decoder.next(bytes) {
        bytes = rest;
        out.push(received.message);
    }
}

fn decode<M: Message + std::fmt::Debug>(make: impl Fn() -> Decoder<M>, bytes: &[u8], cut: usize) {
    let (mut whole, mut parts) = (Vec::new(), Vec::new());
    messages(&mut make(), bytes, &mut whole);
    let (first, second) = bytes.split_at(cut.min(bytes.len()));
    let mut decoder = make();
    messages(&mut decoder, first, &mut parts);
    messages(&mut decoder, second, &mut parts);
    // Compared as text, since NaN is not equal to itself.
    assert_eq!(format!("{whole:?}"), format!("{parts:?}"), "where a read ends does not matter");
    for message in whole {
        assert!(Encoder::new(1).encode(&message, &mut [0; FRAME_BYTES]).is_ok(), "{message:?} fits a frame");
    }
}

fuzz_target!(|bytes: &[u8]| {
    let cut = bytes.first().map_or(0, |byte| usize::from(*byte));
    decode::<ToBoard>(Decoder::new, bytes, cut);
    decode::<FromBoard>(|| Decoder::for_session(1), bytes, cut);
});
