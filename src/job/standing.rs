//! Which parts touch, which stand on the ground, and what bears what.

use crate::design::{Design, Foot};
use crate::fit::{Body, Forest, Meeting, forest};
use crate::geom::{P3, V3};
use crate::mesh::{Contact, TriMesh, contact};
use crate::progress::Warning;

/// A place where two parts touch.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Touch {
    /// The two, by number, the smaller first.
    pub parts: [usize; 2],
    /// Where.
    pub contact: Contact,
}

/// How the parts of a design stand.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Standing {
    /// Every two parts that touch.
    pub meetings: Vec<Touch>,
    /// What bears what.
    pub forest: Forest,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// Looks at how the parts' meshes lie to each other and to the ground under the whole shape.
pub(super) fn standing(design: &Design, whole: Option<&TriMesh>, meshes: &[Option<TriMesh>]) -> Standing {
    let mut meetings = Vec::new();
    for a in 0..meshes.len() {
        for b in a + 1..meshes.len() {
            if let (Some(one), Some(other)) = (&meshes[a], &meshes[b]) {
                let found = contact(one, other);
                meetings.extend(found.map(|contact| Touch { parts: [a, b], contact }));
            }
        }
    }
    let ground = whole.map_or(0.0, |m| m.height_range().0);
    let bodies: Vec<Body> = meshes
        .iter()
        .map(|mesh| match mesh {
            Some(mesh) => {
                let (lo, hi) = mesh.height_range();
                Body { center: mesh.centroid(), above_ground_mm: lo - ground, height_mm: hi - lo }
            }
            // A shape that no mesh is cut for stands on the ground by itself.
            None => Body { center: P3::origin(), above_ground_mm: 0.0, height_mm: 0.0 },
        })
        .collect();
    let places: Vec<Meeting> = meetings.iter().map(|t| Meeting { parts: t.parts, at: t.contact.center }).collect();
    let forest = forest(&bodies, &places, whole.map_or(V3::y(), |m| m.up));
    let afloat = |i: &usize| {
        let name = &design.parts[*i].name;
        let message = format!(
            "part {name} touches neither the ground nor a part that leads there: it is worked out as if it stood by itself, and nothing ties it to the others"
        );
        Warning::new("part-afloat", message).in_part(name)
    };
    let warnings = forest.afloat.iter().map(afloat).collect();
    Standing { meetings, forest, warnings }
}

impl Standing {
    /// Whether a part stands on the ground (or is taken to).
    pub fn on_the_ground(&self, part: usize) -> bool {
        self.forest.leans[part].is_empty()
    }

    /// How a part stands when nobody says: parts on others are tied to them, and one that bears others must not tip under them.
    pub fn foot(&self, part: usize, asked: Foot) -> Foot {
        let bears = self.forest.leans.iter().flatten().any(|lean| lean.on == part);
        if asked == Foot::Auto && (bears || !self.on_the_ground(part)) { Foot::Pinned } else { asked }
    }
}

impl Touch {
    /// The ends of the line along which the two parts meet in the plane through `origin` across `normal`; twice the middle where that plane passes them by.
    pub fn line(&self, origin: P3, normal: V3) -> [P3; 2] {
        self.contact.chord(origin, normal).unwrap_or([self.contact.center; 2])
    }
}
