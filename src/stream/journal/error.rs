//! What can be wrong with the journal.

use std::io;
use std::path::{Path, PathBuf};

/// The journal cannot do what is asked.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// No job with this number.
    #[error("there is no job {number}; `furbelow jobs` lists them")]
    NoSuchJob {
        /// Its number.
        number: u32,
    },
    /// Its sender lives.
    #[error("job {number} is being sent at this moment: stop it first")]
    Running {
        /// Its number.
        number: u32,
    },
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// Where.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file does not hold what it should.
    #[error("{} cannot be read as part of a job: {reason}", path.display())]
    Garbled {
        /// Where.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// An error of the system's at a path.
pub(super) fn at(path: &Path) -> impl Fn(io::Error) -> JournalError {
    let path = path.to_owned();
    move |source| JournalError::File { path: path.clone(), source }
}
