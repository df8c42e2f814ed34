//! The rooms a folded strip encloses, and which of them lie around every joint.
//!
//! With all joints closed the strip is a plane graph: its faces are the rooms, plus the outside. Around a joint the faces lie in sectors between neighbouring
//! edges. A sector between two edges of the same pass of the strip is behind that sheet; the sectors between two different passes are the two sides of their
//! contact, and become one when the joint is open.

use crate::fit::Part;
use crate::geom::{P2, V2, signed_area, thickness};
use crate::ruffle::ConnectionPoint;

/// What lies between two neighbouring edges at a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sector {
    /// Index into [`Rooms::thickness_mm`].
    pub room: usize,
    /// The passes of the two edges, smaller first: indices into the joint's passes.
    pub passes: [usize; 2],
}

/// One way of the strip from a joint.
#[derive(Debug, Clone, Copy)]
struct Edge {
    /// Index into the joint's passes.
    pass: usize,
    /// The segment, and whether the strip runs along it away from the joint.
    segment: usize,
    forward: bool,
    /// Where it meets the circle about the joint, rad.
    angle: f64,
}

/// Rooms and what lies around every joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rooms {
    /// How thick each room is ([`thickness`]), mm; the outside is infinite.
    pub thickness_mm: Vec<f64>,
    /// Around every joint in the order of the connection points, counter-clockwise.
    pub around: Vec<Vec<Sector>>,
}

impl Rooms {
    /// The rooms of a part with all its joints closed.
    pub fn of(part: &Part, joints: &[ConnectionPoint]) -> Rooms {
        let mut is_joint = vec![false; part.ruffle.node_count];
        joints.iter().for_each(|joint| is_joint[joint.node.index()] = true);
        let edges: Vec<Vec<Edge>> = joints.iter().map(|joint| edges(part, joint, &is_joint)).collect();
        let faces = Faces::walk(part, joints, &edges);
        let around = edges
            .iter()
            .map(|edges| {
                let n = edges.len();
                let sector = |i: usize| {
                    let (a, b) = (edges[i], edges[(i + 1) % n]);
                    let room = faces.room_of[leaving(&a)];
                    Sector { room, passes: [a.pass.min(b.pass), a.pass.max(b.pass)] }
                };
                (0..n).map(sector).collect()
            })
            .collect();
        Rooms { thickness_mm: faces.thickness_mm, around }
    }
}

/// The edges at a joint, counter-clockwise. They leave it in nearly the same direction, so they are told apart where they first meet a circle about it that all of
/// them reach: ways that do not cross meet it in the order in which they leave.
fn edges(part: &Part, joint: &ConnectionPoint, is_joint: &[bool]) -> Vec<Edge> {
    let (ruffle, x) = (&part.ruffle, &part.equilibrium.positions);
    let middle = x[joint.node.index()];
    let last = ruffle.rest_lengths.len();
    // From the joint to the next, ends included.
    let way = |forward: bool, k: usize| {
        let mut points = vec![middle];
        let mut k = k;
        while if forward { k < last } else { k > 0 } {
            k = if forward { k + 1 } else { k - 1 };
            points.push(x[ruffle.at(k)]);
            if is_joint[ruffle.at(k)] {
                break;
            }
        }
        points
    };
    let mut ways: Vec<(usize, usize, bool, Vec<P2>)> = Vec::new();
    for (pass, k) in joint.passes.iter().enumerate() {
        if *k < last {
            ways.push((pass, *k, true, way(true, *k)));
        }
        if *k > 0 {
            ways.push((pass, *k - 1, false, way(false, *k)));
        }
    }
    let farthest = |points: &[P2]| points.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max);
    let radius = ways.iter().map(|w| 0.9 * farthest(&w.3)).fold(CIRCLE_MM, f64::min);
    let angle = |points: &[P2]| {
        let leaves = points.windows(2).find(|w| (w[1] - middle).norm() > radius).map_or(V2::x(), |w| {
            let (near, far) = ((w[0] - middle).norm(), (w[1] - middle).norm());
            w[0] + (w[1] - w[0]) * ((radius - near) / (far - near)) - middle
        });
        leaves.y.atan2(leaves.x)
    };
    let mut edges: Vec<Edge> = ways
        .into_iter()
        .map(|(pass, segment, forward, points)| Edge { pass, segment, forward, angle: angle(&points) })
        .collect();
    edges.sort_by(|a, b| a.angle.total_cmp(&b.angle).then(a.segment.cmp(&b.segment)));
    edges
}

/// Radius of the circle on which edges are told apart, mm, where all of them reach that far.
const CIRCLE_MM: f64 = 12.0;

/// Number of the half-edge that leaves a joint along `edge`: segment k is walked forward as 2 k and backward as 2 k + 1.
fn leaving(edge: &Edge) -> usize {
    2 * edge.segment + usize::from(!edge.forward)
}

/// The faces of the plane graph.
struct Faces {
    /// The room on the left of every half-edge.
    room_of: Vec<usize>,
    thickness_mm: Vec<f64>,
}

impl Faces {
    fn walk(part: &Part, joints: &[ConnectionPoint], edges: &[Vec<Edge>]) -> Faces {
        let ruffle = &part.ruffle;
        let last = ruffle.rest_lengths.len();
        let mut joint_at = vec![None; ruffle.node_count];
        for (j, joint) in joints.iter().enumerate() {
            joint_at[joint.node.index()] = Some(j);
        }
        // The half-edge after `half` round the face on its left: at a joint the next edge clockwise from the way back, elsewhere straight on.
        let next = |half: usize| {
            let (segment, forward) = (half / 2, half.is_multiple_of(2));
            let at = if forward { segment + 1 } else { segment };
            let back = 2 * segment + usize::from(forward);
            if let Some(j) = joint_at[ruffle.at(at)] {
                let edges = &edges[j];
                let here = edges.iter().position(|e| leaving(e) == back).unwrap_or(0);
                return leaving(&edges[(here + edges.len() - 1) % edges.len()]);
            }
            match (forward, at) {
                (true, k) if k < last => 2 * k,
                (false, k) if k > 0 => 2 * (k - 1) + 1,
                // A loose end: back along the other side.
                _ => back,
            }
        };
        let mut room_of = vec![usize::MAX; 2 * last];
        let mut loops: Vec<Vec<P2>> = Vec::new();
        for start in 0..2 * last {
            if room_of[start] != usize::MAX {
                continue;
            }
            let mut points = Vec::new();
            let mut half = start;
            while room_of[half] == usize::MAX {
                room_of[half] = loops.len();
                let node = ruffle.at(half / 2 + half % 2);
                points.push(part.equilibrium.positions[node]);
                half = next(half);
            }
            loops.push(points);
        }
        // Rooms are walked counter-clockwise; the one walk that is clockwise goes round the whole.
        let outside = (0..loops.len()).min_by(|a, b| signed_area(&loops[*a]).total_cmp(&signed_area(&loops[*b])));
        let thickness_mm = loops.iter().enumerate().map(|(i, points)| {
            if outside == Some(i) { f64::INFINITY } else { thickness(signed_area(points).max(0.0), points) }
        });
        Faces { thickness_mm: thickness_mm.collect(), room_of }
    }
}
