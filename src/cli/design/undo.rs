//! `furbelow design undo FILE`: the last change taken back.

use std::path::PathBuf;

use super::super::output::{count, line};
use super::super::{Exit, Failure};
use super::{is_stdin, read, write};
use crate::design::Design;

/// Arguments of `design undo`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A design .toml; `-` reads stdin and writes stdout
    file: PathBuf,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let (_, source) = read(&args.file)?;
    let mut design = Design::parse(&source.file, &source.text)?;
    let Some(edit) = design.undo() else {
        return Err(Failure {
            exit: Exit::Refused,
            source: format!("{}: there is no edit to take back", source.file).into(),
        });
    };
    write(&args.file, &design.written_over(&source.file, &source.text)?)?;
    if is_stdin(&args.file) {
        return Ok(());
    }
    line(&format!("took back {edit}; {} left", count(design.edits.len(), "edit")))
}
