//! Sheets of paper for the person at the table: what is cut, from what, and how it is folded and closed, step by step; and patterns at true size for scissors.
//!
//! Everything is drawn with lines, grey fills and Helvetica, which every reader has: it prints in black and white, and the same job gives the same bytes.

mod cards;
mod code;
mod cover;
mod flat;
mod flow;
mod folded;
mod joints;
mod letters;
mod order;
mod page;
mod pdf;
mod rooms;
#[cfg(test)]
mod samples;
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
    /// Whether strips must run along a grain; `Some(false)` when they must and nobody knows how the grain runs in the stock.
    pub grain_known: Option<bool>,
    /// True when pieces carry lettering.
    pub lettered: bool,
}

/// Time to join two pieces of one strip, s: lay, glue, hold.
const SPLICE_S: f64 = 60.0;

/// The assembly sheets of a job, a PDF file.
pub fn book(job: &Book) -> Vec<u8> {
    let mut flow = flow::Flow::new(job.paper);
    let joints = joints::joints(job.pieces);
    cover::cover(&mut flow, job, &joints);
    cards::cutting_card(&mut flow, job);
    cards::cut_list(&mut flow, job);
    steps::before(&mut flow, job);
    for part in job.parts {
        folded::pages(&mut flow, job, part);
        steps::steps(&mut flow, job, part, &joints);
    }
    steps::after(&mut flow, job);
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

/// What stands under every page.
fn footer(job: &Book) -> String {
    format!("{}   {}", job.name, job.hash)
}

/// "1 piece", "3 pieces".
fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
