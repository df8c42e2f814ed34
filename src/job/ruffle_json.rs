//! ruffle.json: the folded strips, complete enough to check or to simulate them elsewhere.

use super::report::rounded;
use super::settings::Setup;
use crate::fit::Part;
use crate::geom::{P2, P3, V3};
use crate::ruffle::Role;
use crate::sim::{GRAVITY_MM_PER_S2, Outcome};
use serde::Serialize;

#[derive(Serialize)]
struct RuffleFile<'a> {
    schema: u32,
    material: MaterialRecord,
    gravity_mm_per_s2: f64,
    parts: Vec<PartRecord<'a>>,
}

#[derive(Serialize)]
struct MaterialRecord {
    flexural_rigidity_n_mm: f64,
    grammage_g_per_m2: f64,
    thickness_mm: f64,
}

#[derive(Serialize)]
struct PartRecord<'a> {
    name: &'a str,
    frame: FrameRecord,
    outline: Vec<Vec<[f64; 2]>>,
    nodes: Vec<[f64; 2]>,
    spans: Vec<[f64; 2]>,
    segments: Vec<(u32, u32, f64)>,
    sections: Vec<SectionRecord>,
    connection_points: Vec<ConnectionRecord>,
    covered: Vec<Vec<[f64; 2]>>,
    /// Forces besides the strip's own weight: node, then N.
    loads_n: Vec<(u32, f64, f64)>,
    equilibrium: EquilibriumRecord,
}

#[derive(Serialize)]
struct FrameRecord {
    origin: [f64; 3],
    u: [f64; 3],
    v: [f64; 3],
    normal: [f64; 3],
}

#[derive(Serialize)]
struct SectionRecord {
    role: Role,
    start: u32,
    end: u32,
    rest_length: f64,
    first_segment: usize,
    last_segment: usize,
}

#[derive(Serialize)]
struct ConnectionRecord {
    node: u32,
    joint: String,
}

#[derive(Serialize)]
struct EquilibriumRecord {
    outcome: Outcome,
    iterations: usize,
    residual_n: f64,
    energy_n_mm: f64,
    max_strain: f64,
    self_intersections: usize,
}

/// The file's text.
pub(super) fn ruffle_json(parts: &[Part], setup: &Setup) -> String {
    let material = setup.material();
    let file = RuffleFile {
        schema: 1,
        material: MaterialRecord {
            flexural_rigidity_n_mm: material.flexural_rigidity_n_mm,
            grammage_g_per_m2: material.grammage_g_per_m2,
            thickness_mm: material.thickness_mm,
        },
        gravity_mm_per_s2: GRAVITY_MM_PER_S2,
        parts: parts.iter().map(record).collect(),
    };
    let mut text = serde_json::to_string(&file).expect("a ruffle holds nothing JSON cannot");
    text.push('\n');
    text
}

fn record(part: &Part) -> PartRecord<'_> {
    let ruffle = &part.ruffle;
    let sections = ruffle.sections.iter().enumerate().map(|(i, section)| {
        let (start, end) = ruffle.section_ends(i);
        SectionRecord {
            role: section.role,
            start: start.0,
            end: end.0,
            rest_length: rounded(ruffle.section_length(i)),
            first_segment: section.first_segment,
            last_segment: section.end_segment - 1,
        }
    });
    let connections = ruffle
        .connection_points()
        .into_iter()
        .map(|c| ConnectionRecord { node: c.node.0, joint: format!("{}{}", part.name, c.joint) });
    let e = &part.equilibrium;
    PartRecord {
        name: &part.name,
        frame: FrameRecord {
            origin: position(part.frame.origin),
            u: direction(part.frame.u),
            v: direction(part.frame.v),
            normal: direction(part.frame.normal),
        },
        outline: part.outline.loops().map(|l| points(l)).collect(),
        nodes: points(&e.positions),
        spans: part.spans.iter().map(|s| [rounded(s.lo), rounded(s.hi)]).collect(),
        segments: ruffle
            .rest_lengths
            .iter()
            .enumerate()
            .map(|(k, l)| (ruffle.walk[k].0, ruffle.walk[k + 1].0, rounded(*l)))
            .collect(),
        sections: sections.collect(),
        connection_points: connections.collect(),
        covered: part.report.covered.iter().map(|l| points(l)).collect(),
        loads_n: part.loads_n.iter().map(|(node, force)| (node.0, rounded(force.x), rounded(force.y))).collect(),
        equilibrium: EquilibriumRecord {
            outcome: e.outcome,
            iterations: e.iterations,
            residual_n: e.residual_n,
            energy_n_mm: rounded(e.energy_n_mm),
            max_strain: rounded(e.max_strain),
            self_intersections: e.self_intersections,
        },
    }
}

fn points(points: &[P2]) -> Vec<[f64; 2]> {
    points.iter().map(|p| [rounded(p.x), rounded(p.y)]).collect()
}

fn position(p: P3) -> [f64; 3] {
    [p.x, p.y, p.z].map(rounded)
}

fn direction(v: V3) -> [f64; 3] {
    [v.x, v.y, v.z].map(rounded)
}
