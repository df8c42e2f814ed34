//! Nesting for anyone's outlines: SVG files become shapes, layouts become SVG files again.

use super::{Error, offcuts};
use crate::drawing::{self, Drawing, DrawnPath, KerfSide, Role};
use crate::geom::{P2, Path as Curve, contains, tolerance};
use crate::nest::{Container, Instance, Item, Layouts, Placement, Settings};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Something to nest: an outline, and all that moves with it.
#[derive(Debug, Clone)]
pub struct Nestable {
    /// The piece's name in our own drawings; in others' the file's, with a number when there are several.
    pub name: String,
    /// The outline, mm, y up.
    pub polygon: Vec<P2>,
    drawing: Drawing,
}

/// The shapes in an SVG: the pieces of our own drawings, else every outermost closed outline, with what lies inside it.
pub fn nestables(file: &Path) -> Result<Vec<Nestable>, Error> {
    let text = std::fs::read_to_string(file).map_err(Error::file(file))?;
    let bad = |source| Error::Drawing { file: file.display().to_string(), source };
    let flat = |path: &Curve| path.flatten(tolerance::FLATTEN_MM);
    if let Ok(pieces) = drawing::read_svg(&text)
        && pieces.iter().any(|p| p.outline().is_some())
    {
        let with_outline = pieces.into_iter().filter_map(|drawing| {
            let polygon = flat(drawing.outline()?);
            Some(Nestable { name: drawing.name.clone(), polygon, drawing })
        });
        return Ok(with_outline.collect());
    }
    let loops = drawing::read_loops(&text).map_err(bad)?;
    let within = |k: usize| {
        let around = |j: usize| j != k && contains(&loops[j], loops[k][0]);
        (0..loops.len()).filter(|j| around(*j)).collect::<Vec<usize>>()
    };
    let around: Vec<Vec<usize>> = (0..loops.len()).map(within).collect();
    let outermost: Vec<usize> = (0..loops.len()).filter(|k| around[*k].is_empty()).collect();
    let stem = file.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let shapes = outermost.iter().enumerate().map(|(n, &k)| {
        let name = if outermost.len() == 1 { stem.clone() } else { format!("{stem}-{}", n + 1) };
        let path = |j: usize, role: Role| {
            let kerf = role.usual_kerf();
            DrawnPath { path: Curve::closed(loops[j].iter().copied()), role, kerf, joint: None }
        };
        let inside = (0..loops.len()).filter(|j| around[*j].contains(&k)).map(|j| path(j, Role::Hole));
        let paths = std::iter::once(path(k, Role::Outline)).chain(inside).collect();
        Nestable { polygon: loops[k].clone(), drawing: Drawing { name: name.clone(), paths }, name }
    });
    Ok(shapes.collect())
}

/// An offcut drawn in an SVG: its outermost outline, and what is cut out of it already or blocked. It costs nothing and there is one of it.
pub fn offcut_stock(file: &Path) -> Result<Container, Error> {
    let mut shapes = nestables(file)?;
    let one = if shapes.len() == 1 { shapes.pop() } else { None };
    let not_one = || Error::Offcut { file: file.display().to_string(), outlines: shapes.len() };
    let shape = one.ok_or_else(not_one)?;
    let bounds = crate::geom::Rect::around(&shape.polygon);
    let moved = |points: &[P2]| points.iter().map(|p| p - bounds.min.coords).collect::<Vec<P2>>();
    let holes = shape.drawing.paths.iter().filter(|p| p.role == Role::Hole);
    let blocked = holes.map(|p| moved(&p.path.flatten(tolerance::FLATTEN_MM))).collect();
    Ok(Container::Sheet {
        name: shape.name,
        width_mm: bounds.width(),
        height_mm: bounds.height(),
        count: Some(1),
        cost: 0.0,
        outline: moved(&shape.polygon),
        blocked,
    })
}

/// A finished nesting job.
#[derive(Debug)]
pub struct Nested<'a> {
    /// What the job is called.
    pub name: &'a str,
    /// What was placed.
    pub items: &'a [Item],
    /// What it was placed on.
    pub containers: &'a [Container],
    /// Distances kept.
    pub settings: &'a Settings,
    /// Where everything lies.
    pub layouts: &'a Layouts,
    /// What is drawn for each item; its polygon when there is nothing more to it.
    pub shapes: &'a [Nestable],
}

/// Writes sheet-NN.svg for every sheet, offcuts/, and the job and its solution as JSON that jagua-rs reads. Returns the files, relative to the folder.
pub fn write_nested(folder: &Path, nested: &Nested) -> Result<Vec<PathBuf>, Error> {
    let mut files: Vec<(String, String)> = Vec::new();
    for (k, layout) in nested.layouts.layouts.iter().enumerate() {
        let drawings: Vec<Drawing> = layout.placements.iter().map(|p| nested.placed(p)).collect();
        let name = format!("sheet-{:02}", k + 1);
        files.push((format!("{name}.svg"), drawing::sheet_svg(layout.width_mm, layout.height_mm, &drawings)));
        let rest = offcuts::offcut(nested.items, nested.containers, layout, nested.settings);
        files.extend(rest.map(|rest| offcuts::file(&name, &rest)));
    }
    let instance = Instance::new(nested.name, nested.items, nested.containers, nested.settings.spacing_mm);
    let json = |what: &str, text: Result<String, serde_json::Error>| {
        text.map(|text| (what.to_owned(), text)).map_err(|source| Error::Json { file: what.to_owned(), source })
    };
    files.push(json("instance.json", instance.to_json())?);
    files.push(json("solution.json", serde_json::to_string(&instance.solution(nested.layouts)))?);
    for (name, text) in &files {
        put(&folder.join(name), text)?;
    }
    Ok(files.into_iter().map(|(name, _)| PathBuf::from(name)).collect())
}

/// Writes a file beside its place and moves it there.
fn put(path: &Path, text: &str) -> Result<(), Error> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let failed = || Error::file(path);
    std::fs::create_dir_all(folder).map_err(failed())?;
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(failed())?;
    file.write_all(text.as_bytes()).map_err(failed())?;
    file.persist(path).map_err(|e| failed()(e.error))?;
    Ok(())
}

impl Nested<'_> {
    fn placed(&self, placement: &Placement) -> Drawing {
        let item = &self.items[placement.item];
        let drawing = match self.shapes.get(placement.item) {
            Some(shape) => shape.drawing.clone(),
            None => outline(&item.name, &item.polygon),
        };
        if !placement.mirrored {
            return drawing.moved(&placement.motion());
        }
        // Curves become chords: an arc that is turned over bends the other way.
        let over = |drawn: &DrawnPath| {
            let points = placement.placed(&drawn.path.flatten(tolerance::FLATTEN_MM));
            let path = if drawn.path.closed { Curve::closed(points) } else { Curve::open(points) };
            let kerf = match drawn.kerf {
                KerfSide::Left => KerfSide::Right,
                KerfSide::Right => KerfSide::Left,
                side => side,
            };
            DrawnPath { path, kerf, ..drawn.clone() }
        };
        Drawing { name: drawing.name, paths: drawing.paths.iter().map(over).collect() }
    }
}

fn outline(name: &str, polygon: &[P2]) -> Drawing {
    let (role, path) = (Role::Outline, Curve::closed(polygon.iter().copied()));
    Drawing { name: name.to_owned(), paths: vec![DrawnPath { path, role, kerf: role.usual_kerf(), joint: None }] }
}
