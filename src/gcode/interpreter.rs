//! The interpreter a line at a time, for who plays the controller: modal state, work offsets and position can be read and set.

use super::trace::{Tracer, sent_bytes};
use super::words::{Motion, Plane};
use super::{Beam, Line, Move, TraceProblem};
use crate::geom::{P3, V3};

/// [`super::trace`] one line at a time, in whatever frame its position and offsets are given.
#[derive(Debug, Clone)]
pub struct Interpreter {
    tracer: Tracer,
    tool: f64,
}

/// What stays in effect between lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modal {
    /// Motion mode as `$G` names it: `G0`, `G1`, `G2`, `G3`, `G38.2` or `G80`.
    pub motion: &'static str,
    /// True for G1, G2 and G3.
    pub feeds: bool,
    /// Arc plane: 17, 18 or 19.
    pub plane: u8,
    /// G20.
    pub inches: bool,
    /// G91.
    pub incremental: bool,
    /// G93.
    pub inverse_time: bool,
    /// Work offset, 0 for G54.
    pub offset: usize,
    /// M3, M4 or M5.
    pub beam: Beam,
    /// M7 and M8.
    pub coolant: [bool; 2],
    /// T word of the last line, 0 without one: GRBL keeps it no longer.
    pub tool: f64,
    /// Feed, mm/min.
    pub feed_mm_per_min: f64,
    /// S word.
    pub power_s: f64,
}

impl Interpreter {
    /// GRBL as it starts, standing at `position_mm` with its stored origins of G54 to G59 and its stored places of G28 and G30, all in machine
    /// coordinates, mm.
    pub fn new(position_mm: P3, offsets_mm: [V3; 6], homes_mm: [P3; 2]) -> Interpreter {
        Interpreter { tracer: Tracer::at(position_mm, offsets_mm, homes_mm), tool: 0.0 }
    }

    /// Carries a line out; its moves have line number 0.
    ///
    /// # Errors
    /// What GRBL would refuse it for. A refused line changes nothing.
    pub fn line(&mut self, line: &Line) -> Result<Vec<Move>, TraceProblem> {
        let mut moves = Vec::new();
        let bytes = sent_bytes(&line.to_string());
        self.tracer.line(line, 0, bytes, &mut moves).map_err(|refusal| refusal.problem)?;
        self.tool = line.value('T').unwrap_or(0.0);
        Ok(moves)
    }

    /// Where the tool is when all said so far is done, mm.
    pub fn position(&self) -> P3 {
        self.tracer.position
    }

    /// The tool is somewhere else.
    pub fn set_position(&mut self, position_mm: P3) {
        self.tracer.position = position_mm;
    }

    /// The machine is found somewhere, with work zero of the offset in effect somewhere: all that makes it up, G92 and the tool's length too, is in
    /// `origin_mm`.
    pub fn find(&mut self, position_mm: P3, origin_mm: V3) {
        let t = &mut self.tracer;
        t.position = position_mm;
        t.offsets[t.offset] += origin_mm - t.origin();
    }

    /// G92 and G43.1 are in effect like this, mm.
    pub fn set_shift(&mut self, shift_mm: V3, tool_length_mm: f64) {
        (self.tracer.shift, self.tracer.tool_length_mm) = (shift_mm, tool_length_mm);
    }

    /// In G91 GRBL adds each step to where the last one ended in single precision (gcode.c, nuts_bolts.h): what is lost of each adds up. For who counts
    /// in machine coordinates as a board does.
    pub fn round_as_board(&mut self) {
        if self.tracer.incremental {
            self.tracer.position = self.tracer.position.map(|mm| f64::from(mm as f32));
        }
    }

    /// Where the program's zero lies: offset, G92 and tool length, mm.
    pub fn origin(&self) -> V3 {
        self.tracer.origin()
    }

    /// Origins of G54 to G59, mm.
    pub fn offsets(&self) -> [V3; 6] {
        self.tracer.offsets
    }

    /// The stored places of G28 and G30, machine coordinates, mm.
    pub fn homes(&self) -> [P3; 2] {
        self.tracer.homes
    }

    /// G92, mm.
    pub fn shift(&self) -> V3 {
        self.tracer.shift
    }

    /// G43.1, mm.
    pub fn tool_length_mm(&self) -> f64 {
        self.tracer.tool_length_mm
    }

    /// What is in effect.
    pub fn modal(&self) -> Modal {
        let t = &self.tracer;
        let (motion, feeds) = match t.motion {
            Motion::Rapid => ("G0", false),
            Motion::Line => ("G1", true),
            Motion::ArcClockwise => ("G2", true),
            Motion::ArcCounterClockwise => ("G3", true),
            Motion::Probe => ("G38.2", false),
            Motion::Cancelled => ("G80", false),
        };
        let plane = match t.plane {
            Plane::Xy => 17,
            Plane::Zx => 18,
            Plane::Yz => 19,
        };
        Modal {
            motion,
            feeds,
            plane,
            inches: t.inches,
            incremental: t.incremental,
            inverse_time: t.inverse_time,
            offset: t.offset,
            beam: t.beam,
            coolant: t.coolant,
            tool: self.tool,
            feed_mm_per_min: t.feed_mm_per_min,
            power_s: t.power_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;

    #[test]
    fn work_zero_lies_where_the_stored_offset_says() {
        let mut offsets = [V3::zeros(); 6];
        offsets[0] = V3::new(-400.0, -300.0, 0.0);
        let mut interpreter = Interpreter::new(P3::new(-2.0, -2.0, 0.0), offsets, [P3::origin(); 2]);
        let say = |i: &mut Interpreter, text: &str| i.line(&parse(text).unwrap().lines[0]);
        let moves = say(&mut interpreter, "G1X10F600T2").unwrap();
        assert_eq!(moves[0].to, P3::new(-390.0, -2.0, 0.0));
        assert_eq!((interpreter.modal().motion, interpreter.modal().tool), ("G1", 2.0));
        assert_eq!(say(&mut interpreter, "G1X10X2").unwrap_err().grbl_error(), 25);
        say(&mut interpreter, "G92X0").unwrap();
        assert_eq!(interpreter.origin().x, -390.0);
    }
}
