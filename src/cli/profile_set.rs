//! `furbelow profile set`: writes values into a profile of the user's own.

use std::path::{Path, PathBuf};

use super::output::line;
use super::today::today;
use super::{Failure, make};
use crate::config::{Changes, Kind, Library, Machine};

/// Arguments of `profile set`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A name from the list, or the path of a .toml file; what is built in is copied into your own folder first
    name: String,
    /// What to set, such as thickness_mm=0.21 or joint.laser.slit_extra_mm=1.1; with --machine also cut.kerf_mm=0.13, cut.feed_mm_per_min=900, cut.power=0.6, engrave.power=0.1
    #[arg(required = true, value_name = "KEY=VALUE")]
    values: Vec<String>,
    /// The machine that cut. and engrave. values were found on
    #[arg(short, long)]
    machine: Option<String>,
    /// Where the values come from [default: set by hand and today's date]
    #[arg(long)]
    source: Option<String>,
}

pub(super) fn run(args: &Args, library: &Library) -> Result<(), Failure> {
    let machine = args.machine.as_deref().map(|name| library.machine(name)).transpose()?;
    let pair = |text: &String| match text.split_once('=') {
        Some((key, value)) => Ok((key.trim().to_owned(), value.trim().to_owned())),
        None => {
            Err(Failure::config(format!("`{text}` sets nothing; write it as key=value, such as thickness_mm=0.21")))
        }
    };
    let values = args.values.iter().map(pair).collect::<Result<_, _>>()?;
    let source = args.source.clone().unwrap_or_else(|| format!("set by hand {}", today()));
    let path = save(library, &args.name, machine.as_ref(), &Changes { values, source })?;
    line(&format!("wrote {}", make::quoted(&path)))
}

/// Changes a profile and writes it to the user's own file, which is there in whole or as it was.
pub(super) fn save(
    library: &Library,
    name: &str,
    machine: Option<&Machine>,
    changes: &Changes,
) -> Result<PathBuf, Failure> {
    let text = library.changed_profile(name, machine, changes)?;
    let path = library.own_file(Kind::Profile, name).ok_or_else(|| {
        Failure::config("there is no folder for your own profiles: set FURBELOW_CONFIG_DIR to one, or give the path of a .toml file")
    })?;
    let failed = |e: std::io::Error| Failure::config(format!("{}: {e}", path.display()));
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(failed)?;
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(failed)?;
    std::io::Write::write_all(&mut file, text.as_bytes()).map_err(failed)?;
    file.persist(&path).map_err(|e| failed(e.error))?;
    Ok(path)
}
