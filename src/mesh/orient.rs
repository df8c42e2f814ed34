//! Triangles turned to one side, then outward.

use super::edges::{self, Side};
use super::load::Soup;
use super::trimesh::{area_vector, bounds, cone_volume};
use crate::geom::P3;

/// Only this many of the largest closed patches can be hollow or fill a hollow: more come from debris, and each is compared with each.
const MAX_HOLLOW: usize = 1000;

/// An open patch bulges when its volume about its own middle exceeds this fraction of area^1.5 (a hemisphere without floor has 0.13).
/// A flatter one has no outside, and keeps the file's.
const BULGE: f64 = 1e-3;

/// Makes neighbouring triangles agree across every edge that joins exactly two; where they did not, the majority of the patch decides.
/// Returns how many were turned.
pub(super) fn agree(triangles: &mut [[u32; 3]]) -> usize {
    let sides = edges::of(triangles);
    let mut across: Vec<[Option<(u32, bool)>; 3]> = vec![[None; 3]; triangles.len()];
    for edge in sides.chunk_by(|a, b| a.key == b.key) {
        if let [a, b] = edge {
            let differ = a.forward == b.forward;
            across[a.triangle as usize][usize::from(a.side)] = Some((b.triangle, differ));
            across[b.triangle as usize][usize::from(b.side)] = Some((a.triangle, differ));
        }
    }

    let mut turn: Vec<Option<bool>> = vec![None; triangles.len()];
    let mut turned = 0;
    for seed in 0..triangles.len() {
        if turn[seed].is_some() {
            continue;
        }
        turn[seed] = Some(false);
        let mut patch = vec![(seed, false)];
        let mut next = 0;
        while let Some((t, t_turns)) = patch.get(next).copied() {
            next += 1;
            for (other, differ) in across[t].into_iter().flatten() {
                let other = other as usize;
                if turn[other].is_none() {
                    turn[other] = Some(t_turns != differ);
                    patch.push((other, t_turns != differ));
                }
            }
        }
        let minority = 2 * patch.iter().filter(|(_, turns)| *turns).count() <= patch.len();
        for (t, _) in patch.iter().filter(|(_, turns)| *turns == minority) {
            triangles[*t].swap(1, 2);
            turned += 1;
        }
    }
    turned
}

/// Turns every patch (triangles joined by edges of exactly two) whole, so that it faces outward: closed patches by the sign of their
/// volume, open ones likewise when they bulge. A closed patch inside another that faces the other way in the file is a hollow and stays
/// so. Returns how many patches were turned.
pub(super) fn outward(soup: &mut Soup) -> usize {
    let sides = edges::of(&soup.triangles);
    let manifold = |edge: &[Side]| edge.len() == 2;
    let (number, count) = edges::groups(soup.triangles.len(), &sides, manifold);
    let mut is_open = vec![false; count];
    for edge in sides.chunk_by(|a, b| a.key == b.key).filter(|edge| !manifold(edge)) {
        edge.iter().for_each(|side| is_open[number[side.triangle as usize]] = true);
    }
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); count];
    number.iter().enumerate().for_each(|(t, patch)| members[*patch].push(t));
    let patches: Vec<Patch> = members.into_iter().zip(is_open).map(|(m, open)| Patch::new(soup, m, open)).collect();

    let mut turned = 0;
    for (patch, turn) in patches.iter().zip(turns(soup, &patches)) {
        if turn {
            patch.triangles.iter().for_each(|t| soup.triangles[*t].swap(1, 2));
            turned += 1;
        }
    }
    turned
}

/// For each patch, whether to turn it.
fn turns(soup: &Soup, patches: &[Patch]) -> Vec<bool> {
    let mut turn: Vec<bool> =
        patches.iter().map(|p| p.volume < 0.0 && (!p.open || p.volume < -BULGE * p.area.powf(1.5))).collect();
    let mut closed: Vec<usize> = (0..patches.len()).filter(|i| !patches[*i].open).collect();
    closed.sort_by(|a, b| patches[*b].volume.abs().total_cmp(&patches[*a].volume.abs()).then(a.cmp(b)));
    closed.truncate(MAX_HOLLOW);
    for (k, inner) in closed.iter().enumerate() {
        // The smallest body around this one is the last that holds it: they come largest first.
        if let Some(outer) = closed[..k].iter().rev().find(|outer| patches[**outer].holds(soup, &patches[*inner])) {
            let opposed = (patches[*inner].volume < 0.0) != (patches[*outer].volume < 0.0);
            let outer_faces_out = (patches[*outer].volume < 0.0) == turn[*outer];
            let faces_out = outer_faces_out != opposed;
            turn[*inner] = (patches[*inner].volume < 0.0) == faces_out;
        }
    }
    turn
}

