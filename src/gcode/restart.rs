//! Where a job that was interrupted is taken up again: at the start of the path it was in, or a little before the place it had come to.

use std::collections::VecDeque;
use std::io;

use super::rewrite::RewriteError;
use super::{Interpreter, Move, parse_line};
use crate::geom::{P3, V3};

/// A place within a program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Restart {
    /// Line, from 1.
    pub line: usize,
    /// How much of the line's way lies before it, mm; more than all of it means its end.
    pub along_mm: f64,
}

/// A move of the path under way.
struct Leg {
    line: usize,
    before_mm: f64,
    length_mm: f64,
}

/// Where to take up a program of which everything before `done` is carried out; `None` when nothing is left to work on. Without an overlap it is the end
/// of the last travel before the path that is not whole: what puts the tool to work is done again there. With one it is so many mm before
/// `done`, but not before the path's start. The head stood at `start_mm` when the program began.
///
/// # Errors
/// The program cannot be read or carried out.
pub fn restart(
    lines: impl Iterator<Item = io::Result<String>>,
    start_mm: P3,
    done: Restart,
    laser: bool,
    overlap_mm: Option<f64>,
) -> io::Result<Option<Restart>> {
    let mut interpreter = Interpreter::new(start_mm, [V3::zeros(); 6], [P3::origin(); 2]);
    let works = |m: &Move| if laser { m.burns() } else { m.feeds() };
    let mut path_start = Restart { line: 1, along_mm: 0.0 };
    let mut path: VecDeque<Leg> = VecDeque::new();
    for (number, text) in (1..).zip(lines) {
        let line = parse_line(&text?, number).map_err(io::Error::other)?;
        let moves = interpreter.line(&line);
        let moves = moves.map_err(|problem| io::Error::other(RewriteError::Trace { line: number, problem }))?;
        let mut before_mm = 0.0;
        for m in moves.iter().filter(|m| m.goes()) {
            let length_mm = m.length_mm();
            let after_mm = before_mm + length_mm;
            if !works(m) {
                path.clear();
                path_start = Restart { line: number, along_mm: after_mm };
            } else {
                path.push_back(Leg { line: number, before_mm, length_mm });
                let behind = number < done.line || number == done.line && after_mm <= done.along_mm;
                if !behind {
                    let into_mm = if number == done.line { (done.along_mm - before_mm).max(0.0) } else { 0.0 };
                    return Ok(Some(overlap_mm.map_or(path_start, |overlap| back(&path, into_mm - overlap))));
                }
                // No more of the path is kept than the overlap may reach.
                let mut kept_mm: f64 = path.iter().map(|leg| leg.length_mm).sum();
                while let Some(first) =
                    path.front().filter(|first| kept_mm - first.length_mm > overlap_mm.unwrap_or(0.0))
                {
                    kept_mm -= first.length_mm;
                    path.pop_front();
                }
            }
            before_mm = after_mm;
        }
    }
    Ok(None)
}

/// The place so far into the last leg of a path, or, below 0, so far before it.
fn back(path: &VecDeque<Leg>, mut into_mm: f64) -> Restart {
    let mut legs = path.iter().rev().peekable();
    while let Some(leg) = legs.next() {
        if into_mm >= 0.0 || legs.peek().is_none() {
            return Restart { line: leg.line, along_mm: leg.before_mm + into_mm.max(0.0) };
        }
        into_mm += legs.peek().map_or(0.0, |before| before.length_mm);
    }
    Restart { line: 1, along_mm: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two paths: lines 3 to 5, and 8 and 9.
    const JOB: &str = "G21G90\nG0X10Y10\nM4S0\nG1X30S500F900\nY30\nM9\nG0X50Y0\nM8\nG1X60\nX70\nM5\nG0X0Y0\n";

    fn at(line: usize, along_mm: f64, overlap_mm: Option<f64>) -> Option<(usize, f64)> {
        let lines = JOB.lines().map(|line| Ok(line.to_owned()));
        let place = restart(lines, P3::origin(), Restart { line, along_mm }, true, overlap_mm).unwrap();
        place.map(|place| (place.line, (place.along_mm * 1e6).round() / 1e6))
    }

    #[test]
    fn a_path_begins_where_the_last_travel_ended() {
        let travel_mm = (200.0_f64).sqrt();
        let first = at(2, 0.0, None).unwrap();
        assert!(first.0 == 2 && (first.1 - travel_mm).abs() < 1e-6);
        assert_eq!([at(4, 5.0, None), at(5, 19.0, None)], [Some(first); 2]);
        let second = at(5, 20.0, None).unwrap();
        assert_eq!(second.0, 7);
        assert_eq!([at(7, 1.0, None), at(9, 0.0, None), at(10, 9.9, None)], [Some(second); 3]);
        assert_eq!([at(10, 10.0, None), at(12, 0.0, None)], [None; 2]);
    }

    #[test]
    fn an_exact_place_is_taken_up_with_its_overlap_and_not_before_the_path() {
        assert_eq!(at(4, 5.0, Some(0.0)), Some((4, 5.0)));
        assert_eq!(at(4, 5.0, Some(2.0)), Some((4, 3.0)));
        assert_eq!(at(4, 1.0, Some(2.0)), Some((4, 0.0)));
        assert_eq!(at(5, 1.0, Some(2.5)), Some((4, 18.5)));
        assert_eq!(at(10, 1.0, Some(100.0)), Some((9, 0.0)));
        assert_eq!(at(7, 3.0, Some(2.0)), Some((9, 0.0)), "in a travel nothing is left to overlap");
    }
}
