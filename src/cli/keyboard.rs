//! Whoever sits at the terminal: answers to questions, and words typed while the machine runs.

use std::io::BufRead;
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::time::Duration;

use super::Failure;
use super::connection::machine_failure;
use super::talk::{OnInterrupt, Talk};
use crate::stream::{Command, Event, Override, Trouble};

/// How often the keyboard is looked at while somebody is asked.
const KEY_WAIT: Duration = Duration::from_millis(50);

/// Lines typed, read on a thread of their own, which nothing but the end of the program ends.
pub(super) struct Keyboard {
    lines: Receiver<String>,
}

/// What a line typed while the machine runs asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Word {
    /// Brake and hold.
    Hold,
    /// Go on.
    Resume,
    /// End the job.
    Stop,
    /// Scale feeds by so many % more or less.
    FeedBy(i32),
    /// Scale feeds to so many %.
    FeedTo(u16),
}

/// What may be typed, for people.
pub(super) const WORDS: &str = "type hold, resume, stop, or the feed in %: 80, +10, -10; then Enter";

impl Keyboard {
    /// Begins to listen.
    pub(super) fn open() -> Keyboard {
        let (typing, lines) = mpsc::channel();
        std::thread::spawn(move || {
            for line in std::io::stdin().lock().lines() {
                let Ok(line) = line else { return };
                if typing.send(line).is_err() {
                    return;
                }
            }
        });
        Keyboard { lines }
    }

    /// A line that has been typed.
    ///
    /// # Errors
    /// Nothing will be typed any more.
    pub(super) fn line(&self) -> Result<Option<String>, Failure> {
        match self.lines.try_recv() {
            Ok(line) => Ok(Some(line)),
            Err(TryRecvError::Empty) => Ok(None),
            Err(TryRecvError::Disconnected) => Err(Failure::config("nobody is there any more to answer")),
        }
    }

    /// Puts a question and waits for a line, with the machine at rest; what was typed before does not count, an answer at the very moment it can be read
    /// does. `None` when the user has stopped it instead.
    ///
    /// # Errors
    /// Nobody is there, or the board fails meanwhile.
    pub(super) fn answer(&self, talk: &mut Talk, put: impl FnOnce()) -> Result<Option<String>, Failure> {
        self.forget();
        put();
        while idle(talk, KEY_WAIT)? {
            if let Some(line) = self.line()? {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    /// Forgets what was typed before a question was asked: an Enter too many must not start a machine.
    pub(super) fn forget(&self) {
        while self.lines.try_recv().is_ok() {}
    }
}

/// Lets time pass with the machine at rest. False when the user has stopped it.
///
/// # Errors
/// The board fails.
pub(super) fn idle(talk: &mut Talk, wait: Duration) -> Result<bool, Failure> {
    talk.on_interrupt(OnInterrupt::Heed);
    match talk.next(wait) {
        Some(Event::Trouble(trouble)) => Err(machine_failure(trouble)),
        Some(Event::Restarted) => Err(machine_failure(Trouble::Restarted)),
        Some(_) | None => Ok(!talk.interrupted()),
    }
}

impl Word {
    /// Reads a line; `None` for one that asks for nothing known.
    pub(super) fn parse(line: &str) -> Option<Word> {
        let line = line.trim().trim_end_matches('%').trim_end();
        Some(match line.to_ascii_lowercase().as_str() {
            "hold" | "h" => Word::Hold,
            "resume" | "r" => Word::Resume,
            "stop" => Word::Stop,
            number if number.starts_with(['+', '-']) => Word::FeedBy(number.parse().ok()?),
            number => Word::FeedTo(number.parse().ok()?),
        })
    }

    /// What it means to the session, where the feed was last asked to be `feed_percent`.
    pub(super) fn command(self, feed_percent: &mut u16) -> Command {
        match self {
            Word::Hold => Command::Hold,
            Word::Resume => Command::Resume,
            Word::Stop => Command::Stop,
            Word::FeedBy(by) => {
                Word::FeedTo((i32::from(*feed_percent) + by.clamp(-200, 200)).max(0) as u16).command(feed_percent)
            }
            Word::FeedTo(percent) => {
                *feed_percent = Override::Feed.nearest(percent);
                Command::Override(Override::Feed, *feed_percent)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_percentages_are_told_apart() {
        let cases = [
            ("hold", Some(Word::Hold)),
            (" R ", Some(Word::Resume)),
            ("stop", Some(Word::Stop)),
            ("+10", Some(Word::FeedBy(10))),
            ("-5 %", Some(Word::FeedBy(-5))),
            ("80%", Some(Word::FeedTo(80))),
            ("", None),
            ("faster", None),
            ("+", None),
        ];
        for (line, word) in cases {
            assert_eq!(Word::parse(line), word, "{line:?}");
        }
    }

    #[test]
    fn the_feed_stays_within_what_boards_take() {
        let mut percent = 100;
        for (word, expected) in [
            (Word::FeedBy(10), 110),
            (Word::FeedBy(i32::MAX), 200),
            (Word::FeedTo(15), 15),
            (Word::FeedBy(-50), 10),
            (Word::FeedTo(u16::MAX), 200),
        ] {
            assert!(matches!(word.command(&mut percent), Command::Override(Override::Feed, p) if p == expected));
            assert_eq!(percent, expected);
        }
    }
}
