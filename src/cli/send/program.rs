//! One program on its way to a machine: read once to be checked, and once more, line by line, to be sent. No more than a line of it is held.

use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use super::super::{Exit, Failure};
use super::watched_file::{Stamp, WatchedFile};
use crate::gcode::{self, CheckSettings, Checker};
use crate::job::Label;
use crate::stream::{Lines, Survey};

/// Bytes read from disk at once, to be checked.
const CHECK_BYTES: usize = 1 << 16;

/// Bytes read from disk at once, to be sent: a few hundred lines, after which the file is looked at again.
const SEND_BYTES: usize = 1 << 12;

/// A program that has been checked.
pub(super) struct Program {
    path: PathBuf,
    stamp: Stamp,
    /// What it says of itself.
    pub(super) label: Label,
    /// What it asks of the machine, and when.
    pub(super) survey: Survey,
    /// Lines of the file.
    pub(super) lines: usize,
    /// What `check` would warn of.
    pub(super) warnings: usize,
}

impl Program {
    /// Reads and checks a file; `step` is told now and then how many bytes are done.
    ///
    /// # Errors
    /// It cannot be read, or must not be sent to this machine.
    pub(super) fn read(path: &Path, settings: &CheckSettings, step: impl FnMut(u64)) -> Result<Program, Failure> {
        let unreadable = |e: io::Error| Failure::config(format!("{} cannot be read: {e}", path.display()));
        let label = Label::read(BufReader::new(WatchedFile::open(path).map_err(unreadable)?)).map_err(unreadable)?;
        let mut file = WatchedFile::open(path).map_err(unreadable)?;
        let mut survey = Survey::default();
        let mut checker = Checker::watched(settings, &mut survey);
        checker.read(BufReader::with_capacity(CHECK_BYTES, &mut file), step).map_err(unreadable)?;
        let report = checker.finish();
        if let Some(finding) = report.errors.first() {
            let more = match report.errors.len() - 1 {
                0 => String::new(),
                n => format!(" (and {n} more)"),
            };
            let why = format!("{} must not be sent: {finding}{more}; furbelow check tells all", path.display());
            return Err(Failure { exit: Exit::Refused, source: why.into() });
        }
        let (lines, warnings) = (report.lines, report.warnings.len());
        Ok(Program { path: path.to_owned(), stamp: file.stamp(), label, survey, lines, warnings })
    }

    /// The file's name, for people.
    pub(super) fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Its lines, read while they are sent; an error among them once the file is no longer what was checked.
    ///
    /// # Errors
    /// It is no longer what was checked, or cannot be opened.
    pub(super) fn open(&self) -> Result<Lines, Failure> {
        let file = WatchedFile::reopen(&self.path, &self.stamp)
            .map_err(|e| Failure::config(format!("{} cannot be sent: {e}", self.name())))?;
        Ok(Box::new(gcode::read_lines(BufReader::with_capacity(SEND_BYTES, file))))
    }

    /// What to lay on the bed, for people: "A4, 297 x 210 mm, grain along X".
    pub(super) fn stock(&self) -> Option<String> {
        let sheet = self.label.sheet.as_ref()?;
        let mut stock = format!("{}, {:.0} x {:.0} mm", sheet.stock, sheet.width_mm, sheet.height_mm);
        if let Some(grain) = &self.label.grain {
            stock += &format!(", grain {grain}");
        }
        Some(stock)
    }

    /// Which sheet it is and of how many: as it says itself, or else by its place in the folder.
    pub(super) fn place(&self, in_folder: (usize, usize)) -> (usize, usize) {
        self.label.sheet.as_ref().map_or(in_folder, |sheet| (sheet.number, sheet.of))
    }
}
