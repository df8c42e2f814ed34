//! Sheets of paper for the person at the table: what is cut, from what, and how it is folded and closed, step by step; and patterns at true size for scissors.
//!
//! Everything is drawn with lines, grey fills and Helvetica, which every reader has: it prints in black and white, and the same job gives the same bytes.

mod beside;
mod cards;
mod closing;
mod code;
mod cover;
mod finish;
mod flat;
mod flow;
mod folded;
mod joints;
mod letters;
mod order;
mod page;
mod pdf;
mod prepare;
mod rooms;
#[cfg(test)]
mod samples;
mod spelling;
mod steps;
mod tiles;

use crate::drawing::Drawing;
use crate::fit::Part;
use crate::mesh::TriMesh;
use crate::nest::Layout;
use crate::strip::{Piece, Splice};

/// What is put into the printer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Paper {
    /// 210 x 297 mm.
    #[default]
    A4,
    /// 8.5 x 11 inches.
    Letter,
}

impl Paper {
    /// Width and height, upright, mm.
    pub fn size_mm(self) -> [f64; 2] {
        match self {
            Paper::A4 => [210.0, 297.0],
            Paper::Letter => [215.9, 279.4],
        }
    }

    /// What people call it.
    pub fn title(self) -> &'static str {
        match self {
            Paper::A4 => "A4",
            Paper::Letter => "Letter",
        }
    }
}

/// A job, ready to be explained.
#[derive(Debug, Clone, Copy)]
pub struct Book<'a> {
    /// What people call the object.
    pub name: &'a str,
    /// Short hash of what was decided.
    pub hash: &'a str,
    /// What the sheets are printed on.
    pub paper: Paper,
    /// The shape, for the drawing on the cover; mesh frame, mm.
    pub mesh: Option<&'a TriMesh>,
    /// The folded ruffles.
    pub parts: &'a [Part],
    /// Everything that is cut, strip frame.
    pub pieces: &'a [Piece],
    /// How pieces of one strip are joined.
    pub splices: &'a [Splice],
    /// The sheets it is cut from, in cutting order.
    pub sheets: &'a [CutSheet<'a>],
    /// Machine and material.
    pub card: &'a Card,
    /// How the material is handled.
    pub handling: Handling,
}

/// One nested sheet.
#[derive(Debug, Clone, Copy)]
pub struct CutSheet<'a> {
    /// What its files are called: "sheet-01".
    pub file: &'a str,
    /// What it is cut from: "A3".
    pub stock: &'a str,
    /// Where the pieces lie; items are indices into [`Book::pieces`].
    pub layout: &'a Layout,
    /// The pieces, sheet frame, nominal.
    pub drawings: &'a [Drawing],
    /// Planned time, in words.
    pub time: &'a str,
}

/// What the person at the machine must know.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Card {
    /// Rows of what and its value: machine, material, feed, power.
    pub facts: Vec<(String, String)>,
    /// What to do and look at before starting, in this order.
    pub setup: Vec<String>,
    /// Why the values are not to be trusted yet, if so.
    pub uncalibrated: Option<String>,
    /// True when there is no machine but a printer and scissors.
    pub by_hand: bool,
}

/// How a material is handled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Handling {
    /// Time a person needs for one flap, s.
    pub flap_s: f64,
    /// Thickness of the rod that strips are curled round beforehand, mm: no tighter than the material bends without a crease.
    pub rod_mm: f64,
    /// How strips run to the grain of the stock; `None` for a material without one.
    pub grain: Option<Grain>,
    /// What tells pieces and joints apart.
    pub marks: Marks,
}

/// How strips run to the grain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grain {
    /// True when they run along it, false across.
    pub along: bool,
    /// False where nobody knows how the grain runs in the stock.
    pub known: bool,
}

/// What cut pieces carry to be told apart by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marks {
    /// Names and numbers, engraved, drawn or cut in dashes.
    Letters,
    /// Notches in the edges: a deep one counts five, a shallow one one.
    Notches,
    /// Nothing.
    Nothing,
}

impl Marks {
    /// What the side is called that lies up on the pages with the flat pieces.
    fn side(self) -> &'static str {
        match self {
            Marks::Letters => "lettered side",
            Marks::Notches | Marks::Nothing => "marked side",
        }
    }
}

/// Time to join two pieces of one strip, s: lay, glue, hold.
const SPLICE_S: f64 = 60.0;
/// Time for one stitch of a lap that is sewn, s.
const STITCH_S: f64 = 10.0;

/// The assembly sheets of a job, a PDF file.
pub fn book(job: &Book) -> Vec<u8> {
    let mut flow = flow::Flow::new(job.paper);
    let joints = joints::joints(job.pieces);
    cover::cover(&mut flow, job, &joints);
    cards::cutting_card(&mut flow, job);
    cards::cut_list(&mut flow, job);
    prepare::prepare(&mut flow, job, &joints);
    for part in job.parts {
        folded::pages(&mut flow, job, part);
        steps::steps(&mut flow, job, part, &joints);
    }
    finish::finish(&mut flow, job);
    flow.finish(&footer(job))
}

/// Patterns at true size, a PDF file: every sheet on as many pages as it takes.
pub fn patterns(job: &Book) -> Vec<u8> {
    tiles::patterns(job)
}

/// Splices between pieces of a part's strip.
fn splices_of<'a>(job: &Book<'a>, part: &'a str) -> impl Iterator<Item = &'a Splice> + 'a {
    let pieces = job.pieces;
    job.splices.iter().filter(move |s| pieces.iter().any(|p| p.part == part && p.name == s.pieces[0]))
}

/// Pieces that lie in joints of two parts and tie them: neither of a strip nor base cards.
fn connectors<'a>(job: &Book<'a>) -> Vec<&'a Piece> {
    of_no_strip(job).into_iter().filter(|piece| !piece.passages.is_empty()).collect()
}

/// Cards that parts stand on.
fn base_cards<'a>(job: &Book<'a>) -> Vec<&'a Piece> {
    of_no_strip(job).into_iter().filter(|piece| piece.passages.is_empty()).collect()
}

/// Pieces that belong to no strip.
fn of_no_strip<'a>(job: &Book<'a>) -> Vec<&'a Piece> {
    let of_strip: Vec<&str> = job
        .parts
        .iter()
        .flat_map(|part| joints::strip_pieces(&part.name, job.pieces))
        .map(|piece| piece.name.as_str())
        .collect();
    job.pieces.iter().filter(|piece| !of_strip.contains(&piece.name.as_str())).collect()
}

/// What stands under every page.
fn footer(job: &Book) -> String {
    format!("{}   {}", job.name, job.hash)
}

/// "1 piece", "3 pieces".
fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
