//! Every part laid flat, in pieces that fit the stock.

use super::settings::Setup;
use super::stock::{self, Sheet};
use super::{Error, Realised};
use crate::progress::Warning;
use crate::strip::{self, Piece};

/// Pieces of all parts and the sheets they are meant for.
#[derive(Debug, Clone)]
pub(super) struct Strips {
    /// Part by part, in strip order.
    pub pieces: Vec<Piece>,
    /// Sheets to cut from, in order of preference.
    pub stock: Vec<Sheet>,
    /// Worst over all joints, mm.
    pub max_mating_error_mm: f64,
    /// Sum over all pieces.
    pub label_collisions: usize,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// Lays all parts flat. Where the design names no stock, the first the material offers on which no strip needs a splice is taken, else the one with the
/// fewest pieces: a splice is work and a weak place.
pub(super) fn strips(realised: &Realised, setup: &Setup) -> Result<Strips, Error> {
    let sheets = stock::sheets(setup)?;
    if !setup.stock.is_empty() {
        return flat(realised, setup, sheets);
    }
    let mut best: Option<Result<Strips, Error>> = None;
    for sheet in sheets {
        let tried = flat(realised, setup, vec![sheet]);
        let fewer = match (&best, &tried) {
            (None | Some(Err(_)), _) => true,
            (Some(Ok(_)), Err(_)) => false,
            (Some(Ok(best)), Ok(tried)) => tried.pieces.len() < best.pieces.len(),
        };
        if fewer {
            best = Some(tried);
        }
    }
    best.expect("there is at least one kind of sheet")
}

fn flat(realised: &Realised, setup: &Setup, stock: Vec<Sheet>) -> Result<Strips, Error> {
    let longest = stock.iter().map(|s| stock::longest_piece_mm(s, setup)).fold(0.0, f64::max);
    let settings = setup.strip(longest);
    let mut strips =
        Strips { pieces: Vec::new(), stock, max_mating_error_mm: 0.0, label_collisions: 0, warnings: Vec::new() };
    for part in &realised.parts {
        let pieces = strip::pieces(part, &settings)?;
        strips.pieces.extend(pieces.pieces);
        strips.max_mating_error_mm = strips.max_mating_error_mm.max(pieces.max_mating_error_mm);
        strips.label_collisions += pieces.label_collisions;
        strips.warnings.extend(pieces.warnings);
    }
    if strips.label_collisions > 0 {
        strips.warnings.push(Warning::new(
            "labels-collide",
            format!("{} labels found no free place and lie over cuts or other labels", strips.label_collisions),
        ));
    }
    Ok(strips)
}
