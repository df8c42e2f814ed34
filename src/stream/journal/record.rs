//! A job as it stands in the journal.

use std::fs::{self, File};
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::error::{JournalError, at};
use super::head::{Head, SCHEMA, hexadecimal, settings_hash};
use super::note::{Mark, Note};
use super::{HEAD, LOCK, LOG, PROGRAM, recorder};
use crate::stream::{Board, Progress};

/// How a job stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It is being sent at this moment.
    Running,
    /// All of it is carried out.
    Done,
    /// It was stopped as asked.
    Stopped,
    /// Trouble ended it.
    Failed,
    /// Something else may have been cut than was planned.
    Damaged,
    /// Its sender was ended in the middle: killed, or without power.
    Interrupted,
    /// Another job goes on with it.
    Resumed,
}

impl Standing {
    /// The word people and scripts read.
    pub fn word(self) -> &'static str {
        match self {
            Standing::Running => "running",
            Standing::Done => "done",
            Standing::Stopped => "stopped",
            Standing::Failed => "failed",
            Standing::Damaged => "damaged",
            Standing::Interrupted => "interrupted",
            Standing::Resumed => "resumed",
        }
    }

    /// True when there is something left that can be cut.
    pub fn is_open(self) -> bool {
        matches!(self, Standing::Stopped | Standing::Failed | Standing::Damaged | Standing::Interrupted)
    }
}

/// A job as it was written down.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Its number.
    pub number: u32,
    /// What was known when it began.
    pub head: Head,
    /// What was noted, in order; of progress as much as is kept.
    pub notes: Vec<Note>,
    /// How it stands.
    pub standing: Standing,
    folder: PathBuf,
}

impl Record {
    pub(super) fn read(number: u32, folder: PathBuf) -> Result<Record, JournalError> {
        let path = folder.join(HEAD);
        let garbled = |reason: String| JournalError::Garbled { path: path.clone(), reason };
        let text = fs::read_to_string(&path).map_err(at(&path))?;
        let head: Head = serde_json::from_str(&text).map_err(|e| garbled(e.to_string()))?;
        if head.schema != SCHEMA {
            return Err(garbled(format!("it was written by another version (schema {})", head.schema)));
        }
        let log = folder.join(LOG);
        let bytes = fs::read(&log).map_err(at(&log))?;
        let text = String::from_utf8_lossy(&bytes);
        // Lines that were torn by a loss of power say nothing.
        let notes: Vec<Note> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
        let standing = standing(&notes, is_held(&folder));
        Ok(Record { number, head, notes, standing, folder })
    }

    /// How far it came, as the last note says.
    pub fn progress(&self) -> Progress {
        self.last().map(|note| note.progress).unwrap_or_default()
    }

    /// The last line that may be carried out, in part or whole. After a sender that was killed it may be a few more.
    pub fn maybe(&self) -> usize {
        self.last().and_then(|note| note.maybe).unwrap_or(self.progress().sent)
    }

    /// The board knew its place when the job ended, and would still if it was not restarted since.
    pub fn position_kept(&self) -> bool {
        self.last().is_some_and(|note| note.position_kept)
    }

    /// The board had lost its place when the job ended. A job whose sender was killed says nothing of that.
    pub fn position_lost(&self) -> bool {
        let lost = |note: &Note| matches!(note.mark, Mark::Stopped | Mark::Failed) && !note.position_kept;
        self.notes.iter().any(lost)
    }

    /// The job that goes on with it.
    pub fn resumed_by(&self) -> Option<u32> {
        let note = self.notes.iter().rfind(|note| note.mark == Mark::Resumed)?;
        note.message.as_deref()?.parse().ok()
    }

    /// The last thing people were told.
    pub fn message(&self) -> Option<&str> {
        let told = |note: &&Note| note.mark != Mark::Resumed && note.message.is_some();
        self.notes.iter().rfind(told)?.message.as_deref()
    }

    /// Says that another job goes on with it.
    ///
    /// # Errors
    /// The disk.
    pub fn resumed(&self, by: u32) -> Result<(), JournalError> {
        let mut note = self.last().cloned().unwrap_or_else(|| Note::new(Mark::Resumed, 0.0, Progress::default()));
        (note.mark, note.message) = (Mark::Resumed, Some(by.to_string()));
        recorder::append(&self.folder, &note)
    }

    /// Says that nothing was left to cut of it: it is done.
    ///
    /// # Errors
    /// The disk.
    pub fn finished(&self) -> Result<(), JournalError> {
        let mut note = self.last().cloned().unwrap_or_else(|| Note::new(Mark::Done, 0.0, Progress::default()));
        (note.mark, note.message) = (Mark::Done, Some("nothing was left to cut".to_owned()));
        recorder::append(&self.folder, &note)
    }

    /// True when a board has other settings than the one it was sent to.
    pub fn is_other_board(&self, board: &Board) -> bool {
        self.head.settings_sha256 != settings_hash(board)
    }

    /// Its own copy of the program, after a look that it is whole.
    ///
    /// # Errors
    /// It cannot be read, or is no longer what was sent.
    pub fn program(&self) -> Result<PathBuf, JournalError> {
        let path = self.folder.join(PROGRAM);
        let hash = hash_of(&path).map_err(at(&path))?;
        if hash != self.head.program_sha256 {
            return Err(JournalError::Garbled { path, reason: "it is no longer what was sent".to_owned() });
        }
        Ok(path)
    }

    fn last(&self) -> Option<&Note> {
        self.notes.last()
    }
}

fn standing(notes: &[Note], held: bool) -> Standing {
    let marked = |mark: Mark| notes.iter().any(|note| note.mark == mark);
    match () {
        () if held => Standing::Running,
        () if marked(Mark::Done) => Standing::Done,
        () if marked(Mark::Resumed) => Standing::Resumed,
        () if notes.iter().any(|note| note.damaged) => Standing::Damaged,
        () if marked(Mark::Stopped) => Standing::Stopped,
        () if marked(Mark::Failed) => Standing::Failed,
        () => Standing::Interrupted,
    }
}

/// True while a sender holds a job's folder.
pub(super) fn is_held(folder: &Path) -> bool {
    File::open(folder.join(LOCK)).is_ok_and(|lock| matches!(lock.try_lock_shared(), Err(fs::TryLockError::WouldBlock)))
}

fn hash_of(path: &Path) -> io::Result<String> {
    let (mut file, mut hash) = (BufReader::new(File::open(path)?), Sha256::new());
    let mut buffer = [0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hexadecimal(&hash.finalize())),
            n => hash.update(&buffer[..n]),
        }
    }
}
