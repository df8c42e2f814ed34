//! Writes a job down while it is sent.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use sha2::{Digest, Sha256};

use super::error::{JournalError, at};
use super::head::{Head, hexadecimal};
use super::note::{Mark, Note};
use super::{HEAD, LOCK, LOG, PROGRAM, sync_folder};
use crate::stream::Progress;

/// A log larger than this is written anew, bytes: some 400 notes, a minute's.
const LOG_BYTES: u64 = 65_536;

/// Notes other than of progress that are kept: a job has a handful.
const KEPT_NOTES: usize = 100;

/// Progress is forced to the disk so often.
const SYNC_EVERY: Duration = Duration::from_secs(5);

/// A job that is being written down. Its lock is let go of with it.
#[derive(Debug)]
pub struct Recorder {
    number: u32,
    folder: PathBuf,
    log: File,
    bytes: u64,
    /// Notes other than of progress.
    kept: Vec<String>,
    /// Those of them that could not be written yet.
    owed: String,
    /// What was last written may not have come whole.
    torn: bool,
    synced: Instant,
    _lock: File,
}

impl Recorder {
    pub(super) fn begin(
        number: u32,
        folder: PathBuf,
        mut head: Head,
        lines: impl Iterator<Item = io::Result<String>>,
    ) -> Result<Recorder, JournalError> {
        let lock_path = folder.join(LOCK);
        let lock = File::create(&lock_path).map_err(at(&lock_path))?;
        // Nobody else knows the folder yet; a file system without locks only shows a running job as an interrupted one.
        let _ = lock.try_lock();
        let program = folder.join(PROGRAM);
        (head.lines, head.program_sha256) = copy(lines, &program).map_err(at(&program))?;
        let log_path = folder.join(LOG);
        let log = OpenOptions::new().create(true).append(true).open(&log_path).map_err(at(&log_path))?;
        let (kept, owed) = (Vec::new(), String::new());
        let mut recorder =
            Recorder { number, folder, log, bytes: 0, kept, owed, torn: false, synced: Instant::now(), _lock: lock };
        recorder.note(&Note::new(Mark::Begun, 0.0, Progress::default()))?;
        let text = serde_json::to_string_pretty(&head)
            .map_err(|e| JournalError::Garbled { path: recorder.folder.join(HEAD), reason: e.to_string() })?;
        recorder.replace(HEAD, text.as_bytes())?;
        Ok(recorder)
    }

    /// The number of the job.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// The copy of the program that is to be sent.
    pub fn program(&self) -> PathBuf {
        self.folder.join(PROGRAM)
    }

    /// Adds a note. All but those of progress are on the disk when this returns; one of them that cannot be written goes with the next.
    ///
    /// # Errors
    /// The disk is full or gone. Later notes may be written all the same.
    pub fn note(&mut self, note: &Note) -> Result<(), JournalError> {
        let path = self.folder.join(LOG);
        // Numbers that are none become null, and nothing else in a note can fail.
        let text = serde_json::to_string(note)
            .map_err(|e| JournalError::Garbled { path: path.clone(), reason: e.to_string() })?;
        let line = text + "\n";
        let passing = note.is_passing();
        if !passing {
            self.owed += &line;
            if self.kept.len() < KEPT_NOTES {
                self.kept.push(line.clone());
            }
        }
        if self.bytes + line.len() as u64 > LOG_BYTES {
            // On a full disk what matters may find a place all the same.
            self.compact().or_else(|error| if passing { Err(error) } else { Ok(()) })?;
        }
        // In one call, so that no other end than a loss of power or a full disk tears it; a torn line must not run into the next.
        let gap = if self.torn { "\n" } else { "" };
        let text = format!("{gap}{}{}", self.owed, if passing { line.as_str() } else { "" });
        if let Err(error) = self.log.write_all(text.as_bytes()) {
            self.torn = true;
            if passing || self.write_over(&line).is_err() {
                return Err(at(&path)(error));
            }
        } else {
            self.bytes += text.len() as u64;
            self.torn = false;
            self.owed.clear();
        }
        if !passing || self.synced.elapsed() >= SYNC_EVERY {
            self.log.sync_data().map_err(at(&path))?;
            self.synced = Instant::now();
        }
        Ok(())
    }

    /// Puts all that matters, with a note as its last, in the place of what the log holds: the room it has already is there on a full disk too.
    fn write_over(&mut self, last: &str) -> io::Result<()> {
        let mut text = self.kept.concat();
        if !text.ends_with(last) {
            text += last;
        }
        let mut log = OpenOptions::new().write(true).open(self.folder.join(LOG))?;
        log.write_all(text.as_bytes())?;
        log.set_len(text.len() as u64)?;
        log.sync_data()?;
        (self.bytes, self.torn) = (text.len() as u64, false);
        self.owed.clear();
        Ok(())
    }

