//! The picture of what the machine does to one sheet.

use super::Stock;
use super::canvas::{Align, Canvas, Colour, Stroke, Text};
use crate::drawing::text_width;
use crate::geom::{P2, Path, Rect, V2};

/// What a move does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MoveKind {
    /// From cut to cut, tool off.
    Travel,
    /// Marks the surface.
    Engrave,
    /// Cuts within a piece.
    CutInner,
    /// Cuts a piece free.
    CutOutline,
}

impl MoveKind {
    /// All kinds, in the order they are drawn: what matters most lies on top.
    pub const ALL: [MoveKind; 4] = [MoveKind::Travel, MoveKind::Engrave, MoveKind::CutInner, MoveKind::CutOutline];

    /// How it is drawn and called.
    pub fn pen(self) -> Pen {
        let (name, colour, weight) = match self {
            MoveKind::Travel => ("travel", Colour::TRAVEL, 0.1),
            MoveKind::Engrave => ("engrave", Colour::INK, 0.1),
            MoveKind::CutInner => ("inner cuts", Colour::BLUE, 0.15),
            MoveKind::CutOutline => ("outlines", Colour::RED, 0.17),
        };
        Pen { name: name.into(), colour, weight, dashed: self == MoveKind::Travel }
    }
}

/// How moves of one sort are drawn, and what the key calls them.
#[derive(Debug, Clone, PartialEq)]
pub struct Pen {
    /// In the key.
    pub name: String,
    /// Of the line.
    pub colour: Colour,
    /// Width of the line, hundredths of the sheet's longer side.
    pub weight: f64,
    /// Broken, as for what is not cut.
    pub dashed: bool,
}

impl Pen {
    fn stroke(&self, unit: f64) -> Stroke {
        let stroke = Stroke::new(self.colour, self.weight * unit);
        if self.dashed { stroke.dashed(0.7 * unit, 0.5 * unit) } else { stroke }
    }
}

/// One move of the tool; curves already as straight lines.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetMove {
    /// Where it runs, mm, sheet frame.
    pub points: Vec<P2>,
    /// Index of its pen in the view's.
    pub pen: usize,
}

/// What a sheet's picture shows; sheet frame (x right, y up, origin at the bottom left), mm.
#[derive(Debug, Clone)]
pub struct SheetView<'a> {
    /// Heading: which sheet of which job.
    pub title: &'a str,
    /// The stock, when it is known.
    pub stock: Option<&'a Stock>,
    /// What the machine reaches, less margins, when it is to be shown.
    pub reach: Option<Rect>,
    /// What stands on the bed.
    pub keep_outs: &'a [(String, Rect)],
    /// The sorts of moves there are, in drawing order.
    pub pens: &'a [Pen],
    /// All moves in the order they are made.
    pub moves: &'a [SheetMove],
    /// Names of the pieces and where to letter them (the middle of the text).
    pub piece_names: Vec<(P2, String)>,
    /// Further lines under the key: time, material, stock.
    pub legend: Vec<String>,
}

impl SheetView<'_> {
    /// The stock, or without one what is drawn.
    fn sheet(&self) -> Rect {
        let drawn = || Rect::around(self.moves.iter().flat_map(|m| &m.points));
        match self.stock {
            Some(stock) => stock.rect(),
            None => Some(drawn()).filter(|r| !r.is_empty()).or(self.reach).unwrap_or(Rect::from_size(1.0, 1.0)),
        }
    }
}

// Sizes in hundredths of the sheet's longer side.
const MARGIN: f64 = 3.0;
const TITLE: f64 = 1.9;
const TEXT: f64 = 1.4;
const NAME: f64 = 2.4;
const LINE_FEED: f64 = 1.3;
const SAMPLE: f64 = 4.0;
/// Longer side of the small map of the bed, and its way from the sheet.
const MAP: f64 = 12.0;
const MAP_GAP: f64 = 2.0;
const MAP_TEXT: f64 = 1.1;
/// A bed so many times as large as what lies on it is shown on a small map: it would make all else small.
const LARGE_BED: f64 = 1.6;
/// Lines grow with the sheet only so far: on a long roll, cuts a few mm apart must not run together.
const WIDEST_PEN_UNIT_MM: f64 = 8.0;

