//! The first page: what it will be.

use super::flow::{BODY, Flow, MARGIN_MM};
use super::joints::{Held, Joint};
use super::letters::Face;
use super::page::{At, Lettering, Page, Pen, Place};
use super::{Book, SPLICE_S, STITCH_S, code, count};
use crate::fit::Part;
use crate::geom::{P2, P3, Rect, V3};
use crate::mesh::TriMesh;
use std::collections::BTreeMap;

/// Edges at which the surface turns by more than this are drawn, rad: 40 degrees.
const CREASE_RAD: f64 = 40.0 * std::f64::consts::PI / 180.0;
const SHAPE: Pen = Pen::gray(0.22, 0.45);
const RIM: Pen = Pen::black(0.28);
const NOTE: Lettering = Lettering { size_mm: 3.0, face: Face::Plain, gray: 0.35 };
/// Side of the square code, mm: a phone reads it from a hand's breadth.
const CODE_MM: f64 = 32.0;

/// Writes the cover.
pub(super) fn cover(flow: &mut Flow, job: &Book, joints: &[Joint]) {
    flow.page(job.name);
    let picture = flow.take(0.5 * flow.free_mm(), job.name);
    draw(flow.paper(), &picture, job);
    flow.skip(6.0);

    let outlines = job.parts.iter().map(|part| Rect::around(part.outline.loops().flatten()));
    let size = match job.mesh {
        Some(mesh) => {
            let (lo, hi) = mesh.bounds();
            let size = hi - lo;
            let height = size.dot(&mesh.up).abs();
            let across: Vec<f64> = (0..3).filter(|i| mesh.up[*i].abs() < 0.5).map(|i| size[i]).collect();
            format!("{:.0} x {:.0} mm, {height:.0} mm high", across[0], across[across.len() - 1])
        }
        None => {
            let all = outlines.fold(Rect::EMPTY, Rect::union);
            format!("{:.0} mm wide, {:.0} mm high", all.width(), all.height())
        }
    };
    let mass: f64 = job.pieces.iter().map(|piece| piece.mass_g).sum();
    let all: Vec<&Joint> = joints.iter().collect();
    let minutes = assembly_minutes(job, &all, job.splices.len());
    let held = |by: Held| joints.iter().filter(|joint| joint.held == by).map(|joint| joint.abreast).sum::<usize>();
    let by = [(Held::Flaps, "flap"), (Held::Holes, "hole"), (Held::Tape, "marked place")];
    let by = by.map(|(by, what)| (held(by), what)).into_iter().filter(|(n, _)| *n > 0);
    let by: Vec<String> = by.map(|(n, what)| count(n, what)).collect();
    let cut = format!("{} on {}", count(job.pieces.len(), "piece"), count(job.sheets.len(), "sheet"));
    let build = format!("{} with {}, about {minutes} minutes by hand", count(joints.len(), "joint"), by.join(" and "));
    let mut facts = vec![("Size", size), ("Mass", format!("{mass:.1} g")), ("To cut", cut), ("To close", build)];
    facts.extend(job.card.facts.iter().take(2).map(|(what, value)| (what.as_str(), value.clone())));
    flow.facts(facts.iter().map(|(what, value)| (*what, value.as_str())), job.name);
    let how = "Cut the pieces. Join them to strips, one strip for each ruffle. Curl the strip, fold it as the drawing shows, and close the joints in the order of the steps: a flap and the slits it goes through carry the same number.";
    flow.paragraph(BODY, how, job.name);

    let area = flow.paper().area;
    let corner = P2::new(area.max.x - MARGIN_MM - CODE_MM, MARGIN_MM);
    let square = Rect { min: corner, max: P2::new(area.max.x - MARGIN_MM, MARGIN_MM + CODE_MM) };
    let caption = P2::new(square.min.x - 2.0, square.min.y + 2.0);
    flow.text(caption, At::Right, NOTE, "This code names the job: keep it with what was made.");
    code::draw(flow.paper(), &square, &format!("furbelow {} {}", job.name, job.hash));
}

/// How long a person needs for these joints and for joining pieces, in minutes, up to the next five.
pub(super) fn assembly_minutes(job: &Book, joints: &[&Joint], splices: usize) -> usize {
    let each = |joint: &&Joint| match joint.held {
        Held::Flaps | Held::Tape => joint.abreast as f64 * job.handling.flap_s,
        Held::Holes => joint.abreast as f64 * STITCH_S,
    };
    let seconds = joints.iter().map(each).sum::<f64>() + splices as f64 * SPLICE_S;
    ((seconds / 300.0).ceil() as usize).max(1) * 5
}

/// Looks at the object from before, a little from the right and from above. Parallel lines stay parallel.
struct Camera {
    right: V3,
    up: V3,
    /// Toward the eye.
    eye: V3,
}

