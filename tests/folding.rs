//! Do the exported strips fold into the exported shape? An outsider's check: it reads strips/*.svg and ruffle.json with code of its own, walks the folded curve by arc
//! length, places every flap's root and every slit in space, and measures whether they meet, on the right side, under the right number. Then it spoils files on purpose
//! and must notice.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Flap and slit may miss each other by this much, mm.
const TOLERANCE_MM: f64 = 0.05;
/// A slit lies this much more than a thickness ahead of its flap's hinge line, mm (materials practice).
const AHEAD_MM: f64 = 0.3;

type Point = [f64; 2];

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// The folded strip of one part, by distance along it.
struct Curve {
    stations: Vec<f64>,
    places: Vec<Point>,
    /// Stations at which the strip passes each joint.
    passes: BTreeMap<String, Vec<f64>>,
    /// Connectors to other parts that lie in a joint, right behind the flap's sheet.
    between: BTreeMap<String, usize>,
    thickness_mm: f64,
}

impl Curve {
    fn of(ruffle: &Value, part: &str, connectors: &[&Piece]) -> Curve {
        let part = ruffle["parts"].as_array().unwrap().iter().find(|p| p["name"] == part).expect("the part");
        let number = |v: &Value| v.as_f64().unwrap();
        let nodes: Vec<Point> =
            part["nodes"].as_array().unwrap().iter().map(|n| [number(&n[0]), number(&n[1])]).collect();
        let segments = part["segments"].as_array().unwrap();
        let mut walk = vec![segments[0][0].as_u64().unwrap() as usize];
        let mut stations = vec![0.0];
        for segment in segments {
            assert_eq!(*walk.last().unwrap() as u64, segment[0].as_u64().unwrap(), "segments follow one another");
            walk.push(segment[1].as_u64().unwrap() as usize);
            stations.push(stations.last().unwrap() + number(&segment[2]));
        }
        let mut passes = BTreeMap::new();
        for point in part["connection_points"].as_array().unwrap() {
            let node = point["node"].as_u64().unwrap() as usize;
            let at = walk.iter().zip(&stations).filter(|(n, _)| **n == node).map(|(_, s)| *s).collect();
            passes.insert(point["joint"].as_str().unwrap().to_owned(), at);
        }
        let places = walk.iter().map(|n| nodes[*n]).collect();
        let mut between = BTreeMap::new();
        for slit in connectors.iter().flat_map(|c| &c.slits) {
            *between.entry(slit.joint.clone()).or_default() += 1;
        }
        Curve { stations, places, passes, between, thickness_mm: number(&ruffle["material"]["thickness_mm"]) }
    }

    /// Where the strip is at `s`; it runs on straight beyond its ends.
    fn at(&self, s: f64) -> Point {
        let k = self.stations.partition_point(|t| *t <= s).clamp(1, self.stations.len() - 1);
        let (a, b) = (self.places[k - 1], self.places[k]);
        let t = (s - self.stations[k - 1]) / (self.stations[k] - self.stations[k - 1]);
        [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]
    }

    /// Direction of growing s, over the segments on both sides.
    fn direction(&self, s: f64) -> Point {
        let d = minus(self.at(s + 2.0), self.at(s - 2.0));
        [d[0] / norm(d), d[1] / norm(d)]
    }

    /// The station within 8 mm of `about` at which the strip is closest to `p`.
    fn closest(&self, p: Point, about: f64) -> f64 {
        let off = |s: f64| norm(minus(self.at(s), p));
        let best = |from: f64, step: f64, n: i32| {
            (0..=n).map(|i| from + f64::from(i) * step).min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap()
        };
        let rough = best(about - 8.0, 0.01, 1600);
        best(rough - 0.01, 1e-4, 200)
    }
}

/// A path of an exported drawing, corners only: x to the right, y up, mm, strip frame.
struct Cut {
    joint: String,
    corners: Vec<Point>,
    closed: bool,
}

impl Cut {
    /// Middle of a flap's root, or of a slit.
    fn middle(&self) -> Point {
        let ends = if self.closed { self.extremes() } else { [self.corners[0], *self.corners.last().unwrap()] };
        [0.5 * (ends[0][0] + ends[1][0]), 0.5 * (ends[0][1] + ends[1][1])]
    }

