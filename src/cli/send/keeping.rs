//! The journal of what is being sent. A job goes on without it when it cannot be written: then it only cannot be picked up again.

use std::fs::File;
use std::io::BufReader;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use super::super::Failure;
use super::super::jobs;
use super::Sending;
use super::teller::Teller;
use crate::gcode;
use crate::stream::{Ending, Head, JournalError, Lines, Note, Progress, Recorder, Status, Trouble, lasting_name};

/// The notes of one job.
pub(super) struct Keeping {
    recorder: Option<Recorder>,
    began: Instant,
    progress: Progress,
}

impl Keeping {
    /// The job's number in the journal.
    pub(super) fn number(&self) -> Option<u32> {
        self.recorder.as_ref().map(Recorder::number)
    }

    /// A report came.
    pub(super) fn reports(&mut self, status: &Status, progress: Progress, teller: &Teller) -> Result<(), Failure> {
        self.progress = progress;
        self.note(Note::of_status(self.t_s(), status, progress), teller)
    }

    /// Something went wrong.
    pub(super) fn troubled(&mut self, trouble: &Trouble, teller: &Teller) -> Result<(), Failure> {
        self.note(Note::of_trouble(self.t_s(), trouble, self.progress), teller)
    }

    /// It is over.
    pub(super) fn ends(&mut self, ending: &Ending, teller: &Teller) -> Result<(), Failure> {
        self.note(Note::of_ending(self.t_s(), ending), teller)
    }

    fn t_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    fn note(&mut self, note: Note, teller: &Teller) -> Result<(), Failure> {
        let Some(recorder) = &mut self.recorder else { return Ok(()) };
        match recorder.note(&note) {
            Ok(()) => Ok(()),
            Err(error) => {
                self.recorder = None;
                unkept(&error, teller)
            }
        }
    }
}

impl Sending<'_> {
    /// Takes a program up in the journal: its lines come from the journal's own copy.
    ///
    /// # Errors
    /// The program is no longer what was checked.
    pub(super) fn keep(&mut self, k: usize) -> Result<(Keeping, Lines), Failure> {
        let program = &self.programs[k];
        let mut head = Head::new(program.name(), &self.args.at.machine, lasting_name(&self.args.at.port), &self.talk.board);
        head.sheet = self.place(k);
        head.laser = self.machine.tool.class.is_laser();
        head.began_unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        head.start_mm = self.talk.status.work_mm;
        head.crosses_mm = program.crosses_mm;
        head.resumes = self.resumes.as_ref().map(|record| record.number);
        let mut keeping = Keeping { recorder: None, began: Instant::now(), progress: Progress::default() };
        // What is wrong with the program itself shows here, before the journal is blamed.
        let lines = program.open()?;
        let taken_up = jobs::journal().and_then(|journal| {
            let recorder = journal.begin(head, lines)?;
            if let Some(before) = &self.resumes {
                before.resumed(recorder.number())?;
            }
            let path = recorder.program();
            let file = File::open(&path).map_err(|source| JournalError::File { path, source })?;
            Ok((recorder, file))
        });
        match taken_up {
            Ok((recorder, file)) => {
                keeping.recorder = Some(recorder);
                Ok((keeping, Box::new(gcode::read_lines(BufReader::new(file)))))
            }
            Err(error) => {
                let lines = self.programs[k].open()?;
                unkept(&error, self.teller)?;
                Ok((keeping, lines))
            }
        }
    }
}

fn unkept(error: &JournalError, teller: &Teller) -> Result<(), Failure> {
    teller.warn("journal", &format!("the journal cannot be written ({error}): this job cannot be resumed later"))
}
