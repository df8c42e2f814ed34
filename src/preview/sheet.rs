//! The picture of what the machine does to one sheet.

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
    const ALL: [MoveKind; 4] = [MoveKind::Travel, MoveKind::Engrave, MoveKind::CutInner, MoveKind::CutOutline];

    fn word(self) -> &'static str {
        match self {
            MoveKind::Travel => "travel",
            MoveKind::Engrave => "engrave",
            MoveKind::CutInner => "inner cuts",
            MoveKind::CutOutline => "outlines",
        }
    }

    fn stroke(self, pen: f64) -> Stroke {
        match self {
            MoveKind::Travel => Stroke::new(Colour::TRAVEL, 0.1 * pen).dashed(0.7 * pen, 0.5 * pen),
            MoveKind::Engrave => Stroke::new(Colour::INK, 0.1 * pen),
            MoveKind::CutInner => Stroke::new(Colour::BLUE, 0.15 * pen),
            MoveKind::CutOutline => Stroke::new(Colour::RED, 0.17 * pen),
        }
    }
}

/// One move of the tool; curves already as straight lines.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetMove {
    /// Where it runs, mm, sheet frame.
    pub points: Vec<P2>,
    /// What it does.
    pub kind: MoveKind,
}

/// What a sheet's picture shows; sheet frame (x right, y up, origin at the bottom left), mm.
#[derive(Debug, Clone)]
pub struct SheetView<'a> {
    /// Heading: which sheet of which job.
    pub title: &'a str,
    /// Size of the stock along x.
    pub width_mm: f64,
    /// Size of the stock along y.
    pub height_mm: f64,
    /// What the machine reaches, less margins, when it is to be shown.
    pub reach: Option<Rect>,
    /// All moves in the order they are made.
    pub moves: &'a [SheetMove],
    /// Names of the pieces and where to letter them (the middle of the text).
    pub piece_names: Vec<(P2, String)>,
    /// Further lines under the key: time, material, stock.
    pub legend: Vec<String>,
}

// Sizes in hundredths of the sheet's longer side.
const MARGIN: f64 = 3.0;
const TITLE: f64 = 1.9;
const TEXT: f64 = 1.4;
const NAME: f64 = 2.4;
const LINE_FEED: f64 = 1.3;
const SAMPLE: f64 = 4.0;
/// Lines grow with the sheet only so far: on a long roll, cuts a few mm apart must not run together.
const WIDEST_PEN_UNIT_MM: f64 = 8.0;

/// Draws the sheet, the machine's reach, every move in the colour of what it does, where the run starts (green) and ends (red square),
/// the pieces' names under it all, and a key with the length of each kind of move. The canvas is in the sheet frame and at true size.
pub fn sheet_canvas(view: &SheetView) -> Canvas {
    let sheet = Rect::from_size(view.width_mm, view.height_mm);
    let unit = 0.01 * sheet.width().max(sheet.height()).max(1e-3);
    let (texts, samples) = legend(view, &sheet, unit);
    let drawn = Rect::around(view.moves.iter().flat_map(|m| &m.points));
    let mut area = sheet.union(view.reach.unwrap_or(sheet)).union(drawn);
    for text in &texts {
        area = area.union(text.as_text().bounds());
    }
    let mut canvas = Canvas::new(area.grown(MARGIN * unit));

    canvas.frame(&sheet, None, Some(Stroke::new(Colour::GREY, 0.2 * unit)));
    if let Some(reach) = &view.reach {
        canvas.frame(reach, None, Some(Stroke::new(Colour::PALE, 0.12 * unit).dashed(1.2 * unit, 0.8 * unit)));
    }
    for (at, text) in &view.piece_names {
        let at = at - V2::new(0.0, 0.5 * NAME * unit);
        canvas.text(Text { at, align: Align::Middle, height_mm: NAME * unit, colour: Colour::PALE, text });
    }
    for kind in MoveKind::ALL {
        canvas.curves(chains(view.moves, kind), kind.stroke(unit.min(WIDEST_PEN_UNIT_MM)));
    }
    draw_ends(&mut canvas, view.moves, unit);
    for (at, kind) in samples {
        canvas.polyline(&[at, at + V2::new(SAMPLE * unit, 0.0)], Stroke { width_mm: 0.25 * unit, ..kind.stroke(unit) });
    }
    for text in &texts {
        canvas.text(text.as_text());
    }
    canvas
}

