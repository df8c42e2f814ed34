//! Putting files into the output folder without losing what is there.

use super::{Error, Order, assembly, dry_run};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Files on their way into a folder: written into a hidden folder inside it, moved into place at the end.
#[derive(Debug)]
pub(super) struct Stage {
    target: PathBuf,
    staging: tempfile::TempDir,
    files: Vec<PathBuf>,
}

/// Folders whose files are all ours: what an earlier run left there and this one does not replace is removed, so that nobody cuts a sheet of last week.
const OWN_FOLDERS: [(&str, &[&str]); 4] = [
    ("parts", &["svg", "png"]),
    ("strips", &["svg", "dxf"]),
    ("sheets", &["svg", "dxf", "nc", "png"]),
    ("offcuts", &["svg"]),
];

/// Files of ours beside them that not every job has.
const OWN_FILES: [&str; 2] = [assembly::PATTERNS, dry_run::PAGE];

impl Stage {
    /// Opens a staging folder inside `target`, so that both are on the same file system.
    pub fn new(target: &Path) -> Result<Stage, Error> {
        let target = absolute(target)?;
        fs::create_dir_all(&target).map_err(Error::file(&target))?;
        let staging =
            tempfile::Builder::new().prefix(".furbelow-").tempdir_in(&target).map_err(Error::file(&target))?;
        Ok(Stage { target, staging, files: Vec::new() })
    }

    /// The folder the files will be in.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Stages one file; `name` is relative to the target folder.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let path = self.staging.path().join("new").join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(Error::file(folder))?;
        }
        fs::write(&path, bytes).map_err(Error::file(&path))?;
        self.files.push(PathBuf::from(name));
        Ok(())
    }

    /// Moves every staged file into place and removes what earlier runs left in our own folders. When anything fails on the way, everything is put back.
    pub fn publish(self) -> Result<Vec<PathBuf>, Error> {
        let mut moved = Moved { new: Vec::new(), old: Vec::new() };
        match self.move_all(&mut moved) {
            Ok(()) => Ok(self.files),
            Err(error) => {
                moved.put_back();
                Err(error)
            }
        }
    }

    fn move_all(&self, moved: &mut Moved) -> Result<(), Error> {
        let (new, old) = (self.staging.path().join("new"), self.staging.path().join("old"));
        let stale = self.stale();
        for (n, path) in self.files.iter().map(|file| self.target.join(file)).chain(stale).enumerate() {
            if path.exists() {
                let aside = old.join(n.to_string());
                fs::create_dir_all(&old).map_err(Error::file(&old))?;
                fs::rename(&path, &aside).map_err(Error::file(&path))?;
                moved.old.push((aside, path));
            }
        }
        for file in &self.files {
            let to = self.target.join(file);
            if let Some(folder) = to.parent() {
                fs::create_dir_all(folder).map_err(Error::file(folder))?;
            }
            fs::rename(new.join(file), &to).map_err(Error::file(&to))?;
            moved.new.push(to);
        }
        Ok(())
    }

    /// Files of ours that this run does not write.
    fn stale(&self) -> Vec<PathBuf> {
        let wanted: BTreeSet<PathBuf> = self.files.iter().map(|f| self.target.join(f)).collect();
        let beside = OWN_FILES.iter().map(|name| self.target.join(name));
        let mut stale: Vec<PathBuf> = beside.filter(|p| p.is_file() && !wanted.contains(p)).collect();
        for (folder, endings) in OWN_FOLDERS {
            let Ok(entries) = fs::read_dir(self.target.join(folder)) else { continue };
            let paths = entries.flatten().map(|entry| entry.path());
            let ours = |p: &PathBuf| p.extension().is_some_and(|e| endings.iter().any(|ending| e == *ending));
            stale.extend(paths.filter(|p| p.is_file() && ours(p) && !wanted.contains(p)));
        }
        stale
    }
}

/// What a publication has moved so far.
struct Moved {
    new: Vec<PathBuf>,
    /// Where an old file was put, and where it was.
    old: Vec<(PathBuf, PathBuf)>,
}

impl Moved {
    fn put_back(self) {
        // Errors here leave nothing better to do: the first one is what the user is told.
        for path in self.new {
            let _ = fs::remove_file(path);
        }
        for (aside, path) in self.old {
            let _ = fs::rename(aside, path);
        }
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
        Ok(text) if text == order.text_for(out_dir)? || order.source.as_ref().is_some_and(|s| s.text == text) => Ok(()),
        Ok(_) => Err(Error::ForeignDesign { path }),
    }
}

/// The path from the root, links resolved as far as it exists, without `.` and `..`.
pub(super) fn absolute(path: &Path) -> Result<PathBuf, Error> {
    let whole = std::path::absolute(path).map_err(Error::file(path))?;
    let mut clean = PathBuf::new();
    for component in whole.components() {
        match component {
            Component::ParentDir => {
                clean.pop();
            }
            Component::CurDir => {}
            other => {
                clean.push(other);
                // A link means what it points to, also for a `..` that follows.
                clean = fs::canonicalize(&clean).unwrap_or(clean);
            }
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
        let left: Vec<_> = fs::read_dir(&out).unwrap().flatten().map(|e| e.file_name()).collect();
        assert_eq!(left, ["sheets"], "no staging folder is left behind");
    }

    #[test]
    fn a_publication_that_fails_half_way_puts_everything_back() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let mut first = Stage::new(&out).unwrap();
        first.write("design.toml", b"old").unwrap();
        first.write("parts/A.svg", b"old").unwrap();
        first.publish().unwrap();
        // Somebody put a file where a folder must be.
        fs::write(out.join("sheets"), b"mine").unwrap();
        let mut second = Stage::new(&out).unwrap();
        for name in ["design.toml", "parts/B.svg", "sheets/sheet-01.nc"] {
            second.write(name, b"new").unwrap();
        }
        assert!(second.publish().is_err());
        assert_eq!(fs::read(out.join("design.toml")).unwrap(), b"old");
        assert_eq!(fs::read(out.join("parts/A.svg")).unwrap(), b"old");
        assert!(!out.join("parts/B.svg").exists());
        assert_eq!(fs::read(out.join("sheets")).unwrap(), b"mine");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_before_a_way_is_worked_out() {
        let folder = tempfile::tempdir().unwrap();
        let root = fs::canonicalize(folder.path()).unwrap();
        fs::create_dir_all(root.join("far/away")).unwrap();
        std::os::unix::fs::symlink(root.join("far/away"), root.join("out")).unwrap();
        let out = absolute(&folder.path().join("out")).unwrap();
        assert_eq!(relative(&out, &root.join("stool.obj")), "../../stool.obj");
    }

    #[test]
    fn a_stage_that_is_dropped_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let mut stage = Stage::new(&out).unwrap();
        stage.write("report.json", b"{}").unwrap();
        drop(stage);
        assert_eq!(fs::read_dir(out).unwrap().count(), 0);
    }
}
