//! Which programs an argument means: a file, or the sheets of a folder that `make` wrote.

use std::path::{Path, PathBuf};

use super::Failure;

/// The file itself, or the programs in a folder: those in its `sheets/`, or else its own, numbers in names counted as numbers.
///
/// # Errors
/// A folder that cannot be read or holds no program.
pub(super) fn programs(job: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !job.is_dir() {
        return Ok(vec![job.to_owned()]);
    }
    let sheets = job.join("sheets");
    let folder = if sheets.is_dir() { sheets } else { job.to_owned() };
    let unreadable = |e: std::io::Error| Failure::config(format!("{} cannot be read: {e}", folder.display()));
    let mut files = Vec::new();
    for entry in std::fs::read_dir(&folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("nc")) {
            files.push(path);
        }
    }
    files.sort_by_cached_key(|path| order(&path.to_string_lossy()));
    match files.is_empty() {
        true => Err(Failure::config(format!("{} holds no .nc file", folder.display()))),
        false => Ok(files),
    }
}

/// A stretch of digits, or of anything else.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Stretch {
    Number(u64),
    Text(String),
}

/// What a name is sorted by: sheet-9 before sheet-10, and the name itself where that does not tell.
fn order(name: &str) -> (Vec<Stretch>, String) {
    let chars: Vec<char> = name.chars().collect();
    let stretches = chars.chunk_by(|a, b| a.is_ascii_digit() == b.is_ascii_digit()).map(|chunk| {
        let text: String = chunk.iter().collect();
        text.parse().map_or(Stretch::Text(text), Stretch::Number)
    });
    (stretches.collect(), name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheets_come_in_the_order_of_their_numbers() {
        let folder = tempfile::tempdir().unwrap();
        let sheets = folder.path().join("sheets");
        std::fs::create_dir(&sheets).unwrap();
        for name in ["sheet-10.nc", "sheet-9.nc", "sheet-09.nc", "sheet-100.nc", "sheet-10.svg", "a.NC"] {
            std::fs::write(sheets.join(name), "").unwrap();
        }
        let names = |job: &Path| -> Vec<String> {
            let name = |p: PathBuf| p.file_name().unwrap().to_string_lossy().into_owned();
            programs(job).unwrap().into_iter().map(name).collect()
        };
        let expected = ["a.NC", "sheet-09.nc", "sheet-9.nc", "sheet-10.nc", "sheet-100.nc"];
        assert_eq!(names(folder.path()), expected);
        assert_eq!(names(&sheets), expected);
        assert_eq!(names(&sheets.join("sheet-10.svg")), ["sheet-10.svg"]);
        assert!(programs(tempfile::tempdir().unwrap().path()).is_err());
    }
}
