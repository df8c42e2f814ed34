//! Closed outlines out of an SVG that any drawing program wrote.

use super::Error;
use crate::geom::P2;
use lyon::extra::parser::{ParserOptions, PathParser, Source};
use lyon::geom::euclid::Angle;
use lyon::math::{Box2D, point, vector};
use lyon::path::iterator::PathIterator;
use lyon::path::{Path, PathEvent, Winding};
use roxmltree::{Document, Node};

/// Curves become chords this close to them, mm: below what scissors, lasers and paper keep.
const FLATNESS_MM: f64 = 0.05;

/// Groups whose shapes are not drawn themselves.
const NOT_DRAWN: [&str; 5] = ["defs", "clipPath", "mask", "pattern", "symbol"];

/// Reads every path, polygon, rectangle, circle and ellipse of an SVG as closed loops in mm, y up, the lowest point at y = 0. Loops that are open in the file are
/// closed; curves become chords.
///
/// # Errors
/// Text that is not XML, a page that does not say its size in mm, cm or inches, a transform, path data that cannot be read; each names the line and column.
pub fn read_loops(text: &str) -> Result<Vec<Vec<P2>>, Error> {
    let document = Document::parse(text)?;
    let mm_per_unit = mm_per_unit(document.root_element())?;
    let mut loops: Vec<Vec<P2>> = Vec::new();
    for node in document.descendants().filter(Node::is_element) {
        if node.ancestors().any(|n| NOT_DRAWN.contains(&n.tag_name().name())) {
            continue;
        }
        if node.has_attribute("transform") {
            return Err(Error::Transform { place: place(node) });
        }
        let Some(path) = shape(node)? else { continue };
        for event in path.iter().flattened((FLATNESS_MM / mm_per_unit) as f32) {
            let p = |at: lyon::math::Point| P2::new(f64::from(at.x) * mm_per_unit, -f64::from(at.y) * mm_per_unit);
            match event {
                PathEvent::Begin { at } => loops.push(vec![p(at)]),
                PathEvent::Line { to, .. } => loops.iter_mut().last().into_iter().for_each(|l| l.push(p(to))),
                // Flattened, so there are no curves left; an end draws nothing.
                _ => {}
            }
        }
    }
    // Pen moves that draw nothing.
    loops.retain(|l| l.len() > 2);
    let floor = loops.iter().flatten().map(|p| p.y).fold(f64::INFINITY, f64::min);
    loops.iter_mut().flatten().for_each(|p| p.y -= floor);
    Ok(loops)
}

fn place(node: Node) -> String {
    let at = node.document().text_pos_at(node.range().start);
    format!("line {}, column {}", at.row, at.col)
}

/// How long a unit of the drawing is, from the page's width and its viewBox.
fn mm_per_unit(root: Node) -> Result<f64, Error> {
    let no_size = || Error::NoSize { place: place(root) };
    let width = root.attribute("width").ok_or_else(no_size)?.trim();
    let units = [("mm", 1.0), ("cm", 10.0), ("in", 25.4)];
    let width_mm = units.iter().find_map(|(unit, mm)| Some(width.strip_suffix(unit)?.trim().parse::<f64>().ok()? * mm));
    let view: Option<f64> =
        root.attribute("viewBox").and_then(|v| v.split([' ', ',']).filter(|t| !t.is_empty()).nth(2)?.parse().ok());
    match (width_mm, view) {
        (Some(mm), Some(units)) if mm > 0.0 && units > 0.0 => Ok(mm / units),
        _ => Err(no_size()),
    }
}

/// What an element draws; `None` for one that draws no outline.
fn shape(node: Node) -> Result<Option<Path>, Error> {
    let bad = |what: String| Error::Shape { place: place(node), element: node.tag_name().name().to_owned(), what };
    let number = |name: &str| -> Result<f32, Error> {
        let text = node.attribute(name).unwrap_or("0").trim();
        let plain = text.strip_suffix("mm").unwrap_or(text);
        plain.parse().map_err(|_| bad(format!("{name}=\"{text}\" is not a number")))
    };
    let mut builder = Path::builder();
    match node.tag_name().name() {
        "path" | "polygon" | "polyline" => {
            let data = match node.attribute("points") {
                Some(points) => format!("M {points} Z"),
                None => node.attribute("d").unwrap_or_default().to_owned(),
            };
            PathParser::new()
                .parse(&ParserOptions::DEFAULT, &mut Source::new(data.chars()), &mut builder)
                .map_err(|e| bad(format!("its data cannot be read: {e}")))?;
        }
        "rect" => {
            let (x, y) = (number("x")?, number("y")?);
            let corner = point(x + number("width")?, y + number("height")?);
            builder.add_rectangle(&Box2D { min: point(x, y), max: corner }, Winding::Positive);
        }
        name @ ("circle" | "ellipse") => {
            let radii = match name {
                "circle" => vector(number("r")?, number("r")?),
                _ => vector(number("rx")?, number("ry")?),
            };
            builder.add_ellipse(point(number("cx")?, number("cy")?), radii, Angle::zero(), Winding::Positive);
        }
        _ => return Ok(None),
    }
    Ok(Some(builder.build()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Rect, signed_area};

    fn page(body: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20cm\" height=\"10cm\" viewBox=\"0 0 100 50\">{body}</svg>"
        )
    }

    #[test]
    fn shapes_of_every_kind_come_in_mm_upright_and_on_the_floor() {
        let text = page(
            "<g><path d=\"m10,10 h20 v10 h-20 z\"/></g><defs><rect width=\"9\" height=\"9\"/></defs><circle cx=\"60\" cy=\"25\" r=\"10\"/><polygon points=\"0,0 1,0 1,1\"/>",
        );
        let loops = read_loops(&text).unwrap();
        assert_eq!(loops.len(), 3);
        let boxes: Vec<Rect> = loops.iter().map(Rect::around).collect();
        // Units of 2 mm; the circle comes down to y = 35, which is the floor.
        assert!((boxes[0].width() - 40.0).abs() < 1e-4 && (boxes[0].min.y - 30.0).abs() < 1e-4, "{:?}", boxes[0]);
        assert!(boxes[1].min.y.abs() < 1e-9);
        let circle = std::f64::consts::PI * 400.0;
        assert!((signed_area(&loops[1]).abs() / circle - 1.0).abs() < 0.01);
    }

    #[test]
    fn what_cannot_be_understood_is_told_with_its_place() {
        for (text, word) in [
            (page("<g transform=\"scale(2)\"/>"), "transform"),
            (page("<path d=\"M 0 0 L x\"/>"), "path"),
            (page("").replace("20cm", "20"), "mm"),
            ("<svg".to_owned(), "XML"),
        ] {
            let message = read_loops(&text).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
    }
}
