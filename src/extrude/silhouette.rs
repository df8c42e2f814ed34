//! Lines parallel to the normal against the triangles, found through a grid over the plane.

use super::Span;
use crate::cut::PlaneFrame;
use crate::geom::{P2, Rect, V2, cross};
use crate::mesh::TriMesh;

/// The grid has at most this many cells along its longer side.
const MAX_CELLS: usize = 512;
/// The grid is made coarser until triangles are listed this many times on average: memory stays in proportion to the mesh.
const MAX_LISTINGS: usize = 8;
/// A line whose crossings contradict each other (it may graze an edge) is tried again this far aside, as fractions of the mesh's size:
/// far above round-off, far below a laser's kerf.
const ASIDE: [(f64, f64); 4] = [(0.0, 0.0), (1e-7, 0.3e-7), (-0.7e-7, 1.1e-7), (0.2e-6, -1.7e-6)];

/// The mesh in plane coordinates, ready to be looked through.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Silhouette {
    /// Corners in the plane, and how far before it they lie, mm.
    corners: Vec<(P2, f64)>,
    triangles: Vec<[u32; 3]>,
    bounds: Rect,
    /// Cells along u and v, and their side.
    cells: [usize; 2],
    side: f64,
    /// Triangles of cell c: `listed[starts[c]..starts[c + 1]]`.
    starts: Vec<u32>,
    listed: Vec<u32>,
}

impl Silhouette {
    pub(super) fn new(mesh: &TriMesh, frame: &PlaneFrame) -> Silhouette {
        let corners: Vec<(P2, f64)> = mesh.vertices.iter().map(|p| (frame.to_plane(*p), frame.height_of(*p))).collect();
        let bounds = Rect::around(corners.iter().map(|(p, _)| p));
        let mut silhouette = Silhouette {
            corners,
            triangles: mesh.triangles.clone(),
            bounds,
            cells: [1, 1],
            side: 1.0,
            starts: Vec::new(),
            listed: Vec::new(),
        };
        let mut along = MAX_CELLS.min(1 + (mesh.triangles.len() as f64).sqrt() as usize);
        loop {
            silhouette.set_grid(along);
            let listings: usize = (0..mesh.triangles.len()).map(|t| silhouette.cells_of(t).count()).sum();
            if along == 1 || listings <= MAX_LISTINGS * mesh.triangles.len() {
                break;
            }
            along = along.div_ceil(2);
        }
        silhouette.list();
        silhouette
    }

    fn set_grid(&mut self, along: usize) {
        let longest = self.bounds.width().max(self.bounds.height());
        self.side = if longest > 0.0 { longest / along as f64 } else { 1.0 };
        let count = |extent: f64| ((extent / self.side) as usize + 1).min(along + 1);
        self.cells = [count(self.bounds.width()), count(self.bounds.height())];
    }

    fn cell(&self, p: P2) -> [usize; 2] {
        let place = (p - self.bounds.min) / self.side;
        // Casting clamps at 0.
        [(place.x as usize).min(self.cells[0] - 1), (place.y as usize).min(self.cells[1] - 1)]
    }

    /// Cells that the box of triangle `t` meets.
    fn cells_of(&self, t: usize) -> impl Iterator<Item = usize> + use<> {
        let points = self.triangles[t].map(|i| self.corners[i as usize].0);
        let around = Rect::around(&points);
        let (lo, hi) = (self.cell(around.min), self.cell(around.max));
        let across = self.cells[0];
        (lo[1]..=hi[1]).flat_map(move |row| (lo[0]..=hi[0]).map(move |column| row * across + column))
    }

