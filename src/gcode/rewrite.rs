//! A program written anew from what it does: in mm and absolute, elsewhere on the bed, from somewhere in its middle on.
//!
//! Lines are read one by one through the [`Interpreter`] and written as the moves they make, so that no mode the original relied on is left to
//! chance. A program that is taken up in its middle begins with the tool off, travels to where it goes on, and says all modes before it works.

use super::interpreter::{Interpreter, Modal};
use super::parse::{ParseError, parse_line};
use super::program::{Line, Word, round3};
use super::restart::Restart;
use super::{Action, Beam, Move, TraceProblem};
use crate::geom::{P2, P3, Similarity, V3};

/// The modes a written program is in.
const MODES: &str = "G21G90G94G17G54M5S0";

/// Arcs shorter than this are written as lines, mm: with three decimals start and end may be the same, and that is a full circle.
const LEAST_ARC_MM: f64 = 0.01;

/// Why a program cannot be written anew.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RewriteError {
    /// A line is no G-code.
    #[error("{0}")]
    Parse(#[from] ParseError),
    /// A line would be refused.
    #[error("line {line}: {problem}")]
    Trace {
        /// Line of the program, from 1.
        line: usize,
        /// What is wrong.
        problem: TraceProblem,
    },
    /// Where a line leads only the machine knows.
    #[error(
        "line {line}: {word} leads where only the machine knows: such a program can be sent as it is, but not moved and not taken up in its middle"
    )]
    Elsewhere {
        /// Line of the program, from 1.
        line: usize,
        /// The word.
        word: Word,
    },
    /// The place to go on from is not in the program.
    #[error("the program has no line {line} to go on from")]
    NoSuchLine {
        /// The line that was asked for.
        line: usize,
    },
}

/// What has been written, and what it leaves in effect; `None` for not written yet.
#[derive(Debug, Default)]
struct Written {
    motion: Option<u8>,
    at: Option<P2>,
    z: Option<f64>,
    power_s: f64,
    feed: Option<f64>,
    beam: Option<Beam>,
    coolant: [bool; 2],
    /// The last dwell, s: how long a tool takes to come down.
    dwell_s: Option<f64>,
}

/// Writes a program anew, line by line.
#[derive(Debug)]
pub struct Rewriter {
    interpreter: Interpreter,
    placing: Similarity,
    laser: bool,
    from: Option<Restart>,
    /// A line with words has been read, and one has been written.
    worded: bool,
    begun: bool,
    /// It has led the head somewhere, or worked where it stands.
    led: bool,
    number: usize,
    /// It has said a height.
    uses_z: bool,
    /// The highest place the program has been at, mm: safe for travels.
    top_mm: f64,
    now: Written,
    out: Vec<String>,
}

impl Rewriter {
    /// A program for a machine whose tool burns or does not (`laser`), which starts with the head at `start_mm` of its own coordinates, each of its
    /// places moved by `placing`, from `from` on when that is not its beginning.
    pub fn new(start_mm: P3, placing: Similarity, laser: bool, from: Option<Restart>) -> Rewriter {
        let interpreter = Interpreter::new(start_mm, [V3::zeros(); 6], [P3::origin(); 2]);
        Rewriter {
            interpreter,
            placing,
            laser,
            from,
            worded: false,
            begun: false,
            led: false,
            number: 0,
            uses_z: false,
            top_mm: start_mm.z,
            now: Written::default(),
            out: Vec::new(),
        }
    }

    /// The lines that stand for the next line of the program.
    ///
    /// # Errors
    /// It cannot be carried out, or leads where only the machine knows.
    pub fn line(&mut self, text: &str) -> Result<Vec<String>, RewriteError> {
        self.number += 1;
        let number = self.number;
        let line = parse_line(text, number)?;
        if line.words.is_empty() {
            // The head says what the program is; remarks in a part that is left out say nothing any more.
            let kept = line.comment.filter(|_| !self.worded || self.from.is_none());
            return Ok(kept.map(|comment| format!("; {comment}")).into_iter().collect());
        }
        self.worded = true;
        self.uses_z |= line.value('Z').is_some();
        if let Some(word) = line.leads_elsewhere().or_else(|| machine_word(&line)) {
            return Err(RewriteError::Elsewhere { line: number, word });
        }
        let before = (self.interpreter.position(), self.interpreter.modal());
        let moves = self.interpreter.line(&line).map_err(|problem| RewriteError::Trace { line: number, problem })?;
        self.top_mm = moves.iter().map(|m| m.to.z).fold(self.top_mm, f64::max);
        match self.from {
            Some(from) if number < from.line => {}
            Some(from) => {
                self.from = None;
                self.take_up(from, before, &line, moves);
            }
            None => {
                if !std::mem::replace(&mut self.begun, true) {
                    self.say_modes();
                }
                self.write(&line, &moves);
            }
        }
        Ok(std::mem::take(&mut self.out))
    }

