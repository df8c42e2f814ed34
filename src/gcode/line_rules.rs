//! Objections to lines as they are written: too long, system commands, words that wear the EEPROM, modes that are only assumed.

use super::check::{CheckSettings, Notes};
use super::parse::column_of_word;
use super::{Line, Move};

/// GRBL takes lines of fewer than 80 characters, blanks and comments not counted (error 11).
const MAX_LINE: usize = 79;

/// What has been said so far.
#[derive(Debug, Default)]
pub(super) struct LineRules {
    units_said: bool,
    distance_said: bool,
    moved: bool,
    place_told: bool,
}

impl LineRules {
    /// Looks at a line before it is parsed, and tells whether it is G-code to read on; `bytes` as a sender sends it, with its line feed.
    pub(super) fn text(&mut self, line: usize, text: &str, bytes: usize, notes: &mut Notes) -> bool {
        if bytes > MAX_LINE + 1 {
            notes.errors.add(line, 1, "error:11", || {
                format!("the line has {} characters and GRBL takes {MAX_LINE} (GRBL error:11); split it", bytes - 1)
            });
            return false;
        }
        let Some(command) = text.trim_start().strip_prefix('$') else { return true };
        let command = command.trim().to_ascii_uppercase();
        let column = text.find('$').unwrap_or(0) + 1;
        if command.contains('=') && !command.starts_with("J=") || command.starts_with("RST") {
            notes.errors.add(line, column, "eeprom-write", || {
                format!("${command} changes the machine's settings for good and loses bytes sent behind it; set it by hand, not in a job")
            });
        } else if matches!(command.as_str(), "H" | "X" | "C" | "SLP" | "" | "$" | "#" | "G" | "I" | "N") {
            notes.warnings.add(line, column, "system-command", || {
                format!("${command} is no G-code: it is answered only while the machine rests; let the sender do it")
            });
        } else {
            notes.errors.add(line, column, "error:3", || {
                format!("${command} is no command a job can give (GRBL error:3); take it out")
            });
        }
        false
    }

    /// True when the machine takes a line's words; M7 is in GRBL only when built with it, and without it the whole line does nothing.
    pub(super) fn takes(line: usize, text: &str, words: &Line, settings: &CheckSettings, notes: &mut Notes) -> bool {
        let mist = words.words.iter().position(|word| word.letter == 'M' && word.value == 7.0);
        let Some(index) = mist.filter(|_| !settings.mist) else { return true };
        notes.errors.add(line, column_of_word(text, index), "error:20", || {
            "M7 is refused by GRBL unless it was built with it (GRBL error:20), and its line does nothing; use M8"
                .into()
        });
        false
    }

    /// Looks at the words of a line that is carried out, and at what they make the machine do.
    pub(super) fn words(&mut self, line: usize, text: &str, words: &Line, moves: &[Move], notes: &mut Notes) {
        for (index, word) in words.words.iter().enumerate() {
            let column = || column_of_word(text, index);
            match (word.letter, word.value) {
                ('G', 20.0 | 21.0) => self.units_said = true,
                ('G', 90.0 | 91.0) => self.distance_said = true,
                ('G', 10.0 | 28.1 | 30.1) => notes.errors.add(line, column(), "eeprom-write", || {
                    format!("{word} writes the machine's memory: bytes sent behind it are lost, and the change outlasts the job; use G92, or set it by hand")
                }),
                ('G', 28.0 | 30.0 | 53.0 | 55.0..=59.0) if !self.place_told => {
                    self.place_told = true;
                    notes.warnings.add(line, column(), "place-unknown", || {
                        format!("{word} goes by places stored in the machine, which are not known here: what follows is checked as if they lay at X0 Y0")
                    });
                }
                _ => {}
            }
        }
        if !self.moved && moves.iter().any(Move::goes) {
            self.moved = true;
            if !self.units_said {
                notes.warnings.add(line, 1, "no-units", || {
                    "the first move comes before G21 or G20: taken as mm, but a machine left in inches would go 25.4 times as far; write G21 first".into()
                });
            }
            if !self.distance_said {
                notes.warnings.add(line, 1, "no-distance-mode", || {
                    "the first move comes before G90 or G91: taken as absolute; write G90 first".into()
                });
            }
        }
    }
}
