//! What a design means: its mesh, cut and filled.

use super::Error;
use super::bodies::{self, Bodies};
use super::order::sha256_of;
use super::settings::Setup;
use super::{proposal, standing, ties};
use crate::cut::{self, cut, default_plane};
use crate::design::Design;
use crate::extrude::Extruder;
use crate::fit::{self, FootUsed, Part, Target};
use crate::geom::tolerance;
use crate::mesh;
use crate::progress::{Observer, Warning};
use crate::strip::PartJoint;
use std::path::Path;
use std::time::Instant;

/// A design's parts, filled.
#[derive(Debug, Clone)]
pub struct Realised {
    /// In the design's order.
    pub parts: Vec<Part>,
    /// Joints of different parts that connectors tie.
    pub ties: Vec<[PartJoint; 2]>,
    /// For each part whether its foot is held by a base card.
    pub based: Vec<bool>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Time spent filling, ms.
    pub fit_ms: f64,
    /// Time spent on the last solves of all parts, ms.
    pub solve_ms: f64,
}

/// Works a design out from its mesh, relative to `folder`. Every start is fixed, so the same design gives the same parts.
pub fn realise(design: &Design, folder: &Path, setup: &Setup, observer: &mut dyn Observer) -> Result<Realised, Error> {
    let path = folder.join(&design.mesh.file);
    let loaded = mesh::load(&path, &setup.mesh(design))?;
    let mut warnings = loaded.warnings;
    if let Some(expected) = &design.mesh.sha256 {
        let found = sha256_of(&path)?;
        if found != *expected {
            let message =
                format!("{} is not the file the design was made from; what follows may differ", design.mesh.file);
            warnings.push(Warning::new("mesh-changed", message));
        }
    }
    let Bodies { meshes, warnings: apart } = bodies::bodies(design, &loaded.mesh)?;
    warnings.extend(apart);
    let standing = standing::standing(design, &loaded.mesh, &meshes);
    warnings.extend(standing.warnings.iter().cloned());

    let material = setup.material();
    let mut realised =
        Realised { parts: Vec::new(), ties: Vec::new(), based: Vec::new(), warnings, fit_ms: 0.0, solve_ms: 0.0 };
    let ground_mm = Some(loaded.mesh.height_range().0);
    let mut prepared = Vec::with_capacity(meshes.len());
    for (part, mesh) in design.parts.iter().zip(&meshes) {
        let name = || part.name.clone();
        let cut_error = |source| Error::Cut { part: name(), source };
        let plane = match part.plane {
            Some(plane) => plane.plane(),
            None => default_plane(mesh).map_err(cut_error)?,
        };
        let section = cut(mesh, &plane, &cut::Settings { ground_mm, ..setup.cut() }).map_err(cut_error)?;
        realised.warnings.extend(section.warnings.iter().cloned().map(|w| w.in_part(name())));
        let extruder = Extruder::from_mesh(mesh, &section.frame, setup.joint().min_width_mm)
            .map_err(|source| Error::Extrude { part: name(), source })?;
        prepared.push((section, extruder));
    }
    let targets: Vec<Target> = design
        .parts
        .iter()
        .zip(&prepared)
        .map(|(part, (section, extruder))| Target {
            name: &part.name,
            frame: &section.frame,
            outline: &section.outline,
            extruder,
            material: &material,
            loads_n: &[],
        })
        .collect();
    let settings: Vec<fit::Settings> =
        design.parts.iter().enumerate().map(|(i, part)| setup.fit(part.layers, standing.foot(i, part.foot))).collect();
    let began = Instant::now();
    let filled = targets
        .iter()
        .zip(&settings)
        .map(|(target, settings)| fit::fit(target, settings, None, observer))
        .collect::<Result<Vec<Part>, fit::Error>>()?;
    realised.fit_ms = began.elapsed().as_secs_f64() * 1e3;
    let began = Instant::now();
    realised.parts = fit::settle_together(&targets, &settings, filled, &standing.forest)?;
    realised.ties = ties::ties(design, &realised.parts, &standing.meetings);
    realised.solve_ms = began.elapsed().as_secs_f64() * 1e3;
    for (i, part) in realised.parts.iter().enumerate() {
        realised.based.push(part.report.foot == FootUsed::Pinned && standing.on_the_ground(i));
        realised.warnings.extend(fit::warnings(part, &settings[i]));
        realised.warnings.extend(proposal::emptiness(design, part));
        realised.warnings.extend(depth_warnings(part, targets[i].extruder, setup.joint().min_width_mm));
    }
    Ok(realised)
}

/// What the user should know about how the strip goes into the shape's depth.
fn depth_warnings(part: &Part, extruder: &Extruder, least_mm: f64) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let at_least = part.spans.iter().filter(|s| s.width() <= least_mm + tolerance::LIMIT_SLACK_MM).count();
    if 2 * at_least > part.spans.len() {
        let message = format!(
            "most of the shape is thinner than the {least_mm:.0} mm a strip needs for its joints: the strip is made {least_mm:.0} mm wide there"
        );
        warnings.push(Warning::new("depth-widened", message).in_part(&part.name));
    }
    if let Some(beyond) = extruder.beyond(&part.equilibrium.positions).filter(|b| b.share > BEYOND_SHARE) {
        let message = format!(
            "before or behind the strip the shape goes on beyond a gap, and {:.0} % of its thickness stays empty: give it a part of its own ([[split]] in the design)",
            100.0 * beyond.share
        );
        let place = format!("u {:.0}, v {:.0} mm", beyond.at.x, beyond.at.y);
        warnings.push(Warning::new("depth-left-out", message).in_part(&part.name).at(place));
    }
    warnings
}

/// Less than this share of the thickness beyond a gap is a fold in the surface, not worth a word.
const BEYOND_SHARE: f64 = 0.02;
