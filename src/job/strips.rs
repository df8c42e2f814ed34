//! Every part laid flat, in pieces that fit the stock.

use super::settings::Setup;
use super::stock::{self, Sheet};
use super::{Error, Realised};
use crate::fit::FootUsed;
use crate::progress::Warning;
use crate::strip::{self, Connector, Piece, Splice};

/// Pieces of all parts and the sheets they are meant for.
#[derive(Debug, Clone)]
pub(super) struct Strips {
    /// Part by part, in strip order; then connectors and base cards.
    pub pieces: Vec<Piece>,
    /// Connectors, each also among the pieces.
    pub connectors: Vec<Connector>,
    /// How pieces of one strip are joined.
    pub splices: Vec<Splice>,
    /// Sheets to cut from, in order of preference.
    pub stock: Vec<Sheet>,
    /// Worst over all joints, mm.
    pub max_mating_error_mm: f64,
    /// Sum over all pieces.
    pub label_collisions: usize,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

impl Strips {
    /// Leaves only the pieces of these names; all for none.
    pub fn keep_only(&mut self, names: &[String]) -> Result<(), Error> {
        if names.is_empty() {
            return Ok(());
        }
        let same = |piece: &Piece, name: &String| piece.name.eq_ignore_ascii_case(name);
        if let Some(unknown) = names.iter().find(|name| !self.pieces.iter().any(|piece| same(piece, name))) {
            let known: Vec<&str> = self.pieces.iter().map(|piece| piece.name.as_str()).collect();
            return Err(Error::UnknownPiece { given: unknown.clone(), known: known.join(", ") });
        }
        self.pieces.retain(|piece| names.iter().any(|name| same(piece, name)));
        Ok(())
    }
}

/// Lays all parts flat. Where the design names stock, the first of it is taken on which every piece fits, or all of it together when no single one will do. Where it
/// names none, a job cut by hand takes the material's own in the same way, since what fits the printer comes first there; else the material's stock is tried, what lies on the machine without hanging over first, and the fewest pieces win: a splice is work and a weak place.
pub(super) fn strips(realised: &Realised, setup: &Setup) -> Result<Strips, Error> {
    let sheets = stock::sheets(setup)?;
    let tried = |sheet: &Sheet| flat(realised, setup, vec![sheet.clone()]).map(|s| (fits(&s, sheet, setup), s));
    if !setup.stock.is_empty() || setup.by_hand() {
        let first = sheets.iter().filter(|s| s.count.is_none()).map(tried).find(|t| matches!(t, Ok((true, _))));
        return match first {
            Some(Ok((_, strips))) => Ok(strips),
            _ => flat(realised, setup, sheets),
        };
    }
    let mut best: Option<((bool, bool, usize), Strips)> = None;
    let mut refused = None;
    for sheet in &sheets {
        match tried(sheet) {
            Ok((fits, strips)) => {
                let rank = (!fits, stock::overhang_mm(sheet, setup) > 0.0, strips.pieces.len());
                if best.as_ref().is_none_or(|(b, _)| rank < *b) {
                    best = Some((rank, strips));
                }
            }
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    match (best, refused) {
        (Some((_, strips)), _) => Ok(strips),
        (None, Some(error)) => Err(error),
        (None, None) => {
            Err(Error::NoStock { profile: setup.profile.name.clone(), machine: setup.machine.name.clone() })
        }
    }
}

/// True when every piece is narrow enough for the sheet; that none is too long was seen to.
fn fits(strips: &Strips, sheet: &Sheet, setup: &Setup) -> bool {
    let widest = strips.pieces.iter().map(|p| p.width_mm).fold(0.0, f64::max);
    widest <= stock::widest_piece_mm(sheet, setup)
}

fn flat(realised: &Realised, setup: &Setup, stock: Vec<Sheet>) -> Result<Strips, Error> {
    let longest = stock.iter().map(|s| stock::longest_piece_mm(s, setup)).fold(0.0, f64::max);
    let settings = setup.strip(longest);
    let mut strips = Strips {
        pieces: Vec::new(),
        connectors: Vec::new(),
        splices: Vec::new(),
        stock,
        max_mating_error_mm: 0.0,
        label_collisions: 0,
        warnings: Vec::new(),
    };
    for (i, part) in realised.parts.iter().enumerate() {
        let tied: Vec<u32> = realised.ties.iter().flatten().filter(|end| end.part == i).map(|end| end.joint).collect();
        let pieces = strip::pieces(part, &tied, &settings)?;
        strips.pieces.extend(pieces.pieces);
        strips.splices.extend(pieces.splices);
        strips.max_mating_error_mm = strips.max_mating_error_mm.max(pieces.max_mating_error_mm);
        strips.label_collisions += pieces.label_collisions;
        strips.warnings.extend(pieces.warnings);
    }
    for tie in &realised.ties {
        strips.connectors.push(strip::connector(&realised.parts, &strips.pieces, *tie, &settings)?);
    }
    strips.pieces.extend(strips.connectors.iter().map(|c| c.piece.clone()));
    if !strips.connectors.is_empty() {
        let names: Vec<&str> = strips.connectors.iter().map(|c| c.piece.name.as_str()).collect();
        let message = format!(
            "pieces {} tie the parts together: each end goes between the two sheets of its joint, whose flap goes through it first",
            names.join(", ")
        );
        strips.warnings.push(Warning::new("connectors", message));
    }
    for part in realised.parts.iter().filter(|part| part.report.foot == FootUsed::Pinned) {
        add_base_card(&mut strips, strip::base_card(part, &settings), longest, setup);
    }
    if strips.label_collisions > 0 {
        strips.warnings.push(Warning::new(
            "labels-collide",
            format!("{} labels found no free place and lie over cuts or other labels", strips.label_collisions),
        ));
    }
    Ok(strips)
}

/// Adds a part's base card, if it fits the stock.
fn add_base_card(strips: &mut Strips, card: Piece, longest_mm: f64, setup: &Setup) {
    let widest_mm = strips.stock.iter().map(|s| stock::widest_piece_mm(s, setup)).fold(0.0, f64::max);
    let (name, part) = (card.name.clone(), card.part.clone());
    let fits = card.length_mm <= longest_mm && card.width_mm <= widest_mm;
    let warning = if fits {
        strips.pieces.push(card);
        Warning::new(
            "base-card",
            format!(
                "{name} is the card that {part} stands on: glue the ends of the bottom rung on its lines, as assembly.pdf shows"
            ),
        )
    } else {
        Warning::new(
            "base-too-large",
            format!(
                "a base card for {part} would be {:.0} x {:.0} mm, larger than the stock: glue the ends of the bottom rung to a board of your own",
                card.length_mm, card.width_mm
            ),
        )
    };
    strips.warnings.push(warning.in_part(part));
}
