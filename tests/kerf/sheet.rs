//! What is wanted: the paths of a sheet's SVG.

use super::plane::{Point, arc, at, foot};

/// One path, nominal.
#[derive(Debug, Clone, PartialEq)]
pub struct Nominal {
    pub class: String,
    pub piece: String,
    /// "outside", "inside", "left", "right" or "on".
    pub kerf: String,
    pub closed: bool,
    /// Sheet frame, y up; a closed path ends where it began.
    pub points: Vec<Point>,
}

impl Nominal {
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|w| w[0].to(w[1])).sum()
    }

    pub fn distance(&self, p: Point) -> f64 {
        self.points.windows(2).map(|w| foot(p, w[0], w[1]).to(p)).fold(f64::INFINITY, f64::min)
    }

    /// Even-odd.
    pub fn holds(&self, p: Point) -> bool {
        let crosses = |w: &&[Point]| {
            (w[0].y > p.y) != (w[1].y > p.y) && p.x < w[0].x + (p.y - w[0].y) / (w[1].y - w[0].y) * (w[1].x - w[0].x)
        };
        self.points.windows(2).filter(crosses).count() % 2 == 1
    }

    /// +1 when the waste lies on the left of the path, -1 on the right, 0 for a single line.
    pub fn waste_side(&self) -> f64 {
        let area: f64 = self.points.windows(2).map(|w| 0.5 * (w[0].x * w[1].y - w[1].x * w[0].y)).sum();
        match self.kerf.as_str() {
            "left" => 1.0,
            "right" => -1.0,
            "outside" => -area.signum(),
            "inside" => area.signum(),
            _ => 0.0,
        }
    }
}

/// All paths of a sheet.
pub fn nominal(svg: &str) -> Vec<Nominal> {
    let mut paths = Vec::new();
    let mut piece = String::new();
    let attribute = |line: &str, name: &str| {
        let (_, rest) = line.split_once(&format!(" {name}=\""))?;
        rest.split_once('"').map(|(value, _)| value.to_owned())
    };
    let height: f64 =
        svg.lines().find_map(|l| attribute(l, "height")).expect("a height").trim_end_matches("mm").parse().unwrap();
    for line in svg.lines() {
        if line.starts_with("<g class=\"piece\"") {
            piece = attribute(line, "data-name").expect("a name");
        }
        if !line.starts_with("<path") {
            continue;
        }
        let class = attribute(line, "class").expect("a class");
        let usual = match class.as_str() {
            "outline" => "outside",
            "hole" => "inside",
            _ => "on",
        };
        let kerf = attribute(line, "data-kerf").unwrap_or_else(|| usual.to_owned());
        let (points, closed) = curve(&attribute(line, "d").expect("data"), height);
        paths.push(Nominal { class, piece: piece.clone(), kerf, closed, points });
    }
    paths
}

/// Path data of M, L, H, V, A and Z with absolute coordinates, turned y up.
fn curve(data: &str, height: f64) -> (Vec<Point>, bool) {
    let spaced: String = data
        .chars()
        .flat_map(|c| if c.is_ascii_alphabetic() { vec![' ', c, ' '] } else { vec![if c == ',' { ' ' } else { c }] })
        .collect();
    let mut words = spaced.split_whitespace().peekable();
    let (mut points, mut closed, mut command) = (Vec::new(), false, "M".to_owned());
    while let Some(word) = words.peek() {
        if word.chars().all(|c| c.is_ascii_alphabetic()) {
            command = words.next().expect("peeked").to_owned();
            if command == "Z" || command == "z" {
                closed = true;
                let first = points[0];
                points.push(first);
            }
            continue;
        }
        let mut number = || words.next().expect("a number").parse::<f64>().expect("a number");
        match command.as_str() {
            "M" | "L" => {
                let x = number();
                points.push(at(x, height - number()));
            }
            "H" => {
                let y = points[points.len() - 1].y;
                points.push(at(number(), y));
            }
            "V" => {
                let x = points[points.len() - 1].x;
                points.push(at(x, height - number()));
            }
            "A" => {
                let radius = number();
                let (_, _, large, clockwise_up) = (number(), number(), number() == 1.0, number() == 1.0);
                let x = number();
                let to = at(x, height - number());
                let from: Point = points[points.len() - 1];
                points.extend(svg_arc(from, to, radius, large, clockwise_up));
                let last = points.len() - 1;
                points[last] = to;
            }
            other => panic!("unknown command {other}"),
        }
    }
    (points, closed)
}

/// An SVG arc between points that are y up already.
fn svg_arc(from: Point, to: Point, radius: f64, large: bool, sweep: bool) -> Vec<Point> {
    let chord = from.to(to);
    let radius = radius.max(0.5 * chord);
    let half = (0.5 * chord / radius).min(1.0).asin();
    let turn = if large { std::f64::consts::TAU - 2.0 * half } else { 2.0 * half };
    // With y down, sweep = 1 turns clockwise as seen; seen it stays clockwise, which with y up is negative.
    let turn = if sweep { -turn } else { turn };
    let height = radius * (0.5 * turn).cos() * turn.signum();
    let (ux, uy) = ((to.x - from.x) / chord, (to.y - from.y) / chord);
    let centre = at(0.5 * (from.x + to.x) - uy * height, 0.5 * (from.y + to.y) + ux * height);
    arc(from, centre, turn)
}