/// Triangles that belong to one sheet.
struct Patch {
    triangles: Vec<usize>,
    open: bool,
    area: f64,
    /// About the middle of the surface, signed.
    volume: f64,
    bounds: (P3, P3),
}

impl Patch {
    fn new(soup: &Soup, triangles: Vec<usize>, open: bool) -> Patch {
        let corners = |t: &usize| soup.corners(*t);
        let area: f64 = triangles.iter().map(|t| area_vector(&corners(t)).norm()).sum();
        let middle = triangles.iter().flat_map(|t| soup.corners(*t)).fold(P3::origin(), |sum, p| sum + p.coords)
            / (3.0 * triangles.len() as f64);
        let volume = triangles.iter().map(|t| cone_volume(&corners(t), middle)).sum();
        let (lo, hi) = triangles
            .iter()
            .map(|t| bounds(&corners(t)))
            .reduce(|(lo, hi), (l, h)| (lo.inf(&l), hi.sup(&h)))
            .unwrap_or_else(|| bounds(&[]));
        Patch { triangles, open, area, volume, bounds: (lo, hi) }
    }

    /// True when `other` lies inside: its box does, and so do corners spread over it.
    fn holds(&self, soup: &Soup, other: &Patch) -> bool {
        let ((lo, hi), (l, h)) = (self.bounds, other.bounds);
        let boxed = (0..3).all(|i| lo[i] < l[i] && h[i] < hi[i]);
        let samples = other.triangles.iter().step_by(other.triangles.len().div_ceil(4).max(1));
        boxed && samples.into_iter().all(|t| self.winding(soup, soup.corners(*t)[0]) != 0)
    }

    /// How often the patch winds round `p`: crossings of the ray from `p` along x, half-open in y and z so that shared edges count once.
    fn winding(&self, soup: &Soup, p: P3) -> i32 {
        let mut winding = 0;
        for t in &self.triangles {
            let corners = soup.corners(*t);
            let mut round = 0;
            for i in 0..3 {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                if (a.z > p.z) != (b.z > p.z) && p.y < a.y + (p.z - a.z) / (b.z - a.z) * (b.y - a.y) {
                    round += if b.z > a.z { 1 } else { -1 };
                }
            }
            if round != 0 {
                let normal = area_vector(&corners);
                let reach = (corners[0] - p).dot(&normal) / normal.x;
                winding += if reach > 0.0 { round } else { 0 };
            }
        }
        winding
    }
}

#[cfg(test)]
mod tests {
    use super::super::TriMesh;
    use super::super::samples::{cuboid, inside_out, sphere, together};
    use super::*;
    use crate::geom::V3;
    use proptest::prelude::*;

    fn mended(mesh: TriMesh) -> TriMesh {
        let mut soup = Soup { vertices: mesh.vertices, triangles: mesh.triangles };
        agree(&mut soup.triangles);
        outward(&mut soup);
        TriMesh { vertices: soup.vertices, triangles: soup.triangles, up: mesh.up }
    }

    fn ball(radius: f64) -> TriMesh {
        sphere(P3::new(1.0, 2.0, 3.0), radius, 12)
    }

    proptest! {
        #[test]
        fn whatever_way_the_triangles_face_the_mesh_ends_up_outward(flips in prop::collection::vec(any::<bool>(), 120)) {
            let right = ball(10.0);
            let mut mesh = right.clone();
            for (t, flip) in mesh.triangles.iter_mut().zip(flips) {
                if flip {
                    t.swap(1, 2);
                }
            }
            let volume = mended(mesh).volume();
            prop_assert!((volume - right.volume()).abs() < 1e-9);
        }
    }

    #[test]
    fn separate_and_overlapping_bodies_all_face_outward() {
        let far = cuboid(P3::new(50.0, 0.0, 0.0), V3::repeat(10.0));
        let mesh = mended(together(&[ball(10.0), inside_out(far), ball(4.0)]));
        let expected = ball(10.0).volume() + 1000.0 + ball(4.0).volume();
        assert!((mesh.volume() - expected).abs() < 1e-9);
    }

    #[test]
    fn a_hollow_stays_hollow_even_when_the_whole_file_is_inside_out() {
        let hollow = together(&[ball(10.0), inside_out(ball(6.0)), ball(2.0)]);
        let expected = ball(10.0).volume() - ball(6.0).volume() + ball(2.0).volume();
        assert!((mended(hollow.clone()).volume() - expected).abs() < 1e-9);
        assert!((mended(inside_out(hollow)).volume() - expected).abs() < 1e-9);
    }

    #[test]
    fn an_open_bowl_faces_outward_too() {
        let mut bowl = ball(10.0);
        bowl.triangles.retain(|t| t.iter().all(|i| bowl.vertices[*i as usize].y < 4.0));
        assert!(mended(inside_out(bowl.clone())).volume() > 0.0);
        assert_eq!(mended(bowl.clone()).triangles, bowl.triangles);
    }
}
