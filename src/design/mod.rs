//! What the user decided, as a file: which mesh, machine and material, and how each part is cut and filled.
//!
//! A design holds decisions only; everything else follows from them and is worked out anew each time, so the same file gives the same bytes: clean stacks, all
//! [`Edit`]s in order, then filling.

mod apart;
mod builtin;
mod check;
mod edit;
mod shape;
mod text;

pub use crate::ruffle::Direction;
pub use builtin::built_in;
#[cfg(test)]
pub(crate) use edit::tests as edit_tests;
pub use edit::{Base, Edit, MAX_LEVELS};
pub use shape::{GivenStack, Method, OutlineSource, Stack};
pub use text::edit_line;

pub use apart::{Connector, Split, StripAlong};

use crate::config::Making;
use crate::cut::Plane;
use crate::geom::{P3, V3};
use serde::{Deserialize, Serialize};

/// The version of the file format this program writes and reads.
pub const SCHEMA: u32 = 1;

/// A design file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Machine to cut on, a name or a path.
    pub machine: String,
    /// Material to cut, a name or a path.
    pub material: String,
    /// Stock to use, in order of preference; empty takes what the material offers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stock: Vec<String>,
    /// Which way strips run in the sheet.
    #[serde(default, skip_serializing_if = "StripAlong::is_default")]
    pub strip_along: StripAlong,
    /// What assembly sheets and patterns are printed on.
    #[serde(default, skip_serializing_if = "Paper::is_default")]
    pub paper: Paper,
    /// How strips are fastened, divided and labelled, where that is not the material's way.
    #[serde(default, skip_serializing_if = "Making::is_default")]
    pub making: Making,
    /// The shape; parts with an outline or a stack of their own need none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshSource>,
    /// How it is taken apart, in order.
    #[serde(default, rename = "split", skip_serializing_if = "Vec::is_empty")]
    pub splits: Vec<Split>,
    /// How it is filled, one entry a part.
    #[serde(rename = "part")]
    pub parts: Vec<PartDesign>,
    /// Strips that tie parts together. Two parts that none of them ties get the nearest connection points.
    #[serde(default, rename = "connector", skip_serializing_if = "Vec::is_empty")]
    pub connectors: Vec<Connector>,
    /// What was changed by hand, in order.
    #[serde(rename = "edit", default, skip_serializing_if = "Vec::is_empty")]
    pub edits: Vec<Edit>,
}

/// What is put into the printer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Paper {
    /// 210 x 297 mm.
    #[default]
    A4,
    /// 8.5 x 11 inches.
    Letter,
}

impl Paper {
    fn is_default(&self) -> bool {
        *self == Paper::default()
    }
}

/// The shape a design starts from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshSource {
    /// OBJ or STL, relative to the design file.
    pub file: String,
    /// SHA-256 of the file, hexadecimal; a mesh that changed since is used with a warning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    /// Axis that points up; default y for OBJ, z for STL.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<Up>,
    /// Height to scale the shape to, mm; default: the file's numbers are mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_mm: Option<f64>,
}

/// An axis of the mesh's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Up {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// One ruffle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartDesign {
    /// A letter or short word; joints are numbered behind it.
    pub name: String,
    /// Bodies of the mesh that it is made of, counted from 1 in the file's order; none: what a split called so, or else the whole shape.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<usize>,
    /// Where the shape is cut; default: upright through the middle, across its thinner side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneSource>,
    /// The outline to fill, instead of one cut out of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outline: Option<OutlineSource>,
    /// Which way its layers lie, or the stack itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stack: Option<Stack>,
    /// Width of the strip, mm, where no mesh says how wide it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width_mm: Option<f64>,
    /// Number of layers; default: from the outline.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layers: Option<usize>,
    /// How it stands.
    #[serde(default, skip_serializing_if = "Foot::is_default")]
    pub foot: Foot,
    /// How section lengths are found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub method: Option<Method>,
}

impl PartDesign {
    /// A part that leaves everything to the program.
    pub fn new(name: &str) -> PartDesign {
        PartDesign {
            name: name.into(),
            bodies: Vec::new(),
            plane: None,
            outline: None,
            stack: None,
            width_mm: None,
            layers: None,
            foot: Foot::Auto,
            method: None,
        }
    }
}

/// A cutting plane in the mesh frame, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneSource {
    /// A point on it.
    pub origin_mm: [f64; 3],
    /// Its normal, of any length.
    pub normal: [f64; 3],
}

/// How the bottom rung stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Foot {
    /// Free where it stands by itself, else pinned.
    #[default]
    Auto,
    /// Rests on the floor.
    Free,
    /// Both ends of the bottom rung are glued or slotted to a base.
    Pinned,
}

impl Foot {
    fn is_default(&self) -> bool {
        *self == Foot::default()
    }
}

