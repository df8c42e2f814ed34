//! How a joint closes, in three pictures: the cuts from above, then the two sheets from the side.

use super::flow::{BODY, Flow};
use super::joints::{Held, Joint};
use super::letters::Face;
use super::page::{At, Lettering, Page, Pen, Place};
use crate::geom::{P2, Path, PathVertex, Rect, V2};

const TITLE: &str = "How a joint closes";
const CAPTION: Lettering = Lettering::new(3.4, Face::Plain);
const WORD: Lettering = Lettering { size_mm: 3.0, face: Face::Plain, gray: 0.25 };
/// Height of the pictures and of the lines below them, mm.
const PICTURE_MM: f64 = 30.0;
const CAPTION_MM: f64 = 8.0;
const GAP_MM: f64 = 6.0;
const SHEET: Pen = Pen::black(0.7);
const OTHER: Pen = Pen::gray(0.7, 0.5);
const ARROW: Pen = Pen::black(0.25);

/// Draws and explains it, where joints have flaps; `title` heads a page that starts with it.
pub(super) fn pictures(flow: &mut Flow, joints: &[Joint], title: &str) {
    if !joints.iter().any(|joint| joint.held == Held::Flaps) {
        return;
    }
    flow.heading(TITLE, PICTURE_MM + CAPTION_MM + 24.0, title);
    let space = flow.take(PICTURE_MM + CAPTION_MM, title);
    let width = (space.width() - 2.0 * GAP_MM) / 3.0;
    let captions =
        ["1  A flap and its slit", "2  Bend the barbs, push it through", "3  The barbs open behind the sheet"];
    for (i, caption) in captions.into_iter().enumerate() {
        let min = space.min + V2::new(i as f64 * (width + GAP_MM), CAPTION_MM);
        let picture = Rect { min, max: min + V2::new(width, PICTURE_MM) };
        match i {
            0 => from_above(flow.paper(), &picture),
            1 => on_the_way(flow.paper(), &picture),
            _ => closed(flow.paper(), &picture),
        }
        flow.text(min - V2::new(0.0, 5.0), At::Left, CAPTION, caption);
    }
    let how = "Lay the flap's sheet on the slit's sheet, number on number. Bend both barbs of the flap up between two fingers, push the flap through the slit, and let the barbs open behind it. Where a number has several slits the same flap goes through all of them, one after the other. Pull lightly: it must not slip back.";
    flow.paragraph(BODY, how, title);
}

/// Half a flap as it is cut, hinge on x = 0 from y = 0 up, tip to the right: neck, barb, tip. Not to the scale of any material.
fn flap() -> Path {
    let half = [(0.0, 4.0), (2.2, 4.0), (1.9, 6.4), (4.0, 6.4), (9.0, 2.2)];
    let above = half.map(|(x, y)| P2::new(x, y));
    let below = half.iter().rev().map(|(x, y)| P2::new(*x, -*y));
    let vertices = above.into_iter().chain(below).map(|point| PathVertex { point, bulge: 0.0 });
    Path { vertices: vertices.collect(), closed: false }
}

fn from_above(page: &mut Page, picture: &Rect) {
    let middle = picture.center().y;
    let place = Place::new(1.5, V2::new(picture.min.x + 13.0, middle));
    let flap = flap();
    let points = place.points(&flap);
    page.region([points.as_slice()], 0.75, None);
    page.curve(&flap, &place, Pen::black(0.4));
    let hinge = [P2::new(0.0, 4.0), P2::new(0.0, -4.0)].map(|p| place.point(p));
    page.line(&hinge, Pen::black(0.3).dashed(1.2, 1.0));
    let slit = P2::new(picture.min.x + 42.0, middle);
    page.line(&[slit - V2::new(0.0, 5.4), slit + V2::new(0.0, 5.4)], Pen::black(0.8));
    page.text(slit - V2::new(0.0, 9.4), At::Middle, WORD, "slit");
    page.text(P2::new(hinge[0].x - 1.5, middle - 1.0), At::Right, WORD, "hinge");
    let barb = place.point(P2::new(4.0, 6.4));
    page.text(barb + V2::new(1.5, 0.6), At::Left, WORD, "barb");
    page.text(place.point(P2::new(3.8, 0.0)) - V2::new(0.0, 1.0), At::Middle, WORD, "flap");
}

/// The sheet with the flap and the sheet with the slit seen from the side, `apart` mm apart; where the hinge and the slit are.
fn sheets(page: &mut Page, picture: &Rect, apart: f64) -> (P2, P2) {
    let (left, right) = (picture.min.x + 1.0, picture.max.x - 3.0);
    let hinge = P2::new(picture.min.x + 17.0, picture.center().y + 0.5 * apart);
    let slit = P2::new(hinge.x + 2.6, hinge.y - apart);
    page.line(&[P2::new(left, hinge.y), hinge], SHEET);
    // Where the flap was cut out the sheet has a hole.
    page.line(&[hinge + V2::new(16.0, 0.0), P2::new(right, hinge.y)], SHEET);
    page.line(&[P2::new(left, slit.y), slit - V2::new(1.0, 0.0)], OTHER);
    page.line(&[slit + V2::new(1.0, 0.0), P2::new(right, slit.y)], OTHER);
    (hinge, slit)
}

fn on_the_way(page: &mut Page, picture: &Rect) {
    let (hinge, slit) = sheets(page, picture, 9.0);
    let tip = slit + V2::new(2.0, -3.5);
    page.line(&[hinge, hinge + V2::new(1.2, -2.5), tip], SHEET);
    let from = P2::new(hinge.x + 8.5, hinge.y + 5.0);
    let to = from - V2::new(0.0, 9.0);
    page.line(&[from, to], ARROW);
    page.line(&[to + V2::new(-1.1, 1.8), to, to + V2::new(1.1, 1.8)], ARROW);
    page.text(P2::new(picture.min.x + 1.0, hinge.y + 1.5), At::Left, WORD, "flap's sheet");
    page.text(P2::new(picture.min.x + 1.0, slit.y - 4.0), At::Left, WORD, "slit's sheet");
}

fn closed(page: &mut Page, picture: &Rect) {
    let (hinge, slit) = sheets(page, picture, 1.6);
    let behind = slit + V2::new(1.6, -1.4);
    page.line(&[hinge, slit + V2::new(-0.2, 0.4), behind, behind + V2::new(11.0, -0.7)], SHEET);
    page.text(behind + V2::new(1.0, -5.0), At::Left, WORD, "flap");
}
