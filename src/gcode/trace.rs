//! What a program does: the only interpreter of G-code in the house.
//!
//! Follows GRBL 1.1's gcode.c in laser mode ($32 = 1): modal state, which lines it refuses, the order in which a line's words act, and which
//! words make the machine come to rest. Positions are work coordinates of G54 as they are when the program starts, in mm; the tool starts at
//! the origin. Where machine zero and the stored places of G28, G30 and G55 to G59 lie only the machine knows: they are taken to lie at the origin.

use super::arc_words::{arc, chords};
use super::parse::column_of_word;
use super::problem::{Refusal, TraceError, TraceProblem};
use super::words::{Motion, Once, Plane, Said};
use super::{Action, Beam, Line, Move, Program, Word};
use crate::geom::{P3, V3};

/// Carries a program out.
///
/// # Errors
/// The first line that GRBL would refuse.
pub fn trace(program: &Program) -> Result<Vec<Move>, TraceError> {
    let mut tracer = Tracer::new();
    let mut moves = Vec::new();
    for (i, line) in program.lines.iter().enumerate() {
        let written = line.to_string();
        tracer.line(line, i + 1, sent_bytes(&written), &mut moves).map_err(|refusal| TraceError {
            line: i + 1,
            column: column_of_word(&written, refusal.word),
            problem: refusal.problem,
        })?;
    }
    Ok(moves)
}

/// Bytes of a line as a sender sends it: without blanks and comments, with its line feed; 0 for a line that is not sent.
pub(super) fn sent_bytes(text: &str) -> usize {
    let mut hidden = false;
    let mut sent = 0;
    for b in text.bytes() {
        // Within parentheses a semicolon begins nothing.
        if b == b';' && !hidden {
            break;
        }
        let comment = hidden || b == b'(';
        hidden = comment && b != b')';
        sent += usize::from(!comment && !b.is_ascii_whitespace());
    }
    if sent == 0 { 0 } else { sent + 1 }
}

/// The state of the machine between lines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tracer {
    line: usize,
    bytes: usize,
    pub(super) position: P3,
    pub(super) motion: Motion,
    pub(super) plane: Plane,
    pub(super) inches: bool,
    pub(super) incremental: bool,
    pub(super) inverse_time: bool,
    /// Origins of G54 to G59.
    pub(super) offsets: [V3; 6],
    /// The stored places of G28 and G30.
    pub(super) homes: [P3; 2],
    pub(super) offset: usize,
    /// G92.
    pub(super) shift: V3,
    pub(super) tool_length_mm: f64,
    pub(super) feed_mm_per_min: f64,
    pub(super) power_s: f64,
    pub(super) beam: Beam,
    /// Mist (M7) and flood (M8).
    pub(super) coolant: [bool; 2],
}

impl Tracer {
    /// GRBL as it starts.
    pub(super) fn new() -> Tracer {
        Tracer {
            line: 0,
            bytes: 0,
            position: P3::origin(),
            motion: Motion::Rapid,
            plane: Plane::Xy,
            inches: false,
            incremental: false,
            inverse_time: false,
            offsets: [V3::zeros(); 6],
            homes: [P3::origin(); 2],
            offset: 0,
            shift: V3::zeros(),
            tool_length_mm: 0.0,
            feed_mm_per_min: 0.0,
            power_s: 0.0,
            beam: Beam::Off,
            coolant: [false; 2],
        }
    }

    /// GRBL as it starts at a position with these origins of G54 to G59 and these places of G28 and G30.
    pub(super) fn at(position: P3, offsets: [V3; 6], homes: [P3; 2]) -> Tracer {
        Tracer { position, offsets, homes, ..Tracer::new() }
    }

    /// Carries one line out, appending what it makes the machine do. A refused line changes nothing, as on GRBL.
    pub(super) fn line(
        &mut self,
        line: &Line,
        number: usize,
        bytes: usize,
        moves: &mut Vec<Move>,
    ) -> Result<(), Refusal> {
        let said = Said::of(line)?;
        let (before, kept) = (*self, moves.len());
        (self.line, self.bytes) = (number, bytes);
        self.obey(&said, moves).inspect_err(|_| {
            *self = before;
            moves.truncate(kept);
        })
    }