    fn extremes(&self) -> [Point; 2] {
        let by = |k: usize, f: fn(f64, f64) -> f64| self.corners.iter().map(|c| c[k]).reduce(f).unwrap();
        [[by(0, f64::min), by(1, f64::min)], [by(0, f64::max), by(1, f64::max)]]
    }

    /// +1 when most of a flap lies ahead of its root.
    fn way(&self) -> f64 {
        let mean = self.corners.iter().map(|c| c[0]).sum::<f64>() / self.corners.len() as f64;
        (mean - self.middle()[0]).signum()
    }
}

/// One exported piece.
struct Piece {
    name: String,
    from_mm: f64,
    to_mm: f64,
    flaps: Vec<Cut>,
    slits: Vec<Cut>,
    /// Joint and whether its triangle is solid, and where it stands.
    folds: Vec<(String, bool, f64)>,
}

/// Commands and numbers of SVG path data.
fn tokens(data: &str) -> Vec<(char, Vec<f64>)> {
    let mut out: Vec<(char, Vec<f64>)> = Vec::new();
    let mut word = String::new();
    let flush = |word: &mut String, out: &mut Vec<(char, Vec<f64>)>| {
        if !word.is_empty() {
            out.last_mut().expect("a command first").1.push(word.parse().expect("a number"));
            word.clear();
        }
    };
    for c in data.chars() {
        if c.is_ascii_alphabetic() {
            flush(&mut word, &mut out);
            out.push((c, Vec::new()));
        } else if c == ' ' || c == ',' {
            flush(&mut word, &mut out);
        } else {
            word.push(c);
        }
    }
    flush(&mut word, &mut out);
    out
}

/// Corners of absolute path data and whether it is closed.
fn corners(data: &str) -> (Vec<Point>, bool) {
    let mut points: Vec<Point> = Vec::new();
    let mut closed = false;
    for (command, n) in tokens(data) {
        let last = points.last().copied().unwrap_or_default();
        match command {
            'M' | 'L' => points.push([n[0], n[1]]),
            'H' => points.push([n[0], last[1]]),
            'V' => points.push([last[0], n[0]]),
            'A' => points.push([n[5], n[6]]),
            'Z' => closed = true,
            other => panic!("a command we do not write: {other}"),
        }
    }
    (points, closed)
}

fn read_piece(file: &Path) -> Piece {
    let text = fs::read_to_string(file).unwrap();
    let svg = roxmltree::Document::parse(&text).unwrap();
    let origin: Vec<f64> =
        svg.root_element().attribute("data-origin-mm").unwrap().split(' ').map(|v| v.parse().unwrap()).collect();
    let group = svg.descendants().find(|n| n.attribute("class") == Some("piece")).expect("a piece");
    let name = group.attribute("data-name").unwrap().to_owned();
    let mut piece = Piece { name, from_mm: 0.0, to_mm: 0.0, flaps: Vec::new(), slits: Vec::new(), folds: Vec::new() };
    let mut strokes: Vec<Cut> = Vec::new();
    for path in group.children().filter(|n| n.has_tag_name("path")) {
        let (points, closed) = corners(path.attribute("d").unwrap());
        let points = points.iter().map(|p| [p[0] - origin[0], origin[1] - p[1]]).collect();
        let cut = Cut { joint: path.attribute("data-joint").unwrap_or("").to_owned(), corners: points, closed };
        match path.attribute("class").unwrap() {
            "flap" => piece.flaps.push(cut),
            "slit" => piece.slits.push(cut),
            "label" => strokes.push(cut),
            "outline" => {
                let [low, high] = cut.extremes();
                (piece.from_mm, piece.to_mm) = (low[0], high[0]);
            }
            _ => {}
        }
    }
    // A fold mark is a triangle in one stroke; strokes inside make it solid.
    for mark in strokes.iter().filter(|s| s.corners.len() == 4 && s.corners[0] == s.corners[3]) {
        let [low, high] = mark.extremes();
        let inside = |s: &&Cut| {
            let within = |p: &Point| p[0] > low[0] && p[0] < high[0] && p[1] > low[1] && p[1] < high[1];
            s.corners.len() == 2 && s.corners.iter().all(within)
        };
        piece.folds.push((mark.joint.clone(), strokes.iter().filter(inside).count() >= 3, 0.5 * (low[0] + high[0])));
    }
    piece
}

