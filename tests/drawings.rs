//! The drawings of a job as another program reads them: DXF and SVG by a reader of their own, held against each other.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

type Point = [f64; 2];

/// What one drawing cuts or marks: layer, corners with bulges (DXF's measure of an arc), closed or not.
#[derive(Debug, Clone)]
struct Curve {
    layer: String,
    corners: Vec<(Point, f64)>,
    closed: bool,
}

impl Curve {
    /// Length along lines and arcs, mm.
    fn length(&self) -> f64 {
        let n = self.corners.len();
        let sides = if self.closed { n } else { n - 1 };
        (0..sides)
            .map(|i| {
                let ((a, bulge), (b, _)) = (self.corners[i], self.corners[(i + 1) % n]);
                let chord = (b[0] - a[0]).hypot(b[1] - a[1]);
                let quarter = bulge.abs().atan();
                if quarter < 1e-12 { chord } else { chord * 2.0 * quarter / (2.0 * quarter).sin() }
            })
            .sum()
    }

    /// The box around lines and arcs, from points along them: the same wherever an arc was cut in two.
    fn around(&self) -> [f64; 4] {
        const STEPS: usize = 64;
        let n = self.corners.len();
        let sides = if self.closed { n } else { n - 1 };
        let mut around = [f64::MAX, f64::MAX, f64::MIN, f64::MIN];
        for i in 0..sides {
            let ((a, bulge), (b, _)) = (self.corners[i], self.corners[(i + 1) % n]);
            for k in 0..=STEPS {
                let t = k as f64 / STEPS as f64;
                let along = [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t];
                let angle = 4.0 * bulge.atan();
                let p = if angle.abs() < 1e-9 { along } else { on_arc(a, b, angle, t) };
                around = [around[0].min(p[0]), around[1].min(p[1]), around[2].max(p[0]), around[3].max(p[1])];
            }
        }
        around
    }
}

/// The point at share `t` of the arc from `a` to `b` that turns left by `angle`.
fn on_arc(a: Point, b: Point, angle: f64, t: f64) -> Point {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let radius = dx.hypot(dy) / (2.0 * (0.5 * angle).sin());
    let leaving = dy.atan2(dx) - 0.5 * angle;
    let center = [a[0] - radius * leaving.sin(), a[1] + radius * leaving.cos()];
    let at = leaving + angle * t;
    [center[0] + radius * at.sin(), center[1] - radius * at.cos()]
}

fn furbelow(folder: &Path, args: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_furbelow"))
        .args(args)
        .current_dir(folder)
        .env("FURBELOW_CONFIG_DIR", folder.join("config"))
        .output()
        .expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn make_cuboid(folder: &Path) {
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/cuboid.obj");
    let model = model.to_str().expect("plain path");
    furbelow(folder, &["make", model, "-m", "diode-400", "-p", "paper-160", "--stock", "A4", "--out", "out"]);
}

/// Reads a DXF file by the R12 reference: pairs of group code and value, sections, a layer table, entities.
fn read_dxf(text: &str) -> Vec<Curve> {
    assert!(text.is_ascii(), "R12 is plain ASCII");
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines.len().is_multiple_of(2) && lines.iter().all(|l| l.len() <= 255));
    let groups: Vec<(i32, &str)> =
        lines.chunks(2).map(|l| (l[0].trim().parse().expect("a group code"), l[1].trim())).collect();
    let mut sections: BTreeMap<&str, Vec<(i32, &str)>> = BTreeMap::new();
    let mut name = None;
    for pair in groups.windows(2) {
        match (pair[0], pair[1]) {
            ((0, "SECTION"), (2, section)) => {
                assert!(name.is_none(), "a section in a section");
                name = Some(section);
            }
            ((0, "ENDSEC"), _) => name = None,
            (group, _) => name.iter().for_each(|n| sections.entry(n).or_default().push(group)),
        }
    }
    assert!(name.is_none() && groups.last() == Some(&(0, "EOF")));
    let header = &sections["HEADER"];
    let variable = |key: &str| header.iter().position(|g| *g == (9, key)).map(|i| header[i + 1].1);
    assert_eq!((variable("$ACADVER"), variable("$INSUNITS")), (Some("AC1009"), Some("4")));
    let tables = &sections["TABLES"];
    let layer_rows = tables.split(|g| g.0 == 0).filter(|rows| rows.iter().any(|g| g.0 == 62));
    let layers: BTreeMap<&str, &str> = layer_rows
        .map(|rows| {
            let of = |code: i32| rows.iter().find(|g| g.0 == code).expect("a group").1;
            (of(2), of(62))
        })
        .collect();
    // AutoCAD's numbers for black, blue and red.
    assert_eq!(layers, BTreeMap::from([("engrave", "7"), ("cut-inner", "5"), ("cut-outline", "1")]));

    let mut curves: Vec<Curve> = Vec::new();
    let mut open_polyline = false;
    let entities = &sections["ENTITIES"];
    let starts: Vec<usize> = (0..entities.len()).filter(|i| entities[*i].0 == 0).collect();
    for (k, start) in starts.iter().enumerate() {
        let body = &entities[start + 1..starts.get(k + 1).copied().unwrap_or(entities.len())];
        let text = |code: i32| body.iter().find(|g| g.0 == code).map(|g| g.1);
        let real =
            |code: i32| text(code).unwrap_or_else(|| panic!("no group {code}")).parse::<f64>().expect("a number");
        let layer = || {
            let layer = text(8).expect("a layer").to_owned();
            assert!(layers.contains_key(layer.as_str()), "{layer} is in no table");
            layer
        };
        match entities[*start].1 {
            "LINE" => curves.push(Curve {
                layer: layer(),
                corners: vec![([real(10), real(20)], 0.0), ([real(11), real(21)], 0.0)],
                closed: false,
            }),
            "ARC" => {
                let on = |degrees: f64| {
                    let (sin, cos) = degrees.to_radians().sin_cos();
                    [real(10) + real(40) * cos, real(20) + real(40) * sin]
                };
                let sweep = (real(51) - real(50)).rem_euclid(360.0).to_radians();
                let corners = vec![(on(real(50)), (sweep / 4.0).tan()), (on(real(51)), 0.0)];
                curves.push(Curve { layer: layer(), corners, closed: false });
            }
            "POLYLINE" => {
                assert!(!open_polyline && text(66) == Some("1"), "vertices follow");
                open_polyline = true;
                curves.push(Curve { layer: layer(), corners: Vec::new(), closed: text(70) == Some("1") });
            }
            "VERTEX" => {
                assert!(open_polyline);
                let bulge = text(42).map_or(0.0, |b| b.parse().expect("a bulge"));
                curves.last_mut().expect("a polyline").corners.push(([real(10), real(20)], bulge));
            }
            "SEQEND" => open_polyline = false,
            other => panic!("no R12 reader needs to know {other}"),
        }
    }
    assert!(!open_polyline);
    curves
}

