//! Shared by the tests of `quatrack pil`: a folder of their own, small images, and a check for files left behind.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder that the command under test takes for the temporary one; removed at the end.
pub(crate) struct Scratch {
    path: PathBuf,
}

impl Scratch {
    pub(crate) fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("quatrack-test-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(path.join("tmp")).expect("a folder in the temporary one");
        Self { path }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// `quatrack` with its temporary files in this folder.
    pub(crate) fn quatrack(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_quatrack"));
        command.args(arguments).current_dir(&self.path).env("TMPDIR", self.path.join("tmp"));
        command
    }

    /// An image that starts with these half-words of Thumb code.
    pub(crate) fn image(&self, name: &str, code: &[u16]) -> PathBuf {
        let path = self.path.join(name);
        fs::write(&path, elf(code)).expect("a file in the test's folder");
        path
    }

    /// Asserts that no pipe, folder or emulator of this test is left.
    pub(crate) fn assert_clean(&self) {
        let left: Vec<_> = fs::read_dir(self.path.join("tmp")).expect("the folder is there").collect();
        assert!(left.is_empty(), "left behind: {left:?}");
        assert_eq!(emulators(&self.path), Vec::<i32>::new(), "emulators that still run");
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Process numbers of the emulators that run an image in a folder.
pub(crate) fn emulators(folder: &Path) -> Vec<i32> {
    let folder = folder.to_string_lossy().into_owned();
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    processes
        .filter_map(|entry| entry.file_name().to_string_lossy().parse().ok().map(|number| (number, entry.path())))
        .filter(|(_, path)| {
            let line = String::from_utf8_lossy(&fs::read(path.join("cmdline")).unwrap_or_default()).into_owned();
            line.contains("qemu-system-arm") && line.contains(&folder)
        })
        .map(|(number, _)| number)
        .collect()
}

/// Whether an emulator is there; says so where it is not.
pub(crate) fn has_emulator() -> bool {
    let there = Command::new("qemu-system-arm").arg("--version").output().is_ok();
    if !there {
        eprintln!("skipped: qemu-system-arm is not installed");
    }
    there
}

/// Exit code and standard error.
pub(crate) fn failure(output: &Output) -> (Option<i32>, String) {
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// An ELF file with one segment at the start of the flash: a vector table of two words, and the code.
fn elf(code: &[u16]) -> Vec<u8> {
    const FLASH: u32 = 0x0800_0000;
    const HEADERS: u32 = 52 + 32;
    const STACK_TOP: u32 = 0x2002_0000;
    let mut segment: Vec<u8> = [STACK_TOP, FLASH + 8 + 1].iter().flat_map(|word| word.to_le_bytes()).collect();
    segment.extend(code.iter().flat_map(|half| half.to_le_bytes()));
    let size = segment.len() as u32;

    let mut file = vec![0x7f, b'E', b'L', b'F', 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    file.extend([2_u16, 40].iter().flat_map(|half| half.to_le_bytes()));
    // Version, entry, offsets of program and section headers, flags.
    file.extend([1, FLASH + 9, 52, 0, 0x0500_0400].iter().flat_map(|word: &u32| word.to_le_bytes()));
    file.extend([52_u16, 32, 1, 40, 0, 0].iter().flat_map(|half| half.to_le_bytes()));
    // Loaded, from the file's end of headers, to the flash, readable and executable.
    let program = [1, HEADERS, FLASH, FLASH, size, size, 5, 4];
    file.extend(program.iter().flat_map(|word: &u32| word.to_le_bytes()));
    file.extend(segment);
    file
}
