//! Instructions of the link's frames on the target, without tags and with: counts of an image in, a table of them out.

use std::fs;
use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use super::PilError;
use super::emulator::{Emulator, Folder};
use super::interrupt::Interrupt;

/// Longest time for an emulator to count.
const LIMIT: Duration = Duration::from_secs(60);

/// The frames and tags that the image counts, in its order.
const COUNTED: [&str; 5] =
    ["a hello and its answer", "an order", "a state with body rates", "a state and a reference", "an answer"];

/// Instructions of the link.
#[derive(Clone, Debug, Serialize)]
pub struct LinkReport {
    /// Of each kind of frame: without a tag and with one.
    pub frames: Vec<FrameCost>,
    /// The check of a signed gain table of 400 bytes.
    pub signature: u32,
}

/// Instructions from a frame's first byte to its message, or from a message to its frame.
#[derive(Clone, Debug, Serialize)]
pub struct FrameCost {
    /// The frame.
    pub frame: &'static str,
    /// Over a cable.
    pub without_tag: u32,
    /// With a key.
    pub with_tag: u32,
}

/// Counts them.
///
/// # Errors
/// [`PilError`].
pub fn count(image: &Path, interrupt: &Interrupt) -> Result<LinkReport, PilError> {
    let folder = Folder::create()?;
    Emulator::start(image, folder.path(), &["-serial", "none"])?.wait(LIMIT, interrupt)?;
    let counts = fs::read(folder.path().join("counts.bin")).map_err(PilError::io("reading the counts"))?;
    let words: Vec<u32> = counts.as_chunks::<4>().0.iter().copied().map(u32::from_le_bytes).collect();
    let [_, short, long, counts @ ..] = &words[..] else { return Err(wrong()) };
    let (counted, instructions) = (long.wrapping_sub(*short), super::measure::LOOP_INSTRUCTIONS);
    if counted != instructions {
        return Err(PilError::Miscounts { counted, instructions });
    }
    let Some((without, rest)) = counts.split_first_chunk::<{ COUNTED.len() }>() else { return Err(wrong()) };
    let Some((with, [signature])) = rest.split_first_chunk::<{ COUNTED.len() }>() else { return Err(wrong()) };
    if counts.contains(&0) {
        return Err(wrong());
    }
    let costs = COUNTED.into_iter().zip(without.iter().zip(with));
    let frames = costs.map(|(frame, (without_tag, with_tag))| FrameCost {
        frame,
        without_tag: *without_tag,
        with_tag: *with_tag,
    });
    Ok(LinkReport { frames: frames.collect(), signature: *signature })
}

fn wrong() -> PilError {
    PilError::Answer("the link's image counted something else, or did not take its own frames".to_owned())
}
