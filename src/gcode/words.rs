//! What one line says, before it is carried out: its words sorted by meaning, as GRBL's parser sorts them (gcode.c, steps 1 and 2).

use super::problem::{Refusal, TraceProblem};
use super::{Line, Word};

/// How the tool moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    Rapid,
    Line,
    ArcClockwise,
    ArcCounterClockwise,
    /// G38.2 to G38.5.
    Probe,
    /// G80: axis words are then an error.
    Cancelled,
}

impl Motion {
    /// True for G1, G2 and G3.
    pub(super) fn feeds(self) -> bool {
        matches!(self, Motion::Line | Motion::ArcClockwise | Motion::ArcCounterClockwise)
    }
}

/// A command that acts once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Once {
    Dwell,
    SetOffset,
    /// To the stored place of G28 (0) or G30 (1).
    GoHome(usize),
    /// G28.1 (0) and G30.1 (1).
    SetHome(usize),
    Machine,
    Shift,
    ClearShift,
}

/// The plane arcs lie in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Plane {
    Xy,
    Zx,
    Yz,
}

/// Letters that carry a value, in the order of [`Said::values`].
const LETTERS: &[u8] = b"FIJKLNPRSTXYZ";

/// GRBL's greatest line number (MAX_LINE_NUMBER).
const MAX_LINE_NUMBER: f64 = 10_000_000.0;

/// A line's words by meaning; `None` where it says nothing.
#[derive(Debug, Default)]
pub(super) struct Said {
    pub(super) motion: Option<Motion>,
    pub(super) once: Option<Once>,
    pub(super) plane: Option<Plane>,
    pub(super) inches: Option<bool>,
    pub(super) incremental: Option<bool>,
    pub(super) inverse_time: Option<bool>,
    /// Work offset, 0 for G54.
    pub(super) offset: Option<usize>,
    /// True for G43.1, false for G49.
    pub(super) tool_length: Option<bool>,
    /// 3, 4 or 5.
    pub(super) spindle: Option<u8>,
    /// 7, 8 or 9.
    pub(super) coolant: Option<u8>,
    pub(super) pause: bool,
    pub(super) end: bool,
    values: [Option<(f64, usize)>; LETTERS.len()],
    /// One bit a modal group that has spoken.
    groups: u32,
    /// The word that wants the axes.
    axis_word: Option<usize>,
}

impl Said {
    pub(super) fn of(line: &Line) -> Result<Said, Refusal> {
        let mut said = Said::default();
        for (index, word) in line.words.iter().enumerate() {
            let read = match word.letter {
                'G' => said.g_word(word, index),
                'M' => said.m_word(word),
                _ => said.value_word(word, index),
            };
            read.map_err(|problem| Refusal { problem, word: index })?;
        }
        Ok(said)
    }

    /// The value of a letter.
    pub(super) fn value(&self, letter: u8) -> Option<f64> {
        self.values[slot(letter)?].map(|(value, _)| value)
    }

    /// True when a position is given.
    pub(super) fn has_axes(&self) -> bool {
        b"XYZ".iter().any(|letter| self.value(*letter).is_some())
    }

    /// True when the line's motion mode, given on this line or before it, uses the axis words.
    pub(super) fn moves(&self) -> bool {
        self.has_axes() && self.tool_length.is_none() && matches!(self.once, None | Some(Once::Dwell | Once::Machine))
    }

    /// The first given word among `letters`, as a word and its place on the line.
    pub(super) fn first_of(&self, letters: &[u8]) -> Option<(Word, usize)> {
        let given = letters.iter().filter_map(|letter| {
            let (value, index) = self.values[slot(*letter)?]?;
            Some((Word { letter: char::from(*letter), value }, index))
        });
        given.min_by_key(|(_, index)| *index)
    }

    /// Place on the line of the word that uses the axes, else of the first axis word, else 0.
    pub(super) fn motion_word(&self) -> usize {
        self.axis_word.or(self.first_of(b"XYZ").map(|(_, index)| index)).unwrap_or(0)
    }

    /// True for the first word of a modal group.
    fn claim(&mut self, group: u32) -> bool {
        let first = self.groups & (1 << group) == 0;
        self.groups |= 1 << group;
        first
    }