impl Camera {
    fn new(part: &Part) -> Camera {
        let frame = &part.frame;
        let eye = (frame.normal + frame.u * 0.5 + frame.v * 0.35).normalize();
        let right = frame.v.cross(&eye).normalize();
        Camera { right, up: eye.cross(&right), eye }
    }

    fn seen(&self, p: P3) -> P2 {
        P2::new(p.coords.dot(&self.right), p.coords.dot(&self.up))
    }
}

/// The ruffles, and the shape's own edges lightly over them.
fn draw(page: &mut Page, picture: &Rect, job: &Book) {
    let Some(first) = job.parts.first() else { return };
    let camera = Camera::new(first);
    let edges: Vec<[P2; 2]> = job.mesh.map_or_else(Vec::new, |mesh| shape_edges(mesh, &camera));
    let walls: Vec<Wall> = job.parts.iter().flat_map(|part| walls(part, &camera)).collect();
    let corners = walls.iter().flat_map(|wall| &wall.corners).chain(edges.iter().flatten());
    let Place { scale, motion } = Place::fit(&Rect::around(corners), picture, MOST_SCALE);
    let place = Place { scale, motion };
    for wall in &walls {
        let corners = wall.corners.map(|p| place.point(p));
        page.region([corners.as_slice()], wall.gray, Some(Pen::gray(0.05, wall.gray)));
        for rim in &wall.rims {
            page.line(&rim.map(|p| place.point(p)), RIM);
        }
    }
    for edge in &edges {
        page.line(&edge.map(|p| place.point(p)), SHAPE);
    }
}

/// Small objects are drawn up to this much larger than they are.
const MOST_SCALE: f64 = 2.0;

/// One segment of a strip as it is seen.
struct Wall {
    corners: [P2; 4],
    /// Lines along it that are drawn: its two edges, and where the strip ends or turns out of sight.
    rims: Vec<[P2; 2]>,
    gray: f64,
    /// The nearer, the larger.
    nearness: f64,
}

/// The strip of a part, farthest first. All its walls stand along the same direction, so that the one whose foot is nearer hides the other.
fn walls(part: &Part, camera: &Camera) -> Vec<Wall> {
    let (ruffle, x, frame) = (&part.ruffle, &part.equilibrium.positions, &part.frame);
    let count = ruffle.rest_lengths.len();
    // A wall turns its right side to the eye, or its left.
    let across = |k: usize| {
        let (i, j) = ruffle.ends(k);
        let way = x[j] - x[i];
        let side = frame.u * way.y - frame.v * way.x;
        side.normalize().dot(&camera.eye)
    };
    let mut walls: Vec<Wall> = (0..count)
        .map(|k| {
            let (i, j) = ruffle.ends(k);
            let at = |node: usize, height: f64| camera.seen(frame.to_space(x[node], height));
            let (si, sj) = (part.spans[i], part.spans[j]);
            let corners = [at(i, si.lo), at(j, sj.lo), at(j, sj.hi), at(i, si.hi)];
            let mut rims = vec![[corners[0], corners[1]], [corners[3], corners[2]]];
            let turns = |other: usize| across(k) * across(other) <= 0.0;
            if k == 0 || turns(k - 1) {
                rims.push([corners[0], corners[3]]);
            }
            if k + 1 == count || turns(k + 1) {
                rims.push([corners[1], corners[2]]);
            }
            let middle = frame.to_space(nalgebra::center(&x[i], &x[j]), 0.0);
            let gray = 1.0 - SHADE * (1.0 - across(k).abs());
            Wall { corners, rims, gray, nearness: middle.coords.dot(&camera.eye) }
        })
        .collect();
    walls.sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
    walls
}

/// How much darker a wall seen edge on is than one seen full face.
const SHADE: f64 = 0.22;

/// Creases, open borders, and the edges between what faces the eye and what does not.
fn shape_edges(mesh: &TriMesh, camera: &Camera) -> Vec<[P2; 2]> {
    let normal = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(&(c - a)).normalize()
    };
    let mut at_edge: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for (t, corners) in mesh.triangles.iter().enumerate() {
        for side in 0..3 {
            let (a, b) = (corners[side], corners[(side + 1) % 3]);
            at_edge.entry((a.min(b), a.max(b))).or_default().push(t);
        }
    }
    let drawn = |triangles: &[usize]| match triangles {
        [one, other] => {
            let (n, m) = (normal(*one), normal(*other));
            n.dot(&camera.eye) * m.dot(&camera.eye) < 0.0 || n.dot(&m) < CREASE_RAD.cos()
        }
        _ => true,
    };
    let edges = at_edge.into_iter().filter(|(_, triangles)| drawn(triangles));
    edges.map(|((a, b), _)| [a, b].map(|i| camera.seen(mesh.vertices[i as usize]))).collect()
}
