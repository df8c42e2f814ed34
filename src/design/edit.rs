//! What a user changed after the first look, one entry for each command: the list is the history, and undoing takes the last one away.

use super::{Design, Direction, PartDesign, PlaneSource, Split, Stack};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Most levels of one densification: a loop is divided by three, so four levels make 81 of it.
pub const MAX_LEVELS: usize = 4;

/// One change. Sections and joints have the numbers that the picture shows before it; those of earlier edits are as they were then.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Edit {
    /// More strip, and stiffer.
    Densify {
        /// The part.
        part: String,
        /// Its sections.
        sections: Vec<usize>,
        /// How often: from the second time on, the loops that the time before made.
        #[serde(default = "once", skip_serializing_if = "is_once")]
        levels: usize,
        /// What the numbers refer to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        on: Option<Base>,
    },
    /// Less again.
    Undensify {
        /// The part.
        part: String,
        /// Its sections; each is taken back with those that were made together with it.
        sections: Vec<usize>,
        /// What the numbers refer to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        on: Option<Base>,
    },
    /// Sections of a length given by hand, which filling leaves alone.
    Length {
        /// The part.
        part: String,
        /// Its sections.
        sections: Vec<usize>,
        /// Length of each, mm.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        length_mm: Option<f64>,
        /// Or the same as it is drawn with, times this.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        factor: Option<f64>,
        /// What the numbers refer to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        on: Option<Base>,
    },
    /// A joint in another place.
    MovePoint {
        /// The part.
        part: String,
        /// Its joint, as numbered.
        joint: u32,
        /// Where it goes: u and v in the picture, mm.
        to_mm: [f64; 2],
        /// What the number refers to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        on: Option<Base>,
    },
    /// Another number of layers. Sections are numbered from the bottom, so edits of lower layers stay what they are.
    Layers {
        /// The part.
        part: String,
        /// How many.
        layers: usize,
    },
    /// Another cut.
    Plane {
        /// The part.
        part: String,
        /// A point on the plane, mesh frame, mm.
        origin_mm: [f64; 3],
        /// Its normal, of any length.
        normal: [f64; 3],
    },
    /// A part cut in two; what lies ahead of the plane is a part of its own from then on.
    Split {
        /// The part; what lies behind the plane keeps its name.
        part: String,
        /// A point on the plane, mesh frame, mm.
        origin_mm: [f64; 3],
        /// Its normal, of any length.
        normal: [f64; 3],
        /// Name of the new part.
        new: String,
    },
}

/// The clean stack that numbers were read from, written down with the first edit that names sections: a program that chooses better another day must not
/// give them another meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Base {
    /// Its layers.
    pub layers: usize,
    /// Which way they lie.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stack: Option<Direction>,
}

fn once() -> usize {
    1
}

fn is_once(levels: &usize) -> bool {
    *levels == once()
}

impl Edit {
    /// Name of the part it changes.
    pub fn part(&self) -> &str {
        match self {
            Edit::Densify { part, .. }
            | Edit::Undensify { part, .. }
            | Edit::Length { part, .. }
            | Edit::MovePoint { part, .. }
            | Edit::Layers { part, .. }
            | Edit::Plane { part, .. }
            | Edit::Split { part, .. } => part,
        }
    }

    /// The stack its numbers refer to, where it says so.
    pub fn on(&self) -> Option<Base> {
        match self {
            Edit::Densify { on, .. }
            | Edit::Undensify { on, .. }
            | Edit::Length { on, .. }
            | Edit::MovePoint { on, .. } => *on,
            Edit::Layers { .. } | Edit::Plane { .. } | Edit::Split { .. } => None,
        }
    }

    /// Says which stack its numbers refer to.
    pub fn set_on(&mut self, base: Base) {
        match self {
            Edit::Densify { on, .. }
            | Edit::Undensify { on, .. }
            | Edit::Length { on, .. }
            | Edit::MovePoint { on, .. } => *on = Some(base),
            Edit::Layers { .. } | Edit::Plane { .. } | Edit::Split { .. } => {}
        }
    }

    /// True for what changes the drawn strip; false for what decides how it is drawn to begin with.
    pub fn changes_strip(&self) -> bool {
        !matches!(self, Edit::Layers { .. } | Edit::Plane { .. } | Edit::Split { .. })
    }

