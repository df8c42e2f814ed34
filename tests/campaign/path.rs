//! What a program should do and what a board did, made comparable.

use furbelow::emulator::Segment;
use furbelow::gcode::{Interpreter, Move, parse_line};
use furbelow::geom::{P3, V3};

/// Burnt paths and plans are compared at places this far apart, mm.
const SAMPLE_MM: f64 = 0.5;

/// The moves of a program, in machine coordinates.
pub struct Plan {
    pub moves: Vec<Move>,
    /// Way up to and with each line, travels too, and burnt of it, mm; of line 0 nothing.
    pub way_mm: Vec<f64>,
    pub burnt_mm: Vec<f64>,
    samples: Vec<P3>,
}

impl Plan {
    /// A program whose head stands at `start_mm` in work coordinates and whose work zero lies at `zero`.
    pub fn new(text: &str, start_mm: P3, zero: V3) -> Plan {
        let mut interpreter = Interpreter::new(start_mm, [V3::zeros(); 6], [P3::origin(); 2]);
        let mut moves = Vec::new();
        for (number, line) in (1..).zip(text.lines()) {
            let made = interpreter.line(&parse_line(line, number).expect("a line")).expect("moves");
            moves.extend(made.into_iter().map(|m| Move { line: number, ..m }));
        }
        let lines = text.lines().count() + 1;
        let (mut way_mm, mut burnt_mm) = (vec![0.0; lines], vec![0.0; lines]);
        for m in &moves {
            way_mm[m.line] += m.length_mm();
            burnt_mm[m.line] += if m.burns() { m.length_mm() } else { 0.0 };
        }
        for line in 1..lines {
            way_mm[line] += way_mm[line - 1];
            burnt_mm[line] += burnt_mm[line - 1];
        }
        for m in &mut moves {
            (m.from, m.to) = (m.from + zero, m.to + zero);
            if let furbelow::gcode::Action::Arc { center, .. } = &mut m.action {
                *center += zero.xy();
            }
        }
        let sampled = |m: &Move| {
            let m = *m;
            let count = (m.length_mm() / SAMPLE_MM).ceil().max(1.0) as usize;
            (0..=count).map(move |k| m.point_at(k as f64 / count as f64))
        };
        let samples = moves.iter().filter(|m| m.burns()).flat_map(sampled).collect();
        Plan { moves, way_mm, burnt_mm, samples }
    }

    /// How far a place is from what is to be burnt (or, when `all`, from any move), mm.
    pub fn off_mm(&self, place: P3, all: bool) -> f64 {
        let counts = |m: &&Move| if all { m.goes() } else { m.burns() };
        self.moves.iter().filter(counts).map(|m| m.nearest(place).1).fold(f64::INFINITY, f64::min)
    }

    /// How far what was burnt strays from the plan at most, mm.
    pub fn strays_mm(&self, trace: &[Segment]) -> f64 {
        let lit = trace.iter().filter(|s| s.is_lit() && s.length_mm() > 0.0);
        let places = lit.flat_map(|s| {
            let count = (s.length_mm() / SAMPLE_MM).ceil().max(1.0) as usize;
            (0..=count).map(move |k| s.from_mm + (s.to_mm - s.from_mm) * (k as f64 / count as f64))
        });
        places.map(|place| self.off_mm(place, false)).fold(0.0, f64::max)
    }

    /// How far the farthest place of the plan is from what was burnt, mm.
    pub fn missed_mm(&self, trace: &[Segment]) -> f64 {
        let lit: Vec<&Segment> = trace.iter().filter(|s| s.is_lit() && s.length_mm() > 0.0).collect();
        let off = |place: &P3| lit.iter().map(|s| off_segment(*place, s)).fold(f64::INFINITY, f64::min);
        self.samples.iter().map(off).fold(0.0, f64::max)
    }

    /// The last line whose way is behind when so much of all of it is.
    pub fn line_at(&self, way_mm: f64) -> usize {
        self.way_mm.partition_point(|line_mm| *line_mm <= way_mm) - 1
    }

    /// How many lines after `from` up to `to` have a way.
    pub fn lines_with_way(&self, from: usize, to: usize) -> usize {
        (from + 1..=to).filter(|line| self.way_mm[*line] > self.way_mm[*line - 1]).count()
    }
}

fn off_segment(place: P3, s: &Segment) -> f64 {
    let way = s.to_mm - s.from_mm;
    let t = ((place - s.from_mm).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
    (s.from_mm + way * t - place).norm()
}

/// What a trace has burnt, mm.
pub fn burnt_mm(trace: &[Segment]) -> f64 {
    trace.iter().filter(|s| s.is_lit()).map(Segment::length_mm).sum()
}

/// The light of a trace: share of full power times s.
pub fn light_s(trace: &[Segment]) -> f64 {
    trace.iter().map(|s| 0.5 * (s.start_power + s.end_power) * (s.end_s - s.start_s)).sum()
}

/// The way of a trace, lit or not, mm.
pub fn way_mm(trace: &[Segment]) -> f64 {
    trace.iter().map(Segment::length_mm).sum()
}
