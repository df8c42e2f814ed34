//! Fills pages from top to bottom.

use super::letters::{Face, wrapped};
use super::page::{At, Lettering, Page, Pen};
use super::{Paper, pdf};
use crate::geom::{P2, Rect, V2};

/// Space kept free around everything, mm: more than any printer needs.
pub(super) const MARGIN_MM: f64 = 15.0;
/// The footer's baseline above the paper's edge, mm.
const FOOTER_MM: f64 = 9.0;
const FOOTER: Lettering = Lettering { size_mm: 3.0, face: Face::Plain, gray: 0.35 };
const TITLE: Lettering = Lettering::new(7.5, Face::Bold);
const HEADING: Lettering = Lettering::new(4.8, Face::Bold);
/// Running text.
pub(super) const BODY: Lettering = Lettering::new(3.7, Face::Plain);
/// Running text that matters.
pub(super) const STRONG: Lettering = Lettering::new(3.7, Face::Bold);
/// From baseline to baseline of running text, mm.
pub(super) const LEADING_MM: f64 = 5.2;
/// Side of a check box, mm: a pencil's tick.
pub(super) const BOX_MM: f64 = 4.0;
/// From the left of a check box to its text, mm.
const INDENT_MM: f64 = 6.5;
/// Border of a check box.
const BOX_PEN: Pen = Pen::black(0.35);
const RULE: Pen = Pen::gray(0.2, 0.6);

/// Pages under way.
pub(super) struct Flow {
    area: Rect,
    pages: Vec<Page>,
    /// Upper edge of what is still free on the last page, mm.
    y: f64,
}

impl Flow {
    /// No page yet.
    pub fn new(paper: Paper) -> Flow {
        let [width, height] = paper.size_mm();
        Flow { area: Rect::from_size(width, height), pages: Vec::new(), y: 0.0 }
    }

    /// Width of the column, mm.
    pub fn width_mm(&self) -> f64 {
        self.area.width() - 2.0 * MARGIN_MM
    }

    /// Height that is still free on this page, mm.
    pub fn free_mm(&self) -> f64 {
        self.y - MARGIN_MM
    }

    /// Opens a page under a title.
    pub fn page(&mut self, title: &str) {
        self.pages.push(Page::new(self.area));
        self.y = self.area.max.y - MARGIN_MM;
        let baseline = self.y - 0.75 * TITLE.size_mm;
        self.text(P2::new(MARGIN_MM, baseline), At::Left, TITLE, title);
        self.y = baseline - 6.0;
    }

    /// The page under way.
    pub fn paper(&mut self) -> &mut Page {
        if self.pages.is_empty() {
            self.pages.push(Page::new(self.area));
            self.y = self.area.max.y - MARGIN_MM;
        }
        let last = self.pages.len() - 1;
        &mut self.pages[last]
    }

    /// Writes a line of text anywhere.
    pub fn text(&mut self, at: P2, align: At, lettering: Lettering, text: &str) {
        self.paper().text(at, align, lettering, text);
    }

    /// Takes `height_mm` of the column, on a new page under `title` where this one has too little left.
    pub fn take(&mut self, height_mm: f64, title: &str) -> Rect {
        if self.pages.is_empty() || self.free_mm() < height_mm {
            self.page(title);
        }
        let min = P2::new(MARGIN_MM, self.y - height_mm);
        self.y -= height_mm;
        Rect { min, max: min + V2::new(self.width_mm(), height_mm) }
    }

    /// Leaves `height_mm` free.
    pub fn skip(&mut self, height_mm: f64) {
        self.y -= height_mm;
    }

    /// A heading over what follows; `title` heads the page if it starts a new one, which it does where fewer than `with_mm` would be left below it.
    pub fn heading(&mut self, text: &str, with_mm: f64, title: &str) {
        if self.free_mm() < 9.0 + with_mm {
            self.page(title);
            if text == title {
                return;
            }
        }
        let line = self.take(9.0, title);
        self.text(P2::new(line.min.x, line.min.y + 2.2), At::Left, HEADING, text);
    }

    /// Running text.
    pub fn paragraph(&mut self, lettering: Lettering, text: &str, title: &str) {
        for line in wrapped(text, lettering.size_mm, lettering.face, self.width_mm()) {
            let space = self.take(LEADING_MM, title);
            self.text(P2::new(space.min.x, space.min.y + 1.4), At::Left, lettering, &line);
        }
        self.skip(1.2);
    }