    /// Laser mode and S word in effect.
    pub(super) fn beam_left(&self) -> (Beam, f64) {
        (self.beam, self.power_s)
    }

    fn obey(&mut self, said: &Said, moves: &mut Vec<Move>) -> Result<(), Refusal> {
        self.inches = said.inches.unwrap_or(self.inches);
        let unit_mm = if self.inches { 25.4 } else { 1.0 };
        let motion = said.motion.unwrap_or(self.motion);
        self.inverse_time = said.inverse_time.unwrap_or(self.inverse_time);
        match said.value(b'F') {
            Some(f) if self.inverse_time => self.feed_mm_per_min = f,
            Some(f) => self.feed_mm_per_min = f * unit_mm,
            // G93 wants a new time with every move.
            None if self.inverse_time || said.inverse_time.is_some() => self.feed_mm_per_min = 0.0,
            None => {}
        }
        self.light(said, motion, moves);
        self.switch_coolant(said.coolant, moves);
        if said.once == Some(Once::Dwell) {
            let seconds = said.value(b'P').ok_or_else(|| missing(said, 'G', 4.0, "P, the seconds"))?;
            self.stand(Action::Dwell { seconds }, moves);
        }
        self.plane = said.plane.unwrap_or(self.plane);
        self.place(said, unit_mm, moves)?;
        self.incremental = said.incremental.unwrap_or(self.incremental);
        if said.moves() || said.motion.is_some() {
            self.motion = motion;
            self.go(said, unit_mm, moves)?;
        }
        refuse_unused(said, self.motion)?;
        if said.pause || said.end {
            self.stand(Action::Stop, moves);
        }
        if said.end {
            let Tracer { position, shift, offsets, homes, inches, feed_mm_per_min, power_s, tool_length_mm, .. } =
                *self;
            let reset = Tracer { motion: Motion::Line, ..Tracer::new() };
            *self =
                Tracer { position, shift, offsets, homes, inches, feed_mm_per_min, power_s, tool_length_mm, ..reset };
        }
        Ok(())
    }

    /// S, M3, M4 and M5 (gcode.c, GC_PARSER_LASER_ISMOTION and GC_PARSER_LASER_FORCE_SYNC).
    fn light(&mut self, said: &Said, motion: Motion, moves: &mut Vec<Move>) {
        // A new power in a motion changes on the fly; without motion the machine stops for it. A constant beam is also switched at rest when
        // the motion mode goes from travel to feed or back without a motion.
        let in_motion = said.moves();
        let power_s = said.value(b'S').unwrap_or(self.power_s);
        let changed = std::mem::replace(&mut self.power_s, power_s) != power_s;
        let mode_changed = self.beam == Beam::Constant && motion.feeds() != self.motion.feeds();
        if !in_motion && self.beam != Beam::Off && (changed || mode_changed) {
            self.stand(Action::Stop, moves);
        }
        let beam = match said.spindle {
            None => self.beam,
            Some(3) => Beam::Constant,
            Some(4) => Beam::Dynamic,
            Some(_) => Beam::Off,
        };
        if std::mem::replace(&mut self.beam, beam) != beam {
            self.stand(Action::Stop, moves);
        }
    }

    fn switch_coolant(&mut self, word: Option<u8>, moves: &mut Vec<Move>) {
        let before = self.coolant;
        match word {
            Some(7) => self.coolant[0] = true,
            Some(8) => self.coolant[1] = true,
            Some(_) => self.coolant = [false; 2],
            None => {}
        }
        if self.coolant != before {
            self.stand(Action::Stop, moves);
        }
    }