    /// What makes no sense about it, whatever the part.
    pub(super) fn problem(&self) -> Option<&'static str> {
        if self.on().is_some_and(|on| on.layers == 0) {
            return Some("on: layers must be at least 1");
        }
        match self {
            Edit::Densify { sections, .. } | Edit::Undensify { sections, .. } | Edit::Length { sections, .. }
                if sections.is_empty() =>
            {
                Some("names no sections; give at least one, such as sections = [3]")
            }
            Edit::Densify { levels, .. } if !(1..=MAX_LEVELS).contains(levels) => Some("levels must be 1 to 4"),
            Edit::Length { length_mm, factor, .. } => {
                let good = |value: f64| value > 0.0 && value.is_finite();
                match (length_mm, factor) {
                    (Some(value), None) | (None, Some(value)) if good(*value) => None,
                    (Some(_), None) | (None, Some(_)) => Some("needs a length above 0"),
                    _ => Some("needs either length_mm or factor"),
                }
            }
            Edit::MovePoint { to_mm, .. } if !to_mm.iter().all(|v| v.is_finite()) => {
                Some("needs finite numbers in to_mm")
            }
            Edit::Layers { layers: 0, .. } => Some("layers must be at least 1"),
            Edit::Plane { origin_mm, normal, .. } | Edit::Split { origin_mm, normal, .. } => {
                PlaneSource { origin_mm: *origin_mm, normal: *normal }.problem()
            }
            _ => None,
        }
    }
}

/// As people name it: "densify A 1 3".
impl fmt::Display for Edit {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let list = |sections: &[usize]| sections.iter().map(|s| format!(" {s}")).collect::<String>();
        match self {
            Edit::Densify { part, sections, levels, .. } => {
                write!(f, "densify {part}{}", list(sections))?;
                if is_once(levels) { Ok(()) } else { write!(f, ", {levels} levels") }
            }
            Edit::Undensify { part, sections, .. } => write!(f, "undensify {part}{}", list(sections)),
            Edit::Length { part, sections, length_mm: Some(mm), .. } => {
                write!(f, "length {part}{}: {mm} mm", list(sections))
            }
            Edit::Length { part, sections, factor, .. } => {
                write!(f, "length {part}{}: times {}", list(sections), factor.unwrap_or(1.0))
            }
            Edit::MovePoint { part, joint, to_mm: [u, v], .. } => {
                write!(f, "move-point {part} {joint} to {u}, {v} mm")
            }
            Edit::Layers { part, layers } => write!(f, "layers {part} {layers}"),
            Edit::Plane { part, origin_mm: [x, y, z], normal: [a, b, c] } => {
                write!(f, "plane {part} through {x}, {y}, {z} mm, normal {a}, {b}, {c}")
            }
            Edit::Split { part, origin_mm: [x, y, z], normal: [a, b, c], new } => {
                write!(f, "split {part} through {x}, {y}, {z} mm, normal {a}, {b}, {c}: {part} and {new}")
            }
        }
    }
}

