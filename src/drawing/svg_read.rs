//! Reads our own SVG back: pieces with their names, roles, joints and kerf sides, in the frame they were drawn in.

use super::path_data::parse_path_data;
use super::{Drawing, DrawnPath, Error, KerfSide, Role};
use crate::geom::P2;
use roxmltree::{Document, Node};

/// Reads every piece of an SVG written by [`piece_svg`](super::piece_svg) or [`sheet_svg`](super::sheet_svg), y up again, mm.
///
/// Pieces come in the order they first appear. On a sheet a piece's paths come in the order of its groups: engraved, inner cuts,
/// outline. A name that appears several times in one group (copies) gives as many pieces.
///
/// # Errors
/// Text that is not XML, a page that is not at true size, a transform, a shape that is no path, an unknown class or kerf side, path
/// data other than absolute `M`, `L`, `H`, `V`, `A`, `Z`; each names the line and column.
pub fn read_svg(text: &str) -> Result<Vec<Drawing>, Error> {
    let document = Document::parse(text)?;
    let origin = origin(document.root_element())?;
    // Which copy of a name a group holds is told by counting within its parent.
    let mut pieces: Vec<(usize, Drawing)> = Vec::new();
    let mut counted: Vec<(roxmltree::NodeId, &str, usize)> = Vec::new();
    for node in document.descendants().filter(Node::is_element) {
        if node.has_attribute("transform") {
            return Err(Error::Transform { place: place(node) });
        }
        if is_piece(node) {
            let name = node.attribute("data-name").ok_or(Error::NoName { place: place(node) })?;
            let parent = node.parent_element().map_or(node.id(), |p| p.id());
            let copy = match counted.iter_mut().find(|(p, n, _)| *p == parent && *n == name) {
                Some((_, _, count)) => {
                    *count += 1;
                    *count
                }
                None => {
                    counted.push((parent, name, 0));
                    0
                }
            };
            let index = pieces.iter().position(|(c, d)| *c == copy && d.name == name).unwrap_or_else(|| {
                pieces.push((copy, Drawing { name: name.to_owned(), paths: Vec::new() }));
                pieces.len() - 1
            });
            for shape in node.descendants().filter(|n| n.is_element() && !n.has_tag_name("g")) {
                read_path(shape, name, origin, &mut pieces[index].1.paths)?;
            }
        } else if node.has_tag_name("path") && !node.ancestors().any(is_piece) {
            return Err(Error::Stray { place: place(node), element: "path".into() });
        }
    }
    Ok(pieces.into_iter().map(|(_, drawing)| drawing).collect())
}

fn is_piece(node: Node) -> bool {
    node.has_tag_name("g") && node.attribute("class") == Some("piece")
}

fn place(node: Node) -> String {
    let at = node.document().text_pos_at(node.range().start);
    format!("line {}, column {}", at.row, at.col)
}

/// Where the frame's origin lies on the page: as written, or the bottom left corner.
fn origin(root: Node) -> Result<P2, Error> {
    let numbers = |name| -> Option<Vec<f64>> {
        let values = root.attribute(name)?.split([' ', ',']).filter(|t| !t.is_empty()).map(|t| t.parse().ok());
        values.collect::<Option<Vec<f64>>>().filter(|v| v.iter().all(|x| x.is_finite()))
    };
    let mm = |name| -> Option<f64> { root.attribute(name)?.strip_suffix("mm")?.trim().parse().ok() };
    let not_true_size = || Error::NotTrueSize { place: place(root) };
    let view: [f64; 4] = numbers("viewBox").and_then(|v| v.try_into().ok()).ok_or_else(not_true_size)?;
    let size = [mm("width").ok_or_else(not_true_size)?, mm("height").ok_or_else(not_true_size)?];
    if (0..2).any(|i| (size[i] - view[2 + i]).abs() > 1e-3) {
        return Err(not_true_size());
    }
    match numbers("data-origin-mm").as_deref() {
        Some([x, y]) => Ok(P2::new(*x, *y)),
        _ => Ok(P2::new(view[0], view[1] + view[3])),
    }
}

