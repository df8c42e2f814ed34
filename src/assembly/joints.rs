//! Which pieces a joint holds together, and where pieces of one strip overlap, read from the drawings that are cut.

use super::rooms::Rooms;
use crate::drawing::{DrawnPath, Role};
use crate::fit::Part;
use crate::geom::{P2, tolerance};
use crate::strip::Piece;

/// Which way a flap is folded, seen with the piece's drawn side up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fold {
    Toward,
    Away,
    /// Sheets on both sides.
    Both,
}

/// A joint as it is cut.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Joint {
    /// "A7", unique in the object.
    pub name: String,
    /// Pieces with its flaps, without repeats.
    pub flap_on: Vec<String>,
    /// Pieces with its slits, once for every sheet that a flap goes through.
    pub slit_on: Vec<String>,
    /// Flaps side by side.
    pub flaps: usize,
    /// Which way they are folded; nothing for joints that are none of a part.
    pub fold: Option<Fold>,
}

/// Two pieces of one strip that overlap.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Splice {
    /// The part.
    pub part: String,
    /// The piece that ends.
    pub from: String,
    /// The piece that begins.
    pub to: String,
    /// Where, along the strip, mm.
    pub start_mm: f64,
    /// How far they overlap, mm.
    pub overlap_mm: f64,
    /// The joint in the overlap, when its flap holds both.
    pub joint: Option<String>,
}

/// All joints, part by part in the order of their numbers; then those that are of no part.
pub(super) fn joints(parts: &[Part], pieces: &[Piece]) -> Vec<Joint> {
    let mut joints: Vec<Joint> = Vec::new();
    for part in parts {
        let connections = part.ruffle.connection_points();
        let rooms = Rooms::of(part, &connections);
        let stations = part.ruffle.stations();
        for (j, connection) in connections.iter().enumerate() {
            let name = format!("{}{}", part.name, connection.joint);
            let mut joint = as_cut(&name, pieces);
            let flap = paths(pieces, &name, Role::Flap).next().and_then(|(_, path)| root(path));
            joint.fold = flap.map(|flap| {
                let nearest = |a: &usize, b: &usize| {
                    let off = |pass: &usize| (stations[connection.passes[*pass]] - flap.x).abs();
                    off(a).total_cmp(&off(b))
                };
                let own = (0..connection.passes.len()).min_by(nearest).unwrap_or(0);
                let others = || (0..connection.passes.len()).filter(|pass| *pass != own);
                // Pieces are drawn as seen from the right of the strip's way.
                match (others().all(|o| rooms.on_right(j, own, o)), others().any(|o| rooms.on_right(j, own, o))) {
                    (true, _) => Fold::Toward,
                    (false, false) => Fold::Away,
                    (false, true) => Fold::Both,
                }
            });
            joints.push(joint);
        }
    }
    let named = pieces.iter().flat_map(|p| &p.drawing.paths).filter_map(|path| path.joint.as_ref());
    for name in named {
        if !joints.iter().any(|joint| joint.name == *name) {
            joints.push(as_cut(name, pieces));
        }
    }
    joints
}

fn as_cut(name: &str, pieces: &[Piece]) -> Joint {
    let flaps: Vec<&str> = paths(pieces, name, Role::Flap).map(|(piece, _)| piece).collect();
    let mut flap_on: Vec<String> = flaps.iter().map(|piece| (*piece).to_owned()).collect();
    flap_on.dedup();
    let across = (flaps.len() / flap_on.len().max(1)).max(1);
    // Slits side by side take flaps side by side; further ones are further sheets.
    let slits: Vec<&str> = paths(pieces, name, Role::Slit).map(|(piece, _)| piece).collect();
    let slit_on = slits.chunks(across).filter_map(|sheet| sheet.first()).map(|piece| (*piece).to_owned()).collect();
    Joint { name: name.to_owned(), flap_on, slit_on, flaps: across, fold: None }
}

/// Cuts of a joint with the names of their pieces.
fn paths<'a>(pieces: &'a [Piece], joint: &'a str, role: Role) -> impl Iterator<Item = (&'a str, &'a DrawnPath)> + 'a {
    pieces.iter().flat_map(move |piece| {
        let own = piece.drawing.paths.iter().filter(move |p| p.role == role && p.joint.as_deref() == Some(joint));
        own.map(|path| (piece.name.as_str(), path))
    })
}

/// The middle of a flap's hinge.
pub(super) fn root(flap: &DrawnPath) -> Option<P2> {
    Some(nalgebra::center(&flap.path.start()?, &flap.path.vertices.last()?.point))
}

/// The pieces a part's strip is made of, in its order: those called by the part's name and a number.
pub(super) fn strip_pieces<'a>(part: &str, pieces: &'a [Piece]) -> Vec<&'a Piece> {
    let of_strip = |piece: &&Piece| {
        let number = piece.name.strip_prefix(part).unwrap_or("");
        piece.part == part && !number.is_empty() && number.chars().all(|c| c.is_ascii_digit())
    };
    pieces.iter().filter(of_strip).collect()
}

/// Where pieces of one strip overlap. Pieces are drawn along the strip, so that their outlines tell.
pub(super) fn splices(parts: &[Part], pieces: &[Piece]) -> Vec<Splice> {
    let mut splices = Vec::new();
    for part in parts {
        for pair in strip_pieces(&part.name, pieces).windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let (Some(ends), Some(begins)) = (from.drawing.outline(), to.drawing.outline()) else { continue };
            let start_mm = begins.bounds().min.x;
            let overlap_mm = ends.bounds().max.x - start_mm;
            if overlap_mm <= tolerance::LIMIT_SLACK_MM {
                continue;
            }
            let inside = |piece: &Piece| -> Vec<String> {
                let within = |path: &&DrawnPath| {
                    let at = path.path.bounds().center().x - start_mm;
                    path.role == Role::Slit && (0.0..=overlap_mm).contains(&at)
                };
                piece.drawing.paths.iter().filter(within).filter_map(|path| path.joint.clone()).collect()
            };
            let both = inside(to);
            let joint = inside(from).into_iter().find(|name| both.contains(name));
            let name = |piece: &Piece| piece.name.clone();
            splices.push(Splice {
                part: part.name.clone(),
                from: name(from),
                to: name(to),
                start_mm,
                overlap_mm,
                joint,
            });
        }
    }
    splices
}
