//! What the user asked for: a design, made from a mesh or read from a file, with the command line's values over it.

use super::Error;
use super::output::{absolute, relative};
use crate::config::Making;
use crate::design::{self, Design, Edit, Foot, MeshSource, OutlineSource, Paper, PartDesign, SCHEMA, StripAlong, Up};
use crate::mesh;
use crate::toolpath::Anchor;
use sha2::{Digest, Sha256};
use std::io::Read;
use std::path::{Path, PathBuf};

/// A design and where it lives.
#[derive(Debug, Clone, PartialEq)]
pub struct Order {
    /// The decisions, command line applied. Machines and materials that are files have absolute paths.
    pub design: Design,
    /// Where the design was read from, when it was.
    pub source: Option<Source>,
    /// Folder that files named in the design are relative to, absolute.
    pub folder: PathBuf,
    /// Name of the job, for headers, captions and folders.
    pub name: String,
    /// Replace a different design in the output folder.
    pub force: bool,
    /// Also write drawings with the kerf in them, for programs that know none.
    pub svg_kerf: bool,
    /// What is cut this time, how often, and where the machine begins; no part of the design.
    pub batch: Batch,
}

/// What is cut this time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Batch {
    /// Cut only these pieces, by name ("A3"); empty for all.
    pub only: Vec<String>,
    /// Number of sets.
    pub copies: usize,
    /// Who each set is for, in order; a set without a name has its number.
    pub names: Vec<String>,
    /// Where the machine begins.
    pub start: StartFrom,
}

/// Where a job lies on the machine.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum StartFrom {
    /// The sheet lies in the stop corner, which the machine knows.
    #[default]
    Absolute,
    /// This point of the job lies where the user set work zero.
    Origin(Anchor),
    /// This point of the job lies where the head stands when it starts.
    Current(Anchor),
}

/// A design file.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// What messages call it.
    pub file: String,
    /// Its text.
    pub text: String,
}

/// Values from the command line; each goes over the design's.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Overrides {
    /// Machine, a name or a path.
    pub machine: Option<String>,
    /// Material, a name or a path.
    pub material: Option<String>,
    /// Stock in order of preference.
    pub stock: Vec<String>,
    /// Height of the shape, mm.
    pub height_mm: Option<f64>,
    /// Axis of the mesh that points up.
    pub up: Option<Up>,
    /// Number of layers.
    pub layers: Option<usize>,
    /// How the foot stands.
    pub foot: Option<Foot>,
    /// What is put into the printer.
    pub paper: Option<Paper>,
}

/// Stands in for a machine or material that neither the design nor the command line names: an empty name is never in a library.
const NOT_NAMED: &str = "";

impl Order {
    /// The default design for a mesh: one part, everything else from the shape.
    pub fn from_mesh(mesh: &Path, overrides: &Overrides) -> Result<Order, Error> {
        let mesh = absolute(mesh)?;
        let folder = mesh.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        let file = mesh.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let design = Design {
            schema: SCHEMA,
            machine: NOT_NAMED.into(),
            material: NOT_NAMED.into(),
            stock: Vec::new(),
            strip_along: StripAlong::Grain,
            paper: Paper::default(),
            making: Making::default(),
            mesh: Some(MeshSource { file, sha256: Some(sha256_of(&mesh)?), up: None, height_mm: None }),
            splits: Vec::new(),
            parts: vec![PartDesign::new("A")],
            connectors: Vec::new(),
            edits: Vec::new(),
        };
        let name = stem(&mesh);
        let design = overridden(design, overrides)?;
        Ok(Order { design, source: None, folder, name, force: false, svg_kerf: false, batch: Batch::default() })
    }

    /// A design file.
    pub fn from_file(path: &Path, overrides: &Overrides) -> Result<Order, Error> {
        let text = std::fs::read_to_string(path).map_err(Error::file(path))?;
        let folder = absolute(path)?.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        Order::from_text(&path.display().to_string(), text, &folder, overrides)
    }

    /// The text of a design file that lies, or might lie, in `folder`; `file` is what messages call it.
    pub fn from_text(file: &str, text: String, folder: &Path, overrides: &Overrides) -> Result<Order, Error> {
        let mut design = Design::parse(file, &text)?;
        let folder = absolute(folder)?;
        for name in [&mut design.machine, &mut design.material] {
            if is_path(name) {
                *name = absolute(&folder.join(&*name))?.display().to_string();
            }
        }
        let name = match &design.mesh {
            Some(mesh) => stem(Path::new(&mesh.file)),
            None => design.parts.iter().map(|p| p.name.as_str()).collect::<Vec<&str>>().join("-"),
        };
        let source = Some(Source { file: file.to_owned(), text });
        let design = overridden(design, overrides)?;
        Ok(Order { design, source, folder, name, force: false, svg_kerf: false, batch: Batch::default() })
    }

