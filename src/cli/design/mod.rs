//! `furbelow design ...`: design files made, looked at and changed.
//!
//! A change is an edit at the end of the file's list. The design is worked out with it before the file is written, so a file that was changed is one that works.

mod change;
mod new;
mod show;
mod undo;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::Failure;
use super::output::read_argument;
use crate::job::{Order, Overrides, Source};
use crate::preview::Canvas;

/// What to do with a design file.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Make a design file for a shape
    New(new::Args),
    /// Show parts, layers, sections and edits
    Show(show::Args),
    /// Make sections stiffer: more strip, more joints
    #[command(visible_alias = "stiffer")]
    Densify(change::Densify),
    /// Make densified sections softer again
    #[command(visible_alias = "softer")]
    Undensify(change::Undensify),
    /// Change the number of layers
    Layers(change::Layers),
    /// Cut the shape elsewhere
    Plane(change::Plane),
    /// Cut a part in two
    Split(change::Split),
    /// Move a joint by hand
    MovePoint(change::MovePoint),
    /// Give a section a length by hand
    Length(change::Length),
    /// Take the last change back
    Undo(undo::Args),
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::New(args) => new::run(&args),
        Command::Show(args) => show::run(&args),
        Command::Densify(args) => args.run(),
        Command::Undensify(args) => args.run(),
        Command::Layers(args) => args.run(),
        Command::Plane(args) => args.run(),
        Command::Split(args) => args.run(),
        Command::MovePoint(args) => args.run(),
        Command::Length(args) => args.run(),
        Command::Undo(args) => undo::run(&args),
    }
}

/// The design in a file, or on stdin for `-`.
fn read(file: &Path) -> Result<(Order, Source), Failure> {
    let overrides = Overrides::default();
    let order = match file.to_str().map(read_argument).transpose()?.flatten() {
        Some((name, text)) => Order::from_text(name, text, Path::new("."), &overrides)?,
        None => Order::from_file(file, &overrides)?,
    };
    let source = order.source.clone().ok_or_else(|| Failure::config("this design was not read from a file"))?;
    Ok((order, source))
}

fn is_stdin(file: &Path) -> bool {
    file == Path::new("-")
}

/// Puts a text in a file's place in one go; on stdout for `-`.
fn write(file: &Path, text: &str) -> Result<(), Failure> {
    let failed = |e: std::io::Error| Failure::config(format!("{}: {e}", file.display()));
    if is_stdin(file) {
        std::io::stdout().lock().write_all(text.as_bytes())?;
        return Ok(());
    }
    // A link keeps pointing at what it points at.
    let file = fs::canonicalize(file).unwrap_or_else(|_| file.to_path_buf());
    let folder = file.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut staged = tempfile::Builder::new().prefix(".furbelow-").tempfile_in(folder).map_err(failed)?;
    staged.write_all(text.as_bytes()).map_err(failed)?;
    if let Ok(old) = fs::metadata(&file) {
        fs::set_permissions(staged.path(), old.permissions()).map_err(failed)?;
    } else {
        readable_by_others(staged.path()).map_err(failed)?;
    }
    staged.persist(&file).map_err(|e| failed(e.error))?;
    Ok(())
}

/// Temporary files are their maker's alone; a design is as readable as any other new file.
#[cfg(unix)]
fn readable_by_others(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable_by_others(_: &Path) -> std::io::Result<()> {
    Ok(())
}

/// Longer side of a picture as PNG, pixels.
const PICTURE_PX: u32 = 1600;

/// Writes a part's picture, as SVG or PNG by the file's ending.
fn picture(canvas: &Canvas, file: &PathBuf) -> Result<(), Failure> {
    let ending = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let bytes = match ending.as_deref() {
        Some("svg") => canvas.to_svg().into_bytes(),
        Some("png") => canvas.to_png(PICTURE_PX).map_err(Failure::config)?,
        _ => {
            return Err(Failure::config(format!(
                "--picture {}: name a file that ends in .svg or .png",
                file.display()
            )));
        }
    };
    fs::write(file, bytes).map_err(|e| Failure::config(format!("{}: {e}", file.display())))
}
