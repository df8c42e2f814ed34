//! Writes drawings as SVG at true size, for the programs of laser cutters and plotters.
//!
//! Width, height and viewBox are mm. Colour and fill are attributes of every path, because those programs ignore CSS and some ignore
//! what a group hands down; nothing is transformed. The root's `data-origin-mm` says where the frame's origin lies, so that a reader
//! gets the strip's or the sheet's own coordinates back.

use super::path_data::{path_data, svg_number};
use super::{Drawing, DrawnPath, Operation};
use crate::geom::{P2, Rect};
use std::fmt::Write;

/// Width of every stroke, mm: thin enough that no program takes it for an area.
const STROKE_MM: f64 = 0.1;

/// One piece, flat and at true size, in its own frame, with `margin_mm` of empty page around everything drawn.
pub fn piece_svg(drawing: &Drawing, margin_mm: f64) -> String {
    let drawn = drawing.bounds();
    let page = if drawn.is_empty() { Rect::from_size(0.0, 0.0) } else { drawn }.grown(margin_mm);
    let origin = P2::new(-page.min.x, page.max.y);
    let mut svg = header(page.width(), page.height(), origin);
    piece(&mut svg, drawing, origin, None);
    svg.push_str("</svg>\n");
    svg
}

/// A sheet of `width_mm` by `height_mm` with its placed pieces (sheet frame: x right, y up, origin at the bottom left).
///
/// One group for each operation, in the order they are made, each with one `g.piece` for every piece.
pub fn sheet_svg(width_mm: f64, height_mm: f64, pieces: &[Drawing]) -> String {
    let origin = P2::new(0.0, height_mm);
    let mut svg = header(width_mm, height_mm, origin);
    for operation in Operation::ALL {
        let _ = writeln!(svg, "<g id=\"{}\">", operation.id());
        for drawing in pieces {
            piece(&mut svg, drawing, origin, Some(operation));
        }
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

fn header(width_mm: f64, height_mm: f64, origin: P2) -> String {
    let [w, h, x, y] = [width_mm, height_mm, origin.x, origin.y].map(svg_number);
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{w}mm\" \
         height=\"{h}mm\" viewBox=\"0 0 {w} {h}\" data-origin-mm=\"{x} {y}\">\n"
    )
}

/// Writes one `g.piece` with the paths of one operation, or with all of them.
fn piece(svg: &mut String, drawing: &Drawing, origin: P2, only: Option<Operation>) {
    let _ = writeln!(svg, "<g class=\"piece\" data-name=\"{}\">", escape(&drawing.name));
    for drawn in drawing.paths.iter().filter(|p| only.is_none_or(|o| p.role.operation() == o)) {
        path(svg, drawn, origin);
    }
    svg.push_str("</g>\n");
}

fn path(svg: &mut String, drawn: &DrawnPath, origin: P2) {
    let data = path_data(&drawn.path, origin);
    if data.is_empty() {
        return;
    }
    let _ = write!(svg, "<path class=\"{}\"", drawn.role.class());
    if let Some(joint) = &drawn.joint {
        let _ = write!(svg, " data-joint=\"{}\"", escape(joint));
    }
    if drawn.kerf != drawn.role.usual_kerf() {
        let _ = write!(svg, " data-kerf=\"{}\"", drawn.kerf.word());
    }
    let _ = writeln!(
        svg,
        " fill=\"none\" stroke=\"{}\" stroke-width=\"{STROKE_MM}\" d=\"{data}\"/>",
        drawn.role.operation().colour()
    );
}

/// Text as an XML attribute's value. Characters that XML 1.0 cannot hold at all become U+FFFD.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            // Unescaped, a reader would turn them into spaces.
            '\t' | '\n' | '\r' => {
                let _ = write!(escaped, "&#{};", c as u32);
            }
            '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{KerfSide, Role};
    use crate::geom::Path;

    fn drawn(path: Path, role: Role, joint: Option<&str>) -> DrawnPath {
        DrawnPath { path, role, kerf: role.usual_kerf(), joint: joint.map(str::to_owned) }
    }

    fn strip() -> Drawing {
        let p = |x, y| P2::new(x, y);
        let outline = Path::closed([p(-5.0, 0.0), p(100.0, 0.0), p(100.0, 30.0), p(-5.0, 30.0)]);
        Drawing {
            name: "A1".into(),
            paths: vec![
                drawn(Path::open([p(1.0, 2.0), p(1.0, 5.0)]), Role::Label, None),
                drawn(Path::open([p(40.0, 10.0), p(40.0, 20.0)]), Role::Slit, Some("A7")),
                drawn(outline, Role::Outline, None),
            ],
        }
    }

    #[test]
    fn a_piece_is_written_at_true_size_with_attributes_only() {
        let expected = concat!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
            "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"109mm\" height=\"34mm\" viewBox=\"0 0 109 34\" ",
            "data-origin-mm=\"7 32\">\n",
            "<g class=\"piece\" data-name=\"A1\">\n",
            "<path class=\"label\" fill=\"none\" stroke=\"#000000\" stroke-width=\"0.1\" d=\"M8 30 V27\"/>\n",
            "<path class=\"slit\" data-joint=\"A7\" fill=\"none\" stroke=\"#0000FF\" stroke-width=\"0.1\" d=\"M47 22 V12\"/>\n",
            "<path class=\"outline\" fill=\"none\" stroke=\"#FF0000\" stroke-width=\"0.1\" d=\"M2 32 H107 V2 H2 Z\"/>\n",
            "</g>\n</svg>\n"
        );
        assert_eq!(piece_svg(&strip(), 2.0), expected);
    }

    #[test]
    fn a_sheet_has_its_groups_in_order_with_every_piece_in_each() {
        let svg = sheet_svg(400.0, 300.0, &[strip(), Drawing { name: "B<1>".into(), ..strip() }]);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let root = document.root_element();
        assert_eq!(root.attribute("viewBox"), Some("0 0 400 300"));
        let groups: Vec<_> = root.children().filter(|n| n.is_element()).collect();
        let ids: Vec<_> = groups.iter().map(|g| g.attribute("id").unwrap()).collect();
        assert_eq!(ids, ["engrave", "cut-inner", "cut-outline"]);
        for (group, class) in groups.iter().zip(["label", "slit", "outline"]) {
            let names: Vec<_> = group.children().filter_map(|n| n.attribute("data-name")).collect();
            assert_eq!(names, ["A1", "B<1>"]);
            let paths: Vec<_> = group.descendants().filter(|n| n.has_tag_name("path")).collect();
            assert!(paths.len() == 2 && paths.iter().all(|p| p.attribute("class") == Some(class)));
        }
        assert!(svg.contains("d=\"M-5 300 H100 V270 H-5 Z\""), "{svg}");
    }

    #[test]
    fn a_kerf_side_is_written_only_where_the_role_does_not_say_it() {
        let mut drawing = strip();
        drawing.paths[1].kerf = KerfSide::Left;
        let svg = piece_svg(&drawing, 0.0);
        assert_eq!(svg.matches("data-kerf").count(), 1);
        assert!(svg.contains("data-kerf=\"left\""));
    }

    #[test]
    fn an_empty_drawing_is_a_valid_page() {
        let svg = piece_svg(&Drawing::default(), 1.0);
        assert!(roxmltree::Document::parse(&svg).is_ok() && svg.contains("viewBox=\"0 0 2 2\""), "{svg}");
    }
}
