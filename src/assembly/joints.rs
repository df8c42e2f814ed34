//! Which pieces a joint holds together, gathered from the pieces' passages.

use crate::geom::tolerance;
use crate::strip::{Face, Half, Piece};

/// A joint as it is cut.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Joint<'a> {
    /// "A7", unique in the object.
    pub name: &'a str,
    /// Pieces with its flaps. Two where the pieces of a strip overlap at the joint.
    pub flap_on: Vec<&'a str>,
    /// Sheets its flaps go through, in this order: the pieces with the slits of each.
    pub through: Vec<Vec<&'a str>>,
    /// Flaps side by side.
    pub flaps: usize,
    /// Which way they are folded, seen with the piece's drawn side up: the front is toward you.
    pub fold: Option<Face>,
}

/// All joints in the order in which the pieces first carry them.
pub(super) fn joints(pieces: &[Piece]) -> Vec<Joint<'_>> {
    let mut joints: Vec<Joint> = Vec::new();
    // Stations of the slits of each joint, sheet by sheet.
    let mut sheets: Vec<Vec<(usize, f64)>> = Vec::new();
    for piece in pieces {
        for passage in &piece.passages {
            let known = joints.iter().position(|joint| joint.name == passage.joint);
            let i = known.unwrap_or_else(|| {
                let name = &passage.joint;
                joints.push(Joint { name, flap_on: Vec::new(), through: Vec::new(), flaps: 0, fold: None });
                sheets.push(Vec::new());
                joints.len() - 1
            });
            let joint = &mut joints[i];
            match passage.half {
                Half::Flap => {
                    joint.flap_on.push(&piece.name);
                    joint.flaps = joint.flaps.max(passage.seats.len());
                    joint.fold = Some(passage.face);
                }
                Half::Slit => {
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
        }
    }
    joints
}

/// The pieces a part's strip is made of, in its order: those called by the part's name and a number.
pub(super) fn strip_pieces<'a>(part: &str, pieces: &'a [Piece]) -> Vec<&'a Piece> {
    let of_strip = |piece: &&Piece| {
        let number = piece.name.strip_prefix(part).unwrap_or("");
        piece.part == part && !number.is_empty() && number.chars().all(|c| c.is_ascii_digit())
    };
    pieces.iter().filter(of_strip).collect()
}
