//! What stands on a card: each sample drawn with its lower left corner on the origin, mm.

use super::shop::Shop;
use crate::drawing::{Drawing, DrawnPath, KerfSide, Role, text_paths, text_width};
use crate::geom::{Motion, P2, Path, V2};
use crate::strip::Joint;

/// Slats of a kerf comb: their gaps add up, so that a ruler can measure what a beam takes away.
pub(super) const SLATS: usize = 10;
/// Size of a kerf comb's window, mm.
pub(super) const COMB_MM: [f64; 2] = [110.0, 14.0];
/// Side of a square of the power row, mm.
pub(super) const SQUARE_MM: f64 = 9.0;
/// Width of a hanging strip, mm.
pub(super) const STRIP_MM: f64 = 15.0;
/// How far the notches reach that mark where a strip leaves the edge, mm.
const NOTCH_MM: f64 = 1.5;
/// From a coupon's edge to the first cut in it, along the strip, mm.
const COUPON_END_MM: f64 = 9.0;

fn drawn(path: Path, role: Role, kerf: KerfSide) -> DrawnPath {
    DrawnPath { path, role, kerf, joint: None }
}

fn line(from: [f64; 2], to: [f64; 2]) -> Path {
    Path::open([P2::new(from[0], from[1]), P2::new(to[0], to[1])])
}

fn rectangle(width: f64, height: f64) -> Path {
    Path::closed([(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)].map(|(x, y)| P2::new(x, y)))
}

/// Letters, standing on y = 0.
pub(super) fn letters(name: &str, text: &str, height_mm: f64) -> Drawing {
    let paths = text_paths(text, height_mm).into_iter().map(|path| drawn(path, Role::Label, KerfSide::On)).collect();
    Drawing { name: name.into(), paths }
}

/// A square cut right on its line.
pub(super) fn square(name: &str) -> Drawing {
    Drawing { name: name.into(), paths: vec![drawn(rectangle(SQUARE_MM, SQUARE_MM), Role::Outline, KerfSide::On)] }
}

/// A window of slats, cut right on their lines.
pub(super) fn comb(name: &str) -> Drawing {
    let [width, height] = COMB_MM;
    let slat = |i: usize| {
        let x = width * i as f64 / SLATS as f64;
        drawn(line([x, 0.0], [x, height]), Role::Hole, KerfSide::On)
    };
    let window = drawn(rectangle(width, height), Role::Outline, KerfSide::On);
    Drawing { name: name.into(), paths: (1..SLATS).map(slat).chain([window]).collect() }
}

/// Width of the coupons of the joint, mm.
pub(super) fn coupon_width_mm(joint: &Joint) -> f64 {
    joint.min_width_mm.max(joint.cut_out_mm() + 2.0 * joint.edge_distance_mm)
}

/// Distance between the slits of a series, mm.
pub(super) fn slit_pitch_mm(joint: &Joint) -> f64 {
    joint.cut_distance_mm.max(10.0)
}

/// Length of the coupon of slits, mm.
pub(super) fn slits_length_mm(shop: &Shop) -> f64 {
    2.0 * COUPON_END_MM + slit_pitch_mm(&shop.joint) * (shop.slit_extras_mm().len() - 1) as f64
}

/// A piece with a series of slits, numbered below them where that can be written.
pub(super) fn slits(name: &str, shop: &Shop) -> Drawing {
    let (length, width) = (slits_length_mm(shop), coupon_width_mm(&shop.joint));
    let mut paths = Vec::new();
    for (i, extra) in shop.slit_extras_mm().into_iter().enumerate() {
        let joint = Joint { slit_length_mm: shop.joint.neck_mm + extra, ..shop.joint };
        let x = COUPON_END_MM + i as f64 * slit_pitch_mm(&joint);
        let shift = Motion::translation(x, 0.5 * width);
        paths.extend(joint.slit_cuts().into_iter().map(|cut| DrawnPath { path: cut.path.moved(&shift), ..cut }));
        if shop.engrave.is_some() {
            let number = (i + 1).to_string();
            // Between this slit and the next, where nothing is cut.
            let at = Motion::translation(x + 1.5, 1.0);
            let strokes = text_paths(&number, shop.letter_mm.min(0.5 * slit_pitch_mm(&joint)));
            paths.extend(strokes.into_iter().map(|stroke| drawn(stroke.moved(&at), Role::Label, KerfSide::On)));
        }
    }
    paths.push(drawn(rectangle(length, width), Role::Outline, KerfSide::Outside));
    Drawing { name: name.into(), paths }
}

