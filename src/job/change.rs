//! Changing a design: what is asked for becomes an edit, the edited design is worked out, and only then is there a new text.

use super::proposal::split_edit;
use super::survey::{PartSurvey, Survey, survey};
use super::{Error, Order, Source};
use crate::config::Library;
use crate::design::{Base, Design, Edit, Stack};
use crate::fit;
use crate::geom::{P2, P3, Rect, V3};
use crate::progress::Observer;

/// Sections as people name them.
#[derive(Debug, Clone, PartialEq)]
pub enum Places {
    /// Numbers from the picture, or the joints at both ends: "A3-A4", "3-4".
    Named(Vec<String>),
    /// Whatever lies in a box of the picture, from one corner to the other, mm.
    Box([f64; 4]),
}

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// More strip, so often.
    Densify(Places, usize),
    /// Less again.
    Undensify(Places),
    /// A length of the sections, mm.
    LengthMm(Places, f64),
    /// A length of the sections, times what they are drawn with.
    LengthFactor(Places, f64),
    /// A joint ("A3" or "3") in another place of the picture, mm.
    MovePoint(String, [f64; 2]),
    /// So many layers.
    Layers(usize),
    /// So many more, or fewer.
    LayersBy(i64),
    /// Another cut; what is not said stays, and the offset moves the plane along its normal, mm.
    Plane {
        /// A point on it, mesh frame, mm.
        origin_mm: Option<[f64; 3]>,
        /// Its normal.
        normal: Option<[f64; 3]>,
        /// How far it is moved along its normal, mm.
        offset_mm: f64,
    },
    /// Cut in two.
    Split(Cut, Option<String>),
}

/// Where a part is cut in two; its new part is what lies ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cut {
    /// Along an upright line of the picture, so far to the right of its origin, mm. The new part is on the right.
    U(f64),
    /// Along a level line of the picture, so far up, mm. The new part is above.
    V(f64),
    /// Along any plane: a point on it, mesh frame, mm, and its normal.
    Plane([f64; 3], [f64; 3]),
}

/// A design after a change that works.
#[derive(Debug, Clone)]
pub struct Changed {
    /// The edit, in words.
    pub edit: String,
    /// Its number in the list, from 1.
    pub number: usize,
    /// The part before.
    pub before: PartSurvey,
    /// The part now.
    pub after: PartSurvey,
    /// The new part, where the change was a split.
    pub added: Option<PartSurvey>,
    /// What the user should know about the part now.
    pub warnings: Vec<crate::progress::Warning>,
    /// The design file's new text.
    pub text: String,
}

/// Does what is asked to part `part` of the design in `source`, whose files lie in the order's folder. Nothing is written.
///
/// # Errors
/// A request that names what is not there; an edit that does not apply, or after which the part cannot be filled.
pub fn change(
    order: &Order,
    source: &Source,
    part: &str,
    request: &Request,
    library: &Library,
    observer: &mut dyn Observer,
) -> Result<Changed, Error> {
    let before = part_of(survey(order, library, observer)?, part)?;
    let mut edit = edit(&order.design, &before, request)?;
    if edit.changes_strip() && !layers_are_said(&order.design, part) {
        // Numbers mean something for a stack of so many layers only.
        edit.set_on(Base { layers: before.layers.unwrap_or(1), stack: Some(before.stack) });
    }
    let mut design = Design::parse(&source.file, &source.text)?;
    design.edits.push(edit.clone());
    design.check(&source.file)?;
    let text = design.written_over(&source.file, &source.text)?;
    let mut edited = order.clone();
    edited.design.edits.push(edit.clone());
    edited.source = Some(Source { file: source.file.clone(), text: text.clone() });
    let number = design.edits.len();
    let survey = survey(&edited, library, observer).map_err(|error| refused(error, number, &edit))?;
    let new = if let Edit::Split { new, .. } = &edit { Some(new.as_str()) } else { None };
    let told = |name: Option<&str>| name.is_none_or(|p| p == part || Some(p) == new);
    let warnings = survey.warnings.iter().filter(|w| told(w.part.as_deref())).cloned().collect();
    let added = survey.parts.iter().find(|p| Some(p.name.as_str()) == new).cloned();
    let after = part_of(survey, part)?;
    Ok(Changed { edit: edit.to_string(), number, before, after, added, warnings, text })
}

/// A part out of a survey.
fn part_of(survey: Survey, name: &str) -> Result<PartSurvey, Error> {
    let names: Vec<String> = survey.parts.iter().map(|p| p.name.clone()).collect();
    let missing = || Error::Request {
        part: name.to_owned(),
        problem: format!("there is no such part; parts are {}", names.join(", ")),
    };
    survey.parts.into_iter().find(|p| p.name == name).ok_or_else(missing)
}

/// Why a new edit was refused: told of the edit itself, not of its place in a file that does not hold it.
fn refused(error: Error, number: usize, edit: &Edit) -> Error {
    let source = match error {
        Error::Edit { number: n, source, .. } if n == number => {
            fit::Error::Edit { part: edit.part().to_owned(), source }.into()
        }
        other => other,
    };
    Error::Change { what: edit.to_string(), source: Box::new(source) }
}

/// Whether the file says how many layers a part has.
fn layers_are_said(design: &Design, name: &str) -> bool {
    design.taken_apart().parts.iter().filter(|p| p.name == name).any(|part| {
        let decided = design.decided(part);
        decided.layers.is_some() || matches!(decided.stack, Some(Stack::Given(_)))
    })
}