    /// Begins the log anew with what is worth keeping. The note that is written next says how far the job is.
    fn compact(&mut self) -> Result<(), JournalError> {
        let path = self.folder.join(LOG);
        let log = fs::read(&path).map_err(at(&path))?;
        let mut text = self.kept.concat();
        text.extend(String::from_utf8_lossy(&log).lines().last().map(|line| format!("{line}\n")));
        self.replace(LOG, text.as_bytes())?;
        self.log = OpenOptions::new().append(true).open(&path).map_err(at(&path))?;
        self.bytes = text.len() as u64;
        Ok(())
    }

    /// Puts a file in its place whole, or not at all.
    fn replace(&self, name: &str, bytes: &[u8]) -> Result<(), JournalError> {
        let (path, fresh) = (self.folder.join(name), self.folder.join(format!("{name}.new")));
        let write = || {
            let mut file = File::create(&fresh)?;
            file.write_all(bytes)?;
            file.sync_all()?;
            fs::rename(&fresh, &path)
        };
        write().map_err(at(&path))?;
        sync_folder(&self.folder);
        Ok(())
    }
}

/// Adds a note to a job nobody writes any more.
pub(super) fn append(folder: &Path, note: &Note) -> Result<(), JournalError> {
    let path = folder.join(LOG);
    let write = || {
        // A torn last line must not run into this one.
        let text = fs::read(&path)?;
        let mut log = OpenOptions::new().append(true).open(&path)?;
        let line = serde_json::to_string(note)?;
        let gap = if text.is_empty() || text.ends_with(b"\n") { "" } else { "\n" };
        log.write_all(format!("{gap}{line}\n").as_bytes())?;
        log.sync_data()
    };
    write().map_err(at(&path))
}

/// Copies a program; tells how many lines it has, and its hash.
fn copy(lines: impl Iterator<Item = io::Result<String>>, path: &Path) -> io::Result<(usize, String)> {
    let mut file = BufWriter::new(File::create(path)?);
    let (mut count, mut hash) = (0, Sha256::new());
    for line in lines {
        let line = line? + "\n";
        hash.update(&line);
        file.write_all(line.as_bytes())?;
        count += 1;
    }
    file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
    Ok((count, hexadecimal(&hash.finalize())))
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use crate::stream::{Board, Ending, Journal, Outcome, Standing, Trouble};

    fn progress(executed: usize) -> Progress {
        Progress { sent: executed, acked: executed, executed, reached: None }
    }

    fn full_disk() -> File {
        OpenOptions::new().append(true).open("/dev/full").unwrap()
    }

    fn begun() -> (tempfile::TempDir, Journal, Recorder) {
        let folder = tempfile::tempdir().unwrap();
        let journal = Journal::at(folder.path());
        let head = Head::new("a.nc", "diode-400", "/dev/ttyUSB0", &Board::default());
        let (mut recorder, _) = journal.begin(head, ["G0X1"].map(|l| Ok(l.to_owned())).into_iter(), None).unwrap();
        recorder.note(&Note::new(Mark::Progress, 1.0, progress(7))).unwrap();
        (folder, journal, recorder)
    }

    #[test]
    fn a_full_disk_does_not_lose_the_ending() {
        let (_folder, journal, mut recorder) = begun();
        recorder.log = full_disk();
        assert!(recorder.note(&Note::new(Mark::Progress, 2.0, progress(8))).is_err());
        let outcome = Outcome::Failed(Trouble::OffPlan { off_mm: 1.0, line: 9 });
        let ending = Ending { outcome, progress: progress(9), maybe: 12, position_kept: true, beam_off: true };
        // The device cannot be forced, the log can.
        let _ = recorder.note(&Note::of_ending(3.0, &ending));
        drop(recorder);
        let record = journal.record(1).unwrap();
        assert_eq!((record.standing, record.progress(), record.maybe()), (Standing::Damaged, progress(9), 12));
        assert_eq!(record.notes[0].mark, Mark::Begun);
    }

    #[test]
    fn what_could_not_be_written_is_written_when_there_is_room_again() {
        let (folder, journal, mut recorder) = begun();
        let (log, away) = (folder.path().join("0001/log"), folder.path().join("0001/away"));
        recorder.log = full_disk();
        fs::rename(&log, &away).unwrap();
        assert!(recorder.note(&Note::of_trouble(2.0, &Trouble::Locked, progress(8))).is_err());
        fs::rename(&away, &log).unwrap();
        // Half a note has come to the disk.
        recorder.log = OpenOptions::new().append(true).open(&log).unwrap();
        recorder.log.write_all(b"{\"mark\":\"trou").unwrap();
        recorder.note(&Note::new(Mark::Progress, 3.0, progress(9))).unwrap();
        let record = journal.record(1).unwrap();
        let marks: Vec<Mark> = record.notes.iter().map(|note| note.mark).collect();
        assert_eq!(marks, [Mark::Begun, Mark::Progress, Mark::Trouble, Mark::Progress]);
        assert_eq!(record.progress(), progress(9));
    }
}
