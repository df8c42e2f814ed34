//! How a shape is taken apart: bodies, split planes, and the strips that tie the parts together again.

use super::{Design, Error, PlaneSource};
use crate::geom::{P3, V3};
use serde::{Deserialize, Serialize};

/// A plane that takes a part in two. Splits apply in the file's order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// What is split: a part, or what an earlier split gave; absent: the whole shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// A point on the plane, mesh frame, mm.
    pub origin_mm: [f64; 3],
    /// Its normal, of any length.
    pub normal: [f64; 3],
    /// Names of what lies behind the plane and of what lies ahead of it, where the normal points.
    pub into: [String; 2],
}

/// A strip that ties two parts together at a connection point of each.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Connector {
    /// Joint at one end, as written on its flap: "A7".
    pub from: String,
    /// Joint at the other: "B2".
    pub to: String,
}

/// Which way the strips of an object run in the sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StripAlong {
    /// Along the grain: stiffer, springs back best.
    #[default]
    Grain,
    /// Across it: softer.
    Across,
}

impl StripAlong {
    pub(super) fn is_default(&self) -> bool {
        *self == StripAlong::default()
    }
}

impl Split {
    /// A point on the plane, mm, and its unit normal.
    pub fn plane(&self) -> (P3, V3) {
        let plane = PlaneSource { origin_mm: self.origin_mm, normal: self.normal }.plane();
        (plane.origin, plane.normal)
    }
}

impl Connector {
    /// Part and joint number at both ends: "A7" is joint 7 of part A. Nothing for a name that no joint has.
    pub fn ends(&self) -> Option<[(&str, u32); 2]> {
        let cut = |name: &'_ str| -> Option<(usize, u32)> {
            let part = name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
            Some((part, name[part..].parse().ok()?)).filter(|_| part > 0)
        };
        let (from, to) = (cut(&self.from)?, cut(&self.to)?);
        Some([(&self.from[..from.0], from.1), (&self.to[..to.0], to.1)])
    }
}

impl Design {
    /// Refuses splits, bodies and connectors that contradict each other or the parts; what depends on the mesh shows when the design is made.
    pub(super) fn check_apart(&self, file: &str) -> Result<(), Error> {
        let wrong = |key: String, problem: String| Err(Error::Value { file: file.into(), key, problem });
        // What there is to split, before the split that is looked at.
        let mut known: Vec<&str> = self.parts.iter().map(|p| p.name.as_str()).collect();
        let mut given: Vec<&str> =
            self.parts.iter().filter(|p| !p.bodies.is_empty()).map(|p| p.name.as_str()).collect();
        for (i, split) in self.splits.iter().enumerate() {
            let key = |k: &str| format!("split {}: {k}", i + 1);
            let plane = PlaneSource { origin_mm: split.origin_mm, normal: split.normal };
            if let Some(problem) = plane.problem() {
                return wrong(key("plane"), problem.into());
            }
            if let Some(part) = &split.part
                && !known.contains(&part.as_str())
            {
                return wrong(key("part"), format!("'{part}' is neither a part nor what an earlier split gave"));
            }
            given.retain(|name| split.part.as_deref() != Some(*name));
            for name in &split.into {
                if given.contains(&name.as_str()) || split.into[0] == split.into[1] {
                    return wrong(key("into"), format!("gives '{name}' twice; every piece needs a name of its own"));
                }
            }
            given.extend(split.into.iter().map(String::as_str));
            known.extend(split.into.iter().map(String::as_str));
        }
        for part in &self.parts {
            let key = format!("part {}: bodies", part.name);
            if part.bodies.contains(&0) {
                return wrong(key, "are counted from 1".into());
            }
            if (1..part.bodies.len()).any(|i| part.bodies[..i].contains(&part.bodies[i])) {
                return wrong(key, "names a body twice".into());
            }
        }
        for (i, connector) in self.connectors.iter().enumerate() {
            let key = format!("connector {}", i + 1);
            let Some([(from, _), (to, _)]) = connector.ends() else {
                return wrong(key, "needs joints such as from = \"A7\", to = \"B2\"".into());
            };
            if let Some(missing) = [from, to].into_iter().find(|name| !self.parts.iter().any(|p| p.name == *name)) {
                return wrong(key, format!("names a joint of '{missing}', which is no part"));
            }
            if from == to {
                return wrong(key, format!("ties part {from} to itself; it needs joints of two parts"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str =
        "schema = 1\nmachine = \"m\"\nmaterial = \"p\"\nstrip_along = \"across\"\n\n[mesh]\nfile = \"a.obj\"\n\n";

    fn parsed(body: &str) -> Result<Design, Error> {
        Design::parse("d.toml", &format!("{HEAD}{body}"))
    }

    #[test]
    fn splits_bodies_and_connectors_read_back() {
        let body = "[[split]]\norigin_mm = [0, 106, 0]\nnormal = [0, 1, 0]\ninto = [\"low\", \"head\"]\n\n[[split]]\npart = \"low\"\norigin_mm = [0, 30, 0]\nnormal = [0, 1, 0]\ninto = [\"legs\", \"low\"]\n\n\
            [[part]]\nname = \"low\"\n\n[[part]]\nname = \"head\"\n\n[[part]]\nname = \"arm\"\nbodies = [4, 2]\n\n[[connector]]\nfrom = \"low12\"\nto = \"head3\"\n";
        let design = parsed(body).unwrap();
        assert_eq!(design.connectors[0].ends(), Some([("low", 12), ("head", 3)]));
        assert_eq!(design.strip_along, StripAlong::Across);
        assert_eq!(design.splits[1].plane(), (P3::new(0.0, 30.0, 0.0), V3::y()));
        assert_eq!(Design::parse("e.toml", &design.to_toml()), Ok(design));
    }

    #[test]
    fn what_contradicts_itself_is_named() {
        let split = |part: &str, into: &str| {
            format!("[[split]]\n{part}origin_mm = [0, 0, 0]\nnormal = [0, 1, 0]\ninto = [{into}]\n\n")
        };
        let parts = "[[part]]\nname = \"A\"\n\n[[part]]\nname = \"B\"\n\n";
        for (body, words) in [
            (split("part = \"Q\"\n", "\"A\", \"B\""), "split 1: part 'Q' is neither"),
            (split("", "\"A\", \"A\""), "twice"),
            (split("", "\"A\", \"B\"") + &split("part = \"A\"\n", "\"A\", \"B\""), "split 2: into gives 'B' twice"),
            (split("", "\"A\", \"B\"").replace("[0, 1, 0]", "[0, 0, 0]"), "split 1: plane needs"),
            (
                split("", "\"A\", \"B\"")
                    + "[[part]]\nname = \"D\"\n\n[[part]]\nname = \"E\"\nbodies = [1]\n\n"
                    + &split("", "\"D\", \"E\""),
                "split 2: into gives 'E' twice",
            ),
            ("[[connector]]\nfrom = \"A1\"\nto = \"C2\"\n\n".into(), "'C', which is no part"),
            ("[[connector]]\nfrom = \"A1\"\nto = \"A2\"\n\n".into(), "to itself"),
            ("[[connector]]\nfrom = \"A\"\nto = \"B2\"\n\n".into(), "needs joints such as"),
        ] {
            let message = parsed(&(body.clone() + parts)).unwrap_err().to_string();
            assert!(message.contains(words), "{body}: {message}");
        }
        let message = parsed("[[part]]\nname = \"A\"\nbodies = [1, 1]\n").unwrap_err().to_string();
        assert!(message.contains("part A: bodies names a body twice"), "{message}");
    }
}
