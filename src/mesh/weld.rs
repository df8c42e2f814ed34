//! Corners that are meant to be one become one; triangles that vanish or repeat are dropped.

use super::load::Soup;
use crate::geom::{P3, V3};
use std::collections::{HashMap, HashSet};

/// Corners closer than this fraction of the mesh's diagonal are one. STL repeats every corner in f32 (error 6e-8 of the coordinate), and
/// text exporters print six digits: 1e-5 is above both, and at 200 mm it is 2 um, below the 12.5 um step of a laser cutter's axis.
pub(super) const TOLERANCE: f64 = 1e-5;

/// What [`weld`] took out.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Dropped {
    /// Triangles with two corners in one place.
    pub(super) degenerate: usize,
    /// Triangles there twice, walked the same way.
    pub(super) repeated: usize,
    /// Back sides of a surface that has every triangle on both sides.
    pub(super) back_sides: usize,
}

/// Merges corners within `tolerance` (same unit as the coordinates; 0 merges equal ones only), drops what that leaves without area or
/// says twice, and drops corners no triangle uses.
pub(super) fn weld(soup: Soup, tolerance: f64) -> (Soup, Dropped) {
    let merged = merge(&soup.vertices, tolerance);
    let mut dropped = Dropped::default();
    let mut seen = HashSet::new();
    let mut triangles = Vec::with_capacity(soup.triangles.len());
    for triangle in soup.triangles {
        let t = triangle.map(|i| merged[i as usize]);
        if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
            dropped.degenerate += 1;
        } else if seen.insert(turned(t)) {
            triangles.push(t);
        } else {
            dropped.repeated += 1;
        }
    }
    // Exporters of double-sided surfaces write each triangle twice, back to back: a closed body then encloses nothing. A few such pairs
    // are walls between touching bodies and stay.
    let twin = |t: [u32; 3]| turned([t[0], t[2], t[1]]);
    let pairs = triangles.iter().filter(|t| seen.contains(&twin(**t))).count();
    if 2 * pairs > triangles.len() {
        let before = triangles.len();
        let mut kept = HashSet::new();
        triangles.retain(|t| !kept.contains(&twin(*t)) && kept.insert(turned(*t)));
        dropped.back_sides = before - triangles.len();
    }
    (compact(&soup.vertices, triangles), dropped)
}

/// The same triangle, starting at its smallest index.
fn turned(t: [u32; 3]) -> [u32; 3] {
    match (0..3).min_by_key(|i| t[*i]) {
        Some(1) => [t[1], t[2], t[0]],
        Some(2) => [t[2], t[0], t[1]],
        _ => t,
    }
}

/// For each point the index of the one it merges with: the nearest earlier point that stands for itself and lies within `tolerance`.
fn merge(points: &[P3], tolerance: f64) -> Vec<u32> {
    let mut stands_for = Vec::with_capacity(points.len());
    let mut exact: HashMap<[u64; 3], u32> = HashMap::new();
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    // Cells much wider than the tolerance: the ball around a point then mostly lies in one of them.
    let size = 16.0 * tolerance;
    let cell = |p: V3| -> [i64; 3] { (p / size).map(|x| x.floor() as i64).into() };
    for (i, p) in points.iter().enumerate() {
        let bits = p.coords.map(|x| (x + 0.0).to_bits()).into();
        if let Some(same) = exact.get(&bits) {
            stands_for.push(*same);
            continue;
        }
        let mut target = i as u32;
        if tolerance > 0.0 {
            let (lo, hi) = (cell(p.coords.add_scalar(-tolerance)), cell(p.coords.add_scalar(tolerance)));
            let mut nearest = tolerance;
            for x in lo[0]..=hi[0] {
                for y in lo[1]..=hi[1] {
                    for z in lo[2]..=hi[2] {
                        for other in cells.get(&[x, y, z]).into_iter().flatten() {
                            let distance = (p - points[*other as usize]).norm();
                            if distance < nearest || (distance == nearest && *other < target) {
                                (nearest, target) = (distance, *other);
                            }
                        }
                    }
                }
            }
            if target == i as u32 {
                cells.entry(cell(p.coords)).or_default().push(target);
            }
        }
        exact.insert(bits, target);
        stands_for.push(target);
    }
    stands_for
}

/// Drops unused vertices; the others keep their order.
pub(super) fn compact(vertices: &[P3], mut triangles: Vec<[u32; 3]>) -> Soup {
    let mut used = vec![false; vertices.len()];
    triangles.iter().flatten().for_each(|i| used[*i as usize] = true);
    let mut number = vec![0; vertices.len()];
    let mut kept = Vec::new();
    for (i, p) in vertices.iter().enumerate().filter(|(i, _)| used[*i]) {
        number[i] = kept.len() as u32;
        kept.push(*p);
    }
    triangles.iter_mut().flatten().for_each(|i| *i = number[*i as usize]);
    Soup { vertices: kept, triangles }
}

#[cfg(test)]
mod tests {
    use super::super::samples::{cuboid, inside_out, together};
    use super::*;
    use proptest::prelude::*;

    /// Every triangle with corners of its own, as STL has them.
    fn shattered(mesh: &super::super::TriMesh, shift: impl Fn(usize) -> V3) -> Soup {
        let corners = mesh.triangles.iter().flatten().enumerate();
        Soup {
            vertices: corners.map(|(k, i)| mesh.vertices[*i as usize] + shift(k)).collect(),
            triangles: (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        }
    }

    #[test]
    fn triangles_without_area_and_repeated_ones_go() {
        let vertices = vec![P3::origin(), P3::new(1.0, 0.0, 0.0), P3::new(0.0, 1.0, 0.0), P3::new(1e-7, 0.0, 0.0)];
        let soup = Soup { vertices, triangles: vec![[0, 1, 2], [0, 3, 2], [1, 2, 3]] };
        let (welded, dropped) = weld(soup, 1e-6);
        assert_eq!(welded.triangles, [[0, 1, 2]]);
        assert_eq!(dropped, Dropped { degenerate: 1, repeated: 1, back_sides: 0 });
        assert_eq!(welded.vertices.len(), 3);
    }

    #[test]
    fn a_surface_written_from_both_sides_keeps_one() {
        let cube = cuboid(P3::origin(), V3::repeat(1.0));
        let both = together(&[cube.clone(), inside_out(cube)]);
        let (welded, dropped) = weld(Soup { vertices: both.vertices, triangles: both.triangles }, 1e-6);
        assert_eq!((welded.triangles.len(), dropped.back_sides), (12, 12));
    }

    proptest! {
        #[test]
        fn a_shattered_cube_has_eight_corners_again(noise in prop::collection::vec(-0.4e-3..0.4e-3f64, 108), at in -1e3..1e3f64) {
            let cube = cuboid(P3::new(at, -at, 0.5 * at), V3::new(1.0, 2.0, 3.0));
            let soup = shattered(&cube, |k| V3::new(noise[3 * k], noise[3 * k + 1], noise[3 * k + 2]));
            let (welded, _) = weld(soup, 1.5e-3);
            prop_assert_eq!(welded.vertices.len(), 8);
            prop_assert_eq!(welded.triangles.len(), 12);
        }
    }
}
