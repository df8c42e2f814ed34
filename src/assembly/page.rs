//! One page, written as it is drawn. Millimetres from the lower left corner, y up.

use super::letters::{Face, encoded, width_mm};
use crate::geom::{Motion, P2, Path, Rect, V2, tolerance};
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Name, Str};

/// A point of the printing trade in mm: 1/72 inch.
pub(super) const POINT_MM: f64 = 25.4 / 72.0;

/// How a line is drawn: black to light, full or dashed. Ends and corners are round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pen {
    /// Width on the page, mm.
    pub width_mm: f64,
    /// 0 black, 1 white.
    pub gray: f64,
    /// Lengths of dash and gap, mm; a full line when there is none.
    pub dash_mm: Option<[f64; 2]>,
}

impl Pen {
    /// A full black line.
    pub const fn black(width_mm: f64) -> Pen {
        Pen { width_mm, gray: 0.0, dash_mm: None }
    }

    /// A full grey line.
    pub const fn gray(width_mm: f64, gray: f64) -> Pen {
        Pen { width_mm, gray, dash_mm: None }
    }

    /// The same line, dashed.
    pub const fn dashed(self, dash_mm: f64, gap_mm: f64) -> Pen {
        Pen { dash_mm: Some([dash_mm, gap_mm]), ..self }
    }
}

/// A line of text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lettering {
    /// Size of the face, mm; capitals are 0.72 of it.
    pub size_mm: f64,
    /// Which face.
    pub face: Face,
    /// 0 black, 1 white.
    pub gray: f64,
}

impl Lettering {
    /// Black text.
    pub const fn new(size_mm: f64, face: Face) -> Lettering {
        Lettering { size_mm, face, gray: 0.0 }
    }

    /// Width of `text`, mm.
    pub fn width_mm(&self, text: &str) -> f64 {
        width_mm(text, self.size_mm, self.face)
    }
}

/// Where on a text's baseline it is put in place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum At {
    Left,
    Middle,
    Right,
}

/// A page and what is on it so far.
pub(super) struct Page {
    /// From (0, 0) to the paper's upper right corner, mm.
    pub area: Rect,
    content: Content,
    pen: Option<Pen>,
    fill: Option<f64>,
}

impl Page {
    /// An empty page.
    pub fn new(area: Rect) -> Page {
        let mut content = Content::new();
        // From here on one unit is a millimetre.
        let mm = (1.0 / POINT_MM) as f32;
        content.transform([mm, 0.0, 0.0, mm, 0.0, 0.0]);
        content.set_line_cap(LineCapStyle::RoundCap).set_line_join(LineJoinStyle::RoundJoin);
        Page { area, content, pen: None, fill: None }
    }

    /// The page's description, for the file.
    pub fn finish(self) -> Vec<u8> {
        self.content.finish().into_vec()
    }

    /// Draws a chain of straight lines.
    pub fn line(&mut self, points: &[P2], pen: Pen) {
        self.take(pen);
        self.chain(points);
        self.content.stroke();
    }