/// The edit that does what is asked to a part of `design` that is as `now`.
fn edit(design: &Design, now: &PartSurvey, request: &Request) -> Result<Edit, Error> {
    let part = now.name.clone();
    let on = None;
    Ok(match request {
        Request::Densify(places, levels) => {
            let loops = |number: &usize| now.sections[*number].closes_room;
            let sections = sections(now, places, "loops", &loops)?;
            Edit::Densify { part, sections, levels: *levels, on }
        }
        Request::Undensify(places) => {
            let dense = |number: &usize| now.sections[*number].level > 0;
            Edit::Undensify { part, sections: sections(now, places, "densified sections", &dense)?, on }
        }
        Request::LengthMm(places, mm) => {
            let sections = sections(now, places, "sections", &|_| true)?;
            Edit::Length { part, sections, length_mm: Some(*mm), factor: None, on }
        }
        Request::LengthFactor(places, factor) => {
            let sections = sections(now, places, "sections", &|_| true)?;
            Edit::Length { part, sections, length_mm: None, factor: Some(*factor), on }
        }
        Request::MovePoint(joint, to_mm) => {
            Edit::MovePoint { joint: joint_number(now, joint)?, part, to_mm: *to_mm, on }
        }
        Request::Layers(layers) => Edit::Layers { part, layers: *layers },
        Request::LayersBy(by) => {
            let layers = now.layers.and_then(|layers| layers.checked_add_signed(*by as isize));
            let few = || wrong(now, "would keep no layer; a ruffle has at least one".into());
            Edit::Layers { part, layers: layers.filter(|n| *n > 0).ok_or_else(few)? }
        }
        Request::Plane { origin_mm, normal, offset_mm } => {
            let normal = normal.unwrap_or(now.plane.normal);
            let origin = P3::from(origin_mm.unwrap_or(now.plane.origin_mm));
            let unit = V3::from(normal).try_normalize(0.0).unwrap_or_default();
            let moved = origin + unit * *offset_mm;
            Edit::Plane { part, origin_mm: [moved.x, moved.y, moved.z].map(rounded), normal }
        }
        Request::Split(cut, name) => {
            let (origin, normal) = match *cut {
                Cut::U(u) => (now.frame.to_space(P2::new(u, 0.0), 0.0), now.frame.u.into()),
                Cut::V(v) => (now.frame.to_space(P2::new(0.0, v), 0.0), now.frame.v.into()),
                Cut::Plane(origin, normal) => (P3::from(origin), normal),
            };
            let mut split = split_edit(design, &part, origin, normal);
            if let (Edit::Split { new, .. }, Some(name)) = (&mut split, name) {
                new.clone_from(name);
            }
            split
        }
    })
}

/// To a thousandth of a millimetre: what people read back from the file.
fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

/// Numbers of the sections that are meant; a box means those in it that `fit`, called `kind`.
fn sections(now: &PartSurvey, places: &Places, kind: &str, fit: &dyn Fn(&usize) -> bool) -> Result<Vec<usize>, Error> {
    let mut found = match places {
        Places::Named(names) => names.iter().map(|name| section(now, name)).collect::<Result<Vec<usize>, Error>>()?,
        Places::Box([u0, v0, u1, v1]) => {
            let corners = Rect::around(&[P2::new(*u0, *v0), P2::new(*u1, *v1)]);
            let inside = |number: &usize| {
                let points = &now.paths[*number];
                2 * points.iter().filter(|p| corners.holds(&Rect::around([*p]), 0.0)).count() > points.len()
            };
            let found: Vec<usize> = (0..now.paths.len()).filter(inside).filter(fit).collect();
            if found.is_empty() {
                let problem = format!(
                    "no {kind} lie by more than half in that box; parts/{}.svg shows where they are, in mm from its origin",
                    now.name
                );
                return Err(wrong(now, problem));
            }
            found
        }
    };
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

/// A section by its number, or by the joints at its ends.
fn section(now: &PartSurvey, name: &str) -> Result<usize, Error> {
    let count = now.sections.len();
    if let Ok(number) = name.parse::<usize>() {
        let missing = || wrong(now, format!("there is no section {number}; it has 0 to {}", count - 1));
        return (number < count).then_some(number).ok_or_else(missing);
    }
    let unclear = || {
        wrong(now, format!("'{name}' is neither the number of a section nor two joints such as {0}3-{0}4", now.name))
    };
    let (from, to) = name.split_once('-').ok_or_else(unclear)?;
    let [from, to] = [from, to].map(|joint| joint_number(now, joint).map(|n| Some(format!("{}{n}", now.name))));
    let (from, to) = (from?, to?);
    let between = |number: &usize| {
        let [a, b] = &now.sections[*number].joints;
        (*a == from && *b == to) || (*a == to && *b == from)
    };
    let found: Vec<usize> = (0..count).filter(between).collect();
    match found.as_slice() {
        [only] => Ok(*only),
        [] => Err(wrong(now, format!("no section runs between {name}; `furbelow design show` lists them"))),
        several => {
            let numbers: Vec<String> = several.iter().map(ToString::to_string).collect();
            Err(wrong(now, format!("several sections run between {name}: name one of {}", numbers.join(", "))))
        }
    }
}

/// A joint's number out of "A3" or "3".
fn joint_number(now: &PartSurvey, name: &str) -> Result<u32, Error> {
    let digits = name.strip_prefix(now.name.as_str()).unwrap_or(name);
    let number = digits.parse::<u32>().ok().filter(|n| (1..=now.joints_mm.len() as u32).contains(n));
    number.ok_or_else(|| {
        wrong(now, format!("there is no joint '{name}'; it has {0}1 to {0}{1}", now.name, now.joints_mm.len()))
    })
}

fn wrong(now: &PartSurvey, problem: String) -> Error {
    Error::Request { part: now.name.clone(), problem }
}
