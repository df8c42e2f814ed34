//! Why a job does not go on.

use super::advice::{alarm_advice, error_advice};
use super::reply::Firmware;

/// Something that ends a job early, with the way out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Trouble {
    /// A line was refused.
    #[error("line {line}: {text:?} was refused with error:{code}: {}", error_advice(*.firmware, *.code))]
    Refused {
        /// Line of the file, from 1.
        line: usize,
        /// As it was sent.
        text: String,
        /// GRBL's number.
        code: u16,
        /// Whose number it is.
        firmware: Firmware,
    },
    /// The board stopped by itself.
    #[error("ALARM:{code}: {}", alarm_advice(*.firmware, *.code))]
    Alarm {
        /// GRBL's number.
        code: u16,
        /// Whose number it is.
        firmware: Firmware,
    },
    /// The board reports that it is locked, though no alarm was heard.
    #[error("the board is locked and its alarm was not heard: home it, or zero it again, before the next job")]
    Locked,
    /// The board has gone to sleep and swallows what is sent.
    #[error("the board went to sleep and swallows lines; reset it")]
    Asleep,
    /// The board started anew.
    #[error(
        "the board restarted by itself (power, cable, or electrical noise): its position is lost; home or zero again"
    )]
    Restarted,
    /// Nothing came for too long.
    #[error(
        "nothing was heard from the board for {0:.1} s: cable, power or USB port; what it still holds it carries out"
    )]
    Silent(f64),
    /// The port is gone.
    #[error("the port failed: {0}; what the board still holds it carries out")]
    Link(String),
    /// The machine rests, and lines are still unanswered.
    #[error(
        "{lines} answers are missing, the first of them to line {first} or one before, though the machine rests: bytes were lost; use a shorter, shielded cable"
    )]
    LostAnswer {
        /// The first line without an answer, from 1, when answers are counted off in order.
        first: usize,
        /// How many there are.
        lines: usize,
    },
    /// An answer to nothing.
    #[error(
        "the board answered a line that was not sent: what it has carried out is not known; a line was split by a lost or added byte"
    )]
    ExtraAnswer,
    /// The tool is not where the program ends.
    #[error("the job should end at X{:.3} Y{:.3} but the board stands at X{:.3} Y{:.3}: a line was garbled on the way", expected_mm[0], expected_mm[1], found_mm[0], found_mm[1])]
    WrongPlace {
        /// Work coordinates, mm.
        expected_mm: [f64; 2],
        /// Work coordinates, mm.
        found_mm: [f64; 2],
    },
    /// The head has left the way the program should take.
    #[error(
        "the head is {off_mm:.2} mm off the way of line {line}: a line was garbled on the way to the board, and what was cut since is wrong; look at it before you go on"
    )]
    OffPlan {
        /// How far from the nearest place of the lines under way, mm.
        off_mm: f64,
        /// The line it is nearest to, from 1.
        line: usize,
    },
    /// The head nearly stands where it should cut.
    #[error(
        "the head crawls along line {line}, more than ten times as slowly as the job says: its feed was garbled on the way to the board, and what was cut since is burnt too deep; look at it before you go on"
    )]
    TooSlow {
        /// From 1.
        line: usize,
    },
    /// A byte that must not be sent.
    #[error("line {line}: {found:?} would be taken for a real-time command or garbled; take it out")]
    Unsendable {
        /// Line of the file, from 1.
        line: usize,
        /// What stands there.
        found: char,
    },
    /// More characters than the board takes.
    #[error("line {line}: {chars} characters and the board takes {limit}; split it")]
    TooLong {
        /// Line of the file, from 1.
        line: usize,
        /// Without blanks and comments.
        chars: usize,
        /// What the board takes.
        limit: usize,
    },
    /// A check has ended and not all lines were taken.
    #[error("the board refuses {refused} of the job's lines: make the job again, or correct them")]
    CheckRefused {
        /// How many it refused.
        refused: usize,
    },
    /// The board did not do with `$C` what GRBL does.
    #[error(
        "the board does not go into, stay in or leave check mode ($C) as GRBL does: it was reset, and the check says nothing"
    )]
    NoCheckMode,
    /// A panic of ours.
    #[error("the sender itself failed, which is a bug: the board was told to hold and reset")]
    Broken,
    /// The program could not be read on.
    #[error("line {line} of the job cannot be read: {reason}")]
    Unreadable {
        /// Line of the file, from 1.
        line: usize,
        /// Why.
        reason: String,
    },
}

impl Trouble {
    /// True when something else may have been cut than was planned.
    pub fn damages(&self) -> bool {
        matches!(
            self,
            Trouble::OffPlan { .. }
                | Trouble::TooSlow { .. }
                | Trouble::WrongPlace { .. }
                | Trouble::Refused { .. }
                | Trouble::ExtraAnswer
                | Trouble::LostAnswer { .. }
        )
    }
}
