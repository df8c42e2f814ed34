//! Flat drawings: what is cut or engraved, with a role, a kerf side and a piece name on every path. Reads and writes our SVG, writes
//! DXF, and letters with single strokes.

mod dxf;
mod error;
mod glyphs;
mod lettering;
mod path_data;
mod svg;
mod svg_loops;
mod svg_read;

pub use dxf::dxf;
pub use error::Error;
pub use lettering::{text_paths, text_width};
pub use path_data::{path_data, svg_number};
pub use svg::{piece_svg, sheet_svg};
pub use svg_loops::read_loops;
pub use svg_read::read_svg;

use crate::geom::{Motion, Path, Rect};

/// What a path is for. Decides its colour, its SVG class and when the machine makes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// The whole contour of a piece; cut last.
    Outline,
    /// The open cut that frees a flap, hinged at its root.
    Flap,
    /// The cut that a flap goes through.
    Slit,
    /// Any other inner cut: closed ones whose waste falls out, and open ones such as the dashes of a hinge or of perforated lettering.
    Hole,
    /// An engraved line: fold marks, splice lines.
    Mark,
    /// Engraved lettering.
    Label,
}

/// When and how a role is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Operation {
    /// Marks on the surface, made first.
    Engrave,
    /// Cuts inside a piece, made while the sheet still holds it.
    CutInner,
    /// Contours that free the piece, made last.
    CutOutline,
}

/// Which side of the nominal line is waste, seen from the piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KerfSide {
    /// Waste outside a closed contour: the tool runs outside by half the kerf.
    Outside,
    /// Waste inside a closed contour (a hole): the tool runs inside by half the kerf.
    Inside,
    /// Waste on the left of an open cut, seen along its direction.
    Left,
    /// Waste on the right of an open cut, seen along its direction.
    Right,
    /// A single line, no offset: slits, marks, lettering.
    On,
}

/// One curve of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnPath {
    /// The nominal curve, before kerf.
    pub path: Path,
    /// What it is for.
    pub role: Role,
    /// Where the waste is.
    pub kerf: KerfSide,
    /// The joint it belongs to ("A7"), for flaps and slits and their labels.
    pub joint: Option<String>,
}

/// All curves of one piece, in the strip frame (s right, w up, mm) until it is placed on a sheet.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// Name of the piece ("A1"), unique in the object.
    pub name: String,
    /// Curves in drawing order.
    pub paths: Vec<DrawnPath>,
}

impl Role {
    /// All roles.
    pub const ALL: [Role; 6] = [Role::Outline, Role::Flap, Role::Slit, Role::Hole, Role::Mark, Role::Label];

    /// The SVG class and DXF vocabulary word.
    pub fn class(self) -> &'static str {
        match self {
            Role::Outline => "outline",
            Role::Flap => "flap",
            Role::Slit => "slit",
            Role::Hole => "hole",
            Role::Mark => "mark",
            Role::Label => "label",
        }
    }

    /// When this role is made.
    pub fn operation(self) -> Operation {
        match self {
            Role::Outline => Operation::CutOutline,
            Role::Flap | Role::Slit | Role::Hole => Operation::CutInner,
            Role::Mark | Role::Label => Operation::Engrave,
        }
    }

    /// The kerf side a path of this role has unless its maker says otherwise.
    pub fn usual_kerf(self) -> KerfSide {
        match self {
            Role::Outline => KerfSide::Outside,
            Role::Hole => KerfSide::Inside,
            Role::Flap | Role::Slit | Role::Mark | Role::Label => KerfSide::On,
        }
    }
}

impl KerfSide {
    /// All sides.
    pub const ALL: [KerfSide; 5] = [KerfSide::Outside, KerfSide::Inside, KerfSide::Left, KerfSide::Right, KerfSide::On];

    /// The word in SVG's `data-kerf`. Left and right are those of the sheet (y up), the way people see it.
    pub fn word(self) -> &'static str {
        match self {
            KerfSide::Outside => "outside",
            KerfSide::Inside => "inside",
            KerfSide::Left => "left",
            KerfSide::Right => "right",
            KerfSide::On => "on",
        }
    }
}

impl Operation {
    /// All operations in the order a sheet is made.
    pub const ALL: [Operation; 3] = [Operation::Engrave, Operation::CutInner, Operation::CutOutline];

    /// The SVG group id and DXF layer.
    pub fn id(self) -> &'static str {
        match self {
            Operation::Engrave => "engrave",
            Operation::CutInner => "cut-inner",
            Operation::CutOutline => "cut-outline",
        }
    }

    /// Stroke colour, exact because cutters' programs choose the layer by it.
    pub fn colour(self) -> &'static str {
        match self {
            Operation::Engrave => "#000000",
            Operation::CutInner => "#0000FF",
            Operation::CutOutline => "#FF0000",
        }
    }
}

impl Drawing {
    /// The smallest box around everything drawn.
    pub fn bounds(&self) -> Rect {
        self.paths.iter().fold(Rect::EMPTY, |rect, p| rect.union(p.path.bounds()))
    }

    /// The piece's contour, if it has one.
    pub fn outline(&self) -> Option<&Path> {
        self.paths.iter().find(|p| p.role == Role::Outline).map(|p| &p.path)
    }

    /// The drawing without the paths of one operation.
    pub fn without(&self, operation: Operation) -> Drawing {
        let paths = self.paths.iter().filter(|p| p.role.operation() != operation).cloned().collect();
        Drawing { name: self.name.clone(), paths }
    }

    /// The drawing after a turn and a shift.
    pub fn moved(&self, motion: &Motion) -> Drawing {
        let paths = self.paths.iter().map(|p| DrawnPath { path: p.path.moved(motion), ..p.clone() }).collect();
        Drawing { name: self.name.clone(), paths }
    }
}