    /// A design that comes with the program ([`design::built_in`]); any other name is a file that is not there.
    pub fn built_in(name: &str, overrides: &Overrides) -> Result<Order, Error> {
        let missing = || Error::file(name)(std::io::ErrorKind::NotFound.into());
        let text = design::built_in(name).ok_or_else(missing)?;
        let order = Order::from_text(name, text.to_owned(), Path::new("."), overrides)?;
        Ok(Order { name: name.to_owned(), ..order })
    }

    /// The design file's text for `out_dir`: re-runnable from there, comments kept.
    pub fn text_for(&self, out_dir: &Path) -> Result<String, Error> {
        let mut design = self.design.clone();
        let out_dir = absolute(out_dir)?;
        for file in files(&mut design) {
            *file = relative(&out_dir, &absolute(&self.folder.join(&*file))?);
        }
        for name in [&mut design.machine, &mut design.material] {
            if is_path(name) {
                *name = relative(&out_dir, Path::new(name));
            }
        }
        match &self.source {
            None => Ok(design.to_toml()),
            Some(source) => Ok(design.written_over(&source.file, &source.text)?),
        }
    }

    /// An error that says where in the file the edit stands that it is about.
    pub(super) fn placed(&self, error: Error) -> Error {
        match (error, &self.source) {
            (Error::Edit { number, what, source, .. }, Some(file)) => {
                let line = design::edit_line(&file.text, number).map_or_else(String::new, |line| format!("{line}: "));
                Error::Edit { place: format!("{}:{line}", file.file), number, what, source }
            }
            (other, _) => other,
        }
    }

    /// Hash of what is decided, wherever the files lie: first 12 hexadecimal digits.
    pub fn hash(&self) -> String {
        let mut design = self.design.clone();
        let last =
            |path: &str| Path::new(path).file_name().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        design.machine = last(&design.machine);
        design.material = last(&design.material);
        for file in files(&mut design) {
            *file = last(file);
        }
        sha256(design.to_toml().as_bytes())[..12].to_owned()
    }
}

/// Shapes that a design takes from files.
fn files(design: &mut Design) -> impl Iterator<Item = &mut String> {
    let outlines = design.parts.iter_mut().filter_map(|part| match &mut part.outline {
        Some(OutlineSource::File(file)) => Some(file),
        _ => None,
    });
    design.mesh.as_mut().map(|mesh| &mut mesh.file).into_iter().chain(outlines)
}

/// A file's name without its ending.
fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

/// Whether a machine or material is named by a file instead of a name in the library.
fn is_path(name: &str) -> bool {
    name.contains(['/', '\\']) || name.ends_with(".toml")
}

fn overridden(mut design: Design, overrides: &Overrides) -> Result<Design, Error> {
    let Overrides { machine, material, stock, height_mm, up, layers, foot, paper } = overrides.clone();
    for (from_command_line, own) in [(machine, &mut design.machine), (material, &mut design.material)] {
        match from_command_line {
            Some(path) if is_path(&path) => *own = absolute(Path::new(&path))?.display().to_string(),
            Some(name) => *own = name,
            None => {}
        }
    }
    if !stock.is_empty() {
        design.stock = stock;
    }
    design.paper = paper.unwrap_or(design.paper);
    if let Some(mesh) = &mut design.mesh {
        mesh.height_mm = height_mm.or(mesh.height_mm);
        mesh.up = up.or(mesh.up);
    }
    for part in &mut design.parts {
        part.layers = layers.or(part.layers);
        // Over what edits say as well.
        if let Some(layers) = layers.filter(|_| design.edits.iter().any(|e| e.part() == part.name)) {
            design.edits.push(Edit::Layers { part: part.name.clone(), layers });
        }
        part.foot = foot.unwrap_or(part.foot);
    }
    design.check("command line")?;
    Ok(design)
}

/// SHA-256 in hexadecimal.
fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn hexadecimal(digest: &[u8]) -> String {
    digest.iter().map(|b| format!("{b:02x}")).collect()
}

/// SHA-256 of a mesh file, read piece by piece. Files that no mesh may be (see [`mesh::MAX_BYTES`]) are hashed up to there only: loading refuses them.
pub(super) fn sha256_of(path: &Path) -> Result<String, Error> {
    let mut file = std::fs::File::open(path).map_err(Error::file(path))?.take(mesh::MAX_BYTES);
    let (mut hash, mut block) = (Sha256::new(), vec![0; 1 << 16]);
    loop {
        let read = file.read(&mut block).map_err(Error::file(path))?;
        if read == 0 {
            return Ok(hexadecimal(&hash.finalize()));
        }
        hash.update(&block[..read]);
    }
}
