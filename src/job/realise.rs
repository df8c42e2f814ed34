//! What a design means: its mesh, cut and filled.

use super::Error;
use super::edits::PartEdits;
use super::order::sha256_of;
use super::settings::Setup;
use super::shape::{Fill, Shape, shape};
use crate::design::{Design, PartDesign};
use crate::fit::{self, Edits, Part, Target};
use crate::geom::tolerance;
use crate::mesh::{self, TriMesh};
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

/// Works a design out; files it names lie in `folder`. Every start is fixed, so the same design gives the same parts.
pub fn realise(design: &Design, folder: &Path, setup: &Setup, observer: &mut dyn Observer) -> Result<Realised, Error> {
    let mut realised = Realised { parts: Vec::new(), warnings: Vec::new(), fit_ms: 0.0, solve_ms: 0.0 };
    let mesh = loaded(design, folder, setup, &mut realised.warnings)?;
    for part in &design.parts {
        let part = design.decided(part);
        let shape = shape(&part, mesh.as_ref(), folder, setup)?;
        let settled = filled(design, &part, &shape, setup, &mut realised, observer)?;
        realised.warnings.extend(shape.warnings);
        let least = setup.joint().min_width_mm;
        let at_least = settled.spans.iter().filter(|s| s.width() <= least + tolerance::LIMIT_SLACK_MM).count();
        if part.width_mm.is_none() && 2 * at_least > settled.spans.len() {
            realised.warnings.push(
                Warning::new(
                    "depth-widened",
                    format!("most of the shape is thinner than the {least:.0} mm a strip needs for its joints: the strip is made {least:.0} mm wide there"),
                )
                .in_part(part.name.clone()),
            );
        }
        realised.parts.push(settled);
    }
    Ok(realised)
}

/// The design's mesh, where it has one.
fn loaded(
    design: &Design,
    folder: &Path,
    setup: &Setup,
    warnings: &mut Vec<Warning>,
) -> Result<Option<TriMesh>, Error> {
    let Some(source) = &design.mesh else { return Ok(None) };
    let path = folder.join(&source.file);
    let loaded = mesh::load(&path, &setup.mesh(source))?;
    warnings.extend(loaded.warnings);
    if let Some(expected) = &source.sha256
        && sha256_of(&path)? != *expected
    {
        let message = format!("{} is not the file the design was made from; what follows may differ", source.file);
        warnings.push(Warning::new("mesh-changed", message));
    }
    Ok(Some(loaded.mesh))
}

/// A part's shape filled with its edited strip, and settled.
fn filled(
    design: &Design,
    part: &PartDesign,
    shape: &Shape,
    setup: &Setup,
    realised: &mut Realised,
    observer: &mut dyn Observer,
) -> Result<Part, Error> {
    let material = setup.material();
    let target = |outline| Target {
        name: &part.name,
        frame: &shape.frame,
        outline,
        extruder: &shape.extruder,
        material: &material,
        loads_n: &[],
    };
    let settings = setup.fit(part);
    let own = PartEdits::of(design, &part.name, setup.edit_limits());
    let began = Instant::now();
    let mut ended = began;
    let settled = match &shape.fill {
        Fill::Outline(outline) => {
            let apply = |clean: &_| own.done(clean);
            let edits = own.any().then_some(Edits { apply: &apply });
            let target = target(outline);
            let filled = fit::fit(&target, &settings, edits.as_ref(), observer).map_err(|e| own.named(e))?;
            ended = Instant::now();
            fit::settle(&target, &settings, filled)?
        }
        Fill::Given(drawn) => {
            let edited = own.done(drawn).map_err(|e| own.refusal(e))?;
            fit::rest(&target(&fit::own_outline(&edited.ruffle, &edited.positions)), &settings, &edited, observer)?
        }
    };
    realised.fit_ms += (ended - began).as_secs_f64() * 1e3;
    realised.solve_ms += ended.elapsed().as_secs_f64() * 1e3;
    realised.warnings.extend(fit::warnings(&settled, &settings));
    Ok(settled)
}
