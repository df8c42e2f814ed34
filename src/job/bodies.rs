//! What each part of a design is made of: bodies of the mesh, or what split planes leave.

use super::Error;
use crate::design::{Design, Split};
use crate::mesh::{Parting, TriMesh, components, parting_plane, split, together};
use crate::progress::Warning;
use std::collections::BTreeMap;

/// A mesh for each part, in the design's order.
#[derive(Debug, Clone)]
pub(super) struct Bodies {
    /// Part by part.
    pub meshes: Vec<TriMesh>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// Takes the shape apart as the design says. Parts made of bodies that pass through each other are parted by the plane in which their surfaces cross.
pub(super) fn bodies(design: &Design, whole: &TriMesh) -> Result<Bodies, Error> {
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
    Ok(Bodies { meshes, warnings })
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