/// Everything that is wrong with an exported job: empty when it folds.
fn problems(out: &Path) -> Vec<String> {
    let ruffle: Value = serde_json::from_slice(&fs::read(out.join("ruffle.json")).unwrap()).unwrap();
    let mut problems = Vec::new();
    let mut files: Vec<PathBuf> = fs::read_dir(out.join("strips")).unwrap().map(|f| f.unwrap().path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "svg"));
    files.sort();
    let pieces: Vec<Piece> = files.iter().map(|f| read_piece(f)).collect();
    let connectors: Vec<&Piece> = pieces.iter().filter(|p| p.name.contains('-')).collect();
    for part in ruffle["parts"].as_array().unwrap() {
        let name = part["name"].as_str().unwrap();
        let own: Vec<&Piece> =
            pieces.iter().filter(|p| p.name.trim_end_matches(|c: char| c.is_ascii_digit()) == name).collect();
        problems.extend(check(&Curve::of(&ruffle, name, &connectors), &own));
    }
    problems
}

fn check(curve: &Curve, pieces: &[&Piece]) -> Vec<String> {
    let mut problems = Vec::new();
    let flaps: Vec<&Cut> = pieces.iter().flat_map(|p| &p.flaps).collect();
    let slits: Vec<&Cut> = pieces.iter().flat_map(|p| &p.slits).collect();
    // Every flap finds a slit, every slit a flap, of the same number and at the same place.
    for (own, others, swapped) in [(&flaps, &slits, false), (&slits, &flaps, true)] {
        for cut in own {
            let error = |other: &&&Cut| if swapped { miss(curve, other, cut) } else { miss(curve, cut, other) };
            let same = others.iter().filter(|o| o.joint == cut.joint);
            let least = same.map(|o| error(&o)).fold(f64::INFINITY, f64::min);
            if least > TOLERANCE_MM {
                let what = if swapped { "slit" } else { "flap" };
                problems.push(format!("{what} {} at {:?} misses by {least:.3} mm", cut.joint, cut.middle()));
            }
        }
    }
    // Wherever the strip passes a joint, each piece there has its flaps, or slits for all of them.
    for (joint, passes) in &curve.passes {
        let count = flaps.iter().filter(|f| f.joint == *joint).count();
        for station in passes {
            for piece in pieces.iter().filter(|p| p.from_mm < *station && *station < p.to_mm) {
                let here = |cuts: &[Cut]| {
                    cuts.iter().filter(|c| c.joint == *joint && (c.middle()[0] - station).abs() < 3.0).count()
                };
                let (own_flaps, own_slits) = (here(&piece.flaps), here(&piece.slits));
                if count == 0 || own_flaps.max(own_slits) != count {
                    problems.push(format!(
                        "{} passes {joint} with {own_flaps} flaps, {own_slits} slits of {count}",
                        piece.name
                    ));
                }
            }
        }
    }
    for piece in pieces {
        for flap in &piece.flaps {
            problems.extend(wrong_side(curve, piece, flap, &slits));
        }
    }
    problems
}

/// How far a slit is from where a flap's root wants it, mm.
fn miss(curve: &Curve, flap: &Cut, slit: &Cut) -> f64 {
    let (root, middle) = (flap.middle(), slit.middle());
    let place = curve.at(root[0]);
    let points = curve.direction(root[0]).map(|d| d * flap.way());
    let pass = curve.closest(place, middle[0]);
    let lead = (middle[0] - pass) * dot(curve.direction(pass), points).signum();
    let apart = norm(minus(curve.at(pass), place));
    // The second sheet a flap goes through lies a thickness farther.
    let sheets = curve.passes.get(&flap.joint).map_or(1, |p| p.len() - 1);
    let first = 1 + curve.between.get(&flap.joint).copied().unwrap_or(0);
    let wanted = (first..first + sheets).map(|k| curve.thickness_mm * k as f64 + AHEAD_MM);
    let lead_error = wanted.map(|w| (lead - w).abs()).fold(f64::INFINITY, f64::min);
    apart.hypot(lead_error).hypot(middle[1] - root[1])
}