    /// Where the program's zero lies, at rest for every change of it; and G28 and G30.
    fn place(&mut self, said: &Said, unit_mm: f64, moves: &mut Vec<Move>) -> Result<(), Refusal> {
        let word = |code: f64| (Word { letter: 'G', value: code }, said.motion_word());
        if let Some(on) = said.tool_length {
            let z = said.value(b'Z');
            if on && (z.is_none() || said.first_of(b"XY").is_some()) {
                return Err(Refusal { problem: TraceProblem::ToolLengthAxis, word: said.motion_word() });
            }
            // G49 clears the length; a Z beside it says nothing.
            let length_mm = z.filter(|_| on).map_or(0.0, |z| z * unit_mm);
            if std::mem::replace(&mut self.tool_length_mm, length_mm) != length_mm {
                self.stand(Action::Stop, moves);
            }
        }
        let offset = said.offset.unwrap_or(self.offset);
        if std::mem::replace(&mut self.offset, offset) != offset {
            self.stand(Action::Stop, moves);
        }
        let needs_axes = |code: f64| match said.has_axes() {
            true => Ok(()),
            false => Err(Refusal { problem: TraceProblem::NoAxes(word(code).0), word: word(code).1 }),
        };
        let given = [b'X', b'Y', b'Z'].map(|letter| said.value(letter).map(|v| v * unit_mm));
        match said.once {
            Some(Once::SetOffset) => {
                needs_axes(10.0)?;
                self.set_offset(said, given)?;
                self.stand(Action::Stop, moves);
            }
            Some(Once::Shift) => {
                needs_axes(92.0)?;
                for (axis, value) in given.into_iter().enumerate() {
                    if let Some(value) = value {
                        self.shift[axis] += self.position[axis] - self.origin()[axis] - value;
                    }
                }
                self.stand(Action::Stop, moves);
            }
            Some(Once::ClearShift) => {
                self.shift = V3::zeros();
                self.stand(Action::Stop, moves);
            }
            Some(Once::SetHome(which)) => {
                self.homes[which] = self.position;
                self.stand(Action::Stop, moves);
            }
            Some(Once::GoHome(which)) => {
                let incremental = said.incremental.unwrap_or(self.incremental);
                self.travel(self.target(given, incremental), moves);
                let mut home = self.position;
                for (axis, value) in given.iter().enumerate() {
                    if value.is_some() || !said.has_axes() {
                        home[axis] = self.homes[which][axis];
                    }
                }
                self.travel(home, moves);
            }
            Some(Once::Dwell | Once::Machine) | None => {}
        }
        Ok(())
    }

    /// G10 L2 and L20.
    fn set_offset(&mut self, said: &Said, given: [Option<f64>; 3]) -> Result<(), Refusal> {
        let (Some(l), Some(p)) = (said.value(b'L'), said.value(b'P')) else {
            return Err(missing(said, 'G', 10.0, "L and P"));
        };
        let at = |letter: u8| said.first_of(&[letter]).unwrap_or((Word { letter: char::from(letter), value: 0.0 }, 0));
        let refuse = |problem: fn(Word) -> TraceProblem, letter| {
            let (named, word) = at(letter);
            Err(Refusal { problem: problem(named), word })
        };
        if p.trunc() > 6.0 {
            return refuse(TraceProblem::NoSuchOffset, b'P');
        }
        if l != 2.0 && l != 20.0 {
            return refuse(TraceProblem::Unsupported, b'L');
        }
        if l == 2.0 && said.value(b'R').is_some() {
            return refuse(TraceProblem::Unsupported, b'R');
        }
        let index = if p < 1.0 { self.offset } else { p as usize - 1 };
        for (axis, value) in given.into_iter().enumerate() {
            let Some(value) = value else { continue };
            let length_mm = if axis == 2 { self.tool_length_mm } else { 0.0 };
            self.offsets[index][axis] =
                if l == 2.0 { value } else { self.position[axis] - self.shift[axis] - length_mm - value };
        }
        Ok(())
    }

    /// Where the program's zero lies.
    pub(super) fn origin(&self) -> V3 {
        self.offsets[self.offset] + self.shift + V3::new(0.0, 0.0, self.tool_length_mm)
    }

    fn target(&self, given: [Option<f64>; 3], incremental: bool) -> P3 {
        let origin = self.origin();
        let axis = |k: usize| match given[k] {
            Some(v) if incremental => self.position[k] + v,
            Some(v) => origin[k] + v,
            None => self.position[k],
        };
        P3::new(axis(0), axis(1), axis(2))
    }

    fn travel(&mut self, to: P3, moves: &mut Vec<Move>) {
        let from = std::mem::replace(&mut self.position, to);
        if from != to {
            self.push(Action::Rapid, from, to, moves);
        }
    }