/// Length of the coupon of the flap, mm.
pub(super) fn flap_length_mm(joint: &Joint) -> f64 {
    let (behind, ahead) = joint.reach_both_ways_mm(1);
    behind + ahead + 2.0 * COUPON_END_MM
}

/// A piece with the flap that goes with the slits.
pub(super) fn flap(name: &str, joint: &Joint) -> Drawing {
    let width = coupon_width_mm(joint);
    let shift = Motion::translation(COUPON_END_MM + joint.reach_both_ways_mm(1).0, 0.5 * width);
    let cuts = joint.flap_cuts(1).into_iter().map(|cut| DrawnPath { path: cut.path.moved(&shift), ..cut });
    let outline = drawn(rectangle(flap_length_mm(joint), width), Role::Outline, KerfSide::Outside);
    Drawing { name: name.into(), paths: cuts.chain([outline]).collect() }
}

/// A strip to hang over an edge: two notches stand where the edge goes, `reach_mm` from its right end; `up` turns it to run along y.
pub(super) fn hanging(name: &str, title: &str, length_mm: f64, reach_mm: f64, up: bool, shop: &Shop) -> Drawing {
    let edge = length_mm - reach_mm;
    let mut paths = vec![
        drawn(line([edge, 0.0], [edge, NOTCH_MM]), Role::Hole, KerfSide::On),
        drawn(line([edge, STRIP_MM - NOTCH_MM], [edge, STRIP_MM]), Role::Hole, KerfSide::On),
    ];
    if shop.engrave.is_some() {
        // On the part that is held, so that no burn stiffens or weakens what hangs.
        let height = shop.letter_mm.min(STRIP_MM - 2.0 * NOTCH_MM);
        let at = Motion::translation(edge - text_width(title, height) - 3.0, 0.5 * (STRIP_MM - height));
        let strokes = text_paths(title, height);
        paths.extend(strokes.into_iter().map(|stroke| drawn(stroke.moved(&at), Role::Label, KerfSide::On)));
    }
    paths.push(drawn(rectangle(length_mm, STRIP_MM), Role::Outline, KerfSide::Outside));
    let lying = Drawing { name: name.into(), paths };
    if !up {
        return lying;
    }
    lying.moved(&Motion::new(V2::new(STRIP_MM, 0.0), std::f64::consts::FRAC_PI_2))
}

/// A ruler to stand beside the edge, from zero at its upper end downward; drawn lying.
pub(super) fn ruler(name: &str, length_mm: f64, letter_mm: f64) -> Drawing {
    let width = RULER_MM;
    let mut paths = Vec::new();
    for mm in 1..length_mm as usize {
        let reach = if mm.is_multiple_of(10) {
            5.0
        } else if mm.is_multiple_of(5) {
            3.5
        } else {
            2.0
        };
        paths.push(drawn(line([mm as f64, width], [mm as f64, width - reach]), Role::Mark, KerfSide::On));
        if mm.is_multiple_of(10) {
            let text = mm.to_string();
            let at = Motion::translation(mm as f64 - 0.5 * text_width(&text, letter_mm), width - 6.5 - letter_mm);
            let strokes = text_paths(&text, letter_mm);
            paths.extend(strokes.into_iter().map(|stroke| drawn(stroke.moved(&at), Role::Label, KerfSide::On)));
        }
    }
    paths.push(drawn(rectangle(length_mm, width), Role::Outline, KerfSide::Outside));
    Drawing { name: name.into(), paths }
}

/// Width of the ruler, mm.
pub(super) const RULER_MM: f64 = 14.0;
