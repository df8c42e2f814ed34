//! What a fitted part amounts to: how full, how long, how tight, how reachable.

use super::{Part, Settings, Target};
use crate::extrude::Span;
use crate::geom::{P2, convex_hull, enclosed, signed_area};
use crate::progress::Warning;
use crate::ruffle::Ruffle;
use crate::sim::{Equilibrium, Outcome};

/// How the bottom rung stands in the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FootUsed {
    /// Rests on the floor by itself.
    Free,
    /// Its two ends are glued or slotted to a base.
    Pinned,
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
    /// Thickness of the thinnest void: its area over the long side of the smallest rectangle around it, mm.
    pub min_void_mm: f64,
    /// Middle of the thinnest void, plane frame, mm.
    pub thinnest_void: P2,
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
    foot: FootUsed,
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
    let margin_mm = standing_margin_mm(ruffle, spans, positions);
    let (min_radius_mm, tightest_section) = tightest_bend(ruffle, positions);
    let (min_void_mm, thinnest_void) = region
        .rooms
        .iter()
        .map(|room| measured_room(room))
        .filter(|room| room.length_mm >= LEAST_VOID_MM)
        .map(|room| (room.thickness_mm, room.center))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((0.0, P2::origin()));
    Report {
        uncovered_fraction: coverage.uncovered_fraction(),
        protruding_fraction: coverage.protruding_fraction(),
        covered: region.loops,
        foot,
        stands: foot == FootUsed::Pinned || margin_mm >= 0.0,
        strip_length_mm: ruffle.strip_length(),
        strip_mass_g: area_mm2 * 1e-6 * target.material.grammage_g_per_m2,
        min_radius_mm,
        tightest_section,
        min_void_mm,
        thinnest_void,
    }
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

/// How far the centre of mass lies inside the contact with the floor, beyond what a standing part needs, mm; negative for one that falls over. The floor is
/// at the lowest node.
fn standing_margin_mm(ruffle: &Ruffle, spans: &[Span], x: &[P2]) -> f64 {
    let (mut mass, mut moment) = (0.0, nalgebra::Vector2::zeros());
    for ((i, j), length) in ruffle.segments().zip(&ruffle.rest_lengths) {
        let m = 0.5 * (spans[i].width() + spans[j].width()) * length;
        mass += m;
        moment += nalgebra::center(&x[i], &x[j]).coords * m;
    }
    let center = moment / mass;
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
    let hull = convex_hull(&corners);
    let n = hull.len();
    let long_side = (0..n)
        .filter_map(|i| (hull[(i + 1) % n] - hull[i]).try_normalize(1e-12))
        .map(|u| {
            let extent = |axis: nalgebra::Vector2<f64>| {
                let along = hull.iter().map(|p| p.coords.dot(&axis));
                let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
                high - low
            };
            let (a, b) = (extent(u), extent(nalgebra::Vector2::new(-u.y, u.x)));
            (a * b, a.max(b))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(1.0, |(_, long)| long);
    let area: f64 = room.iter().map(|t| signed_area(t)).sum();
    let weighted = room.iter().map(|t| (t[0].coords + t[1].coords + t[2].coords) * (signed_area(t) / 3.0));
    let center = weighted.fold(nalgebra::Vector2::zeros(), |sum, v| sum + v) / area;
    Room { thickness_mm: area / long_side, length_mm: long_side, center: P2::from(center) }
}

/// What the user should know before cutting.
pub fn warnings(part: &Part, settings: &Settings) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let r = &part.report;
    let mut warn = |warning: Warning| warnings.push(warning.in_part(&part.name));
    if part.equilibrium.self_intersections > 0 {
        let n = part.equilibrium.self_intersections;
        warn(Warning::new(
            "self-intersection",
            format!(
                "the folded strip passes through itself in {n} places; it will fold differently there. Try another number of layers"
            ),
        ));
    }
    if r.foot == FootUsed::Pinned && settings.foot == super::Foot::Auto {
        warn(Warning::new(
            "foot-pinned",
            "standing free it would tip or fill less: glue both ends of the bottom rung to a base, or set foot = \"free\" in the design",
        ));
    }
    if !r.stands {
        warn(Warning::new(
            "tips",
            "standing free it falls over when pushed: glue both ends of the bottom rung to a base (--foot pinned)",
        ));
    }
    if r.min_radius_mm < settings.min_bend_radius_mm {
        warn(
            Warning::new(
                "bend-tight",
                format!(
                    "the strip bends to a radius of {:.1} mm; below {:.1} mm this material creases. Use fewer layers or make the shape larger",
                    r.min_radius_mm, settings.min_bend_radius_mm
                ),
            )
            .at(format!("section {}", r.tightest_section)),
        );
    }
    if r.min_void_mm < settings.min_void_mm {
        warn(
            Warning::new(
                "void-small",
                format!(
                    "a void is only {:.1} mm thick; tools need {:.1} mm to reach the flaps. Use fewer layers or make the shape larger",
                    r.min_void_mm, settings.min_void_mm
                ),
            )
            .at(format!("u {:.0}, v {:.0} mm", r.thinnest_void.x, r.thinnest_void.y)),
        );
    }
    if part.equilibrium.outcome != Outcome::Converged {
        warn(Warning::new(
            "not-settled",
            format!(
                "the strip had not come to rest (unbalanced force {:.1e} N); its shape may differ",
                part.equilibrium.residual_n
            ),
        ));
    }
    if r.protruding_fraction > 0.1 {
        warn(Warning::new(
            "sticks-out",
            format!(
                "{:.0} % of the outline's area again sticks out of it: narrow places are bridged. Other layers may follow the shape better",
                100.0 * r.protruding_fraction
            ),
        ));
    }
    warnings
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
