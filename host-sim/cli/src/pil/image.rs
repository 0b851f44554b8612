//! Images: a checkout in, an ELF file out; an ELF file in, its sizes out.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use quatrack_plan::bounded;

use super::PilError;

/// The target's name for the compiler.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// Where the flash of an STM32F405 is, and its size, bytes.
const FLASH: (u32, u32) = (0x0800_0000, 1024 * 1024);

/// Where its RAM is, and its size, bytes.
const RAM: (u32, u32) = (0x2000_0000, 128 * 1024);

/// An image of the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Image {
    /// Flies, with its line on a USART: the board's own.
    Usart,
    /// Flies, with its line on two pipes of the emulating machine.
    Pipes,
    /// Counts instructions on recorded states.
    Measure,
    /// Counts the estimator's instructions and stack.
    MeasureEstimator,
    /// Counts the instructions of the link's frames.
    MeasureLink,
    /// The control path alone, for its size.
    ControlPath,
    /// The same down to the motors.
    MotorPath,
}

impl Image {
    /// The name of its file.
    pub fn binary(self) -> &'static str {
        match self {
            Self::Usart => "quatrack-firmware",
            Self::Pipes => "quatrack-firmware-pipes",
            Self::Measure => "quatrack-measure",
            Self::MeasureEstimator => "quatrack-measure-estimator",
            Self::MeasureLink => "quatrack-measure-link",
            Self::ControlPath => "quatrack-control-path",
            Self::MotorPath => "quatrack-motor-path",
        }
    }

    fn features(self) -> &'static [&'static str] {
        match self {
            Self::Usart => &[],
            Self::Pipes => &["--features", "semihosting"],
            Self::Measure | Self::MeasureEstimator | Self::MeasureLink => {
                &["--no-default-features", "--features", "semihosting"]
            }
            Self::ControlPath => &["--no-default-features"],
            Self::MotorPath => &["--no-default-features", "--features", "motors"],
        }
    }
}

/// The checkout around the current folder.
///
/// # Errors
/// [`PilError::NoCheckout`].
pub fn checkout() -> Result<PathBuf, PilError> {
    let current = env::current_dir().map_err(PilError::io("finding the current folder"))?;
    let is_checkout = |dir: &&Path| dir.join("memory.x").is_file() && dir.join("firmware/Cargo.toml").is_file();
    current.ancestors().find(is_checkout).map(Path::to_path_buf).ok_or(PilError::NoCheckout)
}

/// The same for a command that also takes a built image.
///
/// # Errors
/// [`PilError::NoImage`].
pub fn checkout_for_image() -> Result<PathBuf, PilError> {
    checkout().map_err(|error| if matches!(error, PilError::NoCheckout) { PilError::NoImage } else { error })
}

/// Builds an image in a checkout; cargo shows how it gets on.
///
/// # Errors
/// [`PilError::Build`].
pub fn build(checkout: &Path, image: Image) -> Result<PathBuf, PilError> {
    let target_dir = checkout.join("target");
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(checkout);
    command.args(["build", "--package", "quatrack-firmware", "--target", TARGET, "--profile", "firmware", "--locked"]);
    command.args(["--bin", image.binary()]).args(image.features()).arg("--target-dir").arg(&target_dir);
    let status = command.status().map_err(PilError::io("starting cargo"))?;
    if !status.success() {
        return Err(PilError::Build {
            command: format!("cargo build --bin {}", image.binary()),
            status: status.to_string(),
        });
    }
    Ok(target_dir.join(TARGET).join("firmware").join(image.binary()))
}

/// Size of an image, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Flash: code, constants and the initial values of variables.
    pub flash_bytes: u32,
    /// RAM: variables; without the stack.
    pub ram_bytes: u32,
}

/// The sizes of an image, which must be one for this microcontroller.
///
/// # Errors
/// [`PilError::Image`] where the file cannot be read or is no such image.
pub fn size(path: &Path) -> Result<Size, PilError> {
    let refuse = |reason: String| PilError::Image { path: path.to_path_buf(), reason };
    let bytes = bounded::read(path).map_err(|error| refuse(format!("cannot read this image ({error})")))?;
    let size = segments(&bytes).map(|segments| {
        let within = |address: u32, (start, length): (u32, u32)| (start..start + length).contains(&address);
        let sum = |sizes: Vec<u32>| sizes.iter().fold(0_u32, |sum, size| sum.saturating_add(*size));
        Size {
            flash_bytes: sum(segments.iter().filter(|s| within(s.load_address, FLASH)).map(|s| s.file_bytes).collect()),
            ram_bytes: sum(segments.iter().filter(|s| within(s.run_address, RAM)).map(|s| s.memory_bytes).collect()),
        }
    });
    match size {
        Some(size) if size.flash_bytes > 0 => Ok(size),
        _ => Err(refuse("is no ELF image for the flash of an STM32F405; build one with `cargo firmware`".to_owned())),
    }
}

struct Segment {
    run_address: u32,
    load_address: u32,
    file_bytes: u32,
    memory_bytes: u32,
}

/// The loaded segments of a 32-bit little-endian ARM executable; nothing where the file is anything else.
fn segments(elf: &[u8]) -> Option<Vec<Segment>> {
    const ELF32_LITTLE_ENDIAN: [u8; 6] = [0x7f, b'E', b'L', b'F', 1, 1];
    const MACHINE_ARM: u16 = 40;
    const TYPE_EXECUTABLE: u16 = 2;
    const LOADED: u32 = 1;
    let half = |at: usize| Some(u16::from_le_bytes(*elf.get(at..)?.first_chunk()?));
    let word = |at: usize| Some(u32::from_le_bytes(*elf.get(at..)?.first_chunk()?));
    if !elf.starts_with(&ELF32_LITTLE_ENDIAN) || half(16)? != TYPE_EXECUTABLE || half(18)? != MACHINE_ARM {
        return None;
    }
    let (table, entry, count) = (word(28)? as usize, usize::from(half(42)?), usize::from(half(44)?));
    let mut segments = Vec::new();
    for header in (0..count).map(|index| table + index * entry) {
        if word(header)? == LOADED {
            segments.push(Segment {
                run_address: word(header + 8)?,
                load_address: word(header + 12)?,
                file_bytes: word(header + 16)?,
                memory_bytes: word(header + 20)?,
            });
        }
    }
    Some(segments)
}
