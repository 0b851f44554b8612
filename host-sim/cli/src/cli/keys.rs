//! `quatrack keys`: keys of the link and of gain tables in; files of them, and images that have them, out.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use quatrack::link::{GivenKeys, KEY_SLOT_BYTES, KEY_SLOT_MAGIC, Protection};
use quatrack_plan::bounded;

use super::{Failure, key_file, output};

/// Makes keys, and gives them to an image of the firmware.
#[derive(clap::Args)]
#[command(arg_required_else_help = true)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Makes a file of a new random key, which its owner alone may read: for the link, or to sign gain tables with.
    New {
        /// The file; one that is there is left as it is.
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
    /// Writes an image of the firmware that has keys. The keys that it had before are gone.
    ///
    /// With a key of the link the board opens sessions for other holders of it, too, and for nobody else. With a key of
    /// tables it takes those alone that are signed with it (`quatrack gains sign`). An image that was given neither is for a cable.
    Provision {
        /// An image, as `cargo firmware` builds it.
        #[arg(value_name = "IMAGE")]
        image: PathBuf,
        /// The image to write. A reader of it has the keys.
        #[arg(long, value_name = "FILE")]
        out: output::File,
        /// The file of the link's key.
        #[arg(long, value_name = "FILE")]
        link: Option<PathBuf>,
        /// States and references need no tag: for a cable that carries them often.
        #[arg(long, requires = "link")]
        orders_only: bool,
        /// The file of the key that gain tables are signed with: another one than the link's.
        #[arg(long, value_name = "FILE")]
        tables: Option<PathBuf>,
    },
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    match &args.command {
        Command::New { file } => {
            key_file::create(file)?;
            output::print(&format!("wrote {}\n", file.display()))
        }
        Command::Provision { image, out, link, orders_only, tables } => {
            let protection = if *orders_only { Protection::Orders } else { Protection::Everything };
            let link = link.as_deref().map(key_file::read).transpose()?.map(|key| (key, protection));
            let signing = tables.as_deref().map(key_file::read).transpose()?;
            let given = GivenKeys { link, signing };
            let provisioned = provisioned(image, &given)?;
            output::write(out, &provisioned)?;
            let line = link.map_or(Protection::CableOnly, |(_, protection)| protection);
            let taken = if signing.is_some() { "signed ones alone" } else { "any" };
            output::print(&format!("wrote {}\nits link is {line}\nit takes gain tables: {taken}\n", out.display()))
        }
    }
}

/// The image with the keys in the place that it has for them.
fn provisioned(path: &Path, given: &GivenKeys) -> Result<Vec<u8>, Failure> {
    let mut image =
        bounded::read(path).map_err(|error| Failure::input(format!("{}: cannot be read ({error})", path.display())))?;
    let mut slots = image.windows(KEY_SLOT_BYTES).enumerate().filter(|(_, bytes)| bytes.starts_with(&KEY_SLOT_MAGIC));
    let (Some((at, _)), None) = (slots.next(), slots.next()) else {
        return Err(Failure::input(format!(
            "{}: has no one place for keys; give an image that `cargo firmware` has built",
            path.display()
        )));
    };
    if let Some(slot) = image.get_mut(at..at + KEY_SLOT_BYTES) {
        slot.copy_from_slice(&given.write());
    }
    Ok(image)
}
