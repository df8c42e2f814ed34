//! What a fitted part amounts to: how full, how long, how tight, how reachable.

use super::Target;
use super::shape::Spent;
use crate::extrude::Span;
use crate::geom::{P2, Rect, V2, enclosed, long_side, signed_area, thickness};
use crate::ruffle::{Direction, Ruffle};
use crate::sim::Equilibrium;

/// How the bottom rung stands in the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FootUsed {
    /// Rests on the floor by itself.
    Free,
    /// Its two ends are glued or slotted to a base.
    Pinned,
    /// Its two ends are held by the strips that tie it to the parts it rests on.
    Tied,
}

/// Figures of one part.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Outline area not enclosed over outline area.
    pub uncovered_fraction: f64,
    /// Enclosed area outside the outline over outline area.
    pub protruding_fraction: f64,
    /// Border loops of the enclosed region, plane frame, mm.
    pub covered: Vec<Vec<P2>>,
    /// How the foot stands.
    pub foot: FootUsed,
    /// Whether it stands without falling over when pushed a little.
    pub stands: bool,
    /// Strip without end tabs, mm.
    pub strip_length_mm: f64,
    /// Mass of the strip without end tabs, g.
    pub strip_mass_g: f64,
    /// Tightest bend, mm, and the section it lies in.
    pub min_radius_mm: f64,
    /// Section of the tightest bend.
    pub tightest_section: usize,
    /// Thickness of the thinnest layer: its area over the long side of the smallest rectangle around it, mm. Densified layers are left out.
    pub thinnest_layer_mm: f64,
    /// Layers of the stack.
    pub layers: usize,
    /// Which way they lie on each other.
    pub direction: Direction,
    /// Work done to find the shape.
    pub spent: Spent,
    /// Thickness of the thinnest void: its area over the long side of the smallest rectangle around it, mm.
    pub min_void_mm: f64,
    /// Middle of the thinnest void, plane frame, mm.
    pub thinnest_void: P2,
}

/// What a part's shape does not tell: how it was made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Origin {
    pub foot: FootUsed,
    pub direction: Direction,
    pub spent: Spent,
}

impl FootUsed {
    /// Whether both ends of the bottom rung are held, by whatever it is.
    pub fn is_held(self) -> bool {
        self != FootUsed::Free
    }
}

impl Report {
    /// How the part was made.
    pub(super) fn origin(&self) -> Origin {
        Origin { foot: self.foot, direction: self.direction, spent: self.spent }
    }
}

/// Voids shorter than this, mm, are what is left between sheets that touch, not rooms. A layer that has collapsed is thin but long.
const LEAST_VOID_MM: f64 = 5.0;

/// A part stands if its centre of mass stays this far inside what touches the floor when it is tilted by [`TILT_DEG`]. Measured: parts with less margin than tan 6°
/// times the height of their centre plus 5 mm fell over at 3 to 6 degrees.
const STANDING_MARGIN_MM: f64 = 5.0;
const TILT_DEG: f64 = 6.0;
/// What lies this close to the floor touches it, mm.
const TOUCHING_MM: f64 = 0.05;

/// Measures a settled ruffle.
pub(super) fn measure(
    target: &Target,
    ruffle: &Ruffle,
    spans: &[Span],
    equilibrium: &Equilibrium,
    Origin { foot, direction, spent }: Origin,
) -> Report {
    let positions = &equilibrium.positions;
    let segments: Vec<(P2, P2)> = ruffle.segments().map(|(i, j)| (positions[i], positions[j])).collect();
    let region = enclosed(&segments);
    let coverage = region.coverage(target.outline.loops());
    let area_mm2: f64 = ruffle
        .segments()
        .zip(&ruffle.rest_lengths)
        .map(|((i, j), l)| 0.5 * (spans[i].width() + spans[j].width()) * l)
        .sum();
    let margin_mm = standing_margin_mm(target, ruffle, spans, positions);
    let (min_radius_mm, tightest_section) = tightest_bend(ruffle, positions);
    let (min_void_mm, thinnest_void) = region
        .rooms
        .iter()
        .map(|room| measured_room(room))
        .filter(|room| room.length_mm >= LEAST_VOID_MM)
        .map(|room| (room.thickness_mm, room.center))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((0.0, P2::origin()));
    let layers = ruffle.layers();
    let thinnest_layer_mm = layers
        .iter()
        .filter_map(|layer| ruffle.layer_border(layer))
        .map(|nodes| {
            let corners: Vec<P2> = nodes.iter().map(|n| positions[*n]).collect();
            thickness(signed_area(&corners).abs(), &corners)
        })
        .fold(f64::INFINITY, f64::min)
        .min(region_height(positions));
    Report {
        thinnest_layer_mm,
        layers: layers.len(),
        direction,
        spent,
        uncovered_fraction: coverage.uncovered_fraction(),
        protruding_fraction: coverage.protruding_fraction(),
        covered: region.loops,
        foot,
        stands: foot.is_held() || margin_mm >= 0.0,
        strip_length_mm: ruffle.strip_length(),
        strip_mass_g: area_mm2 * 1e-6 * target.material.grammage_g_per_m2,
        min_radius_mm,
        tightest_section,
        min_void_mm,
        thinnest_void,
    }
}

