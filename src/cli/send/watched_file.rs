//! A file that is read twice, to be checked and to be sent, and must be the same both times.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::time::SystemTime;

use sha2::{Digest, Sha256};

/// What a file was when it was read to its end.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stamp {
    version: Version,
    hash: Vec<u8>,
}

/// What the system says of a file without reading it.
#[derive(Debug, Clone, PartialEq)]
struct Version {
    bytes: u64,
    modified: Option<SystemTime>,
}

/// A file that says when it is no longer what it was.
#[derive(Debug)]
pub(super) struct WatchedFile {
    file: File,
    version: Version,
    hash: Sha256,
    /// What it must turn out to be.
    expected: Option<Stamp>,
}

impl Version {
    fn of(file: &File) -> io::Result<Version> {
        let metadata = file.metadata()?;
        Ok(Version { bytes: metadata.len(), modified: metadata.modified().ok() })
    }
}

impl WatchedFile {
    /// Opens a file for the first time.
    pub(super) fn open(path: &Path) -> io::Result<WatchedFile> {
        let file = File::open(path)?;
        Ok(WatchedFile { version: Version::of(&file)?, file, hash: Sha256::new(), expected: None })
    }

    /// Opens it again. Reading fails as soon as it is seen to differ, at its end at the latest.
    ///
    /// # Errors
    /// It differs already.
    pub(super) fn reopen(path: &Path, stamp: &Stamp) -> io::Result<WatchedFile> {
        let mut file = WatchedFile::open(path)?;
        file.expected = Some(stamp.clone());
        if file.version == stamp.version { Ok(file) } else { Err(changed()) }
    }

    /// What it was, as far as it has been read.
    pub(super) fn stamp(self) -> Stamp {
        Stamp { version: self.version, hash: self.hash.finalize().to_vec() }
    }
}

impl Read for WatchedFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.file.read(buffer)?;
        self.hash.update(&buffer[..n]);
        // After reading: what was written before is seen now.
        if Version::of(&self.file)? != self.version {
            return Err(changed());
        }
        let at_end = n == 0 && !buffer.is_empty();
        match &self.expected {
            Some(stamp) if at_end && self.hash.clone().finalize().as_slice() != stamp.hash => Err(changed()),
            _ => Ok(n),
        }
    }
}

fn changed() -> io::Error {
    io::Error::other("it was changed after it was checked; send it again")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn stamped(path: &Path) -> Stamp {
        let mut file = WatchedFile::open(path).unwrap();
        io::copy(&mut file, &mut io::sink()).unwrap();
        file.stamp()
    }

    #[test]
    fn a_file_that_is_rewritten_is_noticed_before_while_and_after_it_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("job.nc");
        std::fs::write(&path, "G0X1\nG0X2\n").unwrap();
        let stamp = stamped(&path);
        let mut same = WatchedFile::reopen(&path, &stamp).unwrap();
        assert_eq!(io::copy(&mut same, &mut io::sink()).unwrap(), 10);

        let mut read = WatchedFile::reopen(&path, &stamp).unwrap();
        read.read_exact(&mut [0; 5]).unwrap();
        std::fs::OpenOptions::new().append(true).open(&path).unwrap().write_all(b"M3S1000\n").unwrap();
        assert!(read.read(&mut [0; 5]).is_err());
        assert!(WatchedFile::reopen(&path, &stamp).unwrap_err().to_string().contains("changed"));

        // Same length and time, another text: only its bytes tell.
        std::fs::write(&path, "G0X1\nG0X9\n").unwrap();
        let Stamp { version, .. } = stamped(&path);
        let mut sly = WatchedFile::reopen(&path, &Stamp { version, ..stamp }).unwrap();
        assert!(io::copy(&mut sly, &mut io::sink()).is_err());
    }
}
