//! What to do where one ruffle does not reach: a split at the narrowest place, as the command that makes it.

use crate::cut::Outline;
use crate::design::{Design, Edit};
use crate::fit::{Part, largest_gap, neck};
use crate::geom::{P2, P3, Rect, signed_area};
use crate::progress::Warning;

/// More than this share of an outline left empty is worth a word.
const EMPTY_SHARE: f64 = 0.15;

/// More than this share of it sticking out, over a hole.
const BRIDGED_SHARE: f64 = 0.1;

/// Says what of a part's outline stays empty, and where, or that the strip goes across a hole; and proposes a split where the outline has a neck, or through the
/// hole.
pub(super) fn emptiness(design: &Design, part: &Part) -> Option<Warning> {
    let (empty, hole) = (part.report.uncovered_fraction, largest_hole(&part.outline));
    let Some(gap) = (empty > EMPTY_SHARE).then(|| largest_gap(part)).flatten() else {
        let middle = hole.filter(|_| part.report.protruding_fraction > BRIDGED_SHARE)?;
        let message = format!("the strip goes across a hole of the outline. {}", beside_hole(design, part, middle));
        let place = format!("u {:.0}, v {:.0} mm", middle.x, middle.y);
        return Some(Warning::new("hole-bridged", message).in_part(&part.name).at(place));
    };
    let place = format!("u {:.0}, v {:.0} mm", gap.at.x, gap.at.y);
    let mut message = format!(
        "{:.0} % of the outline stays empty, {:.0} % of it here: one ruffle does not reach everywhere in this shape",
        100.0 * empty,
        100.0 * gap.share
    );
    if let Some(neck) = neck(&part.outline, gap.at) {
        let middle = nalgebra::center(&neck.from, &neck.to);
        let along = neck.to - neck.from;
        // The smaller side lies on the chord's right.
        let normal = (part.frame.u * along.y - part.frame.v * along.x).normalize();
        let split = split_edit(design, &part.name, part.frame.to_space(middle, 0.0), normal.into());
        message += &format!(
            ". A split where it is {:.0} mm wide gives {:.0} % of the outline a strip of its own: {}",
            along.norm(),
            100.0 * neck.share,
            command(&split)
        );
    } else if let Some(middle) = hole {
        message += &format!(". {}", beside_hole(design, part, middle));
    } else {
        message += "; other layers, or a plane that shows another outline, may fill more";
    }
    Some(Warning::new("empty", message).in_part(&part.name).at(place))
}

/// The middle of the largest hole.
fn largest_hole(outline: &Outline) -> Option<P2> {
    let largest = outline.holes.iter().max_by(|a, b| signed_area(a).abs().total_cmp(&signed_area(b).abs()))?;
    Some(Rect::around(largest).center())
}

/// The advice to part a shape to the left and right of a hole's middle: two bows are filled where a ring is not.
fn beside_hole(design: &Design, part: &Part, middle: P2) -> String {
    let split = split_edit(design, &part.name, part.frame.to_space(middle, 0.0), part.frame.u.into());
    format!("A split through the hole gives each side a strip of its own: {}", command(&split))
}

/// The split of `part` through a point along the plane across `normal`, as it is written in the file: its new part, ahead of the plane, has a name that is free.
pub(super) fn split_edit(design: &Design, part: &str, origin: P3, normal: [f64; 3]) -> Edit {
    let apart = design.taken_apart();
    let taken = |name: &str| {
        let given = apart.splits.iter().flat_map(|s| &s.into).map(String::as_str);
        apart.parts.iter().map(|p| p.name.as_str()).chain(given).any(|n| n.eq_ignore_ascii_case(name))
    };
    let letters = ('A'..='Z').map(String::from).chain(('A'..='Z').map(|c| format!("{part}{c}")));
    let new = letters.into_iter().find(|name| !taken(name)).unwrap_or_else(|| format!("{part}-cut"));
    let short = |v: f64, digits: f64| (v * digits).round() / digits + 0.0;
    Edit::Split {
        part: part.to_owned(),
        origin_mm: [origin.x, origin.y, origin.z].map(|v| short(v, 100.0)),
        normal: normal.map(|v| short(v, 1e4)),
        new,
    }
}

/// The command that splits so.
fn command(split: &Edit) -> String {
    let Edit::Split { part, origin_mm: [x, y, z], normal: [a, b, c], .. } = split else { return String::new() };
    format!("furbelow design split design.toml {part} --origin {x} {y} {z} --normal {a} {b} {c}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_several_holes_the_largest_is_split() {
        let square = |at: f64, side: f64| {
            [(0.0, 0.0), (0.0, side), (side, side), (side, 0.0)].map(|(x, y)| P2::new(at + x, at + y)).to_vec()
        };
        let outline = Outline { outer: square(0.0, 100.0), holes: vec![square(10.0, 5.0), square(40.0, 20.0)] };
        assert_eq!(largest_hole(&outline), Some(P2::new(50.0, 50.0)));
        assert_eq!(largest_hole(&Outline { holes: Vec::new(), ..outline }), None);
    }

    #[test]
    fn what_is_proposed_takes_a_free_name_and_can_be_typed() {
        let text =
            "schema = 1\nmachine = \"m\"\nmaterial = \"p\"\nmesh = { file = \"a.obj\" }\n\n[[part]]\nname = \"A\"\n\n";
        let mut design = Design::parse("d.toml", text).unwrap();
        let split = split_edit(&design, "A", P3::new(1.0, 106.12345, -0.0), [0.0, 1.0, -0.0]);
        assert_eq!(split.to_string(), "split A through 1, 106.12, 0 mm, normal 0, 1, 0: A and B");
        assert_eq!(command(&split), "furbelow design split design.toml A --origin 1 106.12 0 --normal 0 1 0");
        design.edits.push(split);
        design.check("d.toml").unwrap();
        let next = split_edit(&design, "A", P3::origin(), [0.0, 1.0, 0.0]);
        assert!(next.to_string().ends_with("A and C"), "{next}");
    }
}
