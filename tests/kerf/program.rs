//! The cut moves of a program, read with no more than G0 to G3 and S need.

use super::plane::{Point, arc, at};

/// One cut without a break.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// "engrave", "cut-inner" or "cut-outline", as the comments say.
    pub operation: String,
    /// What the middle of the tool follows, sheet frame.
    pub points: Vec<Point>,
}

/// All runs, and the kerf the header names.
pub fn runs(text: &str) -> (Vec<Run>, f64) {
    let told = |key: &str| text.lines().find_map(|l| l.strip_prefix(&format!("; {key}: ")));
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let kerf_mm = told("kerf").map_or(0.0, |t| number(t.trim_end_matches(" mm")));
    // "X570.000 Y0.000 turned 90": work coordinates of the sheet's origin, and its turn.
    let (ox, oy, turn) = told("sheet lies").map_or((0.0, 0.0, 0.0), |t| {
        let words: Vec<&str> = t.split(' ').collect();
        (number(&words[0][1..]), number(&words[1][1..]), number(words[3]).to_radians())
    });
    let to_sheet = |p: Point| {
        let (dx, dy, c, s) = (p.x - ox, p.y - oy, turn.cos(), turn.sin());
        at(c * dx + s * dy, c * dy - s * dx)
    };
    let burns_by_power = text.lines().any(|l| l.starts_with("M4S0") || l == "M3S0");
    let mut runs: Vec<Run> = Vec::new();
    let (mut operation, mut motion, mut power, mut cutting) = (String::new(), 0, 0.0, false);
    let mut here = at(0.0, 0.0);
    for line in text.lines() {
        if let Some(comment) = line.strip_prefix("; ") {
            if ["engrave", "cut-inner", "cut-outline"].contains(&comment) {
                operation = comment.to_owned();
                cutting = false;
            }
            continue;
        }
        let words = words(line);
        let word = |letter: char| words.iter().find(|w| w.0 == letter).map(|w| w.1);
        let g = words.iter().filter(|w| w.0 == 'G').map(|w| w.1).find(|g| *g <= 3.0);
        motion = g.map_or(motion, |g| g as i32);
        power = word('S').unwrap_or(power);
        let to = at(word('X').unwrap_or(here.x), word('Y').unwrap_or(here.y));
        let centre = (word('I').is_some() || word('J').is_some())
            .then(|| at(here.x + word('I').unwrap_or(0.0), here.y + word('J').unwrap_or(0.0)));
        if to == here && centre.is_none() {
            cutting &= motion != 0;
            continue;
        }
        let cuts = motion > 0 && (!burns_by_power || power > 0.0);
        if cuts {
            if !cutting {
                runs.push(Run { operation: operation.clone(), points: vec![to_sheet(here)] });
            }
            let run = runs.last_mut().expect("just begun");
            match centre {
                Some(centre) if motion > 1 => {
                    let angle = |p: Point| (p.y - centre.y).atan2(p.x - centre.x);
                    let full = std::f64::consts::TAU;
                    let left = (angle(to) - angle(here)).rem_euclid(full);
                    let sweep = if motion == 3 { left } else { left - full };
                    run.points.extend(arc(here, centre, sweep).into_iter().map(to_sheet));
                }
                _ => run.points.push(to_sheet(to)),
            }
        }
        cutting = cuts;
        here = to;
    }
    (runs, kerf_mm)
}

fn words(line: &str) -> Vec<(char, f64)> {
    let mut words = Vec::new();
    let mut rest = line;
    while let Some(letter) = rest.chars().next() {
        let end = rest[1..].find(|c: char| c.is_ascii_alphabetic()).map_or(rest.len(), |k| k + 1);
        words.push((letter, rest[1..end].parse().expect("a number")));
        rest = &rest[end..];
    }
    words
}
