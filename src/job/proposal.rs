//! What to do where one ruffle does not reach: a split at the narrowest place, ready to paste into the design.

use crate::design::{Design, Split};
use crate::fit::{Part, largest_gap, neck};
use crate::geom::P3;
use crate::progress::Warning;

/// More than this share of an outline left empty is worth a word.
const EMPTY_SHARE: f64 = 0.15;

/// Says what of a part's outline stays empty, and where, and proposes a split where the outline has a neck.
pub(super) fn emptiness(design: &Design, part: &Part) -> Option<Warning> {
    let empty = part.report.uncovered_fraction;
    let gap = (empty > EMPTY_SHARE).then(|| largest_gap(part)).flatten()?;
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
        let split = proposed(design, &part.name, part.frame.to_space(middle, 0.0), normal.into());
        message += &format!(
            ". A split where it is {:.0} mm wide gives {:.0} % of the outline a strip of its own. In the design:\n\n{}\n",
            along.norm(),
            100.0 * neck.share,
            pasted(&split)
        );
    } else {
        message += "; other layers, or a plane that shows another outline, may fill more";
    }
    Some(Warning::new("empty", message).in_part(&part.name).at(place))
}

/// A split of `part` whose new part, ahead of the plane, has a name that is free.
fn proposed(design: &Design, part: &str, origin: P3, normal: [f64; 3]) -> Split {
    let taken = |name: &str| {
        let given = design.splits.iter().flat_map(|s| &s.into).map(String::as_str);
        design.parts.iter().map(|p| p.name.as_str()).chain(given).any(|n| n.eq_ignore_ascii_case(name))
    };
    let letters = ('A'..='Z').map(String::from).chain(('A'..='Z').map(|c| format!("{part}{c}")));
    let new = letters.into_iter().find(|name| !taken(name)).unwrap_or_else(|| format!("{part}-cut"));
    let short = |v: f64, digits: f64| (v * digits).round() / digits + 0.0;
    Split {
        part: Some(part.to_owned()),
        origin_mm: [origin.x, origin.y, origin.z].map(|v| short(v, 100.0)),
        normal: normal.map(|v| short(v, 1e4)),
        into: [part.to_owned(), new],
    }
}

/// The split as it is written in a design file, with its new part.
fn pasted(split: &Split) -> String {
    let name = |s: &str| format!("\"{s}\"");
    let part = split.part.as_deref().map_or(String::new(), |p| format!("part = {}\n", name(p)));
    format!(
        "[[split]]\n{part}origin_mm = {:?}\nnormal = {:?}\ninto = [{}, {}]\n\n[[part]]\nname = {}",
        split.origin_mm,
        split.normal,
        name(&split.into[0]),
        name(&split.into[1]),
        name(&split.into[1])
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_proposed_can_be_pasted_and_takes_a_free_name() {
        let text =
            "schema = 1\nmachine = \"m\"\nmaterial = \"p\"\nmesh = { file = \"a.obj\" }\n\n[[part]]\nname = \"A\"\n\n";
        let mut design = Design::parse("d.toml", text).unwrap();
        let split = proposed(&design, "A", P3::new(1.0, 106.12345, -0.0), [0.0, 1.0, -0.0]);
        assert_eq!((split.into[1].as_str(), split.origin_mm[1]), ("B", 106.12));
        let pasted = Design::parse("d.toml", &(text.to_owned() + &pasted(&split))).unwrap();
        assert_eq!(pasted.splits, std::slice::from_ref(&split));
        assert_eq!(pasted.parts.len(), 2);
        design.splits.push(split);
        assert_eq!(proposed(&design, "A", P3::origin(), [0.0, 1.0, 0.0]).into[1], "C");
    }
}
