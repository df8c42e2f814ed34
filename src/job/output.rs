//! Putting files into the output folder without losing what is there.

use super::{Error, Order};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Files on their way into a folder: written beside it, moved in at the end.
#[derive(Debug)]
pub(super) struct Stage {
    target: PathBuf,
    staging: tempfile::TempDir,
    files: Vec<PathBuf>,
}

/// Folders whose files are all ours: what an earlier run left there and this one does not replace is removed, so that nobody cuts a sheet of last week.
const OWN_FOLDERS: [(&str, &[&str]); 3] =
    [("parts", &["svg", "png"]), ("strips", &["svg", "dxf"]), ("sheets", &["svg", "dxf", "nc", "png"])];

impl Stage {
    /// Opens a staging folder next to `target`, on the same file system.
    pub fn new(target: &Path) -> Result<Stage, Error> {
        let target = absolute(target)?;
        let parent = target.parent().unwrap_or(&target);
        fs::create_dir_all(parent).map_err(Error::file(parent))?;
        let staging = tempfile::Builder::new().prefix(".furbelow-").tempdir_in(parent).map_err(Error::file(parent))?;
        Ok(Stage { target, staging, files: Vec::new() })
    }

    /// The folder the files will be in.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Stages one file; `name` is relative to the target folder.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let path = self.staging.path().join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(Error::file(folder))?;
        }
        fs::write(&path, bytes).map_err(Error::file(&path))?;
        self.files.push(PathBuf::from(name));
        Ok(())
    }

    /// Moves every staged file into place and removes what earlier runs left in our own folders.
    pub fn publish(self) -> Result<Vec<PathBuf>, Error> {
        let Stage { target, staging, files } = self;
        let wanted: BTreeSet<PathBuf> = files.iter().map(|f| target.join(f)).collect();
        for (file, to) in files.iter().map(|f| (f, target.join(f))) {
            if let Some(folder) = to.parent() {
                fs::create_dir_all(folder).map_err(Error::file(folder))?;
            }
            fs::rename(staging.path().join(file), &to).map_err(Error::file(&to))?;
        }
        for (folder, endings) in OWN_FOLDERS {
            let Ok(entries) = fs::read_dir(target.join(folder)) else { continue };
            for path in entries.flatten().map(|entry| entry.path()) {
                let ours = path.extension().is_some_and(|e| endings.iter().any(|ending| e == *ending));
                if ours && !wanted.contains(&path) {
                    fs::remove_file(&path).map_err(Error::file(&path))?;
                }
            }
        }
        Ok(files)
    }
}

/// Refuses to write over a design that is not the one being made.
pub(super) fn refuse_foreign_design(out_dir: &Path, order: &Order) -> Result<(), Error> {
    let path = out_dir.join("design.toml");
    if order.force {
        return Ok(());
    }
    match fs::read_to_string(&path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Err(source) => Err(Error::File { path, source }),
        Ok(text) if text == order.text_for(out_dir)? || order.text.as_ref() == Some(&text) => Ok(()),
        Ok(_) => Err(Error::ForeignDesign { path }),
    }
}

/// The path with the current folder before it when it is relative, without `.` and `..`.
pub(super) fn absolute(path: &Path) -> Result<PathBuf, Error> {
    let mut clean = PathBuf::new();
    for component in std::path::absolute(path).map_err(Error::file(path))?.components() {
        match component {
            Component::ParentDir => {
                clean.pop();
            }
            Component::CurDir => {}
            other => clean.push(other),
        }
    }
    Ok(clean)
}

/// `path` as seen from folder `from`, both absolute, with forward slashes on every system; the absolute path where there is no way between them.
pub(super) fn relative(from: &Path, path: &Path) -> String {
    let (from, to): (Vec<_>, Vec<_>) = (from.components().collect(), path.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return path.display().to_string();
    }
    let up = std::iter::repeat_n("..".to_owned(), from.len() - shared);
    let down = to[shared..].iter().map(|c| c.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<String>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_paths_lead_back() {
        assert_eq!(relative(Path::new("/a/out/stool"), Path::new("/a/models/stool.obj")), "../../models/stool.obj");
        assert_eq!(relative(Path::new("/a"), Path::new("/a/stool.obj")), "stool.obj");
    }

    #[test]
    fn stale_sheets_go_and_foreign_files_stay() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let mut first = Stage::new(&out).unwrap();
        first.write("sheets/sheet-01.nc", b"old").unwrap();
        first.write("sheets/sheet-02.nc", b"old").unwrap();
        first.publish().unwrap();
        fs::write(out.join("sheets/notes.txt"), b"mine").unwrap();
        let mut second = Stage::new(&out).unwrap();
        second.write("sheets/sheet-01.nc", b"new").unwrap();
        second.publish().unwrap();
        assert_eq!(fs::read(out.join("sheets/sheet-01.nc")).unwrap(), b"new");
        assert!(!out.join("sheets/sheet-02.nc").exists());
        assert!(out.join("sheets/notes.txt").exists());
        let left: Vec<_> = fs::read_dir(folder.path()).unwrap().flatten().collect();
        assert_eq!(left.len(), 1, "no staging folder is left behind");
    }

    #[test]
    fn a_stage_that_is_dropped_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let mut stage = Stage::new(&out).unwrap();
        stage.write("report.json", b"{}").unwrap();
        drop(stage);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