    /// Something to tick off.
    pub fn check(&mut self, text: &str, title: &str) {
        let lines = wrapped(text, BODY.size_mm, BODY.face, self.width_mm() - INDENT_MM);
        let height = lines.len().max(1) as f64 * LEADING_MM + 1.4;
        let space = self.take(height, title);
        let mut baseline = space.max.y - LEADING_MM + 1.4;
        check_box(self.paper(), P2::new(space.min.x, baseline - 0.6));
        for line in &lines {
            self.text(P2::new(space.min.x + INDENT_MM, baseline), At::Left, BODY, line);
            baseline -= LEADING_MM;
        }
    }

    /// Two columns: what, and its value.
    pub fn facts<'a>(&mut self, rows: impl IntoIterator<Item = (&'a str, &'a str)>, title: &str) {
        let column = 0.28 * self.width_mm();
        for (what, value) in rows {
            let lines = wrapped(value, BODY.size_mm, BODY.face, self.width_mm() - column);
            let space = self.take(lines.len().max(1) as f64 * LEADING_MM + 0.6, title);
            let mut baseline = space.max.y - LEADING_MM + 1.4;
            self.text(P2::new(space.min.x, baseline), At::Left, STRONG, what);
            for line in &lines {
                self.text(P2::new(space.min.x + column, baseline), At::Left, BODY, line);
                baseline -= LEADING_MM;
            }
        }
        self.skip(1.5);
    }

    /// A table. Every row starts with a box to tick when `ticked`; columns are `shares` of the width, and what does not fit is cut short.
    pub fn table(&mut self, heads: &[&str], rows: &[Vec<String>], shares: &[f64], ticked: bool, title: &str) {
        const ROW_MM: f64 = 6.4;
        let indent = if ticked { INDENT_MM } else { 0.0 };
        let total: f64 = shares.iter().sum();
        let width = self.width_mm() - indent;
        let columns: Vec<(f64, f64)> = shares
            .iter()
            .scan(indent, |left, share| {
                let at = *left;
                *left += width * share / total;
                Some((at, width * share / total))
            })
            .collect();
        let mut headed = false;
        for row in rows {
            if !headed || self.free_mm() < ROW_MM {
                let line = self.take(if headed { self.free_mm() + ROW_MM } else { ROW_MM }, title);
                for (head, (x, _)) in heads.iter().zip(&columns) {
                    self.text(P2::new(line.min.x + x, line.min.y + 1.8), At::Left, STRONG, head);
                }
                self.rule(line.min);
                headed = true;
            }
            let line = self.take(ROW_MM, title);
            if ticked {
                check_box(self.paper(), line.min + V2::new(0.0, 1.2));
            }
            for (cell, (x, width)) in row.iter().zip(&columns) {
                let short = shortened(cell, BODY, width - 1.5);
                self.text(P2::new(line.min.x + x, line.min.y + 1.9), At::Left, BODY, &short);
            }
            self.rule(line.min);
        }
        self.skip(2.0);
    }

    fn rule(&mut self, left: P2) {
        let right = left + V2::new(self.width_mm(), 0.0);
        self.paper().line(&[left, right], RULE);
    }

    /// The file; `footer` stands under every page, with its number.
    pub fn finish(mut self, footer: &str) -> Vec<u8> {
        let count = self.pages.len();
        for (i, page) in self.pages.iter_mut().enumerate() {
            page.text(P2::new(MARGIN_MM, FOOTER_MM), At::Left, FOOTER, footer);
            let right = P2::new(self.area.max.x - MARGIN_MM, FOOTER_MM);
            page.text(right, At::Right, FOOTER, &format!("page {} of {count}", i + 1));
        }
        pdf::file(footer, self.pages)
    }
}

/// A box to tick, from its lower left corner.
pub(super) fn check_box(page: &mut Page, at: P2) {
    page.frame(&Rect { min: at, max: at + V2::new(BOX_MM, BOX_MM) }, BOX_PEN);
}

/// The text, or as much of its beginning as is no wider than `width_mm`, with dots.
pub(super) fn shortened(text: &str, lettering: Lettering, width_mm: f64) -> String {
    if lettering.width_mm(text) <= width_mm {
        return text.to_owned();
    }
    let mut kept = text.to_owned();
    while !kept.is_empty() && lettering.width_mm(&kept) + lettering.width_mm("...") > width_mm {
        kept.pop();
    }
    kept + "..."
}