    fn list(&mut self) {
        let mut starts = vec![0u32; self.cells[0] * self.cells[1] + 1];
        for t in 0..self.triangles.len() {
            self.cells_of(t).for_each(|cell| starts[cell + 1] += 1);
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let mut listed = vec![0; starts.last().copied().unwrap_or(0) as usize];
        for t in 0..self.triangles.len() {
            for cell in self.cells_of(t) {
                listed[next[cell] as usize] = t as u32;
                next[cell] += 1;
            }
        }
        (self.starts, self.listed) = (starts, listed);
    }

    /// Length of the line through `p` that lies inside the mesh but not in the stretch that holds the plane, mm. Nothing where the mesh is open there.
    pub(super) fn beyond_at(&self, p: P2) -> f64 {
        let crossings = self.crossings(p);
        if crossings.iter().map(|c| c.winding).sum::<i32>() != 0 {
            return 0.0;
        }
        stretches(&crossings).iter().filter(|s| !s.holds_plane()).map(Span::width).sum()
    }

    /// The stretch of the line through `p` that lies inside the mesh and holds the plane; none where the line misses or the mesh lies
    /// wholly before or behind the plane. Where the mesh is open and the line leaves less often than it enters (or the other way round),
    /// the nearest way in behind the plane and the nearest way out before it count.
    pub(super) fn span_at(&self, p: P2) -> Option<Span> {
        let size = self.bounds.width().max(self.bounds.height());
        let tries = ASIDE.map(|(u, v)| p + V2::new(u, v) * size);
        for at in tries {
            let crossings = self.crossings(at);
            if crossings.iter().map(|c| c.winding).sum::<i32>() == 0 {
                return around_plane(&crossings);
            }
        }
        nearest(&self.crossings(p))
    }

    /// Where the line through `p` meets the mesh, in order along the normal.
    fn crossings(&self, p: P2) -> Vec<Crossing> {
        if !self.bounds.holds(&Rect::around([&p]), 0.0) {
            return Vec::new();
        }
        let [column, row] = self.cell(p);
        let cell = row * self.cells[0] + column;
        let here = &self.listed[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        let mut found: Vec<Crossing> = here.iter().filter_map(|t| self.crossing(*t as usize, p)).collect();
        found.sort_by(|a, b| a.height.total_cmp(&b.height).then(b.winding.cmp(&a.winding)));
        found
    }

    /// Triangles that face along the normal are left through, those that face against it are entered through. Sides are half-open, as if
    /// the line stood a hair aside, so that a line through a shared edge meets one of its triangles.
    fn crossing(&self, t: usize, p: P2) -> Option<Crossing> {
        let corners = self.triangles[t];
        let at = |k: usize| self.corners[corners[k % 3] as usize];
        let sides = [0, 1, 2].map(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let side = side(self.corners[a.min(b) as usize].0, self.corners[a.max(b) as usize].0, p);
            if a < b { side } else { (-side.0, !side.1) }
        });
        let left = sides.map(|(_, left)| left);
        if left[0] != left[1] || left[1] != left[2] {
            return None;
        }
        let whole: f64 = sides.iter().map(|(area, _)| area).sum();
        // A triangle seen edge-on has no inside.
        if whole == 0.0 {
            return None;
        }
        let height = (0..3).map(|k| sides[(k + 1) % 3].0 * at(k).1).sum::<f64>() / whole;
        Some(Crossing { height, winding: if left[0] { -1 } else { 1 } })
    }
}

/// Twice the area of a, b, p, and whether p lies left of a b; on the line, whether a point a hair up and a smaller hair right would.
/// Called with each edge's corners in the same order for both of its triangles, so that they agree.
fn side(a: P2, b: P2, p: P2) -> (f64, bool) {
    let ab = b - a;
    let area = cross(ab, p - a);
    let left = if area != 0.0 {
        area > 0.0
    } else if ab.x != 0.0 {
        ab.x > 0.0
    } else {
        ab.y < 0.0
    };
    (area, left)
}

/// A place where a line meets the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Crossing {
    /// Along the normal from the plane, mm.
    height: f64,
    /// +1 on the way in, -1 on the way out.
    winding: i32,
}

/// The stretch with a winding number other than 0 that holds height 0.
fn around_plane(crossings: &[Crossing]) -> Option<Span> {
    stretches(crossings).into_iter().find(Span::holds_plane)
}

/// Stretches with a winding number other than 0, in order along the normal. Stretches that touch are one.
fn stretches(crossings: &[Crossing]) -> Vec<Span> {
    let mut winding = 0;
    let mut stretches: Vec<Span> = Vec::new();
    for c in crossings {
        if winding == 0 {
            match stretches.last() {
                Some(last) if last.hi == c.height => {}
                _ => stretches.push(Span { lo: c.height, hi: c.height }),
            }
        }
        winding += c.winding;
        if let Some(last) = stretches.last_mut() {
            last.hi = c.height;
        }
    }
    stretches
}