    /// The end of the program.
    ///
    /// # Errors
    /// It ended before the place to go on from.
    pub fn finish(&self) -> Result<(), RewriteError> {
        self.from.map_or(Ok(()), |from| Err(RewriteError::NoSuchLine { line: from.line }))
    }

    fn say_modes(&mut self) {
        self.out.push(MODES.to_owned());
        self.now.beam = Some(Beam::Off);
    }

    /// From a place within a line on: there with the tool off, then the rest of the line.
    fn take_up(&mut self, from: Restart, (position, before): (P3, Modal), line: &Line, moves: Vec<Move>) {
        self.begun = true;
        self.say_modes();
        let (place, rest) = rest_of(position, moves, from.along_mm);
        if !self.laser {
            // A tool that is lifted by what else would be the power must be up while it travels.
            self.switch(&before);
        }
        if self.uses_z {
            // Wherever a stop has left it: up first, then there, then down to where it goes on.
            self.rise(self.top_mm);
            self.go(0, P3::new(place.x, place.y, self.top_mm), &[], None, None);
        }
        self.led = true;
        self.go(0, place, &[], None, None);
        self.write(line, &rest);
    }

    fn write(&mut self, line: &Line, moves: &[Move]) {
        let modal = self.interpreter.modal();
        let dwell_s = self.lead_in(moves);
        self.switch(&modal);
        if let Some(seconds) = dwell_s {
            self.say(&[('G', 4.0), ('P', seconds)]);
        }
        for m in moves {
            match m.action {
                Action::Stop => {}
                Action::Dwell { seconds } => {
                    if m.beam == Beam::Constant && m.feeding && self.now.power_s != round3(m.power_s) {
                        self.say(&[('S', m.power_s)]);
                        self.now.power_s = round3(m.power_s);
                    }
                    self.say(&[('G', 4.0), ('P', seconds)]);
                    self.now.dwell_s = Some(seconds);
                }
                // Laser mode keeps the beam off in travels; not every firmware does.
                Action::Rapid => self.go(0, m.to, &[], Some(0.0), None),
                Action::Line => self.go(1, m.to, &[], Some(m.power_s), Some(m.feed_mm_per_min)),
                Action::Arc { center, sweep_rad, .. } => self.arc(m, center, sweep_rad),
            }
        }
        let says = |codes: &[f64]| line.words.iter().any(|w| w.letter == 'M' && codes.contains(&w.value));
        if says(&[0.0]) {
            self.say(&[('M', 0.0)]);
        }
        if says(&[2.0, 30.0]) {
            self.say(&[('M', 2.0)]);
            // Which puts the tool off, and the motion to G1.
            (self.now.beam, self.now.coolant, self.now.motion) = (Some(Beam::Off), [false; 2], None);
        }
    }

    /// Leads the head to where a program begins that would work before it travels: from wherever it stands, that would be a line of its own. A tool
    /// that was put down there is put off for it; how long it then takes to come down, s.
    fn lead_in(&mut self, moves: &[Move]) -> Option<f64> {
        let lit =
            |m: &Move| m.beam == Beam::Constant && m.feeding && m.power_s > 0.0 && !matches!(m.action, Action::Stop);
        let first = moves.iter().find(|m| m.goes() || lit(m))?;
        if std::mem::replace(&mut self.led, true) {
            return None;
        }
        if first.action == Action::Rapid {
            if self.uses_z && first.to.z >= first.from.z {
                // Not aslant: the tool may be down.
                self.rise(first.to.z);
            }
            return None;
        }
        let down = !self.laser && self.now.beam.is_some_and(|beam| beam != Beam::Off);
        if down {
            self.say(&[('M', 5.0), ('S', 0.0)]);
            (self.now.beam, self.now.power_s) = (Some(Beam::Off), 0.0);
        }
        self.now.z = Some(round3(first.from.z));
        self.go(0, first.from, &[], Some(0.0), None);
        self.now.dwell_s.filter(|_| down)
    }

    fn rise(&mut self, z: f64) {
        self.say(&[('G', 0.0), ('Z', z)]);
        (self.now.motion, self.now.z) = (Some(0), Some(round3(z)));
    }

