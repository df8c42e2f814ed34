//! `furbelow design new SHAPE`: a design file to start from.

use std::path::{Path, PathBuf};

use super::super::Failure;
use super::super::make::quoted;
use super::super::order::Shape;
use super::super::output;
use super::super::screen::Screen;
use super::show::tell;
use super::write;
use crate::config::Library;
use crate::job;

/// Arguments of `design new`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    shape: Shape,
    /// File to write; `-` for stdout
    #[arg(short, long, value_name = "FILE", default_value = "design.toml")]
    out: PathBuf,
    /// Replace a file of that name
    #[arg(long)]
    force: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let order = args.shape.order()?;
    let to_stdout = args.out == Path::new("-");
    if !to_stdout && !args.force && args.out.exists() {
        let message = format!(
            "{} is there already; name another file with --out, or replace it with --force",
            args.out.display()
        );
        return Err(Failure::config(message));
    }
    let folder = match args.out.parent().filter(|f| !to_stdout && !f.as_os_str().is_empty()) {
        Some(folder) => folder,
        None => Path::new("."),
    };
    let text = order.text_for(folder)?;
    // A design that cannot be filled is told now, not at the next step.
    let mut screen = Screen::open()?;
    let survey = job::survey(&order, &Library::open(), &mut screen);
    screen.close();
    let survey = survey?;
    write(&args.out, &text)?;
    if to_stdout {
        return Ok(());
    }
    tell(&survey, false)?;
    let file = quoted(&args.out);
    output::line(&format!(
        "\nwrote {file}; change it with furbelow design densify {file} PART SECTION..., make it with furbelow make {file}"
    ))
}