/// Draws the sheet with its grain, the machine's reach and what stands on it, every move with its pen, where the run starts (green) and ends
/// (red square), the pieces' names under it all, and a key with the length of each sort of move. A reach much larger than that is cut off, and a small
/// map shows where on it the sheet lies. The canvas is in the sheet frame and at true size.
pub fn sheet_canvas(view: &SheetView) -> Canvas {
    let sheet = view.sheet();
    let unit = 0.01 * sheet.width().max(sheet.height()).max(1e-3);
    let main = sheet.union(Rect::around(view.moves.iter().flat_map(|m| &m.points)));
    let area = |r: &Rect| r.width() * r.height();
    let map = view.reach.filter(|reach| area(reach) > LARGE_BED * area(&main));
    let main = main.union(view.reach.filter(|_| map.is_none()).unwrap_or(main));
    let (texts, samples) = legend(view, &main, &sheet, unit);
    let mut shown = main;
    for text in &texts {
        shown = shown.union(text.as_text().bounds());
    }
    let map = map.map(|reach| Map::beside(&shown, &reach, main.max.y, unit));
    let mut canvas = Canvas::new(map.as_ref().map_or(shown, |map| shown.union(map.frame)).grown(MARGIN * unit));

    if view.stock.is_some() {
        canvas.frame(&sheet, None, Some(Stroke::new(Colour::GREY, 0.2 * unit)));
    }
    if let Some(reach) = view.reach.as_ref().filter(|_| map.is_none()) {
        canvas.frame(reach, None, Some(Stroke::new(Colour::PALE, 0.12 * unit).dashed(1.2 * unit, 0.8 * unit)));
    }
    for (name, rect) in view.keep_outs {
        canvas.frame(rect, Some(Colour::PALE), Some(Stroke::new(Colour::GREY, 0.12 * unit)));
        let at = P2::new(rect.min.x, rect.max.y + 0.5 * unit);
        canvas.text(Text { at, align: Align::Left, height_mm: TEXT * unit, colour: Colour::GREY, text: name });
    }
    if let Some(grain) = view.stock.and_then(|stock| stock.grain) {
        draw_grain(&mut canvas, &sheet, grain.along_x, unit);
    }
    for (at, text) in &view.piece_names {
        let at = at - V2::new(0.0, 0.5 * NAME * unit);
        canvas.text(Text { at, align: Align::Middle, height_mm: NAME * unit, colour: Colour::PALE, text });
    }
    for (index, pen) in view.pens.iter().enumerate() {
        canvas.curves(chains(view.moves, index), pen.stroke(unit.min(WIDEST_PEN_UNIT_MM)));
    }
    draw_ends(&mut canvas, view.moves, unit);
    for (at, pen) in samples {
        let stroke = Stroke { width_mm: 0.25 * unit, ..pen.stroke(unit) };
        canvas.polyline(&[at, at + V2::new(SAMPLE * unit, 0.0)], stroke);
    }
    for text in &texts {
        canvas.text(text.as_text());
    }
    if let Some(map) = &map {
        map.draw(&mut canvas, view, &sheet, unit);
    }
    canvas
}

/// The whole bed, small.
struct Map {
    /// Where the bed lies in the picture.
    frame: Rect,
    reach: Rect,
}

impl Map {
    /// To the right of what is drawn, its top at a height.
    fn beside(area: &Rect, reach: &Rect, top_mm: f64, unit: f64) -> Map {
        let scale = MAP * unit / reach.width().max(reach.height());
        let corner = P2::new(area.max.x + MAP_GAP * unit, top_mm - scale * reach.height());
        let frame = Rect { min: corner, max: corner + V2::new(reach.width(), reach.height()) * scale };
        Map { frame, reach: *reach }
    }

