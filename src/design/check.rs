//! Which designs make sense.

use super::{Design, Edit, Error, PartDesign, PlaneSource, SCHEMA, Stack};

/// Longest side of anything that is given in mm: no strip is a hundred metres long.
const LONGEST_MM: f64 = 1e5;

impl Design {
    /// Refuses values that make no sense; `file` is where they came from, for messages.
    pub fn check(&self, file: &str) -> Result<(), Error> {
        if self.schema != SCHEMA {
            return Err(Error::Schema { file: file.into(), found: self.schema });
        }
        let wrong = |key: String, problem: &str| Err(Error::Value { file: file.into(), key, problem: problem.into() });
        if self.mesh.as_ref().and_then(|m| m.height_mm).is_some_and(|h| !(h.is_finite() && h > 0.0)) {
            return wrong("mesh: height_mm".into(), "must be a positive number");
        }
        if self.parts.is_empty() {
            return wrong("part".into(), "is missing; a design has at least one [[part]] with a name");
        }
        for (i, part) in self.parts.iter().enumerate() {
            let key = |k: &str| format!("part {}: {k}", part.name);
            if let Some((k, problem)) = name_problem(&part.name).or_else(|| shape_problem(part, self.mesh.is_some())) {
                return wrong(key(k), problem);
            }
            // Some systems do not tell A.svg from a.svg.
            if self.parts[..i].iter().any(|p| p.name.eq_ignore_ascii_case(&part.name)) {
                return wrong(key("name"), "is used twice");
            }
        }
        self.check_edits(file)?;
        self.taken_apart().check_apart(file)
    }

    fn check_edits(&self, file: &str) -> Result<(), Error> {
        let mut names: Vec<&str> = self.parts.iter().map(|p| p.name.as_str()).collect();
        for (i, edit) in self.edits.iter().enumerate() {
            let wrong = |problem: &str| {
                Err(Error::Value {
                    file: file.into(),
                    key: format!("edit {} ({edit})", i + 1),
                    problem: problem.into(),
                })
            };
            let part = edit.part();
            if !names.contains(&part) {
                return wrong(&format!("names a part that is not there; parts are {}", names.join(", ")));
            }
            if let Some(problem) = edit.problem() {
                return wrong(problem);
            }
            let own_shape = self.parts.iter().any(|p| p.name == part && p.width_mm.is_some());
            if matches!(edit, Edit::Plane { .. } | Edit::Split { .. }) && own_shape {
                return wrong("cuts a mesh, and this part has none");
            }
            if let Edit::Split { new, .. } = edit {
                if let Some((_, problem)) = name_problem(new) {
                    return wrong(&format!("gives the new part a name that {problem}"));
                }
                if names.iter().any(|name| name.eq_ignore_ascii_case(new)) {
                    return wrong(&format!("gives the new part the name of another, {new}"));
                }
                // What is left of the part has another stack, with other numbers.
                let counted = |e: &&Edit| e.part() == part && (e.changes_strip() || matches!(e, Edit::Layers { .. }));
                if let Some(before) = self.edits[..i].iter().find(counted) {
                    return wrong(&format!(
                        "comes after '{before}', which counts layers or sections of the part as it was: take that back first"
                    ));
                }
                names.push(new);
            }
        }
        Ok(())
    }
}

/// A key and what is wrong with it.
type Problem = (&'static str, &'static str);

fn name_problem(name: &str) -> Option<Problem> {
    if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-') {
        return Some(("name", "must be letters, digits and '-' only: it is cut into every piece and names files"));
    }
    // Pieces and joints are the name and a number.
    let digit = name.ends_with(|c: char| c.is_ascii_digit());
    digit.then_some(("name", "must not end in a digit: pieces and joints are numbered behind it"))
}

fn shape_problem(part: &PartDesign, mesh: bool) -> Option<Problem> {
    let size = |value: f64| value > 0.0 && value <= LONGEST_MM;
    if part.layers == Some(0) {
        return Some(("layers", "must be at least 1"));
    }
    if let Some(problem) = part.plane.as_ref().and_then(PlaneSource::problem) {
        return Some(("plane", problem));
    }
    let given = match part.stack {
        Some(Stack::Given(given)) => Some(given),
        _ => None,
    };
    if given.is_some_and(|g| g.layers == 0 || !size(g.inner_mm) || !size(g.outer_mm)) {
        return Some(("stack", "needs at least 1 layer and lengths above 0 mm, up to 100 m"));
    }
    let own_shape = part.outline.is_some() || given.is_some();
    match part.width_mm {
        Some(width) if !size(width) => Some(("width_mm", "must be above 0, up to 100 m")),
        Some(_) if !own_shape => {
            Some(("width_mm", "goes with an outline or a stack with lengths: a mesh says itself how wide it is"))
        }
        None if own_shape => Some(("width_mm", "is missing: without a mesh nothing else says how wide the strip is")),
        _ if part.outline.is_some() && given.is_some() => {
            Some(("outline", "and a stack with lengths exclude each other: such a stack fills no outline"))
        }
        _ if own_shape && part.plane.is_some() => {
            Some(("plane", "cuts a mesh; an outline or a stack with lengths needs none"))
        }
        _ if given.is_some() && part.layers.is_some() => Some(("layers", "is said in the stack already")),
        _ if given.is_some() && part.method.is_some() => {
            Some(("method", "is of no use to a stack whose lengths are given"))
        }
        _ if !own_shape && !mesh => Some((
            "name",
            "has no shape: add [mesh] file = \"...\", or to the part an outline or a stack with lengths, and width_mm",
        )),
        _ => None,
    }
}
