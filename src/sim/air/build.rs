//! The first air mesh of a drawing: its constrained Delaunay triangulation, closed by infinity.

use super::triangulation::{Triangle, Triangulation};
use crate::geom::P2;
use spade::handles::FixedDirectedEdgeHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

/// Triangulates the plane round `segments` over the nodes at `x`. Nothing where segments cross, a node lies on a segment that it is no end of, or two nodes lie on each other:
/// there is no telling which side is which.
pub fn triangulate(segments: &[[usize; 2]], x: &[P2]) -> Option<Triangulation> {
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles = Vec::with_capacity(x.len());
    for (node, p) in x.iter().enumerate() {
        let handle = cdt.insert(spade::mitigate_underflow(Point2::new(p.x, p.y))).ok()?;
        if handle.index() != node {
            return None;
        }
        handles.push(handle);
    }
    for [i, j] in segments {
        if cdt.try_add_constraint(handles[*i], handles[*j]).len() != 1 {
            return None;
        }
    }

    let infinity = x.len();
    // Place of each directed edge: the triangle on its left, and the corner opposite it there.
    let mut place = vec![(usize::MAX, 0); cdt.num_directed_edges()];
    let mut corners = Vec::with_capacity(2 * x.len());
    for face in cdt.inner_faces() {
        for (k, edge) in face.adjacent_edges().into_iter().enumerate() {
            place[edge.fix().index()] = (corners.len(), (k + 2) % 3);
        }
        corners.push(face.vertices().map(|v| v.index()));
    }
    let outer: Vec<FixedDirectedEdgeHandle> =
        cdt.directed_edges().filter(|e| e.is_outer_edge()).map(|e| e.fix()).collect();
    for edge in &outer {
        place[edge.index()] = (corners.len(), 2);
        let edge = cdt.directed_edge(*edge);
        corners.push([edge.from().index(), edge.to().index(), infinity]);
    }

    let mut triangles: Vec<Triangle> =
        corners.into_iter().map(|corners| Triangle { corners, across: [0; 3], strip: [false; 3] }).collect();
    for edge in cdt.directed_edges() {
        let ((t, k), (u, _)) = (place[edge.fix().index()], place[edge.rev().fix().index()]);
        triangles[t].across[k] = u;
        triangles[t].strip[k] = edge.is_constraint_edge();
    }
    // Infinite triangles over consecutive edges of the border share the side from their common node to infinity.
    for edge in outer {
        let (t, u) = (place[edge.index()].0, place[cdt.directed_edge(edge).next().fix().index()].0);
        triangles[t].across[0] = u;
        triangles[u].across[1] = t;
    }
    Some(Triangulation::new(x.len(), triangles))
}
