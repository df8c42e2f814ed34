//! The bodies a mesh consists of.

use super::{TriMesh, edges, weld};

/// Bodies of `mesh`: triangles that hang together by edges, in the file's order. A hollow (a closed surface that faces inward) belongs to the smallest body whose box
/// holds it.
pub fn components(mesh: &TriMesh) -> Vec<TriMesh> {
    let (number, count) = edges::groups(mesh.triangles.len(), &edges::of(&mesh.triangles), |_| true);
    let mut groups: Vec<Vec<[u32; 3]>> = vec![Vec::new(); count];
    for (triangle, group) in mesh.triangles.iter().zip(&number) {
        groups[*group].push(*triangle);
    }
    let pieces: Vec<TriMesh> = groups.into_iter().map(|triangles| part(mesh, triangles)).collect();
    let hollow: Vec<bool> = pieces.iter().map(|p| p.is_closed() && p.volume() < 0.0).collect();
    let mut bodies: Vec<(usize, TriMesh)> =
        (0..count).filter(|i| !hollow[*i]).map(|i| (i, pieces[i].clone())).collect();
    for inner in (0..count).filter(|i| hollow[*i]) {
        let (lo, hi) = pieces[inner].bounds();
        let holds = |body: &TriMesh| {
            let (from, to) = body.bounds();
            (0..3).all(|k| from[k] <= lo[k] && hi[k] <= to[k])
        };
        let smallest = bodies.iter_mut().filter(|(_, b)| holds(b)).min_by(|a, b| a.1.volume().total_cmp(&b.1.volume()));
        match smallest {
            Some((_, body)) => *body = together(&[body, &pieces[inner]]),
            None => bodies.push((inner, pieces[inner].clone())),
        }
    }
    bodies.sort_by_key(|(i, _)| *i);
    bodies.into_iter().map(|(_, body)| body).collect()
}

fn part(mesh: &TriMesh, triangles: Vec<[u32; 3]>) -> TriMesh {
    let soup = weld::compact(&mesh.vertices, triangles);
    TriMesh { vertices: soup.vertices, triangles: soup.triangles, up: mesh.up }
}

/// Several meshes with the same up as one; nothing is merged. At least one is needed.
pub fn together(meshes: &[&TriMesh]) -> TriMesh {
    let mut all = TriMesh { vertices: Vec::new(), triangles: Vec::new(), up: meshes[0].up };
    for mesh in meshes {
        let shift = all.vertices.len() as u32;
        all.vertices.extend(&mesh.vertices);
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| i + shift)));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::samples::{cuboid, inside_out, sphere};
    use super::*;
    use crate::geom::{P3, V3};

    #[test]
    fn bodies_come_in_the_files_order_and_hollows_stay_in_theirs() {
        let outer = cuboid(P3::origin(), V3::repeat(10.0));
        let hollow = inside_out(cuboid(P3::new(2.0, 2.0, 2.0), V3::repeat(3.0)));
        let ball = sphere(P3::new(50.0, 0.0, 0.0), 8.0, 12);
        let bodies = components(&together(&[&hollow, &ball, &outer]));
        assert_eq!(bodies.len(), 2);
        assert_eq!(bodies[0], ball);
        assert!((bodies[1].volume() - 973.0).abs() < 1e-9);
    }
}