/// From the nearest way in behind the plane to the nearest way out before it.
fn nearest(crossings: &[Crossing]) -> Option<Span> {
    let lo = crossings.iter().rev().find(|c| c.height <= 0.0 && c.winding > 0)?.height;
    let hi = crossings.iter().find(|c| c.height >= 0.0 && c.winding < 0)?.height;
    Some(Span { lo, hi })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut::Plane;
    use crate::geom::{P3, V3};
    use crate::mesh::samples::{cuboid, inside_out, sphere, together};
    use proptest::prelude::*;

    fn seen(mesh: &TriMesh, normal: V3) -> Silhouette {
        Silhouette::new(mesh, &PlaneFrame::new(&Plane { origin: P3::origin(), normal }, V3::y()))
    }

    fn close(span: Option<Span>, lo: f64, hi: f64) -> bool {
        span.is_some_and(|s| (s.lo - lo).abs() < 1e-4 && (s.hi - hi).abs() < 1e-4)
    }

    #[test]
    fn a_line_through_edges_and_corners_meets_each_side_once() {
        let cube = seen(&cuboid(P3::new(-5.0, -5.0, -3.0), V3::repeat(10.0)), V3::z());
        // On the diagonal of both faces, in the open, on the outline's corner and beside.
        for (u, v) in [(0.0, 0.0), (1.25, 1.25), (2.0, -3.5), (-4.0, 4.0)] {
            assert!(close(cube.span_at(P2::new(u, v)), -3.0, 7.0), "{u} {v}");
        }
        assert_eq!(cube.span_at(P2::new(5.1, 0.0)), None);
        let ball = seen(&sphere(P3::origin(), 5.0, 16), V3::y());
        assert!(close(ball.span_at(P2::origin()), -5.0, 5.0), "through both poles");
    }

    #[test]
    fn the_stretch_that_holds_the_plane_is_taken_and_overlaps_are_one() {
        let at = |z: f64, depth: f64| cuboid(P3::new(-5.0, -5.0, z), V3::new(10.0, 10.0, depth));
        let p = P2::new(1.0, 2.0);
        assert!(close(seen(&together(&[at(-9.0, 3.0), at(-2.0, 5.0), at(7.0, 1.0)]), V3::z()).span_at(p), -2.0, 3.0));
        assert!(close(seen(&together(&[at(-2.0, 5.0), at(1.0, 8.0), at(9.0, 1.0)]), V3::z()).span_at(p), -2.0, 10.0));
        let hollow = together(&[at(-10.0, 20.0), inside_out(cuboid(P3::new(-3.0, -3.0, 4.0), V3::new(6.0, 6.0, 3.0)))]);
        assert!(close(seen(&hollow, V3::z()).span_at(p), -10.0, 4.0));
        assert_eq!(seen(&at(1.0, 5.0), V3::z()).span_at(p), None);
        assert_eq!(seen(&together(&[at(-9.0, 3.0), at(-2.0, 5.0), at(7.0, 1.0)]), V3::z()).beyond_at(p), 4.0);
        assert_eq!(seen(&at(-2.0, 5.0), V3::z()).beyond_at(p), 0.0);
    }

    #[test]
    fn an_open_mesh_uses_what_is_there() {
        let mut open = cuboid(P3::new(-5.0, -5.0, -3.0), V3::repeat(10.0));
        open.triangles.retain(|t| !t.iter().all(|i| open.vertices[*i as usize].z > 0.0));
        assert_eq!(seen(&open, V3::z()).span_at(P2::new(1.0, 2.0)), None);
        let doubled = together(&[open, cuboid(P3::new(-5.0, -5.0, -1.0), V3::repeat(3.0))]);
        assert!(close(seen(&doubled, V3::z()).span_at(P2::new(-4.0, -3.0)), -1.0, 2.0));
    }

    proptest! {
        #[test]
        fn a_ball_is_as_thick_as_pythagoras_says(
            n in prop::array::uniform3(-1.0..1.0f64), u in -49.0..49.0f64, v in -49.0..49.0f64,
        ) {
            prop_assume!(V3::from(n).norm() > 0.1 && u.hypot(v) < 45.0);
            let ball = seen(&sphere(P3::origin(), 50.0, 64), V3::from(n).normalize());
            let half = (2500.0 - u * u - v * v).sqrt();
            let span = ball.span_at(P2::new(u, v)).unwrap();
            prop_assert!((span.hi - half).abs() < 0.5 && (span.lo + half).abs() < 0.5, "{span:?} {half}");
        }

        #[test]
        fn lines_through_corners_and_edges_of_a_ball_never_miss(corner in 0usize..482, t in 0.0..1.0f64, other in 0usize..3) {
            let mesh = sphere(P3::origin(), 50.0, 32);
            let ball = seen(&mesh, V3::new(0.3, 0.1, 1.0).normalize());
            let triangle = mesh.triangles[corner * 2 % mesh.triangles.len()];
            let (a, b) = (ball.corners[triangle[other] as usize].0, ball.corners[triangle[(other + 1) % 3] as usize].0);
            let p = P2::from(a.coords * 0.98 + (b - a) * (0.98 * t));
            prop_assert!(ball.span_at(p).is_some_and(|s| s.width() > 5.0));
        }
    }
}
