//! Lettering a machine can draw: every letter a few single strokes, no areas, no fonts.

use super::glyphs::{BASELINE, CAP_HEIGHT, GAP, glyph};
use crate::geom::{P2, Path, PathVertex};
use std::f64::consts::FRAC_PI_8;

/// The strokes of one line of text as open paths. The text starts at x = 0 and stands on y = 0; `height_mm` is the height of capitals
/// and digits, descenders reach a quarter of it below. A character the alphabet does not have is drawn as a box.
pub fn text_paths(text: &str, height_mm: f64) -> Vec<Path> {
    let unit = height_mm / CAP_HEIGHT;
    let mut column = 0.0;
    let mut paths = Vec::new();
    for c in text.chars() {
        let glyph = glyph(c);
        let place = |x: f64, y: f64| P2::new((column + x) * unit, (y - BASELINE) * unit);
        paths.extend(glyph.strokes.split_whitespace().map(|stroke| stroke_path(stroke, place)));
        column += glyph.width + GAP;
    }
    paths
}

/// Width of [`text_paths`] from the first glyph's left to the last one's right, mm; 0 for no text.
pub fn text_width(text: &str, height_mm: f64) -> f64 {
    let columns: f64 = text.chars().map(|c| glyph(c).width + GAP).sum();
    (columns - GAP).max(0.0) * height_mm / CAP_HEIGHT
}

/// One stroke of the glyph table (its notation is explained there).
fn stroke_path(stroke: &str, place: impl Fn(f64, f64) -> P2) -> Path {
    let mut path = Path::default();
    let mut digits = stroke.chars();
    while let Some(first) = digits.next() {
        let quarter = FRAC_PI_8.tan();
        let (bulge, x) = match first {
            '<' => (quarter, digits.next()),
            '>' => (-quarter, digits.next()),
            _ => (0.0, Some(first)),
        };
        let grid = |digit: Option<char>| {
            f64::from(digit.and_then(|d| d.to_digit(16)).expect("the glyph table holds pairs of hexadecimal digits"))
        };
        if let Some(last) = path.vertices.last_mut() {
            last.bulge = bulge;
        }
        path.vertices.push(PathVertex { point: place(grid(x), grid(digits.next())), bulge: 0.0 });
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Rect;

    const ALL: &str = " #%&'()*+,-./0123456789:<=>ABCDEFGHIJKLMNOPQRSTUVWXYZ_abcdefghijklmnopqrstuvwxyz";

    fn bounds(text: &str, height_mm: f64) -> Rect {
        text_paths(text, height_mm).iter().fold(Rect::EMPTY, |r, p| r.union(p.bounds()))
    }

    #[test]
    fn every_glyph_stays_in_its_box_and_spans_its_width() {
        for c in ALL.chars().filter(|c| *c != ' ') {
            let text = c.to_string();
            let b = bounds(&text, 8.0);
            assert!(b.min.x.abs() < 0.1, "{c} starts at {}", b.min.x);
            assert!((b.max.x - text_width(&text, 8.0)).abs() < 0.1, "{c} ends at {}", b.max.x);
            assert!(b.min.y >= -2.0 - 1e-9 && b.max.y <= 9.0 + 1e-9, "{c} spans {} to {}", b.min.y, b.max.y);
        }
    }

    #[test]
    fn strokes_are_open_have_length_and_no_corner_repeats() {
        for path in text_paths(ALL, 3.0) {
            assert!(!path.closed && path.vertices.len() > 1);
            assert!(path.segments().all(|s| s.length() > 0.1), "{path:?}");
        }
    }

    #[test]
    fn capitals_and_digits_are_as_high_as_asked_and_stand_on_the_baseline() {
        for c in ('A'..='Z').chain('0'..='9') {
            let b = bounds(&c.to_string(), 3.0);
            assert!(b.min.y.abs() < 1e-9 && (b.max.y - 3.0).abs() < 1e-9, "{c} spans {} to {}", b.min.y, b.max.y);
        }
    }

    #[test]
    fn arcs_of_bowls_join_without_a_kink() {
        // An o runs smoothly all the way round: the turning of its arcs is one full turn.
        let o = &text_paths("o", 8.0)[0];
        let turned: f64 = o.vertices.iter().map(|v| 4.0 * v.bulge.atan()).sum();
        assert!((turned - std::f64::consts::TAU).abs() < 1e-9);
        assert_eq!(o.start(), o.end());
    }

    #[test]
    fn text_grows_by_glyph_and_gap_and_scales_with_its_height() {
        assert_eq!(text_width("", 3.0), 0.0);
        assert!((text_width("A7", 8.0) - 12.0).abs() < 1e-12);
        assert!((text_width("A7", 4.0) - 6.0).abs() < 1e-12);
        assert!((bounds("A7", 4.0).max.x - 6.0).abs() < 1e-12);
    }

    #[test]
    fn an_unknown_character_is_a_box() {
        let paths = text_paths("\u{2603}", 8.0);
        assert_eq!(paths.len(), 1);
        assert!((paths[0].length() - 24.0).abs() < 1e-9 && paths[0].start() == paths[0].end());
    }

    #[test]
    fn six_and_nine_are_each_other_upside_down_and_nothing_else() {
        let turn = crate::geom::Motion::new(crate::geom::V2::new(4.0, 8.0), std::f64::consts::PI);
        let nine = text_paths("9", 8.0)[0].moved(&turn);
        assert!((nine.length() - text_paths("6", 8.0)[0].length()).abs() < 1e-9);
        assert_ne!(text_paths("6", 8.0), text_paths("9", 8.0));
    }
}
