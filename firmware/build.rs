//! Makes the linker see an edited `memory.x`, which cargo does not watch by itself, and gives the control path a number:
//! a checksum of the sources that compute commands.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// The sources that compute commands, seen from the workspace's root.
const CONTROL_PATH: [&str; 10] = [
    "core/src",
    "plans",
    "firmware/src/flight.rs",
    "firmware/src/flight",
    "firmware/src/laws.rs",
    "firmware/src/laws",
    "firmware/src/playback.rs",
    "firmware/src/playback",
    "firmware/src/rates.rs",
    "firmware/src/vehicle.rs",
];

fn main() -> io::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    println!("cargo:rerun-if-changed={}", root.join("memory.x").display());
    println!("cargo:rustc-link-search={}", root.display());

    let mut sources = Vec::new();
    for part in CONTROL_PATH {
        println!("cargo:rerun-if-changed={}", root.join(part).display());
        collect(&root.join(part), &mut sources)?;
    }
    sources.sort();
    let mut checksum = Fnv1a::default();
    for source in &sources {
        checksum.add(&fs::read(source)?);
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    fs::write(out.join("control_image.rs"), format!("0x{:08x}\n", checksum.0))
}

/// The Rust files under a path.
fn collect(path: &Path, sources: &mut Vec<PathBuf>) -> io::Result<()> {
    if path.is_dir() {
        for entry in fs::read_dir(path)? {
            collect(&entry?.path(), sources)?;
        }
    } else if path.extension().is_some_and(|extension| extension == "rs") {
        sources.push(path.to_path_buf());
    }
    Ok(())
}

/// The hash FNV-1a of 32 bits.
struct Fnv1a(u32);

impl Default for Fnv1a {
    fn default() -> Self {
        Self(0x811c_9dc5)
    }
}

impl Fnv1a {
    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u32::from(*byte)).wrapping_mul(0x0100_0193);
        }
    }
}