    fn draw(&self, canvas: &mut Canvas, view: &SheetView, sheet: &Rect, unit: f64) {
        let scale = self.frame.width() / self.reach.width();
        let on_map = |p: P2| self.frame.min + (p - self.reach.min) * scale;
        let thin = Stroke::new(Colour::GREY, 0.1 * unit);
        canvas.frame(&self.frame, Some(Colour::WHITE), Some(thin));
        for (rect, fill) in
            [(sheet, Colour::PALE)].into_iter().chain(view.keep_outs.iter().map(|(_, r)| (r, Colour::GREY)))
        {
            let small = Rect { min: on_map(rect.min), max: on_map(rect.max) };
            canvas.frame(&small, Some(fill), Some(thin));
        }
        if let Some(start) = view.moves.iter().flat_map(|m| m.points.first()).next() {
            canvas.disc(on_map(*start), 0.4 * unit, Colour::GREEN, None);
        }
        let at = self.frame.min - V2::new(0.0, 1.8 * MAP_TEXT * unit);
        let text = &format!("{:.0} x {:.0} mm", self.reach.width(), self.reach.height());
        canvas.text(Text { at, align: Align::Left, height_mm: MAP_TEXT * unit, colour: Colour::GREY, text });
    }
}

/// A double arrow along the grain in the sheet's upper right corner, where nesting fills last.
fn draw_grain(canvas: &mut Canvas, sheet: &Rect, along_x: bool, unit: f64) {
    let stroke = Stroke::new(Colour::GREY, 0.15 * unit);
    let (along, across) = if along_x { (V2::x(), V2::y()) } else { (V2::y(), V2::x()) };
    let tip = sheet.max - (along + across) * (1.5 * unit);
    let tail = tip - along * (9.0 * unit);
    canvas.polyline(&[tail, tip], stroke);
    for (end, back) in [(tip, -along), (tail, along)] {
        let barbs = [1.0, -1.0].map(|side| end + (back * 1.2 + across * 0.5 * side) * unit);
        canvas.polyline(&[barbs[0], end, barbs[1]], stroke);
    }
    let at = tip - V2::new(0.0, (TEXT + 1.0) * unit) - if along_x { V2::zeros() } else { V2::new(unit, 0.0) };
    canvas.text(Text { at, align: Align::Right, height_mm: TEXT * unit, colour: Colour::GREY, text: "grain" });
}

/// Moves of one pen as curves; moves that go on where the last one ended become one curve.
fn chains(moves: &[SheetMove], pen: usize) -> Vec<Path> {
    let mut chains: Vec<Vec<P2>> = Vec::new();
    for m in moves.iter().filter(|m| m.pen == pen && !m.points.is_empty()) {
        match chains.last_mut() {
            Some(chain) if chain.last() == m.points.first() => chain.extend(&m.points[1..]),
            _ => chains.push(m.points.clone()),
        }
    }
    chains.into_iter().map(Path::open).collect()
}

fn draw_ends(canvas: &mut Canvas, moves: &[SheetMove], unit: f64) {
    let start = moves.iter().flat_map(|m| m.points.first()).next();
    let end = moves.iter().rev().flat_map(|m| m.points.last()).next();
    let rim = Some(Stroke::new(Colour::WHITE, 0.15 * unit));
    if let Some(end) = end {
        let square = Rect { min: *end, max: *end }.grown(0.75 * unit);
        canvas.frame(&square, Some(Colour::RED), rim);
    }
    // Drawn last and smaller: where a run ends at its start, both are seen.
    if let Some(start) = start {
        canvas.disc(*start, 0.55 * unit, Colour::GREEN, rim);
    }
}

/// A line of the legend; owns its words.
struct Line {
    at: P2,
    height_mm: f64,
    colour: Colour,
    text: String,
}

impl Line {
    fn as_text(&self) -> Text<'_> {
        let Line { at, height_mm, colour, text } = self;
        Text { at: *at, align: Align::Left, height_mm: *height_mm, colour: *colour, text }
    }
}

