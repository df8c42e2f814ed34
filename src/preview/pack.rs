//! A program's moves as the page reads them: columns of little-endian numbers in base64, about 55 bytes a move.

use super::run::{Bed, Run};
use super::shade::ColorBy;
use crate::gcode::{Action, Beam, Move};
use crate::geom::P2;
use serde::Serialize;

/// Coordinates are written as whole micrometres: one digit below what G-code has.
const PER_MM: f64 = 1000.0;

/// Columns, one entry a move unless said otherwise.
#[derive(Debug, Serialize)]
pub(super) struct Columns {
    /// i32: line of the program, from 1.
    line: String,
    /// i32 pairs: where it ends, um.
    end: String,
    /// u8: what it is, see [`kind`].
    kind: String,
    /// i32 triples for every arc in order: move's index, centre, um.
    arc: String,
    /// f32 for every arc: turn, rad.
    turn: String,
    /// f32: s.
    time: String,
    /// f32 triples: speed at the start, at its fastest and at the end, mm/s.
    pace: String,
    /// f32: mm/min.
    feed: String,
    /// f32: % of full power, 0 when off.
    power: String,
    /// f32: J/mm, 0 when off.
    energy: String,
}

impl Columns {
    pub fn of(run: &Run, bed: &Bed) -> Columns {
        let moves = run.moves;
        let arcs = || moves.iter().enumerate().filter_map(|(k, m)| Some((k, arc(m)?)));
        let value = |by: ColorBy| floats(by.values(run, bed).into_iter().map(|v| v.unwrap_or(0.0)));
        Columns {
            line: integers(moves.iter().map(|m| m.line as f64)),
            end: integers(moves.iter().flat_map(|m| um(m.to.xy()))),
            kind: base64(&moves.iter().map(|m| kind(m, bed)).collect::<Vec<u8>>()),
            arc: integers(arcs().flat_map(|(k, (center, _))| [k as f64, um(center)[0], um(center)[1]])),
            turn: floats(arcs().map(|(_, (_, sweep_rad))| sweep_rad)),
            time: floats(run.timing.move_s.iter().copied()),
            pace: floats(run.timing.speeds.iter().flat_map(|s| [s.entry_mm_per_s, s.cruise_mm_per_s, s.exit_mm_per_s])),
            feed: floats(moves.iter().map(|m| m.feed_mm_per_min)),
            power: value(ColorBy::Power),
            energy: value(ColorBy::Energy),
        }
    }
}

/// Bits 0-2: 0 rapid, 1 line, 2 arc, 3 dwell, 4 stop. Bit 3: the tool is at work. Bits 4-5: 0 M5, 1 M3, 2 M4.
fn kind(m: &Move, bed: &Bed) -> u8 {
    let action = match m.action {
        Action::Rapid => 0,
        Action::Line => 1,
        Action::Arc { .. } => 2,
        Action::Dwell { .. } => 3,
        Action::Stop => 4,
    };
    let beam = match m.beam {
        Beam::Off => 0,
        Beam::Constant => 1,
        Beam::Dynamic => 2,
    };
    action | u8::from(m.works(bed.laser)) << 3 | beam << 4
}

fn arc(m: &Move) -> Option<(P2, f64)> {
    match m.action {
        Action::Arc { center, sweep_rad, .. } => Some((center, sweep_rad)),
        _ => None,
    }
}

pub(super) fn um(p: P2) -> [f64; 2] {
    [p.x * PER_MM, p.y * PER_MM]
}

/// Rounded; what is beyond two kilometres stays there.
fn integers(values: impl Iterator<Item = f64>) -> String {
    base64(&values.flat_map(|v| (v.round() as i32).to_le_bytes()).collect::<Vec<u8>>())
}

fn floats(values: impl Iterator<Item = f64>) -> String {
    base64(&values.flat_map(|v| (v as f32).to_le_bytes()).collect::<Vec<u8>>())
}

/// Standard base64 with padding (RFC 4648).
pub(super) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |i: usize| u32::from(three.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::run::tests::{bed, moves, run};
    use super::*;

    #[test]
    fn base64_is_the_standard_one() {
        let cases =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("\u{3ff}", "z78=")];
        for (plain, coded) in cases {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn columns_hold_every_move_and_every_arc() {
        let text = "M4S0\nG0X10\nG3X-10I-10S300F600\nG4P1\nG1X5";
        let moves = moves(text);
        let columns = Columns::of(&run(text, &moves), &bed());
        let n = moves.len();
        let length = |bytes: usize| bytes.div_ceil(3) * 4;
        for (column, bytes) in [
            (&columns.line, 4 * n),
            (&columns.end, 8 * n),
            (&columns.kind, n),
            (&columns.arc, 12),
            (&columns.turn, 4),
            (&columns.time, 4 * n),
            (&columns.pace, 12 * n),
            (&columns.feed, 4 * n),
            (&columns.power, 4 * n),
            (&columns.energy, 4 * n),
        ] {
            assert_eq!(column.len(), length(bytes));
        }
        let kinds: Vec<u8> = moves.iter().map(|m| kind(m, &bed())).collect();
        assert_eq!(kinds, [4 | 2 << 4, 2 << 4, 2 | 8 | 2 << 4, 3 | 2 << 4, 1 | 8 | 2 << 4]);
    }

    #[test]
    fn coordinates_out_of_all_bounds_stay_numbers() {
        assert_eq!(integers([1e30, -1e30].into_iter()), base64(&[255, 255, 255, 127, 0, 0, 0, 128]));
    }
}
