//! The journal of what is being sent. A job goes on though it cannot be written: then only it cannot be picked up again, or not from where it came to.

use std::io::BufReader;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use super::super::{Failure, jobs};
use super::Sending;
use super::program::Program;
use crate::gcode;
use crate::stream::{
    Ending, Head, JournalError, Lines, Note, Progress, Record, Recorder, Status, Trouble, lasting_name,
};

/// The notes of one job.
pub(super) struct Keeping {
    recorder: Option<Recorder>,
    began: Instant,
    progress: Progress,
    /// Why it is not kept as it should be, not told yet; and that it was told once.
    complaint: Option<JournalError>,
    complained: bool,
}

impl Keeping {
    /// Takes a program up in the journal: its lines come from the journal's own copy, or from the file itself when there is none.
    ///
    /// # Errors
    /// The program is no longer what was checked.
    pub(super) fn take_up(
        program: &Program,
        mut head: Head,
        before: Option<&Record>,
    ) -> Result<(Keeping, Lines), Failure> {
        head.began_unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        (head.crosses_mm, head.own_zero_mm) = (program.crosses_mm, program.own_zero_mm);
        head.resumes = before.map(|record| record.number);
        let mut keeping = Keeping {
            recorder: None,
            began: Instant::now(),
            progress: Progress::default(),
            complaint: None,
            complained: false,
        };
        // What is wrong with the program itself shows here, before the journal is blamed.
        let lines = program.open()?;
        let taken_up = jobs::journal().and_then(|journal| journal.begin(head, lines, before));
        match taken_up {
            Ok((recorder, file)) => {
                keeping.recorder = Some(recorder);
                Ok((keeping, Box::new(gcode::read_lines(BufReader::new(file)))))
            }
            Err(error) => {
                keeping.complaint = Some(error);
                Ok((keeping, program.open()?))
            }
        }
    }

    /// The job's number in the journal.
    pub(super) fn number(&self) -> Option<u32> {
        self.recorder.as_ref().map(Recorder::number)
    }

    /// A report came.
    pub(super) fn reports(&mut self, status: &Status, progress: Progress) {
        self.progress = progress;
        self.note(Note::of_status(self.t_s(), status, progress));
    }

    /// Something went wrong.
    pub(super) fn troubled(&mut self, trouble: &Trouble) {
        self.note(Note::of_trouble(self.t_s(), trouble, self.progress));
    }

    /// It is over.
    pub(super) fn ends(&mut self, ending: &Ending) {
        // That its end is not kept is worth a word of its own.
        self.complained = false;
        self.note(Note::of_ending(self.t_s(), ending));
    }

    /// Why the journal is not kept as it should be, told once.
    pub(super) fn complaint(&mut self) -> Option<String> {
        let error = self.complaint.take()?;
        let so = match self.recorder {
            Some(_) => "what it knows of this job is behind until it can",
            None => "this job cannot be resumed later",
        };
        Some(format!("the journal cannot be written ({error}): {so}"))
    }

    fn t_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    fn note(&mut self, note: Note) {
        if let Some(Err(error)) = self.recorder.as_mut().map(|recorder| recorder.note(&note)) {
            // It is tried again with every note: room may be made meanwhile, and what matters most is the last one.
            if !std::mem::replace(&mut self.complained, true) {
                self.complaint = Some(error);
            }
        }
    }
}

impl Sending<'_> {
    /// Takes a program up in the journal.
    ///
    /// # Errors
    /// The program is no longer what was checked.
    pub(super) fn keep(&mut self, k: usize) -> Result<(Keeping, Lines), Failure> {
        let program = &self.programs[k];
        let port = lasting_name(&self.at.port);
        let mut head = Head::new(program.name(), &self.at.machine, port, &self.talk.board);
        head.sheet = self.place(k);
        head.laser = self.machine.tool.class.is_laser();
        head.start_mm = self.talk.status.work_mm;
        head.anyway = self.args.anyway;
        Keeping::take_up(program, head, self.resumes.as_ref())
    }

    /// Says when the journal is not kept as it should be.
    pub(super) fn heed(&self, keeping: &mut Keeping) -> Result<(), Failure> {
        keeping.complaint().map_or(Ok(()), |complaint| self.teller.warn("journal", &complaint))
    }
}
