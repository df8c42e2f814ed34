//! SVG path data, both ways: the `d` attribute of a curve of lines and circular arcs.
//!
//! SVG has y down, every frame of this crate has y up; both directions flip about an origin, so nothing needs a transform.

use crate::geom::{P2, Path, PathVertex, Segment, V2};
use std::f64::consts::TAU;

/// Decimals written, mm: a tenth of a micrometre, far below what any cutter resolves.
const DECIMALS: usize = 4;

/// Arcs that turn further are written as equal parts. SVG gives an arc by its ends and its radius; near a half circle the radius then
/// says almost nothing about how far the arc bulges (half a unit of the last digit moves the crown of a 50 mm half circle by 0.07 mm),
/// while up to a third of a circle the crown moves no further than the radius is rounded.
const LONGEST_ARC_RAD: f64 = TAU / 3.0;

/// Writes a number with at most `decimals` decimals, without trailing zeros and without a negative zero.
pub(super) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Writes a length or coordinate in mm the way every SVG of this crate does: four decimals, trimmed.
pub fn svg_number(value_mm: f64) -> String {
    number(value_mm, DECIMALS)
}

/// The `d` attribute of `path`. `origin` is where the frame's origin lies in SVG coordinates: (x, y) is written as
/// (origin.x + x, origin.y - y), mm.
///
/// Lines become `L`, `H` and `V`, arcs `A`, a closed path ends in `Z`. Steps and bulges below the last digit are left out. Arcs beyond
/// a third of a circle are written in equal parts, so a full circle is four `A`. A path without corners gives an empty string.
pub fn path_data(path: &Path, origin: P2) -> String {
    let Some(start) = path.start() else { return String::new() };
    let mut writer = Writer { origin, at: [String::new(), String::new()], data: String::new() };
    writer.at = writer.coordinates(start);
    writer.data = format!("M{} {}", writer.at[0], writer.at[1]);
    let count = path.segments().count();
    for (i, segment) in path.segments().enumerate() {
        match segment {
            // `Z` draws it.
            Segment::Line { .. } if path.closed && i + 1 == count => {}
            Segment::Line { to, .. } => writer.line(to),
            Segment::Arc { from, to, center, radius, sweep_rad } => writer.arc(from, to, center, radius, sweep_rad),
        }
    }
    if path.closed {
        writer.data.push_str(" Z");
    }
    writer.data
}

struct Writer {
    origin: P2,
    /// The pen's place as written, so that steps are judged by what a reader will see.
    at: [String; 2],
    data: String,
}

impl Writer {
    fn coordinates(&self, p: P2) -> [String; 2] {
        [svg_number(self.origin.x + p.x), svg_number(self.origin.y - p.y)]
    }

    fn line(&mut self, to: P2) {
        let [x, y] = self.coordinates(to);
        match (x == self.at[0], y == self.at[1]) {
            (true, true) => return,
            (true, false) => self.data.push_str(&format!(" V{y}")),
            (false, true) => self.data.push_str(&format!(" H{x}")),
            (false, false) => self.data.push_str(&format!(" L{x} {y}")),
        }
        self.at = [x, y];
    }

    fn arc(&mut self, from: P2, to: P2, center: P2, radius: f64, sweep_rad: f64) {
        let sagitta = radius * (1.0 - (0.5 * sweep_rad).cos());
        if sagitta < 0.5 * 10f64.powi(-(DECIMALS as i32)) {
            return self.line(to);
        }
        // The slack keeps an exact third of a circle in one part.
        let parts = (sweep_rad.abs() / LONGEST_ARC_RAD - 1e-9).ceil().max(1.0);
        let spoke = from - center;
        for part in 1..=parts as usize {
            let turn = sweep_rad * part as f64 / parts;
            let end = if part as f64 == parts { to } else { center + nalgebra::Rotation2::new(turn) * spoke };
            let [x, y] = self.coordinates(end);
            if [&x, &y] != [&self.at[0], &self.at[1]] {
                let r = svg_number(radius);
                // SVG's sweep flag is 1 for what looks clockwise on the page.
                let clockwise = u8::from(sweep_rad < 0.0);
                self.data.push_str(&format!(" A{r} {r} 0 0 {clockwise} {x} {y}"));
                self.at = [x, y];
            }
        }
    }
}

/// Why path data could not be read; `at` counts bytes from the start of the attribute.
pub(super) struct BadData {
    pub at: usize,
    pub what: String,
}