/// Reads the paths of one of our SVG files by what any SVG reader does: y down, absolute commands, colours as attributes.
fn read_svg(text: &str) -> Vec<Curve> {
    let svg = roxmltree::Document::parse(text).expect("XML");
    let root = svg.root_element();
    let size = |key: &str| root.attribute(key).unwrap().trim_end_matches("mm").parse::<f64>().unwrap();
    let view: Vec<f64> = root.attribute("viewBox").unwrap().split(' ').map(|v| v.parse().unwrap()).collect();
    assert_eq!((view[2], view[3]), (size("width"), size("height")), "a unit is a millimetre");
    assert!(svg.descendants().all(|n| n.attribute("style").is_none() && n.attribute("transform").is_none()));
    let paths = svg.descendants().filter(|n| n.has_tag_name("path"));
    paths
        .map(|path| {
            let layer = match path.attribute("stroke") {
                Some("#000000") => "engrave",
                Some("#0000FF") => "cut-inner",
                Some("#FF0000") => "cut-outline",
                other => panic!("a cutter's program knows no {other:?}"),
            };
            assert_eq!(path.attribute("fill"), Some("none"));
            let (corners, closed) = path_data(path.attribute("d").unwrap());
            assert!(layer != "cut-outline" || closed, "contours are whole");
            Curve { layer: layer.into(), corners, closed }
        })
        .collect()
}

/// Corners of path data and their bulges, y up.
fn path_data(data: &str) -> (Vec<(Point, f64)>, bool) {
    let spaced: String =
        data.chars().map(|c| if c.is_ascii_alphabetic() { format!(" {c} ") } else { c.to_string() }).collect();
    let mut words = spaced.split([' ', ',']).filter(|w| !w.is_empty()).peekable();
    let (mut corners, mut closed): (Vec<(Point, f64)>, bool) = (Vec::new(), false);
    let mut command = "M";
    while let Some(word) = words.peek() {
        if word.starts_with(|c: char| c.is_ascii_alphabetic()) {
            command = words.next().expect("peeked");
        }
        let mut number = || words.next().expect("a number").parse::<f64>().expect("a number");
        let last = corners.last().map_or([0.0; 2], |c| c.0);
        match command {
            "Z" => closed = true,
            "M" | "L" => corners.push(([number(), -number()], 0.0)),
            "H" => corners.push(([number(), last[1]], 0.0)),
            "V" => corners.push(([last[0], -number()], 0.0)),
            "A" => {
                let radius = number();
                assert_eq!(radius, number(), "circular");
                let (_, large, sweep) = (number(), number(), number());
                let to = [number(), -number()];
                let half = 0.5 * (to[0] - last[0]).hypot(to[1] - last[1]);
                let small = 2.0 * (half / radius).min(1.0).asin();
                let angle = if large > 0.5 { std::f64::consts::TAU - small } else { small };
                // Clockwise on a page whose y runs down is clockwise to the eye.
                corners.last_mut().expect("a start").1 = (angle / 4.0).tan() * if sweep > 0.5 { -1.0 } else { 1.0 };
                corners.push((to, 0.0));
            }
            other => panic!("a command we do not write: {other}"),
        }
    }
    // A closed path may name its start again.
    if closed && corners.len() > 1 {
        let (first, last) = (corners[0].0, corners[corners.len() - 1].0);
        if (first[0] - last[0]).hypot(first[1] - last[1]) < 1e-9 {
            corners.pop();
        }
    }
    (corners, closed)
}

