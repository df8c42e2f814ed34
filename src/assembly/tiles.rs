//! Patterns at true size: every sheet on as many pages as it takes, neighbouring pages overlapping, each with a rule to check the printer by.

use super::flow::{MARGIN_MM, shortened};
use super::letters::Face;
use super::page::{At, Lettering, Page, Pen, Place};
use super::{Book, CutSheet, footer, pdf};
use crate::drawing::{Drawing, Operation};
use crate::geom::{P2, Rect, V2};

/// What printers leave white along the edges, mm.
const EDGE_MM: f64 = 8.0;
/// Height of the line with the rule at the foot of every page, mm.
const FOOT_MM: f64 = 10.0;
/// How far neighbouring pages repeat each other, mm: enough to glue.
const OVERLAP_MM: f64 = 10.0;
/// A drawing this much larger than the window still goes into it, mm: less than its lines are wide.
const SLACK_MM: f64 = 0.05;
/// Length of the rule, mm.
const RULE_MM: f64 = 100.0;
const CAPTION: Lettering = Lettering { size_mm: 3.0, face: Face::Plain, gray: 0.2 };
const SEAM: Pen = Pen::gray(0.15, 0.55).dashed(2.0, 2.0);
const CROSS: Pen = Pen::black(0.2);

/// How one sheet is spread over pages.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tiling {
    /// What one page shows, mm.
    window: V2,
    /// Pages across and up.
    columns: usize,
    rows: usize,
    landscape: bool,
}

impl Tiling {
    /// The fewest pages for a drawing of this size, upright before lying.
    fn of(size: V2, paper: V2) -> Tiling {
        let lying = V2::new(paper.y, paper.x);
        let of = |page: V2, landscape: bool| {
            let window = page - V2::new(2.0 * EDGE_MM, 2.0 * EDGE_MM + FOOT_MM);
            let number = |length: f64, window: f64| {
                (((length - OVERLAP_MM - SLACK_MM) / (window - OVERLAP_MM)).ceil() as usize).max(1)
            };
            Tiling { window, columns: number(size.x, window.x), rows: number(size.y, window.y), landscape }
        };
        let (upright, lying) = (of(paper, false), of(lying, true));
        if lying.columns * lying.rows < upright.columns * upright.rows { lying } else { upright }
    }

    /// The part of the drawing on page `column`, `row`, from the drawing's lower left corner.
    fn shown(&self, column: usize, row: usize) -> Rect {
        let step = self.window - V2::new(OVERLAP_MM, OVERLAP_MM);
        let min = P2::new(column as f64 * step.x, row as f64 * step.y);
        Rect { min, max: min + self.window }
    }
}

/// Every sheet's pages.
pub(super) fn patterns(job: &Book) -> Vec<u8> {
    let [width, height] = job.paper.size_mm();
    let mut pages = Vec::new();
    for sheet in job.sheets {
        let drawn = sheet.drawings.iter().map(Drawing::bounds).fold(Rect::EMPTY, Rect::union);
        let tiling = Tiling::of(drawn.max - drawn.min, V2::new(width, height));
        for row in 0..tiling.rows {
            for column in 0..tiling.columns {
                let size =
                    if tiling.landscape { Rect::from_size(height, width) } else { Rect::from_size(width, height) };
                let mut page = Page::new(size);
                tile(&mut page, job, sheet, &drawn, &tiling, (column, row));
                pages.push(page);
            }
        }
    }
    pdf::file(&footer(job), pages)
}

