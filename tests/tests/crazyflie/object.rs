//! The object for the Crazyflie's firmware: no symbol but ours comes out of it, none is missing, nothing in it panics.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Names of an ELF32 object's symbols: global and defined, undefined, local.
fn symbols(elf: &[u8]) -> [Vec<String>; 3] {
    let half = |at: usize| usize::from(u16::from_le_bytes([elf[at], elf[at + 1]]));
    let word = |at: usize| u32::from_le_bytes([elf[at], elf[at + 1], elf[at + 2], elf[at + 3]]) as usize;
    assert_eq!(&elf[..6], b"\x7fELF\x01\x01", "a little-endian ELF32");
    let sections: Vec<[usize; 4]> = (0..half(48))
        .map(|index| word(32) + index * half(46))
        .map(|at| [word(at + 4), word(at + 16), word(at + 20), word(at + 24)])
        .collect();
    const SYMBOL_TABLE: usize = 2;
    let [_, at, size, link] = *sections.iter().find(|section| section[0] == SYMBOL_TABLE).unwrap();
    let names = sections[link][1];
    let mut sorted = [const { Vec::new() }; 3];
    for symbol in (at + 16..at + size).step_by(16) {
        let name = &elf[names + word(symbol)..];
        let name = String::from_utf8_lossy(name.split(|byte| *byte == 0).next().unwrap()).into_owned();
        let (is_local, is_undefined) = (elf[symbol + 12] >> 4 == 0, half(symbol + 14) == 0);
        sorted[if is_local {
            2
        } else if is_undefined {
            1
        } else {
            0
        }]
        .push(name);
    }
    sorted
}

#[test]
fn the_object_has_the_symbols_of_its_header_and_no_other() {
    let object = env::temp_dir().join(format!("quatrack-crazyflie-{}.o", std::process::id()));
    let output = Command::new(root().join("crazyflie/build"))
        .arg(&object)
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .current_dir(root())
        .output();
    let built = match output {
        Ok(output) if output.status.success() => fs::read(&object).unwrap(),
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            let no_tool = said.contains("rust-objcopy")
                || said.contains("rust-lld")
                || said.contains("can't find crate for `core`");
            assert!(no_tool, "{said}");
            eprintln!("skipped: the toolchain has no linker or no target for the object:\n{said}");
            return;
        }
        Err(error) => {
            eprintln!("skipped: no shell to build the object with ({error})");
            return;
        }
    };
    fs::remove_file(&object).unwrap();
    let [mut global, undefined, local] = symbols(&built);
    global.sort();
    let listed = fs::read_to_string(root().join("crazyflie/app/symbols")).unwrap();
    let mut wanted: Vec<&str> = listed.lines().collect();
    wanted.sort_unstable();
    assert_eq!(global, wanted, "any other symbol would take the place of the firmware's own");
    assert_eq!(undefined, Vec::<String>::new(), "missing symbols, a panic's among others");
    let panics: Vec<&String> = local.iter().filter(|name| name.contains("panic")).collect();
    assert_eq!(panics, Vec::<&String>::new());
}