fn read_path(node: Node, piece: &str, origin: P2, paths: &mut Vec<DrawnPath>) -> Result<(), Error> {
    if !node.has_tag_name("path") {
        return Err(Error::Stray { place: place(node), element: node.tag_name().name().to_owned() });
    }
    let class = node.attribute("class").unwrap_or_default();
    let role = Role::ALL.into_iter().find(|r| r.class() == class).ok_or_else(|| Error::Class {
        place: place(node),
        piece: piece.to_owned(),
        class: class.to_owned(),
    })?;
    let kerf = match node.attribute("data-kerf") {
        None => role.usual_kerf(),
        Some(word) => KerfSide::ALL.into_iter().find(|k| k.word() == word).ok_or_else(|| Error::Kerf {
            place: place(node),
            piece: piece.to_owned(),
            word: word.to_owned(),
        })?,
    };
    let joint = node.attribute("data-joint").map(str::to_owned);
    let curves = parse_path_data(node.attribute("d").unwrap_or_default(), origin).map_err(|bad| Error::PathData {
        place: place(node),
        piece: piece.to_owned(),
        at: bad.at,
        what: bad.what,
    })?;
    paths.extend(curves.into_iter().map(|path| DrawnPath { path, role, kerf, joint: joint.clone() }));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{piece_svg, sheet_svg};
    use crate::geom::{Path, PathVertex};
    use proptest::prelude::*;

    /// A curve whose arcs turn less than a third of a circle, so that it comes back corner by corner.
    fn curve() -> impl Strategy<Value = Path> {
        let corner = (-200.0..200.0f64, -200.0..200.0f64, prop_oneof![Just(0.0), -0.55..0.55f64]);
        (prop::collection::vec(corner, 2..7), any::<bool>()).prop_map(|(corners, closed)| {
            let vertices = corners.into_iter().map(|(x, y, bulge)| PathVertex { point: P2::new(x, y), bulge });
            Path { vertices: vertices.collect(), closed }
        })
    }

    fn drawing() -> impl Strategy<Value = Drawing> {
        let joint = prop::option::of("[A-Z][0-9]{1,2}");
        let path =
            (curve(), 0..Role::ALL.len(), 0..KerfSide::ALL.len(), joint).prop_map(|(path, role, kerf, joint)| {
                DrawnPath { path, role: Role::ALL[role], kerf: KerfSide::ALL[kerf], joint }
            });
        ("[A-Za-z0-9<>&\"' \té]{0,8}", prop::collection::vec(path, 0..6))
            .prop_map(|(name, paths)| Drawing { name, paths })
    }

    fn same(a: &Drawing, b: &Drawing) -> Result<(), TestCaseError> {
        prop_assert_eq!(&a.name, &b.name);
        prop_assert_eq!(a.paths.len(), b.paths.len());
        for (p, q) in a.paths.iter().zip(&b.paths) {
            prop_assert_eq!((p.role, p.kerf, &p.joint, p.path.closed), (q.role, q.kerf, &q.joint, q.path.closed));
            prop_assert_eq!(p.path.vertices.len(), q.path.vertices.len());
            // An open path's last bulge leads nowhere and is not drawn.
            let drawn = p.path.vertices.len() - usize::from(!p.path.closed);
            for (i, (v, w)) in p.path.vertices.iter().zip(&q.path.vertices).enumerate() {
                prop_assert!((v.point - w.point).norm() < 1e-3);
                let chord = (p.path.vertices[(i + 1) % p.path.vertices.len()].point - v.point).norm();
                prop_assert!(i >= drawn || (v.bulge - w.bulge).abs() * chord < 1e-3, "{v:?} {w:?}");
            }
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn a_piece_comes_back_as_it_was_written(drawing in drawing(), margin in 0.0..20.0f64) {
            let read = read_svg(&piece_svg(&drawing, margin)).map_err(|e| TestCaseError::fail(e.to_string()))?;
            prop_assert_eq!(read.len(), 1);
            same(&drawing, &read[0])?;
        }

        #[test]
        fn a_sheet_comes_back_with_its_paths_in_the_order_they_are_made(mut pieces in prop::collection::vec(drawing(), 0..4)) {
            let read = read_svg(&sheet_svg(400.0, 300.0, &pieces)).map_err(|e| TestCaseError::fail(e.to_string()))?;
            prop_assert_eq!(read.len(), pieces.len());
            for (piece, read) in pieces.iter_mut().zip(&read) {
                piece.paths.sort_by_key(|p| p.role.operation());
                same(piece, read)?;
            }
        }
    }

    const PAGE: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="10mm" height="10mm" viewBox="0 0 10 10">"#;

    fn refusal(inside: &str) -> String {
        read_svg(&format!("{PAGE}\n{inside}\n</svg>")).unwrap_err().to_string()
    }

    #[test]
    fn copies_of_a_piece_stay_apart() {
        let line = |x| DrawnPath {
            path: Path::open([P2::new(x, 0.0), P2::new(x, 9.0)]),
            role: Role::Slit,
            kerf: KerfSide::On,
            joint: None,
        };
        let copy = |x| Drawing { name: "A1".into(), paths: vec![line(x)] };
        let sheet = [copy(1.0), copy(5.0)];
        assert_eq!(read_svg(&sheet_svg(10.0, 10.0, &sheet)).unwrap(), sheet);
    }

    #[test]
    fn a_page_without_an_origin_has_it_at_the_bottom_left() {
        let text = format!("{PAGE}<g class='piece' data-name='A'><path class='mark' d='M1 9 V4'/></g></svg>");
        let read = read_svg(&text).unwrap();
        assert_eq!(read[0].paths[0].path, Path::open([P2::new(1.0, 1.0), P2::new(1.0, 6.0)]));
    }

    #[test]
    fn refusals_name_the_place_and_the_piece() {
        let piece = |inside: &str| refusal(&format!("<g class='piece' data-name='A1'>\n{inside}</g>"));
        assert!(piece("<path class='slit' d='M1 1 Q2 2 3 3'/>").contains("line 3, column 1"));
        assert!(piece("<path class='slit' d='M1 1 Q2 2 3 3'/>").contains("\"A1\""));
        assert!(piece("<path class='tab' d='M1 1'/>").contains("\"tab\""));
        assert!(piece("<path class='slit' data-kerf='up' d='M1 1'/>").contains("\"up\""));
        assert!(piece("<circle r='3'/>").contains("<circle>"));
        assert!(piece("<path transform='scale(2)' class='slit' d='M1 1'/>").contains("transform"));
        assert!(refusal("<g class='piece'/>").contains("data-name"));
        assert!(refusal("<path class='slit' d='M1 1'/>").contains("line 2"));
        assert!(refusal("<g>").contains("XML"));
    }

    #[test]
    fn a_page_that_is_not_at_true_size_is_refused() {
        for page in ["<svg width='10mm' height='10mm'/>", "<svg width='9mm' height='10mm' viewBox='0 0 10 10'/>"] {
            assert!(read_svg(page).unwrap_err().to_string().contains("true size"), "{page}");
        }
        assert!(read_svg("<svg width='10' height='10' viewBox='0 0 10 10'/>").is_err());
    }
}