    /// Fills a region bounded by closed loops (a loop within a loop is a hole), with a border or without.
    pub fn region<'a>(&mut self, loops: impl IntoIterator<Item = &'a [P2]>, gray: f64, pen: Option<Pen>) {
        self.dip(gray);
        if let Some(pen) = pen {
            self.take(pen);
        }
        for points in loops {
            self.chain(points);
            self.content.close_path();
        }
        match pen {
            Some(_) => self.content.fill_even_odd_and_stroke(),
            None => self.content.fill_even_odd(),
        };
    }

    /// Draws a curve moved by `place`.
    pub fn curve(&mut self, path: &Path, place: &Place, pen: Pen) {
        let points = place.points(path);
        self.take(pen);
        self.chain(&points);
        if path.closed {
            self.content.close_path();
        }
        self.content.stroke();
    }

    /// Draws the border of a box.
    pub fn frame(&mut self, rect: &Rect, pen: Pen) {
        self.take(pen);
        self.rect(rect);
        self.content.stroke();
    }

    /// Fills a box.
    pub fn block(&mut self, rect: &Rect, gray: f64) {
        self.dip(gray);
        self.rect(rect);
        self.content.fill_nonzero();
    }

    /// Fills a disc.
    pub fn disc(&mut self, center: P2, radius_mm: f64, gray: f64, pen: Option<Pen>) {
        let points = Path::circle(center, radius_mm).flatten(0.02);
        self.region([points.as_slice()], gray, pen);
    }

    /// Writes a line of text that starts at, ends at or is centred on `at`.
    pub fn text(&mut self, at: P2, align: At, lettering: Lettering, text: &str) {
        let width = lettering.width_mm(text);
        let left = match align {
            At::Left => 0.0,
            At::Middle => 0.5 * width,
            At::Right => width,
        };
        self.dip(lettering.gray);
        let (x, y) = (rounded(at.x - left), rounded(at.y));
        self.content.begin_text();
        self.content.set_font(Name(lettering.face.resource()), lettering.size_mm as f32);
        self.content.next_line(x, y);
        self.content.show(Str(&encoded(text)));
        self.content.end_text();
    }

    /// Draws with everything outside `window` cut away.
    pub fn within(&mut self, window: &Rect, draw: impl FnOnce(&mut Page)) {
        self.content.save_state();
        self.rect(window);
        self.content.clip_nonzero().end_path();
        draw(self);
        self.content.restore_state();
        // Whatever was set inside is forgotten.
        (self.pen, self.fill) = (None, None);
    }

    fn chain(&mut self, points: &[P2]) {
        for (i, p) in points.iter().enumerate() {
            let (x, y) = (rounded(p.x), rounded(p.y));
            if i == 0 {
                self.content.move_to(x, y)
            } else {
                self.content.line_to(x, y)
            };
        }
    }

    fn rect(&mut self, rect: &Rect) {
        let [x, y, width, height] = [rect.min.x, rect.min.y, rect.width(), rect.height()].map(rounded);
        self.content.rect(x, y, width, height);
    }

    fn take(&mut self, pen: Pen) {
        if self.pen == Some(pen) {
            return;
        }
        self.content.set_line_width(pen.width_mm as f32).set_stroke_gray(pen.gray as f32);
        self.content.set_dash_pattern(pen.dash_mm.iter().flatten().map(|l| *l as f32), 0.0);
        self.pen = Some(pen);
    }

    fn dip(&mut self, gray: f64) {
        if self.fill != Some(gray) {
            self.content.set_fill_gray(gray as f32);
            self.fill = Some(gray);
        }
    }
}

/// Where a drawing comes to lie on a page: scaled, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Page mm per mm of the drawing.
    pub scale: f64,
    /// Turn and shift after scaling.
    pub motion: Motion,
}

impl Place {
    /// Scaled and shifted, not turned.
    pub fn new(scale: f64, shift: V2) -> Place {
        Place { scale, motion: Motion::new(shift, 0.0) }
    }

    /// The largest scale, up to `most`, at which `from` fits into `into`, middle on middle.
    pub fn fit(from: &Rect, into: &Rect, most: f64) -> Place {
        let scale = (into.width() / from.width()).min(into.height() / from.height()).min(most);
        Place::new(scale, into.center().coords - from.center().coords * scale)
    }

    /// A point on the page.
    pub fn point(&self, p: P2) -> P2 {
        self.motion * (p * self.scale)
    }

    /// Points of a polyline on the page that a reader cannot tell from the curve.
    pub fn points(&self, path: &Path) -> Vec<P2> {
        path.flatten(tolerance::FLATTEN_MM.max(FLAT_MM / self.scale)).into_iter().map(|p| self.point(p)).collect()
    }
}

/// How far a polyline may leave its curve on the page, mm: a tenth of the thinnest line.
const FLAT_MM: f64 = 0.02;

/// Thousandths of a millimetre: more digits only make the file longer.
fn rounded(mm: f64) -> f32 {
    ((mm * 1000.0).round() / 1000.0) as f32
}