/// Title above the sheet; key and further lines below it. Key entries run on along the sheet's width and break where it ends.
fn legend<'a>(view: &SheetView<'a>, main: &Rect, sheet: &Rect, unit: f64) -> (Vec<Line>, Vec<(P2, &'a Pen)>) {
    let mut lines = Vec::new();
    let mut samples = Vec::new();
    if !view.title.is_empty() {
        let at = P2::new(main.min.x.min(0.0), main.max.y.max(0.0) + 1.2 * unit);
        lines.push(Line { at, height_mm: TITLE * unit, colour: Colour::INK, text: view.title.to_owned() });
    }
    let (left, feed) = (main.min.x.min(0.0), (TEXT + LINE_FEED) * unit);
    let bottom = main.min.y.min(0.0);
    let mut at = P2::new(left, bottom - (TEXT + 1.6) * unit);
    for (index, pen) in view.pens.iter().enumerate() {
        let of_pen = view.moves.iter().filter(|m| m.pen == index);
        let length_mm: f64 = of_pen.flat_map(|m| m.points.windows(2)).map(|w| (w[1] - w[0]).norm()).sum();
        if length_mm == 0.0 {
            continue;
        }
        let text = format!("{}, {}", pen.name, people_length(length_mm));
        let entry_mm = SAMPLE * unit + unit + text_width(&text, TEXT * unit);
        if at.x > left && at.x + entry_mm > sheet.max.x {
            at = P2::new(left, at.y - feed);
        }
        samples.push((at + V2::new(0.0, 0.5 * TEXT * unit), pen));
        let beside = at + V2::new((SAMPLE + 1.0) * unit, 0.0);
        lines.push(Line { at: beside, height_mm: TEXT * unit, colour: Colour::INK, text });
        at.x += entry_mm + 3.0 * unit;
    }
    let mut y = if samples.is_empty() { at.y } else { at.y - feed };
    for text in &view.legend {
        lines.push(Line { at: P2::new(left, y), height_mm: TEXT * unit, colour: Colour::GREY, text: text.clone() });
        y -= feed;
    }
    (lines, samples)
}

/// A length as people say it: mm below a metre, metres above.
fn people_length(length_mm: f64) -> String {
    if length_mm < 1000.0 { format!("{length_mm:.0} mm") } else { format!("{:.2} m", length_mm / 1000.0) }
}

#[cfg(test)]
mod tests {
    use super::super::GrainRun;
    use super::*;
    use tiny_skia::Pixmap;

    fn moves() -> Vec<SheetMove> {
        let p = |x, y| P2::new(x, y);
        let m = |points: Vec<P2>, kind| SheetMove { points, pen: kind as usize };
        vec![
            m(vec![p(0.0, 0.0), p(20.0, 20.0)], MoveKind::Travel),
            m(vec![p(20.0, 20.0), p(60.0, 20.0)], MoveKind::Engrave),
            m(vec![p(60.0, 20.0), p(60.0, 40.0)], MoveKind::CutInner),
            m(vec![p(60.0, 40.0), p(100.0, 90.0)], MoveKind::Travel),
            m(vec![p(100.0, 90.0), p(10.0, 90.0)], MoveKind::CutOutline),
            m(vec![p(10.0, 90.0), p(10.0, 50.0)], MoveKind::CutOutline),
        ]
    }

    fn pens() -> Vec<Pen> {
        MoveKind::ALL.map(MoveKind::pen).into()
    }

    fn stock(width_mm: f64, height_mm: f64) -> Stock {
        Stock {
            name: "A4".into(),
            at: P2::origin(),
            width_mm,
            height_mm,
            grain: Some(GrainRun { along_x: true, known: true }),
        }
    }

    fn view<'a>(stock: &'a Stock, pens: &'a [Pen], moves: &'a [SheetMove], title: &'a str) -> SheetView<'a> {
        SheetView {
            title,
            stock: Some(stock),
            keep_outs: &[],
            pens,
            reach: Some(Rect::from_size(200.0, 100.0).grown(-5.0)),
            moves,
            piece_names: vec![(P2::new(150.0, 50.0), "A1".into())],
            legend: vec!["12 min 3 s".into()],
        }
    }

    #[test]
    fn every_kind_of_move_has_its_colour_and_the_run_its_ends() {
        let (stock, pens, moves) = (stock(200.0, 100.0), pens(), moves());
        let canvas = sheet_canvas(&view(&stock, &pens, &moves, "sheet 1"));
        let pixmap = Pixmap::decode_png(&canvas.to_png(4000).unwrap()).unwrap();
        let scale = f64::from(pixmap.width()) / canvas.area.width();
        let at = |x: f64, y: f64| {
            let px = ((x - canvas.area.min.x) * scale) as u32;
            let c = pixmap.pixel(px, ((canvas.area.max.y - y) * scale) as u32).unwrap();
            Colour(c.red(), c.green(), c.blue())
        };
        assert_eq!(at(40.0, 20.0), Colour::INK);
        assert_eq!(at(60.0, 30.0), Colour::BLUE);
        assert_eq!(at(50.0, 90.0), Colour::RED);
        assert_eq!(at(0.0, 0.0), Colour::GREEN);
        assert_eq!(at(10.0, 50.0), Colour::RED);
        assert_eq!(at(11.0, 51.0), Colour::RED, "the end is a square of some size");
        assert_eq!(at(120.0, 70.0), Colour::WHITE);
        assert_eq!(at(190.0, 97.0), Colour::GREY, "the grain's arrow");
    }

    #[test]
    fn moves_that_go_on_become_one_curve_and_others_do_not() {
        let moves = moves();
        let outline = chains(&moves, MoveKind::CutOutline as usize);
        assert_eq!((outline.len(), outline[0].vertices.len()), (1, 3));
        assert_eq!(chains(&moves, MoveKind::Travel as usize).len(), 2);
    }

    #[test]
    fn the_key_tells_the_length_of_each_kind_made_and_no_other() {
        let (stock, pens, moves) = (stock(200.0, 100.0), pens(), moves());
        let sheet = Rect::from_size(200.0, 100.0);
        let (lines, samples) = legend(&view(&stock, &pens, &moves[1..2], "t"), &sheet, &sheet, 2.0);
        let texts: Vec<&str> = lines.iter().map(|l| l.text.as_str()).collect();
        assert_eq!(texts, ["t", "engrave, 40 mm", "12 min 3 s"]);
        assert_eq!(samples.len(), 1);
        let (lines, _) = legend(&view(&stock, &pens, &moves, ""), &sheet, &sheet, 2.0);
        assert!(lines.iter().any(|l| l.text == "outlines, 130 mm"));
        assert_eq!(people_length(1234.0), "1.23 m");
    }

    #[test]
    fn a_bed_much_larger_than_the_sheet_is_a_small_map() {
        let (stock, pens, moves) = (stock(200.0, 100.0), pens(), moves());
        let small = sheet_canvas(&view(&stock, &pens, &moves, "t")).area;
        let bed = Rect::from_size(800.0, 600.0);
        let large = sheet_canvas(&SheetView { reach: Some(bed), ..view(&stock, &pens, &moves, "t") }).area;
        let map_mm = (MAP + MAP_GAP) * 2.0;
        assert!(
            (large.width() - small.width() - map_mm).abs() < 1e-9 && large.height() < 1.2 * small.height(),
            "{large:?}"
        );
    }

    #[test]
    fn nothing_is_clipped_on_a_narrow_sheet_with_a_long_title() {
        let (stock, pens, moves) = (stock(30.0, 120.0), pens(), moves());
        let canvas = sheet_canvas(&view(&stock, &pens, &moves, "sheet 1 of 12, stool, paper-160, diode-400"));
        for shape in &canvas.shapes {
            let air = shape.stroke.map_or(0.0, |s| 0.5 * s.width_mm);
            let drawn = shape.paths.iter().fold(Rect::EMPTY, |r, p| r.union(p.bounds()));
            assert!(drawn.is_empty() || canvas.area.holds(&drawn.grown(air), 0.0), "{drawn:?} in {:?}", canvas.area);
        }
    }
}