/// Layer by layer: number of curves, length in all, and the size of the box around them.
fn amounts(curves: &[Curve]) -> BTreeMap<String, (usize, f64, f64, f64)> {
    let mut layers: BTreeMap<String, (usize, f64, [f64; 4])> = BTreeMap::new();
    for curve in curves {
        let [a, b, c, d] = curve.around();
        let (count, length, around) =
            layers.entry(curve.layer.clone()).or_insert((0, 0.0, [f64::MAX, f64::MAX, f64::MIN, f64::MIN]));
        *count += 1;
        *length += curve.length();
        *around = [around[0].min(a), around[1].min(b), around[2].max(c), around[3].max(d)];
    }
    layers.into_iter().map(|(layer, (n, length, b))| (layer, (n, length, b[2] - b[0], b[3] - b[1]))).collect()
}

#[test]
fn dxf_and_svg_hold_the_same_curves_at_the_same_size_on_the_same_layers() {
    let folder = tempfile::tempdir().unwrap();
    make_cuboid(folder.path());
    let mut compared = 0;
    for group in ["strips", "sheets"] {
        for entry in fs::read_dir(folder.path().join("out").join(group)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|e| e != "dxf") {
                continue;
            }
            let read = |ending: &str| fs::read_to_string(path.with_extension(ending)).unwrap();
            let (dxf, svg) = (amounts(&read_dxf(&read("dxf"))), amounts(&read_svg(&read("svg"))));
            assert_eq!(dxf.keys().collect::<Vec<_>>(), svg.keys().collect::<Vec<_>>(), "{}", path.display());
            assert_eq!(dxf.len(), 3);
            for (layer, (count, length, width, height)) in &dxf {
                let other = svg[layer];
                assert_eq!(*count, other.0, "{}: {layer}", path.display());
                // The SVG rounds to thousandths.
                let near = |a: f64, b: f64, mm: f64| (a - b).abs() < mm;
                assert!(near(*length, other.1, 0.002 * *count as f64 + 0.05), "{layer}: {length} and {}", other.1);
                assert!(near(*width, other.2, 0.003) && near(*height, other.3, 0.003), "{layer}: {width} x {height}");
            }
            compared += 1;
        }
    }
    assert!(compared >= 3, "{compared} pairs");
}

#[test]
fn arcs_stay_arcs_and_what_a_pen_writes_is_on_a_layer_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    make_cuboid(folder.path());
    let read = || read_dxf(&fs::read_to_string(folder.path().join("out/strips/A1.dxf")).unwrap());
    let engraved = read();
    let arcs =
        |layer: &str| engraved.iter().filter(|c| c.layer == layer && c.corners.iter().any(|k| k.1 != 0.0)).count();
    assert!(arcs("cut-inner") >= 2 && arcs("engrave") >= 2, "barbs, hooks and letters are arcs");

    let file = folder.path().join("out/design.toml");
    let design = fs::read_to_string(&file).unwrap();
    fs::write(&file, design.replacen("[mesh]", "[making]\nlabel = \"pen\"\n\n[mesh]", 1)).unwrap();
    furbelow(folder.path(), &["make", "out/design.toml"]);
    let penned = read();
    let of = |curves: &[Curve], layer: &str| curves.iter().filter(|c| c.layer == layer).count();
    assert!(of(&penned, "engrave") > 20);
    assert_eq!(of(&penned, "cut-outline"), of(&engraved, "cut-outline"));
    let svg = read_svg(&fs::read_to_string(folder.path().join("out/sheets/sheet-01.svg")).unwrap());
    assert!(of(&svg, "engrave") > 20, "the letters are in the drawing of the sheet");
    let sheets = fs::read(folder.path().join("out/assembly.pdf")).unwrap();
    assert!(
        String::from_utf8_lossy(&sheets).contains("with a pen: black in sheets"),
        "the cutting card says where they are"
    );
}
