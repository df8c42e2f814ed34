//! Writes drawings as DXF, release 12: the oldest and the one every cutter's program reads.
//!
//! Plain ASCII, mm at true size, y up, one layer for each operation with its colour, arcs kept as arcs. Release 12 knows no unit;
//! `$INSUNITS` and `$MEASUREMENT` come from later releases, whose readers heed them and which older readers skip.
//! (Autodesk, DXF Reference R12; group codes: 10/20/30 point, 40 radius, 42 bulge, 50/51 angles in degrees, 62 colour, 70 flags.)

use super::path_data::number;
use super::{Drawing, Operation};
use crate::geom::{P2, Path, Rect, Segment};
use std::fmt::{Display, Write};

/// All drawings in one DXF file, in the frame they are in. A single line or arc becomes LINE or ARC, everything else a POLYLINE whose
/// vertices carry bulges. Engraving comes first, then inner cuts, then outlines.
pub fn dxf(drawings: &[Drawing]) -> String {
    let bounds = drawings.iter().fold(Rect::EMPTY, |r, d| r.union(d.bounds()));
    let bounds = if bounds.is_empty() { Rect::from_size(0.0, 0.0) } else { bounds };
    let mut out = Groups::default();
    out.section("HEADER");
    out.put(9, "$ACADVER").put(1, "AC1009");
    out.put(9, "$INSUNITS").put(70, 4);
    out.put(9, "$MEASUREMENT").put(70, 1);
    out.put(9, "$EXTMIN").point(bounds.min);
    out.put(9, "$EXTMAX").point(bounds.max);
    out.put(0, "ENDSEC");

    out.section("TABLES");
    out.put(0, "TABLE").put(2, "LTYPE").put(70, 1);
    out.put(0, "LTYPE").put(2, "CONTINUOUS").put(70, 64).put(3, "Solid line").put(72, 65).put(73, 0).real(40, 0.0);
    out.put(0, "ENDTAB");
    out.put(0, "TABLE").put(2, "LAYER").put(70, Operation::ALL.len());
    for operation in Operation::ALL {
        out.put(0, "LAYER").put(2, operation.id()).put(70, 64).put(62, colour_index(operation)).put(6, "CONTINUOUS");
    }
    out.put(0, "ENDTAB").put(0, "ENDSEC");

    out.section("ENTITIES");
    for operation in Operation::ALL {
        for drawn in drawings.iter().flat_map(|d| &d.paths).filter(|p| p.role.operation() == operation) {
            out.path(operation.id(), &drawn.path);
        }
    }
    out.put(0, "ENDSEC").put(0, "EOF");
    out.text
}

/// AutoCAD's colour numbers: 1 red, 5 blue, 7 black (white on a dark screen).
fn colour_index(operation: Operation) -> u8 {
    match operation {
        Operation::Engrave => 7,
        Operation::CutInner => 5,
        Operation::CutOutline => 1,
    }
}

/// A DXF file under construction: pairs of a group code and a value, a line each.
#[derive(Default)]
struct Groups {
    text: String,
}

impl Groups {
    fn put(&mut self, code: u16, value: impl Display) -> &mut Groups {
        let _ = writeln!(self.text, "{code:>3}\n{value}");
        self
    }

    fn real(&mut self, code: u16, value: f64) -> &mut Groups {
        // Nine decimals: a bulge is multiplied by the chord, so its digits count for more than a coordinate's.
        let digits = number(value, 9);
        let point = if digits.contains('.') { "" } else { ".0" };
        self.put(code, format_args!("{digits}{point}"))
    }

    fn point(&mut self, p: P2) -> &mut Groups {
        self.real(10, p.x).real(20, p.y).real(30, 0.0)
    }

    fn section(&mut self, name: &str) {
        self.put(0, "SECTION").put(2, name);
    }

    fn path(&mut self, layer: &str, path: &Path) {
        let mut segments = path.segments();
        match (segments.next(), segments.next()) {
            (None, _) => {}
            (Some(Segment::Line { from, to }), None) => {
                self.put(0, "LINE").put(8, layer).point(from).real(11, to.x).real(21, to.y).real(31, 0.0);
            }
            (Some(Segment::Arc { from, to, center, radius, sweep_rad }), None) => {
                // A DXF arc always runs counter-clockwise.
                let (start, end) = if sweep_rad > 0.0 { (from, to) } else { (to, from) };
                let angle = |p: P2| (p.y - center.y).atan2(p.x - center.x).to_degrees().rem_euclid(360.0);
                self.put(0, "ARC").put(8, layer).point(center).real(40, radius);
                self.real(50, angle(start)).real(51, angle(end));
            }
            _ => self.polyline(layer, path),
        }
    }

