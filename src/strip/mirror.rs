//! A piece seen from its other side.

use crate::drawing::{DrawnPath, KerfSide};
use crate::geom::{P2, Path, PathVertex};

/// Curves seen from behind: (s, w) becomes (-s, w). What lay on the left of a cut lies on its right.
pub(super) fn mirrored(paths: &[DrawnPath]) -> Vec<DrawnPath> {
    let flip = |drawn: &DrawnPath| DrawnPath {
        path: path(&drawn.path),
        kerf: match drawn.kerf {
            KerfSide::Left => KerfSide::Right,
            KerfSide::Right => KerfSide::Left,
            same => same,
        },
        ..drawn.clone()
    };
    paths.iter().map(flip).collect()
}

/// One curve; closed ones keep their sense.
fn path(path: &Path) -> Path {
    let vertex = |v: &PathVertex| PathVertex { point: P2::new(-v.point.x, v.point.y), bulge: -v.bulge };
    let flipped = Path { vertices: path.vertices.iter().map(vertex).collect(), closed: path.closed };
    if path.closed { flipped.reversed() } else { flipped }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Role;

    #[test]
    fn a_mirrored_flap_has_its_waste_on_the_other_side_and_a_contour_keeps_its_sense() {
        let bend = PathVertex { point: P2::new(1.0, 2.0), bulge: 0.3 };
        let end = PathVertex { point: P2::new(4.0, 2.0), bulge: 0.0 };
        let open = Path { vertices: vec![bend, end], closed: false };
        let drawn = |path: Path, role: Role, kerf: KerfSide| DrawnPath { path, role, kerf, joint: None };
        let contour = Path::closed([(0.0, 0.0), (5.0, 0.0), (5.0, 3.0)].map(|(x, y)| P2::new(x, y)));
        let area = contour.signed_area();
        let flipped = mirrored(&[
            drawn(open.clone(), Role::Flap, KerfSide::Left),
            drawn(contour, Role::Outline, KerfSide::Outside),
        ]);
        assert_eq!(flipped[0].kerf, KerfSide::Right);
        assert_eq!((flipped[0].path.vertices[0].point.x, flipped[0].path.vertices[0].bulge), (-1.0, -0.3));
        assert!((flipped[1].path.signed_area() - area).abs() < 1e-12);
        assert_eq!(mirrored(&flipped)[0].path, open);
    }
}
