//! How much was burnt, and how much should be.

use furbelow::emulator::Segment;
use furbelow::gcode::{Move, parse, trace};

/// What a board has burnt, mm.
pub fn burnt_mm(trace: &[Segment]) -> f64 {
    trace.iter().filter(|s| s.is_lit()).map(Segment::length_mm).sum()
}

/// What a program burns, mm.
pub fn planned_mm(text: &str) -> f64 {
    let moves = trace(&parse(text).expect("a program")).expect("moves");
    moves.iter().filter(|m| m.burns()).map(Move::length_mm).sum()
}