/// Reads path data of absolute `M`, `L`, `H`, `V`, `A` and `Z` commands back into curves, one for every `M`; the inverse of
/// [`path_data`] for the same `origin`.
pub(super) fn parse_path_data(data: &str, origin: P2) -> Result<Vec<Path>, BadData> {
    let mut scanner = Scanner { data, at: 0 };
    let mut paths: Vec<Path> = Vec::new();
    let mut command = None;
    while !scanner.done() {
        let at = scanner.at;
        let bad = |what: String| BadData { at, what };
        match scanner.command() {
            Some(letter) => command = Some(letter),
            // Numbers that follow without a letter repeat the command; after a move they draw lines (SVG 1.1, section 8.3.2).
            None if command == Some('M') => command = Some('L'),
            None => {}
        }
        let flipped = |x: f64, y: f64| P2::new(x - origin.x, origin.y - y);
        let drawing = matches!(command, Some('L' | 'H' | 'V' | 'A' | 'Z'));
        let Some(path) = (if drawing { paths.last_mut() } else { None }).filter(|p| !p.closed) else {
            if command != Some('M') {
                return Err(bad(match command {
                    Some(c) if !drawing => format!("command '{c}' is not one of M, L, H, V, A, Z (absolute)"),
                    _ => "a curve must begin with M".to_owned(),
                }));
            }
            let (x, y) = (scanner.number()?, scanner.number()?);
            paths.push(Path::open([flipped(x, y)]));
            continue;
        };
        let last = path.vertices.len() - 1;
        let pen = path.vertices[last].point;
        let to = match command {
            Some('Z') => {
                command = None;
                path.closed = true;
                // A curved last stretch is drawn up to the start, which a closed path does not repeat.
                if last > 0 && (pen - path.vertices[0].point).norm() < 1e-9 {
                    path.vertices.pop();
                }
                continue;
            }
            Some('H') => P2::new(scanner.number()? - origin.x, pen.y),
            Some('V') => P2::new(pen.x, origin.y - scanner.number()?),
            Some('A') => {
                let radii = V2::new(scanner.number()?, scanner.number()?);
                if (radii.x - radii.y).abs() > 1e-9 {
                    return Err(bad(format!(
                        "radii {} and {} differ; only circular arcs can be cut",
                        radii.x, radii.y
                    )));
                }
                scanner.number()?;
                let (large, clockwise) = (scanner.number()? != 0.0, scanner.number()? != 0.0);
                let to = flipped(scanner.number()?, scanner.number()?);
                path.vertices[last].bulge = bulge((to - pen).norm(), radii.x.abs(), large, clockwise);
                to
            }
            _ => flipped(scanner.number()?, scanner.number()?),
        };
        path.vertices.push(PathVertex { point: to, bulge: 0.0 });
    }
    Ok(paths)
}

/// tan(sweep / 4) of an SVG arc; a radius too small for its chord is scaled up (SVG 1.1, appendix F.6.6), none at all is a line.
fn bulge(chord: f64, radius: f64, large: bool, clockwise: bool) -> f64 {
    if chord == 0.0 || radius == 0.0 {
        return 0.0;
    }
    let short = 2.0 * (0.5 * chord / radius).min(1.0).asin();
    let sweep = if large { TAU - short } else { short };
    if clockwise { -(0.25 * sweep).tan() } else { (0.25 * sweep).tan() }
}

struct Scanner<'a> {
    data: &'a str,
    at: usize,
}