/// A fold mark that says the wrong way, or none where the partner is another pass of the strip.
fn wrong_side(curve: &Curve, piece: &Piece, flap: &Cut, slits: &[&Cut]) -> Option<String> {
    let root = flap.middle();
    let partner = slits.iter().find(|s| s.joint == flap.joint && (s.middle()[0] - root[0]).abs() > 3.0)?;
    let pass = curve.closest(curve.at(root[0]), partner.middle()[0]);
    let same_way = dot(curve.direction(root[0]), curve.direction(pass)).signum();
    // On which hand of the flap's sheet does the other lie, a little away from where they touch?
    let hand: f64 = [-6.0, -3.0, 3.0, 6.0]
        .iter()
        .map(|d| {
            let here = curve.at(root[0] + d);
            cross(curve.direction(root[0] + d), minus(curve.at(pass + same_way * d), here))
        })
        .sum();
    // Drawings show the side that is on the right hand.
    let toward = hand < 0.0;
    let near = |f: &&(String, bool, f64)| f.0 == flap.joint && (f.2 - root[0]).abs() < 40.0;
    let marks: Vec<&(String, bool, f64)> = piece.folds.iter().filter(near).collect();
    match marks.as_slice() {
        [] => Some(format!("no fold mark for {} on {}", flap.joint, piece.name)),
        marks if marks.iter().all(|m| m.1 != toward) => {
            Some(format!("{} folds the other way on {}", flap.joint, piece.name))
        }
        _ => None,
    }
}

/// Makes a shape in a folder of its own.
fn make(folder: &Path, args: &[&str]) -> PathBuf {
    let output = Command::new(env!("CARGO_BIN_EXE_furbelow"))
        .args(args)
        .current_dir(folder)
        .env("FURBELOW_CONFIG_DIR", folder.join("config"))
        .output()
        .expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join("out")
}

fn model(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/models/{name}.obj")).display().to_string()
}

fn paper(folder: &Path, name: &str, stock: &str) -> PathBuf {
    make(folder, &["make", &model(name), "-m", "diode-400", "-p", "paper-160", "--stock", stock, "--out", "out"])
}

/// Rewrites the first path of a class in a file: every point moved by `point`, arcs turned over when it mirrors.
fn spoil(file: &Path, class: &str, mirrors: bool, point: impl Fn(Point, &[Point]) -> Point) {
    let text = fs::read_to_string(file).unwrap();
    let path = text.find(&format!("<path class=\"{class}\"")).expect("such a path");
    let from = path + text[path..].find(" d=\"").unwrap() + 4;
    let to = from + text[from..].find('"').unwrap();
    let (all, _) = corners(&text[from..to]);
    let mut at = 0;
    let mut data = String::new();
    for (command, n) in tokens(&text[from..to]) {
        if command == 'Z' {
            data.push_str(" Z");
            continue;
        }
        let p = point(all[at], &all);
        at += 1;
        match command {
            'A' => {
                let sweep = if mirrors { 1.0 - n[4] } else { n[4] };
                data.push_str(&format!(" A{} {} 0 {} {sweep} {} {}", n[0], n[1], n[3], p[0], p[1]));
            }
            'M' => data.push_str(&format!("M{} {}", p[0], p[1])),
            _ => data.push_str(&format!(" L{} {}", p[0], p[1])),
        }
    }
    fs::write(file, format!("{}{data}{}", &text[..from], &text[to..])).unwrap();
}

#[test]
fn teddy_and_stool_fold_up_whole_and_in_pieces() {
    for (name, stock) in [("teddy", "A3"), ("stool", "A4")] {
        let folder = tempfile::tempdir().unwrap();
        let out = paper(folder.path(), name, stock);
        assert_eq!(problems(&out), Vec::<String>::new(), "{name}");
        let report: Value = serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap();
        assert!(report["pieces"].as_array().unwrap().len() > 1, "{name} is spliced");
        assert!(report["totals"]["max_mating_error_mm"].as_f64().unwrap() <= TOLERANCE_MM);
    }
}

