//! Which pieces a joint holds together, gathered from the pieces' passages.

use crate::geom::tolerance;
use crate::strip::{Half, Passage, Piece};

/// What holds a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Held {
    /// Flaps that go through slits.
    Flaps,
    /// Rivets, fasteners or thread through holes.
    Holes,
    /// Tape or glue on marked places.
    Tape,
}

/// A joint as it is cut.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Joint<'a> {
    /// "A7", unique in the object.
    pub name: &'a str,
    /// What holds it.
    pub held: Held,
    /// Pieces with its flaps. Two where the pieces of a strip overlap at the joint.
    pub flap_on: Vec<&'a str>,
    /// Sheets with its slits, holes or marks, in the order a flap goes through them: the pieces that have them.
    pub through: Vec<Vec<&'a str>>,
    /// How many times side by side.
    pub abreast: usize,
    /// Whether its flaps are folded toward the person who looks at the drawn side of their piece, or away.
    pub toward: Option<bool>,
}

/// All joints in the order in which the pieces first carry them.
pub(super) fn joints(pieces: &[Piece]) -> Vec<Joint<'_>> {
    let mut joints: Vec<Joint> = Vec::new();
    // Depth and station of every sheet in `through`.
    let mut sheets: Vec<Vec<(usize, f64)>> = Vec::new();
    for piece in pieces {
        for passage in &piece.passages {
            let known = joints.iter().position(|joint| joint.name == passage.joint);
            let i = known.unwrap_or_else(|| {
                joints.push(empty(passage));
                sheets.push(Vec::new());
                joints.len() - 1
            });
            let joint = &mut joints[i];
            joint.abreast = joint.abreast.max(passage.seats.len());
            if passage.half == Half::Flap {
                joint.flap_on.push(&piece.name);
                joint.toward = Some(passage.face == piece.seen_from);
                continue;
            }
            // The same slit in two pieces that overlap is one sheet of the fold.
            let same = |(depth, station): &(usize, f64)| {
                *depth == passage.depth && (station - passage.station_mm).abs() < tolerance::LIMIT_SLACK_MM
            };
            match sheets[i].iter().position(same) {
                Some(sheet) => joint.through[sheet].push(&piece.name),
                None => {
                    let before = sheets[i].partition_point(|(depth, _)| *depth <= passage.depth);
                    sheets[i].insert(before, (passage.depth, passage.station_mm));
                    joint.through.insert(before, vec![&piece.name]);
                }
            }
        }
    }
    joints
}

fn empty(passage: &Passage) -> Joint<'_> {
    let held = match passage.half {
        Half::Flap | Half::Slit => Held::Flaps,
        Half::Holes { .. } => Held::Holes,
        Half::Mark => Held::Tape,
    };
    let (flap_on, through) = (Vec::new(), Vec::new());
    Joint { name: &passage.joint, held, flap_on, through, abreast: 0, toward: None }
}

/// The pieces a part's strip is made of, in its order: those called by the part's name and a number.
pub(super) fn strip_pieces<'a>(part: &str, pieces: &'a [Piece]) -> Vec<&'a Piece> {
    let of_strip = |piece: &&Piece| {
        let number = piece.name.strip_prefix(part).unwrap_or("");
        piece.part == part && !number.is_empty() && number.chars().all(|c| c.is_ascii_digit())
    };
    pieces.iter().filter(of_strip).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Drawing;
    use crate::strip::{Face, Seat};

    fn piece(name: &str, seen_from: Face, passages: &[(&str, Half, usize, f64)]) -> Piece {
        let passage = |(joint, half, depth, station_mm): &(&str, Half, usize, f64)| Passage {
            joint: (*joint).into(),
            station_mm: *station_mm,
            half: *half,
            face: Face::Front,
            depth: *depth,
            sheets: 2,
            seats: vec![Seat { across_mm: 0.0, direction: 1.0 }; 2],
        };
        Piece {
            name: name.into(),
            part: "A".into(),
            drawing: Drawing::default(),
            seen_from,
            stations_mm: 0.0..100.0,
            passages: passages.iter().map(passage).collect(),
            length_mm: 100.0,
            width_mm: 50.0,
            mass_g: 1.0,
        }
    }

    #[test]
    fn a_flap_goes_through_its_sheets_by_depth_and_an_overlap_is_one_sheet() {
        let pieces = [
            piece("A1", Face::Front, &[("A1", Half::Flap, 0, 0.0), ("A1", Half::Slit, 2, 90.0)]),
            piece(
                "A2",
                Face::Back,
                &[("A1", Half::Slit, 2, 90.0), ("A1", Half::Slit, 1, 150.0), ("A2", Half::Flap, 0, 99.0)],
            ),
        ];
        let joints = joints(&pieces);
        assert_eq!(joints.iter().map(|j| j.name).collect::<Vec<_>>(), ["A1", "A2"]);
        assert_eq!(joints[0].flap_on, ["A1"]);
        assert_eq!(joints[0].through, [vec!["A2"], vec!["A1", "A2"]]);
        assert_eq!((joints[0].abreast, joints[0].held), (2, Held::Flaps));
        // Folded toward the front in both; the second piece is drawn from the back.
        assert_eq!((joints[0].toward, joints[1].toward), (Some(true), Some(false)));
    }

    #[test]
    fn base_cards_and_connectors_are_no_pieces_of_the_strip() {
        let pieces = ["A1", "A-base", "B1", "A2", "A"].map(|name| piece(name, Face::Front, &[]));
        let names: Vec<&str> = strip_pieces("A", &pieces).iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names, ["A1", "A2"]);
    }
}