impl Design {
    /// The edits of a part that change its strip, with their numbers in the list, from 1.
    pub fn strip_edits<'a>(&'a self, part: &'a str) -> impl Iterator<Item = (usize, &'a Edit)> {
        let numbered = self.edits.iter().enumerate().map(|(i, edit)| (i + 1, edit));
        numbered.filter(move |(_, edit)| edit.part() == part && edit.changes_strip())
    }

    /// A part with what edits decide about how it is cut and drawn: the last word on its plane, its layers and which way they lie.
    pub fn decided(&self, part: &PartDesign) -> PartDesign {
        let mut decided = part.clone();
        for edit in self.edits.iter().filter(|edit| edit.part() == part.name) {
            match edit {
                Edit::Layers { layers, .. } => match &mut decided.stack {
                    Some(Stack::Given(given)) => given.layers = *layers,
                    _ => decided.layers = Some(*layers),
                },
                Edit::Plane { origin_mm, normal, .. } => {
                    decided.plane = Some(PlaneSource { origin_mm: *origin_mm, normal: *normal });
                }
                _ => {}
            }
            if let Some(on) = edit.on().filter(|_| !matches!(decided.stack, Some(Stack::Given(_)))) {
                decided.layers = Some(on.layers);
                if let Some(direction) = on.stack {
                    decided.stack = Some(Stack::Toward(direction));
                }
            }
        }
        decided
    }

    /// This design with every split that is an edit among those of the file, and a part for what it gives.
    pub fn taken_apart(&self) -> Design {
        let mut apart = self.clone();
        for edit in &self.edits {
            if let Edit::Split { part, origin_mm, normal, new } = edit {
                let (part, new) = (part.clone(), new.clone());
                let into = [part.clone(), new.clone()];
                apart.splits.push(Split { part: Some(part), origin_mm: *origin_mm, normal: *normal, into });
                apart.parts.push(PartDesign::new(&new));
            }
        }
        apart
    }

    /// Takes the last edit away.
    pub fn undo(&mut self) -> Option<Edit> {
        self.edits.pop()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Any edit of part A, of sections up to `sections`, so that some apply to a stack and some do not.
    pub(crate) fn any_edit(sections: usize) -> impl Strategy<Value = Edit> {
        let part = || Just("A".to_owned());
        let some = move || prop::collection::vec(0..sections, 1..4);
        let on = || prop::option::of((1usize..5).prop_map(|layers| Base { layers, stack: Some(Direction::Vertical) }));
        let quarter = |range: std::ops::Range<i32>| range.prop_map(|n| f64::from(n) / 4.0);
        prop_oneof![
            3 => (part(), some(), 1usize..3, on())
                .prop_map(|(part, sections, levels, on)| Edit::Densify { part, sections, levels, on }),
            2 => (part(), some(), on()).prop_map(|(part, sections, on)| Edit::Undensify { part, sections, on }),
            2 => (part(), some(), quarter(80..320), on()).prop_map(|(part, sections, mm, on)| Edit::Length {
                part,
                sections,
                length_mm: Some(mm),
                factor: None,
                on
            }),
            1 => (part(), some(), quarter(2..7), on()).prop_map(|(part, sections, factor, on)| Edit::Length {
                part,
                sections,
                length_mm: None,
                factor: Some(factor),
                on
            }),
            2 => (part(), 1u32..9, quarter(-60..260), quarter(0..300), on())
                .prop_map(|(part, joint, u, v, on)| Edit::MovePoint { part, joint, to_mm: [u, v], on }),
            1 => (part(), 1usize..5).prop_map(|(part, layers)| Edit::Layers { part, layers }),
            1 => (part(), quarter(-9..9)).prop_map(|(part, x)| Edit::Plane {
                part,
                origin_mm: [x, 0.0, 1.5],
                normal: [0.0, x, 1.0]
            }),
        ]
    }

    const TEXT: &str = "# mine\nschema = 1\nmachine = \"m\"\nmaterial = \"p\" # thick\n\n[mesh]\nfile = \"a.obj\"\n\n# the seat\n[[part]]\nname = \"A\" # only one\n\n# first idea\n[[edit]]\ndo = \"layers\" # more\npart = \"A\"\nlayers = 3\n";

    proptest! {
        #[test]
        fn any_edits_read_back_as_they_were_written(edits in prop::collection::vec(any_edit(30), 0..6)) {
            let mut design = Design::parse("d.toml", TEXT).unwrap();
            design.edits.extend(edits);
            prop_assert_eq!(Design::parse("d.toml", &design.to_toml()), Ok(design.clone()));
            let over = design.written_over("d.toml", TEXT).unwrap();
            prop_assert_eq!(Design::parse("d.toml", &over), Ok(design));
            prop_assert!(over.starts_with(TEXT), "{}", over);
        }

        #[test]
        fn undoing_gives_the_same_text_back(edits in prop::collection::vec(any_edit(30), 1..5)) {
            let mut design = Design::parse("d.toml", TEXT).unwrap();
            let mut texts = vec![TEXT.to_owned()];
            for edit in edits {
                design.edits.push(edit);
                texts.push(design.written_over("d.toml", &texts[texts.len() - 1]).unwrap());
            }
            while texts.len() > 1 {
                let text = texts.pop().unwrap();
                design.undo();
                prop_assert_eq!(&design.written_over("d.toml", &text).unwrap(), &texts[texts.len() - 1]);
            }
        }
    }

    #[test]
    fn edits_in_one_line_keep_their_place_and_comments_too() {
        let inline = TEXT
            .split("# first")
            .next()
            .unwrap()
            .replace("\n[mesh]", "edit = [\n  { do = \"layers\", part = \"A\", layers = 3 }, # more\n]\n\n[mesh]");
        let mut design = Design::parse("d.toml", &inline).unwrap();
        design.edits.push(Edit::Layers { part: "A".into(), layers: 4 });
        let more = design.written_over("d.toml", &inline).unwrap();
        assert_eq!(Design::parse("d.toml", &more).as_ref(), Ok(&design), "{more}");
        assert!(more.contains("# more") && super::super::edit_line(&more, 2).is_some(), "{more}");
    }

    #[test]
    fn what_is_wrong_with_an_edit_is_told_with_its_line() {
        let text = |body: &str| format!("{TEXT}\n[[edit]]\n{body}\n");
        let split = |part: &str, new: &str| {
            format!("do = \"split\"\npart = \"{part}\"\norigin_mm = [0, 5, 0]\nnormal = [0, 1, 0]\nnew = \"{new}\"")
        };
        for (body, words) in [
            (
                "do = \"densfy\"\npart = \"A\"\nsections = [1]",
                "d.toml:20:7: unknown value 'densfy'; did you mean 'densify'?",
            ),
            (
                "do = \"densify\"\npart = \"A\"\nsectoins = [1]",
                "d.toml:22:1: unknown key 'sectoins'; did you mean 'sections'?",
            ),
            ("do = \"densify\"\npart = \"A\"", "missing field `sections`"),
            ("do = \"densify\"\npart = \"B\"\nsections = [1]", "edit 2 (densify B 1) names a part that is not there"),
            ("do = \"densify\"\npart = \"A\"\nsections = []", "names no sections"),
            ("do = \"densify\"\npart = \"A\"\nsections = [1]\nlevels = 9", "levels must be 1 to 4"),
            ("do = \"length\"\npart = \"A\"\nsections = [1]", "either length_mm or factor"),
            ("do = \"length\"\npart = \"A\"\nsections = [1]\nlength_mm = -2", "a length above 0"),
            ("do = \"plane\"\npart = \"A\"\norigin_mm = [0, 0, 0]\nnormal = [0, 0, 0]", "a normal that is not zero"),
            (&split("A", "B"), "edit 2 (split A through 0, 5, 0 mm, normal 0, 1, 0: A and B) comes after 'layers A 3'"),
            (&split("A", "a"), "gives the new part the name of another, a"),
            (&split("A", "B2"), "gives the new part a name that must not end in a digit"),
            (&split("B", "C"), "names a part that is not there; parts are A"),
        ] {
            let message = Design::parse("d.toml", &text(body)).unwrap_err().to_string();
            assert!(message.contains(words), "{body}: {message}");
        }
        assert_eq!([1, 2].map(|n| super::super::edit_line(&text("do = \"layers\""), n)), [Some(14), Some(19)]);
    }

    #[test]
    fn a_split_reads_back_and_undoing_it_gives_the_same_text() {
        let whole = TEXT.split("# first idea").next().unwrap();
        let mut design = Design::parse("d.toml", whole).unwrap();
        let (part, new) = ("A".to_owned(), "B".to_owned());
        design.edits.push(Edit::Split { part, origin_mm: [0.0, 5.25, 0.0], normal: [0.0, 1.0, 0.0], new });
        let text = design.written_over("d.toml", whole).unwrap();
        assert_eq!(Design::parse("d.toml", &text), Ok(design.clone()));
        assert_eq!(Design::parse("d.toml", &design.to_toml()), Ok(design.clone()));
        design.undo();
        assert_eq!(design.written_over("d.toml", &text).unwrap(), whole);
    }

    #[test]
    fn what_a_split_gives_is_a_part_that_later_edits_can_name() {
        let mut design = Design::parse("d.toml", TEXT).unwrap();
        design.edits.clear();
        let (part, new) = ("A".to_owned(), "B".to_owned());
        design.edits.push(Edit::Split { part, origin_mm: [0.0, 5.0, 0.0], normal: [0.0, 1.0, 0.0], new });
        design.edits.push(Edit::Layers { part: "B".into(), layers: 2 });
        let text = design.written_over("d.toml", TEXT).unwrap();
        assert_eq!(Design::parse("d.toml", &text), Ok(design.clone()));
        let apart = design.taken_apart();
        assert_eq!(apart.splits[0].into, ["A", "B"]);
        assert_eq!(apart.decided(&apart.parts[1]).layers, Some(2));
    }

    #[test]
    fn the_last_word_on_plane_and_layers_counts() {
        let mut design = Design::parse("d.toml", TEXT).unwrap();
        let part = design.parts[0].clone();
        assert_eq!(design.decided(&part).layers, Some(3));
        let on = Some(Base { layers: 5, stack: Some(Direction::Horizontal) });
        design.edits.push(Edit::Densify { part: "A".into(), sections: vec![1], levels: 1, on });
        let decided = design.decided(&part);
        assert_eq!((decided.layers, decided.stack), (Some(5), Some(Stack::Toward(Direction::Horizontal))));
        design.edits.push(Edit::Layers { part: "A".into(), layers: 4 });
        assert_eq!(design.decided(&part).layers, Some(4));
    }
}
