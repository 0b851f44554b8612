//! The `quatrack` command: arguments and files in; tables, files and an exit code out.
//!
//! Exit code 0: done. 1: the question was answered with no (a cell of Table I missed, a plan that cannot be met).
//! 2: the input cannot be used; one line names the reason and the remedy. 3: the craft of a scenario was lost.

use std::process::ExitCode;

fn main() -> ExitCode {
    quatrack_cli::cli::main()
}
