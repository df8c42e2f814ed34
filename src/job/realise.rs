//! What a design means: its mesh, cut and filled.

use super::bodies::{self, Bodies};
use super::edits::PartEdits;
use super::order::sha256_of;
use super::settings::Setup;
use super::shape::{Fill, Shape, shape};
use super::{Error, proposal, standing, ties};
use crate::cut::Outline;
use crate::design::{Design, PartDesign};
use crate::extrude::Extruder;
use crate::fit::{self, Edits, FootUsed, Part, Target};
use crate::geom::tolerance;
use crate::mesh::{self, TriMesh};
use crate::progress::{Observer, Warning};
use crate::sim::Material;
use crate::strip::PartJoint;
use std::path::Path;
use std::time::Instant;

/// A design's parts, filled.
#[derive(Debug, Clone)]
pub struct Realised {
    /// The shape, where there is one; mesh frame, mm.
    pub mesh: Option<TriMesh>,
    /// In the design's order.
    pub parts: Vec<Part>,
    /// Joints of different parts that connectors tie.
    pub ties: Vec<[PartJoint; 2]>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Time spent filling, ms.
    pub fit_ms: f64,
    /// Time spent on the last solves of all parts, ms.
    pub solve_ms: f64,
}

/// Works a design out; files it names lie in `folder`. Every start is fixed, so the same design gives the same parts.
pub fn realise(design: &Design, folder: &Path, setup: &Setup, observer: &mut dyn Observer) -> Result<Realised, Error> {
    let design = &design.taken_apart();
    let mut warnings = Vec::new();
    let mesh = loaded(design, folder, setup, &mut warnings)?;
    let Bodies { meshes, warnings: apart } = bodies::bodies(design, mesh.as_ref())?;
    warnings.extend(apart);
    let standing = standing::standing(design, mesh.as_ref(), &meshes);
    warnings.extend(standing.warnings.iter().cloned());
    let ground_mm = mesh.as_ref().map(|m| m.height_range().0);

    let decided = |(i, part): (usize, &PartDesign)| {
        let part = design.decided(part);
        PartDesign { foot: standing.foot(i, part.foot), ..part }
    };
    let parts: Vec<PartDesign> = design.parts.iter().enumerate().map(decided).collect();
    let mut shapes = Vec::with_capacity(parts.len());
    for (part, mesh) in parts.iter().zip(&meshes) {
        let shape = shape(part, mesh.as_ref(), ground_mm, folder, setup)?;
        warnings.extend(shape.warnings.iter().cloned());
        shapes.push(shape);
    }
    let settings: Vec<fit::Settings> = parts.iter().map(|part| setup.fit(part)).collect();
    let material = setup.material();
    let began = Instant::now();
    let mut filled = Vec::with_capacity(parts.len());
    for ((part, shape), settings) in parts.iter().zip(&shapes).zip(&settings) {
        let own = PartEdits::of(design, &part.name, setup.edit_limits());
        filled.push(fill(&target(part, shape, &material), shape, settings, &own, observer)?);
    }
    let fit_ms = began.elapsed().as_secs_f64() * 1e3;

    let began = Instant::now();
    // What a strip of given lengths is to fill is known when it has settled.
    let outlines: Vec<Outline> = filled.iter().map(|part| part.outline.clone()).collect();
    let targets: Vec<Target> = (0..parts.len())
        .map(|i| Target { outline: &outlines[i], ..target(&parts[i], &shapes[i], &material) })
        .collect();
    let mut settled = fit::settle_together(&targets, &settings, filled, &standing.forest)?;
    let held = |(i, part): &(usize, &mut Part)| !standing.on_the_ground(*i) && part.report.foot == FootUsed::Pinned;
    for (_, part) in settled.iter_mut().enumerate().filter(held) {
        // Connectors tie it to what it rests on.
        part.report.foot = FootUsed::Tied;
    }
    let ties = ties::ties(design, &settled, &standing.meetings);
    let solve_ms = began.elapsed().as_secs_f64() * 1e3;

    let mut realised = Realised { mesh, parts: settled, ties, warnings, fit_ms, solve_ms };
    for (i, part) in realised.parts.iter().enumerate() {
        realised.warnings.extend(fit::warnings(part, &settings[i]));
        if meshes[i].is_some() {
            realised.warnings.extend(proposal::emptiness(design, part));
            realised.warnings.extend(depth_warnings(part, &shapes[i].extruder, setup.joint().min_width_mm));
        }
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

fn target<'a>(part: &'a PartDesign, shape: &'a Shape, material: &'a Material) -> Target<'a> {
    let outline = match &shape.fill {
        Fill::Outline(outline) => outline,
        Fill::Given { outline, .. } => outline,
    };
    Target { name: &part.name, frame: &shape.frame, outline, extruder: &shape.extruder, material, loads_n: &[] }
}

/// A part's shape filled with its edited strip.
fn fill(
    target: &Target,
    shape: &Shape,
    settings: &fit::Settings,
    own: &PartEdits,
    observer: &mut dyn Observer,
) -> Result<Part, Error> {
    match &shape.fill {
        Fill::Outline(_) => {
            let apply = |clean: &_| own.done(clean);
            let edits = own.any().then_some(Edits { apply: &apply });
            fit::fit(target, settings, edits.as_ref(), observer).map_err(|e| own.named(e))
        }
        Fill::Given { drawn, .. } => {
            let edited = own.done(drawn).map_err(|e| own.refusal(e))?;
            Ok(fit::rest(target, settings, &edited, observer)?)
        }
    }
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
