//! One program on its way to a machine: read once to be checked, and once more, line by line, to be sent. No more than a line of it is held.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::super::connection::refused;
use super::super::{Exit, Failure};
use super::watched_file::{Stamp, WatchedFile};
use crate::gcode::{self, CheckSettings, Checker, Rewriter};
use crate::geom::{P2, Similarity};
use crate::job::Label;
use crate::stream::{Lines, Survey};

/// Bytes read from disk at once, to be checked.
const CHECK_BYTES: usize = 1 << 16;

/// Bytes read from disk at once, to be sent: a few hundred lines, after which the file is looked at again.
const SEND_BYTES: usize = 1 << 12;

/// A program that has been checked.
pub(super) struct Program {
    path: PathBuf,
    /// What people call it.
    name: String,
    stamp: Stamp,
    /// What it says of itself.
    pub(super) label: Label,
    /// What it asks of the machine, and when.
    pub(super) survey: Survey,
    /// Lines of the file.
    pub(super) lines: usize,
    /// What `check` would warn of.
    pub(super) warnings: usize,
    /// Middles of its two alignment crosses, mm in work coordinates.
    pub(super) crosses_mm: Option<[[f64; 2]; 2]>,
    /// Where its own X0 Y0 lies, mm in work coordinates.
    pub(super) own_zero_mm: [f64; 2],
}

impl Program {
    /// Reads and checks a file that people call `name`; `step` is told now and then how many bytes are done.
    ///
    /// # Errors
    /// It cannot be read, or must not be sent to this machine.
    pub(super) fn read(
        path: &Path,
        name: String,
        settings: &CheckSettings,
        step: impl FnMut(u64),
    ) -> Result<Program, Failure> {
        let unreadable = |e: io::Error| Failure::config(format!("{name} cannot be read: {e}"));
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
            let why = format!("{name} must not be sent: {finding}{more}; furbelow check tells all");
            return Err(Failure { exit: Exit::Refused, source: why.into() });
        }
        let (lines, warnings) = (report.lines, report.warnings.len());
        let crosses_mm = label.crosses_mm;
        let (path, stamp, own_zero_mm) = (path.to_owned(), file.stamp(), [0.0; 2]);
        Ok(Program { path, name, stamp, label, survey, lines, warnings, crosses_mm, own_zero_mm })
    }

    /// What people call it.
    pub(super) fn name(&self) -> String {
        self.name.clone()
    }

    /// This program elsewhere, or from somewhere on, written to a file and checked there.
    ///
    /// # Errors
    /// It leads where only the machine knows, or lies where it must not.
    pub(super) fn rewritten(
        &self,
        mut rewriter: Rewriter,
        placing: &Similarity,
        path: &Path,
        settings: &CheckSettings,
    ) -> Result<Program, Failure> {
        let unfit = |why: &dyn std::fmt::Display| refused(format!("{}: {why}", self.name));
        let mut file = BufWriter::new(File::create(path)?);
        for line in self.open()? {
            for line in rewriter.line(&line?).map_err(|e| unfit(&e))? {
                writeln!(file, "{line}")?;
            }
        }
        rewriter.finish().map_err(|e| unfit(&e))?;
        file.flush()?;
        let mut program = Program::read(path, self.name.clone(), settings, |_| ())?;
        // The file's own remark on its crosses is that of the original.
        let placed = |[x, y]: [f64; 2]| (placing * P2::new(x, y)).into();
        program.crosses_mm = self.crosses_mm.map(|crosses| crosses.map(placed));
        program.own_zero_mm = placed(self.own_zero_mm);
        Ok(program)
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
