//! The emulated STM32F405: an image and a folder in, a process that ends with its owner out.

use std::fs;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::PilError;
use super::interrupt::Interrupt;

/// QEMU for ARM.
pub const PROGRAM: &str = "qemu-system-arm";

/// Its machine with an STM32F405.
const MACHINE: &str = "netduinoplus2";

/// Between two looks at a process that is waited for.
const LOOK_EVERY: Duration = Duration::from_millis(2);

/// A running emulator. Dropped, it is killed.
pub struct Emulator {
    child: Child,
}

impl Emulator {
    /// Starts `image`, with the files that it opens in `folder`. An instruction takes one nanosecond of the emulated
    /// time, so that its timers count the same on every run and every machine.
    ///
    /// # Errors
    /// [`PilError::NoEmulator`].
    pub fn start(image: &Path, folder: &Path, arguments: &[&str]) -> Result<Self, PilError> {
        let image = image.canonicalize().map_err(|error| PilError::Image {
            path: image.to_path_buf(),
            reason: format!("cannot read this image ({error})"),
        })?;
        let child = Command::new(PROGRAM)
            .args(["-M", MACHINE, "-display", "none", "-monitor", "none", "-icount", "shift=0"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .args(arguments)
            .arg("-kernel")
            .arg(image)
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn();
        match child {
            Ok(child) => Ok(Self { child }),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Err(PilError::NoEmulator),
            Err(error) => Err(PilError::Io { doing: format!("starting {PROGRAM}"), source: error }),
        }
    }

    /// How it ended, if it has.
    ///
    /// # Errors
    /// [`PilError::Io`].
    pub fn ended(&mut self) -> Result<Option<ExitStatus>, PilError> {
        self.child.try_wait().map_err(PilError::io("looking at the emulator"))
    }

    /// The error for an emulator that ended.
    pub fn ended_early(&mut self, status: ExitStatus) -> PilError {
        let mut output = String::new();
        if let Some(stderr) = &mut self.child.stderr {
            // Bytes that cannot be read are not shown.
            let _ = stderr.read_to_string(&mut output);
        }
        PilError::EmulatorEnded { status: status.to_string(), output }
    }

    /// Waits for an image that ends the emulator by itself.
    ///
    /// # Errors
    /// [`PilError::EmulatorEnded`] where it does so with a failure, [`PilError::Silent`] where it does not in time.
    pub fn wait(&mut self, limit: Duration, interrupt: &Interrupt) -> Result<(), PilError> {
        let start = Instant::now();
        loop {
            interrupt.check()?;
            match self.ended()? {
                Some(status) if status.success() => return Ok(()),
                Some(status) => return Err(self.ended_early(status)),
                None if start.elapsed() > limit => {
                    let waiting_for = "the image in the emulator does not end; is it the right one?".to_owned();
                    return Err(PilError::Silent { seconds: limit.as_secs(), waiting_for });
                }
                None => std::thread::sleep(LOOK_EVERY),
            }
        }
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // Both fail only for a process that has ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A folder for the files between host and image; removed with its contents when dropped.
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// A new folder among the temporary ones.
    ///
    /// # Errors
    /// [`PilError::Io`].
    pub fn create() -> Result<Self, PilError> {
        let since_1970 = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
        let name = format!("quatrack-{}-{}", std::process::id(), since_1970.as_nanos());
        let path = std::env::temp_dir().join(name);
        fs::create_dir(&path).map_err(PilError::io(format!("creating the folder {}", path.display())))?;
        Ok(Self { path })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A folder that cannot be removed is left to the system, which empties the temporary ones.
        let _ = fs::remove_dir_all(&self.path);
    }
}