fn tile(page: &mut Page, job: &Book, sheet: &CutSheet, drawn: &Rect, tiling: &Tiling, (column, row): (usize, usize)) {
    let corner = P2::new(EDGE_MM, EDGE_MM + FOOT_MM);
    let window = Rect { min: corner, max: corner + tiling.window };
    let shown = tiling.shown(column, row);
    let place = Place::new(1.0, corner - shown.min - drawn.min.coords);
    page.within(&window.grown(0.2), |page| {
        for path in sheet.drawings.iter().flat_map(|drawing| &drawing.paths) {
            let pen = match path.role.operation() {
                Operation::CutOutline => Pen::black(0.35),
                Operation::CutInner => Pen::black(0.2),
                Operation::Engrave => Pen::gray(0.2, 0.5),
            };
            page.curve(&path.path, &place, pen);
        }
    });
    if tiling.columns * tiling.rows > 1 {
        seams(page, &window, tiling, column, row);
    }
    rule(page, P2::new(MARGIN_MM, EDGE_MM + 2.0));
    let right = page.area.max.x - MARGIN_MM;
    let left = MARGIN_MM + RULE_MM + 4.0;
    let of = match tiling.columns * tiling.rows {
        1 => String::new(),
        all => {
            let number = row * tiling.columns + column + 1;
            format!(", page {number} of {all}: column {}, row {} from below", column + 1, row + 1)
        }
    };
    let name = shortened(job.name, CAPTION, right - left - CAPTION.width_mm(&format!(" {}{of}", sheet.file)));
    page.text(P2::new(right, EDGE_MM + 5.6), At::Right, CAPTION, &format!("{name} {}{of}", sheet.file));
    let legend = "Print at 100 %. Heavy: scissors. Thin: knife. Grey: marks.";
    page.text(P2::new(right, EDGE_MM + 1.6), At::Right, CAPTION, legend);
}

/// Lines where the neighbouring pages begin, with crosses that lie on theirs.
fn seams(page: &mut Page, window: &Rect, tiling: &Tiling, column: usize, row: usize) {
    let mut upright = Vec::new();
    let mut level = Vec::new();
    if column > 0 {
        upright.push(window.min.x + 0.5 * OVERLAP_MM);
    }
    if column + 1 < tiling.columns {
        upright.push(window.max.x - 0.5 * OVERLAP_MM);
    }
    if row > 0 {
        level.push(window.min.y + 0.5 * OVERLAP_MM);
    }
    if row + 1 < tiling.rows {
        level.push(window.max.y - 0.5 * OVERLAP_MM);
    }
    // Crosses a quarter and three quarters of the way lie at the same places on both pages.
    let shares = [0.25, 0.75];
    for x in upright {
        page.line(&[P2::new(x, window.min.y), P2::new(x, window.max.y)], SEAM);
        shares.iter().for_each(|s| cross(page, P2::new(x, window.min.y + s * window.height())));
    }
    for y in level {
        page.line(&[P2::new(window.min.x, y), P2::new(window.max.x, y)], SEAM);
        shares.iter().for_each(|s| cross(page, P2::new(window.min.x + s * window.width(), y)));
    }
}

fn cross(page: &mut Page, at: P2) {
    for way in [V2::new(4.0, 0.0), V2::new(0.0, 4.0)] {
        page.line(&[at - way, at + way], CROSS);
    }
}

/// A line of 100 mm with a tick every 10.
fn rule(page: &mut Page, left: P2) {
    let pen = Pen::black(0.25);
    page.line(&[left, left + V2::new(RULE_MM, 0.0)], pen);
    for n in 0..=10 {
        let at = left + V2::new(f64::from(n) * RULE_MM / 10.0, 0.0);
        let height = if n % 5 == 0 { 3.0 } else { 1.8 };
        page.line(&[at, at + V2::new(0.0, height)], pen);
    }
    page.text(
        left + V2::new(2.0, 3.6),
        At::Left,
        CAPTION,
        "100 mm: if it measures otherwise, print again without scaling",
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    const A4: V2 = V2::new(210.0, 297.0);

    #[test]
    fn what_fits_one_page_takes_one_and_lies_as_it_fits() {
        assert_eq!(Tiling::of(V2::new(150.0, 250.0), A4).columns, 1);
        let lying = Tiling::of(V2::new(273.0, 180.0), A4);
        assert!(lying.landscape && lying.columns * lying.rows == 1);
        let full = Tiling::of(V2::new(281.0, 184.0 + 1e-9), A4);
        assert_eq!(full.columns * full.rows, 1, "exactly as large as the window, but for rounding");
    }

    #[test]
    fn pages_cover_the_drawing_and_repeat_each_other_by_the_overlap() {
        let size = V2::new(430.0, 280.0);
        let tiling = Tiling::of(size, A4);
        assert!(tiling.columns * tiling.rows > 1);
        let last = tiling.shown(tiling.columns - 1, tiling.rows - 1);
        assert!(last.max.x >= size.x && last.max.y >= size.y);
        let (first, second) = (tiling.shown(0, 0), tiling.shown(1, 0));
        assert!((first.max.x - second.min.x - OVERLAP_MM).abs() < 1e-9);
    }
}
