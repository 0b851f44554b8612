//! `quatrack completions` and `quatrack man`: the command's arguments for a shell and for a manual.

use clap::CommandFactory as _;
use clap_complete::Shell;

use super::names::did_you_mean;
use super::{Arguments, Failure, output};

/// Prints the script by which a shell completes the arguments of `quatrack`.
///
/// Examples:
///   quatrack completions bash > ~/.local/share/bash-completion/completions/quatrack
///   quatrack completions zsh > ~/.zfunc/_quatrack
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct CompletionArgs {
    /// The shell.
    #[arg(value_enum)]
    shell: Shell,
}

/// Prints the manual page of `quatrack`, or of one of its commands.
///
/// Examples:
///   quatrack man > quatrack.1
///   quatrack man plan > quatrack-plan.1
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct ManArgs {
    /// Which command; the whole without one.
    command: Option<String>,
}

pub(crate) fn completions(args: &CompletionArgs) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Arguments::command(), "quatrack", &mut text);
    output::print(&String::from_utf8_lossy(&text))
}

pub(crate) fn man(args: &ManArgs) -> Result<(), Failure> {
    let mut whole = Arguments::command();
    whole.build();
    let command = match &args.command {
        None => whole,
        Some(name) => whole.find_subcommand(name).cloned().ok_or_else(|| {
            let names: Vec<&str> = whole.get_subcommands().map(clap::Command::get_name).collect();
            Failure::input(format!(
                "no command {name:?}: {}{}",
                names.join(", "),
                did_you_mean(name, names.iter().copied())
            ))
        })?,
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(command).render(&mut text).map_err(Failure::input)?;
    output::print(&String::from_utf8_lossy(&text))
}