impl Scanner<'_> {
    fn rest(&self) -> &[u8] {
        &self.data.as_bytes()[self.at..]
    }

    fn done(&mut self) -> bool {
        while self.rest().first().is_some_and(|b| b.is_ascii_whitespace() || *b == b',') {
            self.at += 1;
        }
        self.rest().is_empty()
    }

    /// The next character, unless it begins a number.
    fn command(&mut self) -> Option<char> {
        let next = self.data[self.at..].chars().next().filter(|c| !(c.is_ascii_digit() || "+-.".contains(*c)))?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn number(&mut self) -> Result<f64, BadData> {
        self.done();
        let rest = self.rest();
        let mut end = 0;
        let mut seen_point = false;
        let mut seen_exponent = false;
        while let Some(byte) = rest.get(end) {
            match byte {
                b'0'..=b'9' => {}
                b'+' | b'-' if end == 0 || matches!(rest[end - 1], b'e' | b'E') => {}
                b'.' if !seen_point && !seen_exponent => seen_point = true,
                b'e' | b'E' if end > 0 && !seen_exponent => seen_exponent = true,
                _ => break,
            }
            end += 1;
        }
        let text = &self.data[self.at..self.at + end];
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => {
                self.at += end;
                Ok(value)
            }
            _ => Err(BadData { at: self.at, what: format!("expected a number, found \"{text}\"") }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{cross, distance_to_segment};
    use proptest::prelude::*;

    fn vertex(x: f64, y: f64, bulge: f64) -> PathVertex {
        PathVertex { point: P2::new(x, y), bulge }
    }

    fn back(data: &str) -> Vec<Path> {
        parse_path_data(data, P2::origin()).unwrap_or_else(|e| panic!("{} at {}", e.what, e.at))
    }

    /// Distance from `p` to a line or arc.
    fn distance(p: P2, segment: Segment) -> f64 {
        let ends = (p - segment.from()).norm().min((p - segment.to()).norm());
        match segment {
            Segment::Line { from, to } => distance_to_segment(p, from, to),
            Segment::Arc { from, center, radius, sweep_rad, .. } => {
                let (a, b) = (from - center, p - center);
                let turn = cross(a, b).atan2(a.dot(&b)).rem_euclid(TAU);
                let along = if sweep_rad > 0.0 { turn } else { TAU - turn };
                if along <= sweep_rad.abs() { (b.norm() - radius).abs().min(ends) } else { ends }
            }
        }
    }

    /// How far points of `a` stray from `b`.
    fn stray(a: &Path, b: &Path) -> f64 {
        let points = a.flatten(0.5);
        let to_b = |p: &P2| b.segments().map(|s| distance(*p, s)).fold(f64::INFINITY, f64::min);
        points.iter().map(to_b).fold(0.0, f64::max)
    }

    #[test]
    fn level_and_upright_lines_are_short_and_numbers_are_trimmed() {
        let p = |x, y| P2::new(x, y);
        let path = Path::closed([p(0.0, 0.0), p(12.5, 0.0), p(12.5, 3.0), p(1.00004, 4.25)]);
        assert_eq!(path_data(&path, p(1.0, 10.0)), "M1 10 H13.5 V7 L2 5.75 Z");
    }

    #[test]
    fn an_arc_that_turns_left_has_its_sweep_flag_off_because_svg_is_mirrored() {
        let quarter = (std::f64::consts::PI / 8.0).tan();
        let path = Path { vertices: vec![vertex(1.0, 0.0, quarter), vertex(0.0, 1.0, 0.0)], closed: false };
        assert_eq!(path_data(&path, P2::origin()), "M1 0 A1 1 0 0 0 0 -1");
        assert_eq!(path_data(&path.reversed(), P2::origin()), "M0 -1 A1 1 0 0 1 1 0");
    }

    #[test]
    fn a_large_circle_keeps_its_crown_although_the_radius_is_rounded() {
        let circle = Path::circle(P2::new(0.0, 0.0), 50.00004);
        let read = back(&path_data(&circle, P2::origin()));
        let b = read[0].bounds();
        assert!((b.max.y - 50.0).abs() < 2e-4 && (b.min.y + 50.0).abs() < 2e-4, "{b:?}");
    }

    #[test]
    fn arcs_flatter_than_the_last_digit_are_lines() {
        let path = Path { vertices: vec![vertex(0.0, 0.0, 1e-6), vertex(10.0, 0.0, 0.0)], closed: false };
        assert_eq!(path_data(&path, P2::origin()), "M0 0 H10");
    }

    #[test]
    fn the_long_way_round_and_compact_numbers_are_understood() {
        let paths = back("M0,0L1-1.5.5e1,2A2 2 0 1 1 9 2M3 3");
        assert_eq!(paths.len(), 2);
        assert_eq!(paths[0].vertices[1].point, P2::new(1.0, 1.5));
        assert_eq!(paths[0].vertices[2].point, P2::new(5.0, -2.0));
        assert!((paths[0].vertices[2].bulge + 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_read_is_told_with_its_place() {
        let told =
            |data: &str| parse_path_data(data, P2::origin()).map(|_| ()).map_err(|e| (e.at, e.what)).unwrap_err();
        assert_eq!(told("M0 0 L1 x").0, 8);
        assert!(told("M0 0 c1 1 2 2 3 3").1.contains("'c'"));
        assert!(told("L1 1").1.contains("begin with M"));
        assert!(told("M0 0 L1 1 Z L2 2").1.contains("begin with M"));
        assert!(told("M0 0 A1 2 0 0 1 3 3").1.contains("circular"));
        assert!(told("M0 0 L1e999 1").1.contains("number"));
        assert!(told("M0 0 L\u{e9}").1.contains("number"));
        assert!(told("\u{e9}").1.contains('\u{e9}'));
    }

    proptest! {
        #[test]
        fn reading_what_was_written_gives_the_same_curve(
            corners in prop::collection::vec((-300.0..300.0f64, -300.0..300.0f64, -3.0..3.0f64, any::<bool>()), 2..8),
            closed: bool,
        ) {
            let vertices = corners.iter().map(|&(x, y, b, arc)| vertex(x, y, if arc { b } else { 0.0 })).collect();
            let path = Path { vertices, closed };
            let origin = P2::new(5.0, 400.0);
            let read = parse_path_data(&path_data(&path, origin), origin).map_err(|e| TestCaseError::fail(e.what))?;
            prop_assert_eq!(read.len(), 1);
            prop_assert_eq!(read[0].closed, closed);
            prop_assert!((read[0].length() - path.length()).abs() < 1e-3 * corners.len() as f64);
            prop_assert!(stray(&read[0], &path) < 1e-3 && stray(&path, &read[0]) < 1e-3);
        }

        #[test]
        fn any_text_is_read_or_refused_without_a_panic(data in "[MLHVAZ0-9 .,eé+-]{0,40}") {
            let _ = parse_path_data(&data, P2::origin());
        }
    }
}