    /// The tool and the air as they are to be. A laser gets its power with the moves.
    fn switch(&mut self, modal: &Modal) {
        let power_s = if self.laser || modal.beam == Beam::Off { 0.0 } else { round3(modal.power_s) };
        let same_power = self.laser || modal.beam == Beam::Off || self.now.power_s == power_s;
        if self.now.beam.replace(modal.beam) != Some(modal.beam) || !same_power {
            let code = match modal.beam {
                Beam::Off => 5.0,
                Beam::Constant => 3.0,
                Beam::Dynamic => 4.0,
            };
            self.say(&[('M', code), ('S', power_s)]);
            self.now.power_s = power_s;
        }
        let wanted = modal.coolant;
        let before = std::mem::replace(&mut self.now.coolant, wanted);
        if before.iter().zip(wanted).any(|(before, wanted)| *before && !wanted) {
            self.say(&[('M', 9.0)]);
        }
        for (on, code) in wanted.into_iter().zip([7.0, 8.0]) {
            if on && before != wanted {
                self.say(&[('M', code)]);
            }
        }
    }

    fn arc(&mut self, m: &Move, center: P2, sweep_rad: f64) {
        let radius_mm = (self.placing * m.to.xy() - self.placing * center).norm();
        let start = self.now.at.unwrap_or_else(|| self.placing * m.from.xy());
        let end = rounded(self.placing * m.to.xy());
        let closes = start == end && sweep_rad.abs() < std::f64::consts::PI;
        let (power, feed) = (Some(m.power_s), Some(m.feed_mm_per_min));
        if radius_mm * sweep_rad.abs() < LEAST_ARC_MM || closes {
            return self.go(1, m.to, &[], power, feed);
        }
        let offset = self.placing * center - start;
        let code = if sweep_rad < 0.0 { 2 } else { 3 };
        self.go(code, m.to, &[('I', offset.x), ('J', offset.y)], power, feed);
    }

    /// A motion, with the words that change; one that goes nowhere is none.
    fn go(&mut self, code: u8, to: P3, centre: &[(char, f64)], power_s: Option<f64>, feed: Option<f64>) {
        let place = rounded(self.placing * to.xy());
        let (before, z) = (self.now.at.replace(place), round3(to.z));
        let mut words = Vec::with_capacity(8);
        if self.now.motion != Some(code) {
            words.push(('G', f64::from(code)));
        }
        let is_arc = !centre.is_empty();
        let axes = words.len();
        if is_arc || before.is_none_or(|before| before.x != place.x) {
            words.push(('X', place.x));
        }
        if is_arc || before.is_none_or(|before| before.y != place.y) {
            words.push(('Y', place.y));
        }
        if self.uses_z && self.now.z != Some(z) {
            words.push(('Z', z));
        }
        if words.len() == axes {
            return;
        }
        (self.now.motion, self.now.z) = (Some(code), Some(z));
        words.extend(centre);
        if let Some(power_s) = power_s.map(round3).filter(|power_s| self.laser && self.now.power_s != *power_s) {
            words.push(('S', power_s));
            self.now.power_s = power_s;
        }
        if let Some(feed) = feed.map(round3).filter(|feed| self.now.feed != Some(*feed)) {
            words.push(('F', feed));
            self.now.feed = Some(feed);
        }
        self.say(&words);
    }

    fn say(&mut self, words: &[(char, f64)]) {
        let line = Line::of(words.iter().map(|(letter, value)| Word::new(*letter, *value)));
        self.out.push(line.to_string());
    }
}

fn rounded(p: P2) -> P2 {
    P2::new(round3(p.x), round3(p.y))
}

/// G53: places of the machine, which are not moved along.
fn machine_word(line: &Line) -> Option<Word> {
    line.words.iter().copied().find(|word| word.letter == 'G' && word.value == 53.0)
}

/// Where a line is taken up, and the moves from there on.
fn rest_of(position: P3, moves: Vec<Move>, along_mm: f64) -> (P3, Vec<Move>) {
    let (mut left_mm, mut place, mut rest) = (along_mm, position, Vec::new());
    for mut m in moves {
        let length_mm = m.length_mm();
        if left_mm > 0.0 && m.goes() {
            if left_mm >= length_mm {
                left_mm -= length_mm;
                place = m.to;
                continue;
            }
            let t = left_mm / length_mm;
            m.from = m.point_at(t);
            if let Action::Arc { sweep_rad, .. } = &mut m.action {
                *sweep_rad *= 1.0 - t;
            }
            (place, left_mm) = (m.from, 0.0);
        }
        rest.push(m);
    }
    (place, rest)
}

#[cfg(test)]
#[path = "rewrite_tests.rs"]
mod tests;