    fn go(&mut self, said: &Said, unit_mm: f64, moves: &mut Vec<Move>) -> Result<(), Refusal> {
        let refuse = |problem| Err(Refusal { problem, word: said.motion_word() });
        let given = [b'X', b'Y', b'Z'].map(|letter| said.value(letter).map(|v| v * unit_mm));
        let moving = said.moves();
        let in_machine = said.once == Some(Once::Machine);
        if in_machine && !matches!(self.motion, Motion::Rapid | Motion::Line) {
            return refuse(TraceProblem::MachineArc);
        }
        if self.motion == Motion::Cancelled {
            return if moving { refuse(TraceProblem::NoMotion) } else { Ok(()) };
        }
        // GRBL asks for the feed as soon as a feed mode is named.
        let uses_motion = moving || said.once.is_none() && said.tool_length.is_none();
        if self.motion != Motion::Rapid && uses_motion && self.feed_mm_per_min == 0.0 {
            return refuse(TraceProblem::NoFeed);
        }
        let from = self.position;
        let mut to = self.target(given, self.incremental);
        if in_machine {
            for axis in 0..3 {
                to[axis] = given[axis].unwrap_or(from[axis]);
            }
        }
        let action = match self.motion {
            Motion::Rapid | Motion::Line if !moving => return Ok(()),
            Motion::Rapid => Action::Rapid,
            Motion::Line => Action::Line,
            Motion::ArcClockwise | Motion::ArcCounterClockwise if !uses_motion => return Ok(()),
            Motion::ArcClockwise | Motion::ArcCounterClockwise => {
                let clockwise = self.motion == Motion::ArcClockwise;
                let turn = arc(said, self.plane, from, to, unit_mm, clockwise)
                    .map_err(|problem| Refusal { problem, word: said.motion_word() })?;
                self.position = to;
                match self.plane {
                    Plane::Xy => self.push(turn, from, to, moves),
                    plane => {
                        let mut at = from;
                        for next in chords(turn, plane, from, to) {
                            self.push(Action::Line, at, next, moves);
                            at = next;
                        }
                    }
                }
                return Ok(());
            }
            Motion::Probe | Motion::Cancelled if !moving => {
                return refuse(TraceProblem::NoAxes(Word { letter: 'G', value: 38.2 }));
            }
            Motion::Probe | Motion::Cancelled if from == to => return refuse(TraceProblem::SamePlace),
            // The laser is off while it probes.
            Motion::Probe | Motion::Cancelled => Action::Rapid,
        };
        self.position = to;
        self.push(action, from, to, moves);
        Ok(())
    }

    fn stand(&mut self, action: Action, moves: &mut Vec<Move>) {
        self.push(action, self.position, self.position, moves);
    }

    fn push(&mut self, action: Action, from: P3, to: P3, moves: &mut Vec<Move>) {
        let Tracer { line, bytes, feed_mm_per_min, power_s, beam, .. } = *self;
        let feeding = self.motion.feeds();
        let mut made = Move { line, action, from, to, feed_mm_per_min, power_s, beam, feeding, bytes };
        if self.inverse_time && matches!(action, Action::Line | Action::Arc { .. }) {
            // G93: F is one over the minutes the move takes.
            made.feed_mm_per_min *= made.length_mm();
        }
        moves.push(made);
    }
}

fn missing(said: &Said, letter: char, value: f64, what: &'static str) -> Refusal {
    Refusal { problem: TraceProblem::MissingValue(Word { letter, value }, what), word: said.motion_word() }
}

/// Words that no command of the line takes (gcode.c, step 3, end).
fn refuse_unused(said: &Said, motion: Motion) -> Result<(), Refusal> {
    let is_arc = matches!(motion, Motion::ArcClockwise | Motion::ArcCounterClockwise) && said.moves();
    let mut unused: Vec<u8> = Vec::new();
    if !is_arc {
        unused.extend(b"IJKR");
    }
    if said.once != Some(Once::SetOffset) {
        unused.push(b'L');
        if said.once != Some(Once::Dwell) {
            unused.push(b'P');
        }
    }
    if !said.moves()
        && !matches!(said.once, Some(Once::SetOffset | Once::Shift | Once::GoHome(_)))
        && said.tool_length.is_none()
    {
        unused.extend(b"XYZ");
    }
    match said.first_of(&unused) {
        Some((word, index)) => Err(Refusal { problem: TraceProblem::Unused(word), word: index }),
        None => Ok(()),
    }
}

#[cfg(test)]
#[path = "trace_tests.rs"]
mod tests;
