//! What is on disk of every job: what was sent, to what machine, how far it came. It outlives the sender, however that ends.
//!
//! ```text
//! JOBS/0012/program.nc   its own copy of the program, as it is sent
//! JOBS/0012/head.json    what is known before the first line; a job without one never began
//! JOBS/0012/log          one note a line, appended; a torn last line is passed over
//! JOBS/0012/lock         held by the sender while it lives
//! ```
//!
//! A note is written with every report and forced to the disk at the start, every few seconds, at every trouble and at the end. A killed sender loses
//! nothing that was written; a computer that loses power loses a few seconds. When the log has grown to a limit its last note of progress and
//! all others take its place in one rename, so that a long job needs no more room than a short one.

mod error;
mod head;
mod note;
mod record;
mod recorder;

use std::fs::{self, File};
use std::path::{Path, PathBuf};

pub use error::JournalError;
pub use head::Head;
pub use note::{Mark, Note};
pub use record::{Record, Standing};
pub use recorder::Recorder;

use error::at;

/// File names within a job's folder.
const PROGRAM: &str = "program.nc";
const HEAD: &str = "head.json";
const LOG: &str = "log";
const LOCK: &str = "lock";

/// All jobs in a folder.
#[derive(Debug, Clone)]
pub struct Journal {
    folder: PathBuf,
}

impl Journal {
    /// The journal in a folder, which need not exist yet.
    pub fn at(folder: impl Into<PathBuf>) -> Journal {
        Journal { folder: folder.into() }
    }

    /// Where it is.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// All jobs that began, oldest first. Folders that cannot be read as jobs are passed over.
    ///
    /// # Errors
    /// The folder is there and cannot be read.
    pub fn records(&self) -> Result<Vec<Record>, JournalError> {
        let mut records: Vec<Record> =
            self.numbers()?.into_iter().filter_map(|number| self.record(number).ok()).collect();
        records.sort_by_key(|record| record.number);
        Ok(records)
    }

    /// One job.
    ///
    /// # Errors
    /// There is none with this number, or it cannot be read.
    pub fn record(&self, number: u32) -> Result<Record, JournalError> {
        let folder = self.job_folder(number);
        if !folder.is_dir() {
            return Err(JournalError::NoSuchJob { number });
        }
        Record::read(number, folder)
    }

    /// Takes up a new job: makes its copy of the program, which it gives back to be sent, and writes down what is known, in the job `before` too, with
    /// which it goes on. `lines` come without their ends.
    ///
    /// # Errors
    /// The lines or the disk. Nothing is left of the job then: it could be taken for one to go on with.
    pub fn begin(
        &self,
        head: Head,
        lines: impl Iterator<Item = std::io::Result<String>>,
        before: Option<&Record>,
    ) -> Result<(Recorder, File), JournalError> {
        fs::create_dir_all(&self.folder).map_err(at(&self.folder))?;
        let mut number = self.numbers()?.into_iter().max().unwrap_or(0) + 1;
        let folder = loop {
            let folder = self.job_folder(number);
            match fs::create_dir(&folder) {
                Ok(()) => break folder,
                // Another sender has just taken the number.
                Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => number += 1,
                Err(e) => return Err(at(&folder)(e)),
            }
        };
        let begin = || {
            let recorder = Recorder::begin(number, folder.clone(), head, lines)?;
            let path = recorder.program();
            let program = File::open(&path).map_err(at(&path))?;
            before.map_or(Ok(()), |before| before.resumed(number))?;
            Ok((recorder, program))
        };
        let begun = begin().inspect_err(|_| {
            // What cannot be removed has no head, or is told of by the error.
            let _ = fs::remove_dir_all(&folder);
        });
        sync_folder(&self.folder);
        begun
    }

    /// Removes a job for good.
    ///
    /// # Errors
    /// It is being sent, or the disk.
    pub fn remove(&self, number: u32) -> Result<(), JournalError> {
        let folder = self.job_folder(number);
        if record::is_held(&folder) {
            return Err(JournalError::Running { number });
        }
        fs::remove_dir_all(&folder).map_err(at(&folder))
    }

    /// Jobs of which nothing but a beginning is there: their sender was ended before the first line.
    ///
    /// # Errors
    /// The folder is there and cannot be read.
    pub fn stillborn(&self) -> Result<Vec<u32>, JournalError> {
        let unborn = |number: &u32| {
            let folder = self.job_folder(*number);
            !folder.join(HEAD).exists() && !record::is_held(&folder)
        };
        Ok(self.numbers()?.into_iter().filter(unborn).collect())
    }

    fn job_folder(&self, number: u32) -> PathBuf {
        self.folder.join(format!("{number:04}"))
    }

    fn numbers(&self) -> Result<Vec<u32>, JournalError> {
        if !self.folder.is_dir() {
            return Ok(Vec::new());
        }
        let mut numbers = Vec::new();
        for entry in fs::read_dir(&self.folder).map_err(at(&self.folder))? {
            let name = entry.map_err(at(&self.folder))?.file_name();
            numbers.extend(name.to_str().and_then(|name| name.parse::<u32>().ok()));
        }
        Ok(numbers)
    }
}

/// Forces names in a folder to the disk, where the system can: a file that is not yet found after a loss of power is no worse than one not begun.
fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
}

#[cfg(test)]
mod tests;