/// Moves of one kind as curves; moves that go on where the last one ended become one curve.
fn chains(moves: &[SheetMove], kind: MoveKind) -> Vec<Path> {
    let mut chains: Vec<Vec<P2>> = Vec::new();
    for m in moves.iter().filter(|m| m.kind == kind && !m.points.is_empty()) {
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
fn legend(view: &SheetView, sheet: &Rect, unit: f64) -> (Vec<Line>, Vec<(P2, MoveKind)>) {
    let mut lines = Vec::new();
    let mut samples = Vec::new();
    if !view.title.is_empty() {
        let at = P2::new(0.0, sheet.max.y.max(view.reach.map_or(0.0, |r| r.max.y)) + 1.2 * unit);
        lines.push(Line { at, height_mm: TITLE * unit, colour: Colour::INK, text: view.title.to_owned() });
    }
    let (left, feed) = (0.0, (TEXT + LINE_FEED) * unit);
    let bottom = sheet.min.y.min(view.reach.map_or(0.0, |r| r.min.y));
    let mut at = P2::new(left, bottom - (TEXT + 1.6) * unit);
    for kind in MoveKind::ALL {
        let of_kind = view.moves.iter().filter(|m| m.kind == kind);
        let length_mm: f64 = of_kind.flat_map(|m| m.points.windows(2)).map(|w| (w[1] - w[0]).norm()).sum();
        if length_mm == 0.0 {
            continue;
        }
        let text = format!("{} {}", kind.word(), people_length(length_mm));
        let entry_mm = SAMPLE * unit + unit + text_width(&text, TEXT * unit);
        if at.x > left && at.x + entry_mm > sheet.max.x {
            at = P2::new(left, at.y - feed);
        }
        samples.push((at + V2::new(0.0, 0.5 * TEXT * unit), kind));
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
    use super::*;
    use tiny_skia::Pixmap;

    fn moves() -> Vec<SheetMove> {
        let p = |x, y| P2::new(x, y);
        let m = |points: Vec<P2>, kind| SheetMove { points, kind };
        vec![
            m(vec![p(0.0, 0.0), p(20.0, 20.0)], MoveKind::Travel),
            m(vec![p(20.0, 20.0), p(60.0, 20.0)], MoveKind::Engrave),
            m(vec![p(60.0, 20.0), p(60.0, 40.0)], MoveKind::CutInner),
            m(vec![p(60.0, 40.0), p(100.0, 90.0)], MoveKind::Travel),
            m(vec![p(100.0, 90.0), p(10.0, 90.0)], MoveKind::CutOutline),
            m(vec![p(10.0, 90.0), p(10.0, 50.0)], MoveKind::CutOutline),
        ]
    }

    fn view<'a>(moves: &'a [SheetMove], title: &'a str) -> SheetView<'a> {
        SheetView {
            title,
            width_mm: 200.0,
            height_mm: 100.0,
            reach: Some(Rect::from_size(200.0, 100.0).grown(-5.0)),
            moves,
            piece_names: vec![(P2::new(150.0, 50.0), "A1".into())],
            legend: vec!["12 min 3 s".into()],
        }
    }

    #[test]
    fn every_kind_of_move_has_its_colour_and_the_run_its_ends() {
        let moves = moves();
        let canvas = sheet_canvas(&view(&moves, "sheet 1"));
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
    }

    #[test]
    fn moves_that_go_on_become_one_curve_and_others_do_not() {
        let moves = moves();
        let outline = chains(&moves, MoveKind::CutOutline);
        assert_eq!((outline.len(), outline[0].vertices.len()), (1, 3));
        assert_eq!(chains(&moves, MoveKind::Travel).len(), 2);
    }

    #[test]
    fn the_key_tells_the_length_of_each_kind_made_and_no_other() {
        let moves = moves();
        let sheet = Rect::from_size(200.0, 100.0);
        let (lines, samples) = legend(&view(&moves[1..2], "t"), &sheet, 2.0);
        let texts: Vec<&str> = lines.iter().map(|l| l.text.as_str()).collect();
        assert_eq!(texts, ["t", "engrave 40 mm", "12 min 3 s"]);
        assert_eq!(samples.len(), 1);
        let (lines, _) = legend(&view(&moves, ""), &sheet, 2.0);
        assert!(lines.iter().any(|l| l.text == "outlines 130 mm"));
        assert_eq!(people_length(1234.0), "1.23 m");
    }

    #[test]
    fn nothing_is_clipped_on_a_narrow_sheet_with_a_long_title() {
        let moves = moves();
        let narrow = SheetView {
            width_mm: 30.0,
            height_mm: 120.0,
            ..view(&moves, "sheet 1 of 12, stool, paper-160, diode-400")
        };
        let canvas = sheet_canvas(&narrow);
        for shape in &canvas.shapes {
            let air = shape.stroke.map_or(0.0, |s| 0.5 * s.width_mm);
            let drawn = shape.paths.iter().fold(Rect::EMPTY, |r, p| r.union(p.bounds()));
            assert!(drawn.is_empty() || canvas.area.holds(&drawn.grown(air), 0.0), "{drawn:?} in {:?}", canvas.area);
        }
    }
}
