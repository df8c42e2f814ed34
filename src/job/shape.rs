//! What a part is to fill: an outline cut out of the mesh, one that is given, or the one a given stack has by itself.

use super::Error;
use super::settings::Setup;
use crate::cut::{self, Outline, Plane, PlaneFrame, cut, default_plane};
use crate::design::{OutlineSource, PartDesign, Stack};
use crate::drawing;
use crate::extrude::Extruder;
use crate::fit::own_outline;
use crate::geom::{P2, P3, V3, signed_area};
use crate::mesh::TriMesh;
use crate::progress::Warning;
use crate::ruffle::{Drawn, uniform_stack};
use std::path::Path;

/// A part's shape.
pub(super) struct Shape {
    /// Where its plane lies in the mesh frame.
    pub frame: PlaneFrame,
    /// What is to be filled, and with what.
    pub fill: Fill,
    /// How wide the strip is where.
    pub extruder: Extruder,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// What becomes of a part.
pub(super) enum Fill {
    /// An outline is filled.
    Outline(Outline),
    /// The strip's lengths are given.
    Given {
        /// The strip without its edits.
        drawn: Drawn,
        /// What it goes round as it is drawn: it stands on the lowest point of it.
        outline: Outline,
    },
}

/// Works out the shape of a part as `decided` ([`Design::decided`](crate::design::Design::decided)) out of its own piece of the mesh. The whole shape
/// stands on the ground at height `ground_mm` of the mesh. Files the part names lie in `folder`.
pub(super) fn shape(
    part: &PartDesign,
    mesh: Option<&TriMesh>,
    ground_mm: Option<f64>,
    folder: &Path,
    setup: &Setup,
) -> Result<Shape, Error> {
    // The check of the design sees to it that a part without a mesh says how wide it is.
    let width_mm = part.width_mm.unwrap_or_default();
    if let Some(Stack::Given(given)) = &part.stack {
        let segment_mm = setup.fit(part).stack.segment_mm;
        let drawn = uniform_stack(given.layers, given.layer_mm(), given.inner_mm, segment_mm);
        let outline = own_outline(&drawn.ruffle, &drawn.positions);
        let fill = Fill::Given { drawn, outline };
        return Ok(Shape { frame: front(), fill, extruder: constant(part, width_mm)?, warnings: Vec::new() });
    }
    if let Some(source) = &part.outline {
        let loops = match source {
            OutlineSource::Loops(loops) => {
                loops.iter().map(|points| points.iter().map(|[u, v]| P2::new(*u, *v)).collect()).collect()
            }
            OutlineSource::File(file) => {
                let path = folder.join(file);
                let text = std::fs::read_to_string(&path).map_err(Error::file(&path))?;
                drawing::read_loops(&text).map_err(|source| Error::Drawing { file: file.clone(), source })?
            }
        };
        let outline = outline(loops).map_err(|problem| Error::Outline { part: part.name.clone(), problem })?;
        let fill = Fill::Outline(outline);
        return Ok(Shape { frame: front(), fill, extruder: constant(part, width_mm)?, warnings: Vec::new() });
    }
    let no_mesh = || Error::Outline { part: part.name.clone(), problem: "there is no mesh to cut it from".into() };
    from_mesh(part, mesh.ok_or_else(no_mesh)?, ground_mm, setup)
}

fn from_mesh(part: &PartDesign, mesh: &TriMesh, ground_mm: Option<f64>, setup: &Setup) -> Result<Shape, Error> {
    let cut_error = |source| Error::Cut { part: part.name.clone(), source };
    let plane = match part.plane {
        Some(plane) => plane.plane(),
        None => default_plane(mesh).map_err(cut_error)?,
    };
    let section = cut(mesh, &plane, &cut::Settings { ground_mm, ..setup.cut() }).map_err(cut_error)?;
    let extruder = Extruder::from_mesh(mesh, &section.frame, setup.joint().min_width_mm)
        .map_err(|source| Error::Extrude { part: part.name.clone(), source })?;
    let warnings = section.warnings.into_iter().map(|w| w.in_part(part.name.clone())).collect();
    Ok(Shape { frame: section.frame, fill: Fill::Outline(section.outline), extruder, warnings })
}

/// The plane of a shape that no mesh is cut for: seen from the front, its origin that of the outline.
fn front() -> PlaneFrame {
    PlaneFrame::new(&Plane { origin: P3::origin(), normal: V3::z() }, V3::y())
}

fn constant(part: &PartDesign, width_mm: f64) -> Result<Extruder, Error> {
    Extruder::constant(-0.5 * width_mm, 0.5 * width_mm)
        .map_err(|source| Error::Extrude { part: part.name.clone(), source })
}

/// Loops as an outline: the one that encloses most, turned counter-clockwise, the others holes in it.
fn outline(mut loops: Vec<Vec<P2>>) -> Result<Outline, String> {
    for points in &mut loops {
        if points.iter().any(|p| !(p.x.is_finite() && p.y.is_finite())) {
            return Err("its points must be finite numbers".into());
        }
        if points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        if points.len() < 3 || signed_area(points) == 0.0 {
            return Err("each of its loops needs three points or more that enclose an area".into());
        }
    }
    let area = |points: &Vec<P2>| signed_area(points).abs();
    let Some(largest) = (0..loops.len()).max_by(|a, b| area(&loops[*a]).total_cmp(&area(&loops[*b]))) else {
        return Err("it has no loops; give the outer one and then the holes".into());
    };
    let turned = |mut points: Vec<P2>, positive: bool| {
        if (signed_area(&points) > 0.0) != positive {
            points.reverse();
        }
        points
    };
    let outer = turned(loops.remove(largest), true);
    let holes = loops.into_iter().map(|points| turned(points, false)).collect();
    let outline = Outline { outer, holes };
    let whole = Outline { outer: outline.outer.clone(), holes: Vec::new() };
    match outline.holes.iter().flatten().find(|p| !whole.contains(**p)) {
        Some(p) => Err(format!(
            "u {:.1}, v {:.1} mm lies outside its outer loop; one part has one outline: make a part of each",
            p.x, p.y
        )),
        None => Ok(outline),
    }
}
