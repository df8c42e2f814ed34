//! `furbelow completions SHELL`

use std::io::Write;

use clap::CommandFactory;
use clap_complete::Shell;

use super::{Cli, Failure};

/// Arguments of `completions`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The shell to complete for
    shell: Shell,
}

pub(super) fn run(args: Args) -> Result<(), Failure> {
    let mut command = Cli::command();
    // Into memory first: clap_complete panics when it cannot write.
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "furbelow", &mut script);
    std::io::stdout().write_all(&script)?;
    Ok(())
}
