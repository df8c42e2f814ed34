//! A retained scene in mm, y up, that is drawn in the order it was built.

use crate::drawing::{text_paths, text_width};
use crate::geom::{Motion, P2, Path, Rect, V2};

/// An opaque colour: red, green, blue, 0..=255.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// Paper.
    pub const WHITE: Colour = Colour(255, 255, 255);
    /// Curves and lettering that matter most; what is engraved.
    pub const INK: Colour = Colour(26, 26, 26);
    /// Lettering and lines of second rank.
    pub const GREY: Colour = Colour(110, 116, 122);
    /// Guides, and names that lie under what is cut.
    pub const PALE: Colour = Colour(196, 201, 206);
    /// The region a ruffle has to fill.
    pub const REGION: Colour = Colour(188, 214, 238);
    /// Bands under sections that were densified once, twice, three times and more: darker each time, and all darker than the region, so that they are told apart
    /// without colour too.
    pub const DENSITY: [Colour; 3] = [Colour(242, 164, 96), Colour(206, 104, 40), Colour(128, 54, 18)];
    /// Joints, outline cuts, the end of a run.
    pub const RED: Colour = Colour(214, 40, 40);
    /// Inner cuts.
    pub const BLUE: Colour = Colour(20, 70, 200);
    /// The start of a run.
    pub const GREEN: Colour = Colour(30, 140, 70);
    /// Travel with the tool off.
    pub const TRAVEL: Colour = Colour(240, 178, 110);

    /// "#rrggbb".
    pub fn hex(self) -> String {
        format!("#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// How a line is drawn. Ends and corners are round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub colour: Colour,
    /// Its width on the canvas, mm.
    pub width_mm: f64,
    /// Lengths of dash and gap, mm; a full line when there is none.
    pub dash_mm: Option<[f64; 2]>,
}

impl Stroke {
    /// A full line.
    pub fn new(colour: Colour, width_mm: f64) -> Stroke {
        Stroke { colour, width_mm, dash_mm: None }
    }

    /// The same line, dashed.
    pub fn dashed(self, dash_mm: f64, gap_mm: f64) -> Stroke {
        Stroke { dash_mm: Some([dash_mm, gap_mm]), ..self }
    }
}

/// Which point of a text's baseline is put in place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// The left end.
    Left,
    /// The middle.
    Middle,
    /// The right end.
    Right,
}

/// A line of lettering.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Text<'a> {
    /// Where on the canvas, mm.
    pub at: P2,
    /// What `at` is to the text.
    pub align: Align,
    /// Height of capitals, mm.
    pub height_mm: f64,
    /// Colour of the strokes.
    pub colour: Colour,
    /// What it says.
    pub text: &'a str,
}

/// Curves drawn alike; filled by the even-odd rule.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shape {
    pub paths: Vec<Path>,
    pub fill: Option<Colour>,
    pub stroke: Option<Stroke>,
}

/// A picture: a rectangle of the plane (mm, y up) and what is drawn there, on white. Whatever lies outside is clipped.
#[derive(Debug, Clone, PartialEq)]
pub struct Canvas {
    /// The part of the plane that is shown.
    pub area: Rect,
    pub(super) shapes: Vec<Shape>,
}

/// Stroke width of lettering over the height of its capitals.
const LETTER_WEIGHT: f64 = 0.11;

impl Canvas {
    /// An empty picture of `area`.
    pub fn new(area: Rect) -> Canvas {
        Canvas { area, shapes: Vec::new() }
    }

    /// Draws a chain of straight lines.
    pub fn polyline(&mut self, points: &[P2], stroke: Stroke) {
        self.curves(vec![Path::open(points.iter().copied())], stroke);
    }

    /// Draws curves in one stroke style.
    pub fn curves(&mut self, paths: Vec<Path>, stroke: Stroke) {
        self.shapes.push(Shape { paths, fill: None, stroke: Some(stroke) });
    }

    /// Fills a region bounded by closed loops (a loop within a loop is a hole), with a border or without.
    pub fn region<'a>(
        &mut self,
        loops: impl IntoIterator<Item = &'a Vec<P2>>,
        fill: Option<Colour>,
        stroke: Option<Stroke>,
    ) {
        let paths = loops.into_iter().map(|points| Path::closed(points.iter().copied())).collect();
        self.shapes.push(Shape { paths, fill, stroke });
    }

    /// Draws a box.
    pub fn frame(&mut self, rect: &Rect, fill: Option<Colour>, stroke: Option<Stroke>) {
        let (a, b) = (rect.min, rect.max);
        self.region([&vec![a, P2::new(b.x, a.y), b, P2::new(a.x, b.y)]], fill, stroke);
    }

    /// Draws a disc.
    pub fn disc(&mut self, center: P2, radius_mm: f64, fill: Colour, stroke: Option<Stroke>) {
        self.shapes.push(Shape { paths: vec![Path::circle(center, radius_mm)], fill: Some(fill), stroke });
    }

    /// Draws a line of text in single strokes.
    pub fn text(&mut self, text: Text) {
        let start = text.bounds().min;
        let motion = Motion::translation(start.x, start.y);
        let paths: Vec<Path> = text_paths(text.text, text.height_mm).iter().map(|p| p.moved(&motion)).collect();
        self.curves(paths, Stroke::new(text.colour, LETTER_WEIGHT * text.height_mm));
    }
}

impl Text<'_> {
    /// The box around the text's capitals, the strokes' width left aside.
    pub fn bounds(&self) -> Rect {
        let width = text_width(self.text, self.height_mm);
        let left = match self.align {
            Align::Left => 0.0,
            Align::Middle => 0.5 * width,
            Align::Right => width,
        };
        let min = self.at - V2::new(left, 0.0);
        Rect { min, max: min + V2::new(width, self.height_mm) }
    }
}
