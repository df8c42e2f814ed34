//! What a design means: its mesh, cut and filled.

use super::Error;
use super::order::sha256_of;
use super::settings::Setup;
use crate::cut::{cut, default_plane};
use crate::design::Design;
use crate::extrude::Extruder;
use crate::fit::{self, Part, Target};
use crate::geom::tolerance;
use crate::mesh;
use crate::progress::{Observer, Warning};
use std::path::Path;
use std::time::Instant;

/// A design's parts, filled.
#[derive(Debug, Clone)]
pub struct Realised {
    /// In the design's order.
    pub parts: Vec<Part>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Time spent filling, ms.
    pub fit_ms: f64,
    /// Time spent on the last solve of every part, ms.
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
    let material = setup.material();
    let mut realised = Realised { parts: Vec::new(), warnings, fit_ms: 0.0, solve_ms: 0.0 };
    for part in &design.parts {
        let name = || part.name.clone();
        let cut_error = |source| Error::Cut { part: name(), source };
        let plane = match part.plane {
            Some(plane) => plane.plane(),
            None => default_plane(&loaded.mesh).map_err(cut_error)?,
        };
        let section = cut(&loaded.mesh, &plane, &setup.cut()).map_err(cut_error)?;
        realised.warnings.extend(section.warnings.into_iter().map(|w| w.in_part(name())));
        let extruder = Extruder::from_mesh(&loaded.mesh, &section.frame, setup.joint().min_width_mm)
            .map_err(|source| Error::Extrude { part: name(), source })?;
        let target = Target {
            name: &part.name,
            frame: &section.frame,
            outline: &section.outline,
            extruder: &extruder,
            material: &material,
            loads_n: &[],
        };
        let settings = setup.fit(part.layers, part.foot);
        let began = Instant::now();
        let filled = fit::fit(&target, &settings, None, observer)?;
        realised.fit_ms += began.elapsed().as_secs_f64() * 1e3;
        let began = Instant::now();
        let settled = fit::settle(&target, &settings, filled)?;
        realised.solve_ms += began.elapsed().as_secs_f64() * 1e3;
        realised.warnings.extend(fit::warnings(&settled, &settings));
        let least = setup.joint().min_width_mm;
        let at_least = settled.spans.iter().filter(|s| s.width() <= least + tolerance::LIMIT_SLACK_MM).count();
        if 2 * at_least > settled.spans.len() {
            realised.warnings.push(
                Warning::new(
                    "depth-widened",
                    format!("most of the shape is thinner than the {least:.0} mm a strip needs for its joints: the strip is made {least:.0} mm wide there"),
                )
                .in_part(name()),
            );
        }
        realised.parts.push(settled);
    }
    Ok(realised)
}