/// Extent of the whole upward, mm.
fn region_height(x: &[P2]) -> f64 {
    Rect::around(x).height()
}

/// Smallest radius of curvature along the strip, mm, and its section. The radius at a node is the mean length of its segments over the turn between them.
fn tightest_bend(ruffle: &Ruffle, x: &[P2]) -> (f64, usize) {
    let mut tightest = (f64::INFINITY, 0);
    for (s, section) in ruffle.sections.iter().enumerate() {
        for k in section.first_segment.max(1)..section.end_segment {
            let (e1, e2) = (x[ruffle.at(k)] - x[ruffle.at(k - 1)], x[ruffle.at(k + 1)] - x[ruffle.at(k)]);
            let radius = 0.5 * (e1.norm() + e2.norm()) / e1.angle(&e2).max(1e-9);
            if radius < tightest.0 {
                tightest = (radius, s);
            }
        }
    }
    tightest
}

/// How far the centre of all weight, the strip's own and what it bears, lies inside the contact with the floor, beyond what a standing part needs, mm; negative
/// for one that falls over. The floor is at the lowest node.
fn standing_margin_mm(target: &Target, ruffle: &Ruffle, spans: &[Span], x: &[P2]) -> f64 {
    let (mut whole_n, mut moment) = (0.0, V2::zeros());
    let mut add = |at: P2, weight_n: f64| {
        whole_n += weight_n;
        moment += at.coords * weight_n;
    };
    for ((i, j), length) in ruffle.segments().zip(&ruffle.rest_lengths) {
        let area_mm2 = 0.5 * (spans[i].width() + spans[j].width()) * length;
        add(nalgebra::center(&x[i], &x[j]), target.material.weight_n_per_mm2() * area_mm2);
    }
    for (node, force) in target.loads_n {
        add(x[node.index()], -force.y);
    }
    let center = moment / whole_n;
    let floor = x.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let touching = x.iter().filter(|p| p.y <= floor + TOUCHING_MM).map(|p| p.x);
    let (left, right) = touching.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, r), u| (l.min(u), r.max(u)));
    let margin = (center.x - left).min(right - center.x);
    margin - (TILT_DEG.to_radians().tan() * (center.y - floor) + STANDING_MARGIN_MM)
}

/// A room's size.
struct Room {
    /// Area over the long side of the smallest rectangle around it, mm.
    thickness_mm: f64,
    /// That long side, mm.
    length_mm: f64,
    /// Centre of area.
    center: P2,
}

fn measured_room(room: &[[P2; 3]]) -> Room {
    let corners: Vec<P2> = room.iter().flatten().copied().collect();
    let area: f64 = room.iter().map(|t| signed_area(t)).sum();
    let weighted = room.iter().map(|t| (t[0].coords + t[1].coords + t[2].coords) * (signed_area(t) / 3.0));
    let center = weighted.fold(nalgebra::Vector2::zeros(), |sum, v| sum + v) / area;
    Room { thickness_mm: thickness(area, &corners), length_mm: long_side(&corners), center: P2::from(center) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangular_room_is_as_thick_as_its_short_side_however_it_is_turned() {
        for angle in [0.0, 0.3, 1.1] {
            let turn = nalgebra::Rotation2::new(angle);
            let p = |x: f64, y: f64| turn * P2::new(x, y);
            let room = [[p(0.0, 0.0), p(40.0, 0.0), p(40.0, 9.0)], [p(0.0, 0.0), p(40.0, 9.0), p(0.0, 9.0)]];
            let Room { thickness_mm: thick, length_mm, center } = measured_room(&room);
            assert!((length_mm - 40.0).abs() < 1e-9);
            assert!((thick - 9.0).abs() < 1e-9, "{thick}");
            assert!((center - p(20.0, 4.5)).norm() < 1e-9);
        }
    }
}