    fn polyline(&mut self, layer: &str, path: &Path) {
        self.put(0, "POLYLINE").put(8, layer).put(66, 1).point(P2::origin()).put(70, u8::from(path.closed));
        let last = path.vertices.len() - 1;
        for (i, vertex) in path.vertices.iter().enumerate() {
            self.put(0, "VERTEX").put(8, layer).point(vertex.point);
            // The last bulge of an open path leads nowhere, yet some readers would draw it.
            if vertex.bulge != 0.0 && (path.closed || i < last) {
                self.real(42, vertex.bulge);
            }
        }
        self.put(0, "SEQEND").put(8, layer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{DrawnPath, Role};
    use crate::geom::{PathVertex, V2};

    /// The entities of a DXF file: layer and curve. Only what this room writes is understood; anything else fails the test.
    fn read(text: &str) -> Vec<(String, Path)> {
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len() % 2, 0);
        let groups: Vec<(u16, &str)> = lines.chunks(2).map(|l| (l[0].trim().parse().unwrap(), l[1])).collect();
        let begin = groups.iter().position(|g| *g == (2, "ENTITIES")).unwrap() + 1;
        let mut found: Vec<(String, Path)> = Vec::new();
        let entities = groups[begin..].split(|g| g.0 == 0).skip(1);
        let names = groups[begin..].iter().filter(|g| g.0 == 0).map(|g| g.1);
        for (name, body) in names.zip(entities) {
            let text = |code| body.iter().find(|g| g.0 == code).map(|g| g.1);
            let real = |code| text(code).unwrap().parse::<f64>().unwrap();
            let layer = text(8).unwrap_or_default().to_owned();
            match name {
                "LINE" => {
                    let ends = [P2::new(real(10), real(20)), P2::new(real(11), real(21))];
                    found.push((layer, Path::open(ends)));
                }
                "ARC" => {
                    let on = |deg: f64| {
                        let (sin, cos) = deg.to_radians().sin_cos();
                        P2::new(real(10), real(20)) + V2::new(cos, sin) * real(40)
                    };
                    let bulge = (((real(51) - real(50)).rem_euclid(360.0)).to_radians() / 4.0).tan();
                    let vertices =
                        vec![PathVertex { point: on(real(50)), bulge }, PathVertex { point: on(real(51)), bulge: 0.0 }];
                    found.push((layer, Path { vertices, closed: false }));
                }
                "POLYLINE" => {
                    found.push((layer, Path { vertices: Vec::new(), closed: text(70) == Some("1") }));
                }
                "VERTEX" => {
                    let bulge = text(42).map_or(0.0, |b| b.parse().unwrap());
                    let vertex = PathVertex { point: P2::new(real(10), real(20)), bulge };
                    found.last_mut().unwrap().1.vertices.push(vertex);
                }
                "SEQEND" | "ENDSEC" | "EOF" => {}
                other => panic!("unexpected {other}"),
            }
        }
        found
    }

    fn drawn(path: Path, role: Role) -> DrawnPath {
        DrawnPath { path, role, kerf: role.usual_kerf(), joint: None }
    }

    #[test]
    fn what_is_written_comes_back_layer_by_layer_at_true_size() {
        let p = |x, y| P2::new(x, y);
        let arc = |bulge| Path {
            vertices: vec![PathVertex { point: p(10.0, 0.0), bulge }, PathVertex { point: p(0.0, 10.0), bulge: 0.0 }],
            closed: false,
        };
        let ring = Path::circle(p(50.0, 20.0), 1.6);
        let mut outline = Path::closed([p(0.0, 0.0), p(420.123456, 0.0), p(420.0, 30.0)]);
        outline.vertices[1].bulge = -0.3;
        let paths = vec![
            drawn(outline.clone(), Role::Outline),
            drawn(ring.clone(), Role::Hole),
            drawn(arc(0.4), Role::Flap),
            drawn(arc(-2.0), Role::Flap),
            drawn(Path::open([p(1.0, 1.0), p(1.0, 4.0)]), Role::Mark),
        ];
        let read = read(&dxf(&[Drawing { name: "A1".into(), paths }]));
        let layers: Vec<&str> = read.iter().map(|r| r.0.as_str()).collect();
        assert_eq!(layers, ["engrave", "cut-inner", "cut-inner", "cut-inner", "cut-outline"]);
        let close = |a: &Path, b: &Path| {
            assert_eq!((a.closed, a.vertices.len()), (b.closed, b.vertices.len()));
            for (v, w) in a.vertices.iter().zip(&b.vertices) {
                assert!((v.point - w.point).norm() < 1e-6 && (v.bulge - w.bulge).abs() < 1e-6, "{v:?} {w:?}");
            }
        };
        close(&read[0].1, &Path::open([p(1.0, 1.0), p(1.0, 4.0)]));
        close(&read[1].1, &ring);
        close(&read[2].1, &arc(0.4));
        close(&read[3].1, &arc(-2.0).reversed());
        close(&read[4].1, &outline);
    }

    #[test]
    fn the_header_says_millimetres_and_layers_have_their_colours() {
        let text = dxf(&[]);
        assert!(text.starts_with("  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\nAC1009\n"));
        assert!(text.contains("$INSUNITS\n 70\n4\n") && text.ends_with("  0\nEOF\n"));
        for (layer, colour) in [("engrave", 7), ("cut-inner", 5), ("cut-outline", 1)] {
            assert!(text.contains(&format!("  2\n{layer}\n 70\n64\n 62\n{colour}\n")), "{layer}");
        }
    }

    #[test]
    fn an_open_polyline_never_carries_a_bulge_on_its_last_vertex() {
        let v = |x: f64| PathVertex { point: P2::new(x, 0.0), bulge: 0.5 };
        let path = Path { vertices: vec![v(0.0), v(1.0), v(3.0)], closed: false };
        let text = dxf(&[Drawing { name: String::new(), paths: vec![drawn(path, Role::Flap)] }]);
        assert_eq!(text.matches("\n 42\n").count(), 2);
    }
}