    fn g_word(&mut self, word: &Word, index: usize) -> Result<(), TraceProblem> {
        let whole = word.value.trunc();
        let hundredths = ((word.value - whole) * 100.0).round() as i64;
        let unsupported = Err(TraceProblem::Unsupported(*word));
        if !(0.0..=99.0).contains(&whole) || hundredths < 0 {
            return unsupported;
        }
        let code = whole as i64;
        let takes_axes = matches!((code, hundredths), (0..=3 | 38 | 43 | 49, _) | (10 | 28 | 30 | 92, 0));
        if takes_axes && self.axis_word.replace(index).is_some() {
            return Err(TraceProblem::AxisConflict(*word));
        }
        // Fractions that mean something of their own.
        let mut rest = hundredths;
        let group = match (code, hundredths) {
            (4 | 10 | 53, _) | (28 | 30 | 92, 0 | 10) => {
                rest = if code >= 28 && code != 53 { 0 } else { hundredths };
                self.once = Some(match (code, hundredths) {
                    (4, _) => Once::Dwell,
                    (10, _) => Once::SetOffset,
                    (53, _) => Once::Machine,
                    (92, 0) => Once::Shift,
                    (92, _) => Once::ClearShift,
                    (_, 0) => Once::GoHome(usize::from(code == 30)),
                    _ => Once::SetHome(usize::from(code == 30)),
                });
                0
            }
            (0..=3, _) | (80, _) | (38, 20 | 30 | 40 | 50) => {
                rest = if code == 38 { 0 } else { hundredths };
                self.motion = Some(match code {
                    0 => Motion::Rapid,
                    1 => Motion::Line,
                    2 => Motion::ArcClockwise,
                    3 => Motion::ArcCounterClockwise,
                    38 => Motion::Probe,
                    _ => Motion::Cancelled,
                });
                1
            }
            (17..=19, _) => {
                self.plane = Some([Plane::Xy, Plane::Zx, Plane::Yz][(code - 17) as usize]);
                2
            }
            (90 | 91, 0) => {
                self.incremental = Some(code == 91);
                3
            }
            // Arc centres from the start of the arc: all GRBL knows.
            (91, 10) => {
                rest = 0;
                4
            }
            (93 | 94, _) => {
                self.inverse_time = Some(code == 93);
                5
            }
            (20 | 21, _) => {
                self.inches = Some(code == 20);
                6
            }
            // No cutter compensation: all GRBL knows.
            (40, _) => 7,
            (43, 10) | (49, 0) => {
                rest = 0;
                self.tool_length = Some(code == 43);
                8
            }
            (54..=59, _) => {
                self.offset = Some((code - 54) as usize);
                9
            }
            // Exact path: all GRBL knows.
            (61, 0) => 10,
            _ => return unsupported,
        };
        if rest != 0 {
            return Err(TraceProblem::NotWhole(*word));
        }
        if self.claim(group) { Ok(()) } else { Err(TraceProblem::Clash(*word)) }
    }

    fn m_word(&mut self, word: &Word) -> Result<(), TraceProblem> {
        if word.value.fract() != 0.0 {
            return Err(TraceProblem::NotWhole(*word));
        }
        let group = match word.value as i64 {
            0 => {
                self.pause = true;
                11
            }
            // GRBL knows no optional stop and goes on.
            1 => 11,
            2 | 30 => {
                self.end = true;
                11
            }
            code @ 3..=5 => {
                self.spindle = Some(code as u8);
                12
            }
            code @ 7..=9 => {
                self.coolant = Some(code as u8);
                13
            }
            _ => return Err(TraceProblem::Unsupported(*word)),
        };
        if self.claim(group) { Ok(()) } else { Err(TraceProblem::Clash(*word)) }
    }

    fn value_word(&mut self, word: &Word, index: usize) -> Result<(), TraceProblem> {
        let letter = u8::try_from(word.letter).unwrap_or(b'?');
        let Some(slot) = slot(letter) else { return Err(TraceProblem::Unsupported(*word)) };
        if letter == b'T' && word.value > 255.0 {
            return Err(TraceProblem::ToolNumber(*word));
        }
        if self.values[slot].replace((word.value, index)).is_some() {
            return Err(TraceProblem::Repeated(*word));
        }
        if word.value < 0.0 && b"FNPST".contains(&letter) {
            return Err(TraceProblem::Negative(*word));
        }
        if letter == b'N' && word.value > MAX_LINE_NUMBER {
            return Err(TraceProblem::LineNumber(*word));
        }
        Ok(())
    }
}

fn slot(letter: u8) -> Option<usize> {
    LETTERS.iter().position(|l| *l == letter)
}
