//! One line of a job's log.

use serde::{Deserialize, Serialize};

use crate::stream::{Ending, Outcome, Progress, Status, Trouble};

/// What a note is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mark {
    /// The first line is about to go.
    Begun,
    /// A report came.
    Progress,
    /// Something went wrong; `message` says what.
    Trouble,
    /// It came to its end.
    Done,
    /// It was stopped as asked.
    Stopped,
    /// It was ended by trouble.
    Failed,
    /// Another job goes on with it; `message` is its number.
    Resumed,
}

/// What is known at a moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Note {
    /// What it is about.
    pub mark: Mark,
    /// Since the job began, s.
    pub t_s: f64,
    /// How far the job has come.
    #[serde(flatten)]
    pub progress: Progress,
    /// The machine's state as people read it, where a report said it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<String>,
    /// Where the head was in machine coordinates, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub machine_mm: Option<[f64; 3]>,
    /// What people read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// The last line that may be carried out, in part or whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maybe: Option<usize>,
    /// The board's position was right at the end.
    #[serde(default, skip_serializing_if = "is_false")]
    pub position_kept: bool,
    /// Something else may have been cut than was planned.
    #[serde(default, skip_serializing_if = "is_false")]
    pub damaged: bool,
}

fn is_false(flag: &bool) -> bool {
    !flag
}

impl Note {
    /// A note that says no more than where the job stands.
    pub fn new(mark: Mark, t_s: f64, progress: Progress) -> Note {
        // Thousandths are enough, and keep the lines short.
        let t_s = (t_s * 1e3).round() / 1e3;
        Note {
            mark,
            t_s,
            progress,
            state: None,
            machine_mm: None,
            message: None,
            maybe: None,
            position_kept: false,
            damaged: false,
        }
    }

    /// A report.
    pub fn of_status(t_s: f64, status: &Status, progress: Progress) -> Note {
        let state = Some(status.state.word().to_owned());
        Note { state, machine_mm: status.machine_mm, ..Note::new(Mark::Progress, t_s, progress) }
    }

    /// Something that went wrong.
    pub fn of_trouble(t_s: f64, trouble: &Trouble, progress: Progress) -> Note {
        let (message, damaged) = (Some(trouble.to_string()), trouble.damages());
        Note { message, damaged, ..Note::new(Mark::Trouble, t_s, progress) }
    }

    /// The end.
    pub fn of_ending(t_s: f64, ending: &Ending) -> Note {
        let (mark, damaged) = match &ending.outcome {
            Outcome::Done => (Mark::Done, false),
            Outcome::Stopped => (Mark::Stopped, false),
            Outcome::Failed(trouble) => (Mark::Failed, trouble.damages()),
        };
        let (message, maybe) = (Some(ending.account()), Some(ending.maybe));
        let position_kept = ending.position_kept;
        Note { message, maybe, position_kept, damaged, ..Note::new(mark, t_s, ending.progress) }
    }

    /// True for notes of which only the last one matters.
    pub(super) fn is_passing(&self) -> bool {
        self.mark == Mark::Progress
    }
}