#[test]
fn laps_fold_up_too() {
    let folder = tempfile::tempdir().unwrap();
    let out = paper(folder.path(), "cuboid", "A4");
    let design = fs::read_to_string(out.join("design.toml")).unwrap();
    let lapped = design.replacen("[mesh]", "[making]\nsplice = \"lap\"\n\n[mesh]", 1);
    fs::write(out.join("design.toml"), lapped).unwrap();
    make(folder.path(), &["make", "out/design.toml"]);
    assert_eq!(problems(&out), Vec::<String>::new());
    let joints = fs::read_to_string(out.join("ruffle.json")).unwrap().matches("\"joint\"").count();
    let text = fs::read_to_string(out.join("strips/A1.svg")).unwrap();
    assert!(text.contains(&format!("data-joint=\"A{}\"", joints + 1)), "the lap has joints of its own");
}

#[test]
fn tied_parts_fold_up_with_a_connector_between_the_sheets_of_each_joint() {
    let folder = tempfile::tempdir().unwrap();
    let design = format!(
        "schema = 1\nmachine = \"diode-400\"\nmaterial = \"paper-160\"\n\n[mesh]\nfile = '{}'\n\n[[split]]\norigin_mm = [0, 50, 0]\nnormal = [0, 1, 0]\ninto = [\"A\", \"B\"]\n\n[[part]]\nname = \"A\"\n\n[[part]]\nname = \"B\"\n",
        model("cuboid")
    );
    fs::write(folder.path().join("halves.toml"), design).unwrap();
    let out = make(folder.path(), &["make", "halves.toml", "--out", "out"]);
    assert_eq!(problems(&out), Vec::<String>::new());
    let report: Value = serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap();
    let connectors = report["connectors"].as_array().unwrap();
    assert!(!connectors.is_empty());
    // Taken away, the slits of the joints it lay in are too far ahead by its thickness.
    let piece = connectors[0]["piece"].as_str().unwrap();
    fs::remove_file(out.join(format!("strips/{piece}.svg"))).unwrap();
    assert!(!problems(&out).is_empty());
}

#[test]
fn spoilt_files_are_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let out = paper(folder.path(), "cuboid", "A4");
    let file = out.join("strips/A1.svg");
    let good = fs::read_to_string(&file).unwrap();
    let noticed = |what: &str| {
        assert!(!problems(&out).is_empty(), "{what} is not noticed");
        fs::write(&file, &good).unwrap();
        assert!(problems(&out).is_empty(), "after {what}");
    };
    for class in ["flap", "slit"] {
        spoil(&file, class, false, |p, _| [p[0] + 0.1, p[1]]);
        noticed(&format!("a {class} moved 0.1 mm along"));
        spoil(&file, class, false, |p, _| [p[0], p[1] - 0.1]);
        noticed(&format!("a {class} moved 0.1 mm across"));
    }
    spoil(&file, "flap", true, |p, all| [2.0 * all[0][0] - p[0], p[1]]);
    noticed("a flap mirrored about its hinge");
    // The first flap's number swapped with another joint's.
    let at = good.find("<path class=\"flap\"").unwrap();
    let number = good[at..].split('"').nth(3).unwrap().to_owned();
    let other = if number == "A2" { "A3" } else { "A2" };
    let swapped = format!(
        "{}{}",
        &good[..at],
        good[at..].replacen(&format!("data-joint=\"{number}\""), &format!("data-joint=\"{other}\""), 1)
    );
    fs::write(&file, swapped).unwrap();
    noticed("a flap with another joint's number");
    // A flap that folds away, marked as one that folds toward the reader.
    let [hollow, solid] = [false, true].map(|solid| {
        let name = read_piece(&file).folds.iter().find(|f| f.1 == solid).map(|f| f.0.clone());
        name.unwrap_or_default()
    });
    let exchanged = good.lines().map(|line| {
        let of = |joint: &str| line.contains("class=\"label\"") && line.contains(&format!("data-joint=\"{joint}\""));
        match (of(&hollow), of(&solid)) {
            (true, _) => line.replacen(&hollow, &solid, 1),
            (_, true) => line.replacen(&solid, &hollow, 1),
            _ => line.to_owned(),
        }
    });
    fs::write(&file, exchanged.map(|l| l + "\n").collect::<String>()).unwrap();
    noticed("fold marks of two joints exchanged");
    // The rest of the file as it was, but one slit gone.
    let at = good.find("<path class=\"slit\"").unwrap();
    let end = at + good[at..].find('\n').unwrap() + 1;
    fs::write(&file, format!("{}{}", &good[..at], &good[end..])).unwrap();
    noticed("a slit left out");
}