/// What is wrong with a design file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Not TOML, or not a design.
    #[error("{file}:{line}:{column}: {message}\n  | {source_line}")]
    Syntax {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong, and what was perhaps meant.
        message: String,
        /// The line itself.
        source_line: String,
    },
    /// Written by another version.
    #[error("{file}: schema = {found}, this furbelow reads schema = {SCHEMA}")]
    Schema {
        /// The file.
        file: String,
        /// Its schema.
        found: u32,
    },
    /// A value that makes no sense.
    #[error("{file}: {key} {problem}")]
    Value {
        /// The file.
        file: String,
        /// Where: "part A: layers".
        key: String,
        /// What is wrong and what would be right.
        problem: String,
    },
}

impl Design {
    /// Reads a design file's text; `file` is its name for messages.
    pub fn parse(file: &str, text: &str) -> Result<Design, Error> {
        let design: Design = toml::from_str(text).map_err(|e| syntax_error(file, text, &e))?;
        design.check(file)?;
        Ok(design)
    }
}

/// Where a TOML error lies and what was perhaps meant.
fn syntax_error(file: &str, text: &str, error: &toml::de::Error) -> Error {
    let mut at = error.span().map_or(0, |span| span.start).min(text.len());
    let mut message = error.message().to_owned();
    // "unknown field `mashine`, expected one of `schema`, `machine`, ...": every second piece between backticks is a name.
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let what = ["unknown field", "unknown variant"].into_iter().find(|what| message.starts_with(what));
    if let ([typed, known @ ..], Some(what)) = (names.as_slice(), what) {
        // Of an edit, the error names the whole entry: the word itself stands further on.
        at += text[at..].find(typed).unwrap_or(0);
        let alike = |name: &&&str| strsim::damerau_levenshtein(typed, name);
        let kind = if what == "unknown field" { "key" } else { "value" };
        message = match known.iter().min_by_key(alike).filter(|name| alike(name) <= 3) {
            Some(meant) => format!("unknown {kind} '{typed}'; did you mean '{meant}'?"),
            None => format!("unknown {kind} '{typed}'; known are {}", known.join(", ")),
        };
    }
    let before = &text[..at];
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    Error::Syntax {
        file: file.into(),
        line: before.matches('\n').count() + 1,
        column: text[line_start..at].chars().count() + 1,
        message,
        source_line: text[line_start..].lines().next().unwrap_or("").to_owned(),
    }
}

impl PlaneSource {
    /// What keeps it from being a plane.
    pub(super) fn problem(&self) -> Option<&'static str> {
        let finite = self.origin_mm.iter().chain(&self.normal).all(|v| v.is_finite());
        (!finite || V3::from(self.normal).norm() < 1e-9).then_some("needs finite numbers and a normal that is not zero")
    }

    /// The plane, with a unit normal.
    pub fn plane(&self) -> Plane {
        Plane { origin: P3::from(self.origin_mm), normal: V3::from(self.normal).normalize() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stool() -> Design {
        Design {
            schema: SCHEMA,
            machine: "diode-400".into(),
            material: "paper-160".into(),
            making: Making::default(),
            stock: vec!["A3".into()],
            strip_along: StripAlong::Grain,
            paper: Paper::Letter,
            splits: Vec::new(),
            connectors: Vec::new(),
            mesh: Some(MeshSource { file: "stool.obj".into(), sha256: None, up: Some(Up::Y), height_mm: Some(100.0) }),
            parts: vec![PartDesign {
                plane: Some(PlaneSource { origin_mm: [0.0; 3], normal: [0.0, 0.0, 2.0] }),
                layers: Some(4),
                foot: Foot::Pinned,
                ..PartDesign::new("A")
            }],
            edits: Vec::new(),
        }
    }

    #[test]
    fn what_is_written_reads_back_the_same() {
        assert_eq!(Design::parse("design.toml", &stool().to_toml()), Ok(stool()));
    }

    #[test]
    fn a_typo_is_told_with_its_line() {
        let text = stool().to_toml().replace("layers", "layerz");
        let message = Design::parse("design.toml", &text).unwrap_err().to_string();
        let line = 1 + text.lines().position(|l| l.contains("layerz")).unwrap();
        assert!(message.starts_with(&format!("design.toml:{line}:1: ")), "{message}");
        assert!(message.contains("did you mean 'layers'"), "{message}");
    }

    #[test]
    fn values_that_make_no_sense_are_named() {
        let mut twice = stool();
        twice.parts.push(twice.parts[0].clone());
        let mut flat = stool();
        flat.parts[0].plane = Some(PlaneSource { origin_mm: [0.0; 3], normal: [0.0; 3] });
        let mut named = stool();
        named.parts[0].name = "../../x".into();
        let mut future = stool();
        future.schema = 9;
        for (design, word) in [(twice, "twice"), (flat, "normal"), (named, "letters"), (future, "schema = 9")] {
            let message = Design::parse("d.toml", &design.to_toml()).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
    }

    #[test]
    fn planes_are_made_with_unit_normals() {
        assert_eq!(stool().parts[0].plane.unwrap().plane().normal, V3::z());
    }
}
