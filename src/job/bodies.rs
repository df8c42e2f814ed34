//! What each part of a design is made of: bodies of the mesh, or what split planes leave.

use super::Error;
use crate::design::{Design, Split};
use crate::mesh::{Parting, TriMesh, components, parting_plane, split, together};
use crate::progress::Warning;
use std::collections::BTreeMap;

/// A mesh for each part, in the design's order.
#[derive(Debug, Clone)]
pub(super) struct Bodies {
    /// Part by part; none for a part that has its shape from elsewhere.
    pub meshes: Vec<Option<TriMesh>>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// Takes the shape apart as the design says. Parts made of bodies that pass through each other are parted by the plane in which their surfaces cross.
pub(super) fn bodies(design: &Design, whole: Option<&TriMesh>) -> Result<Bodies, Error> {
    let Some(whole) = whole else {
        return Ok(Bodies { meshes: vec![None; design.parts.len()], warnings: Vec::new() });
    };
    let mut pieces: BTreeMap<String, TriMesh> = BTreeMap::new();
    let all = if design.parts.iter().any(|p| !p.bodies.is_empty()) { components(whole) } else { Vec::new() };
    for part in design.parts.iter().filter(|p| !p.bodies.is_empty()) {
        let body = |n: &usize| {
            all.get(n - 1).ok_or_else(|| Error::Apart {
                what: format!("part {}: body {n}", part.name),
                problem: format!("is not there: the mesh has {}, counted in the file's order", all.len()),
            })
        };
        let own = part.bodies.iter().map(body).collect::<Result<Vec<&TriMesh>, Error>>()?;
        pieces.insert(part.name.clone(), together(&own));
    }
    for (i, cut) in design.splits.iter().enumerate() {
        apply(i + 1, cut, &mut pieces, whole)?;
    }
    let mut meshes: Vec<TriMesh> = design.parts.iter().map(|p| pieces.get(&p.name).unwrap_or(whole).clone()).collect();
    let mut warnings = Vec::new();
    for name in pieces.keys().filter(|name| !design.parts.iter().any(|p| p.name == **name)) {
        warnings.push(Warning::new(
            "piece-unused",
            format!("a split gives '{name}', which no part takes: it is left out. Add a [[part]] with name = \"{name}\" to make it"),
        ));
    }
    let own: Vec<usize> = (0..meshes.len()).filter(|i| pieces.contains_key(&design.parts[*i].name)).collect();
    for (k, a) in own.iter().copied().enumerate() {
        for b in own[k + 1..].iter().copied() {
            match parting_plane(&meshes[a], &meshes[b]) {
                Parting::Apart => {}
                Parting::Plane { origin, normal } => {
                    let (behind, ahead) =
                        (split(&meshes[a], origin, normal).behind, split(&meshes[b], origin, normal).ahead);
                    (meshes[a], meshes[b]) = (behind, ahead);
                }
                Parting::Entangled => {
                    let (a, b) = (&design.parts[a].name, &design.parts[b].name);
                    let message = format!(
                        "parts {a} and {b} pass through each other and no plane parts them: their strips would collide. Split one of them where they meet"
                    );
                    warnings.push(Warning::new("parts-overlap", message).in_part(a));
                }
            }
        }
    }
    let meshes = meshes.into_iter().zip(&design.parts).map(|(mesh, part)| part.width_mm.is_none().then_some(mesh));
    Ok(Bodies { meshes: meshes.collect(), warnings })
}

fn apply(number: usize, cut: &Split, pieces: &mut BTreeMap<String, TriMesh>, whole: &TriMesh) -> Result<(), Error> {
    let (origin, normal) = cut.plane();
    let source = cut.part.as_ref().and_then(|name| pieces.remove(name)).unwrap_or_else(|| whole.clone());
    let halves = split(&source, origin, normal);
    if halves.behind.triangles.is_empty() || halves.ahead.triangles.is_empty() {
        let along = source.vertices.iter().map(|p| (p - origin).dot(&normal));
        let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), h| (lo.min(h), hi.max(h)));
        let source = cut.part.as_ref().map_or("the shape".to_owned(), |name| format!("'{name}'"));
        return Err(Error::Apart {
            what: format!("split {number}"),
            problem: format!(
                "passes {source} by: move its origin along its normal by more than {lo:.1} and less than {hi:.1} mm"
            ),
        });
    }
    let [behind, ahead] = cut.into.clone();
    pieces.insert(behind, halves.behind);
    pieces.insert(ahead, halves.ahead);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{P3, V3};
    use crate::mesh::contact;
    use crate::mesh::samples::{cuboid, sphere};

    fn design(body: &str) -> Design {
        let head = "schema = 1\nmachine = \"m\"\nmaterial = \"p\"\n[mesh]\nfile = \"a.obj\"\n";
        Design::parse("d.toml", &format!("{head}{body}")).unwrap()
    }

    const UP_AT_40: &str = "[[split]]\norigin_mm = [0, 40, 0]\nnormal = [0, 2, 0]\ninto = [\"A\", \"B\"]\n";

    #[test]
    fn splits_apply_in_order_and_what_no_part_takes_is_told() {
        let cube = cuboid(P3::origin(), V3::repeat(100.0));
        let second = "[[split]]\npart = \"B\"\norigin_mm = [70, 0, 0]\nnormal = [1, 0, 0]\ninto = [\"B\", \"rest\"]\n";
        let parts = "[[part]]\nname = \"B\"\n[[part]]\nname = \"A\"\n[[part]]\nname = \"whole\"\n";
        let found = bodies(&design(&format!("{UP_AT_40}{second}{parts}")), Some(&cube)).unwrap();
        let volumes: Vec<f64> = found.meshes.iter().flatten().map(|m| (m.volume() / 1e3).round()).collect();
        assert_eq!(volumes, [420.0, 400.0, 1000.0]);
        assert_eq!(found.warnings.iter().map(|w| w.code).collect::<Vec<_>>(), ["piece-unused"]);
        let beside = UP_AT_40.replace("[0, 40, 0]", "[0, -10, 0]");
        let error = bodies(&design(&format!("{beside}{parts}")), Some(&cube)).unwrap_err().to_string();
        assert_eq!(
            error,
            "split 1 passes the shape by: move its origin along its normal by more than 10.0 and less than 110.0 mm"
        );
    }

    #[test]
    fn bodies_that_overlap_are_parted_and_then_touch() {
        let two = together(&[&sphere(P3::origin(), 30.0, 32), &sphere(P3::new(40.0, 0.0, 0.0), 20.0, 32)]);
        let parts = "[[part]]\nname = \"A\"\nbodies = [2]\n[[part]]\nname = \"B\"\nbodies = [1]\n";
        let found = bodies(&design(parts), Some(&two)).unwrap();
        assert!(found.warnings.is_empty());
        assert!(found.meshes.iter().flatten().all(TriMesh::is_closed));
        let lid = contact(found.meshes[0].as_ref().unwrap(), found.meshes[1].as_ref().unwrap()).unwrap();
        // Two balls meet in the plane at (40^2 + 30^2 - 20^2) / 80 from the larger one's middle.
        assert!((lid.center - P3::new(26.25, 0.0, 0.0)).norm() < 0.5, "{}", lid.center);
        let missing = bodies(&design(&parts.replace("[2]", "[3]")), Some(&two)).unwrap_err().to_string();
        assert_eq!(missing, "part A: body 3 is not there: the mesh has 2, counted in the file's order");
    }
}
