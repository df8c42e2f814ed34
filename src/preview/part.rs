//! The picture of one folded ruffle in its outline.

use super::canvas::{Align, Canvas, Colour, Stroke, Text};
use crate::cut::Outline;
use crate::drawing::{svg_number, text_width};
use crate::geom::{Obstacles, P2, Rect, V2};
use crate::ruffle::{Role, Ruffle, Section};

/// What a part's picture shows; plane frame, mm, floor at v = 0.
#[derive(Debug, Clone)]
pub struct PartView<'a> {
    /// Name of the part.
    pub name: &'a str,
    /// The region to fill.
    pub outline: &'a Outline,
    /// The strip's topology.
    pub ruffle: &'a Ruffle,
    /// Where every node is, one for each node of the ruffle.
    pub positions: &'a [P2],
    /// Joints: where, and the number people read.
    pub joints: Vec<(P2, String)>,
    /// Lines of text under the picture: how full, how long, how heavy.
    pub caption: Vec<String>,
}

// Sizes in hundredths of the part's longer side, so that a cup and a stool look alike.
const MARGIN: f64 = 7.0;
const OUTER: f64 = 0.46;
const INNER: f64 = 0.33;
const HAIR: f64 = 0.2;
const BAND: f64 = 1.5;
const DOT: f64 = 0.75;
const JOINT_TEXT: f64 = 2.5;
const SMALLEST_TEXT: f64 = 1.2;
const TITLE: f64 = 3.2;
const CAPTION: f64 = 2.1;
const SECTION_TEXT: f64 = 1.5;
const RULER_TEXT: f64 = 1.4;
/// The floor is shown under parts that lie at most this share of their height above it; a part that rests on others would be lost in the room between.
const NEAR_FLOOR: f64 = 0.25;

/// Draws the folded ruffle in its outline: the region pale blue, outer sections a little heavier than inner ones, a band under densified sections that is the darker
/// the more often they were densified, joints as dots with their numbers beside them, the sections' numbers in little boxes, the floor where it is near, a scale bar and the caption.
/// The canvas is in the plane frame and at true size.
pub fn part_canvas(view: &PartView) -> Canvas {
    let shown = view.outline.bounds().union(Rect::around(view.positions));
    let shown = if shown.is_empty() { Rect::from_size(1.0, 1.0) } else { shown };
    let near_floor = shown.min.y <= NEAR_FLOOR * shown.height();
    let shown = if near_floor { shown.with(P2::new(shown.min.x, 0.0)) } else { shown };
    let unit = 0.01 * shown.width().max(shown.height()).max(1e-3);
    let picture = shown.grown(MARGIN * unit);
    let foot = Foot::new(view, &picture, unit);
    let mut canvas = Canvas::new(foot.area(&picture));

    canvas.region(view.outline.loops(), Some(Colour::REGION), None);
    if near_floor {
        let floor = [P2::new(picture.min.x + unit, 0.0), P2::new(picture.max.x - unit, 0.0)];
        canvas.polyline(&floor, Stroke::new(Colour::GREY, HAIR * unit));
    }
    draw_rulers(&mut canvas, &picture, unit);
    draw_density(&mut canvas, view, unit);
    draw_strip(&mut canvas, view, unit);
    let (taken, joint_mm) = draw_joints(&mut canvas, view, picture.grown(-unit), unit);
    draw_section_numbers(&mut canvas, view, taken, joint_mm.min(SECTION_TEXT * unit));
    foot.draw(&mut canvas);
    canvas
}

/// Marks u along the lower edge and v along the left one, so that a place in the picture can be told in mm.
fn draw_rulers(canvas: &mut Canvas, picture: &Rect, unit: f64) {
    let step = round_length(0.2 * picture.width().max(picture.height()));
    let stroke = Stroke::new(Colour::PALE, HAIR * unit);
    let (tick, height_mm) = (unit, RULER_TEXT * unit);
    // Not in the corner, where the two would run into each other.
    let marks = |from: f64, to: f64| {
        let numbers = ((from + MARGIN * unit) / step).ceil() as i64..=((to - MARGIN * unit) / step).floor() as i64;
        numbers.map(move |k| k as f64 * step)
    };
    for u in marks(picture.min.x, picture.max.x) {
        let low = P2::new(u, picture.min.y + tick);
        canvas.polyline(&[low, low + V2::new(0.0, tick)], stroke);
        let (at, text) = (low + V2::new(0.0, 1.4 * tick), svg_number(u));
        canvas.text(Text { at, align: Align::Middle, height_mm, colour: Colour::GREY, text: &text });
    }
    // The floor line shows where v = 0 is.
    for v in marks(picture.min.y, picture.max.y).filter(|v| *v != 0.0) {
        let left = P2::new(picture.min.x, v);
        canvas.polyline(&[left, left + V2::new(tick, 0.0)], stroke);
        let (at, text) = (left + V2::new(1.4 * tick, -0.5 * height_mm), svg_number(v));
        canvas.text(Text { at, align: Align::Left, height_mm, colour: Colour::GREY, text: &text });
    }
}

fn points(view: &PartView, section: &Section) -> Vec<P2> {
    let nodes = &view.ruffle.walk[section.first_segment..=section.end_segment];
    nodes.iter().map(|n| view.positions[n.index()]).collect()
}

/// Which of [`Colour::DENSITY`] stands for a level from 1 on.
fn shade(level: usize) -> usize {
    level.min(Colour::DENSITY.len()) - 1
}

/// Bands under densified sections, the densest last.
fn draw_density(canvas: &mut Canvas, view: &PartView, unit: f64) {
    let sections = view.ruffle.sections.iter().enumerate();
    let mut dense: Vec<(usize, &Section)> = sections.map(|(i, s)| (view.ruffle.densified.level(i), s)).collect();
    dense.retain(|(level, _)| *level > 0);
    dense.sort_by_key(|(level, _)| *level);
    for (level, section) in dense {
        canvas.polyline(&points(view, section), Stroke::new(Colour::DENSITY[shade(level)], BAND * unit));
    }
}

/// Draws inner sections first, so that the outer contour stays whole where they meet.
fn draw_strip(canvas: &mut Canvas, view: &PartView, unit: f64) {
    for (role, width) in [(Role::Inner, INNER), (Role::Densified, INNER), (Role::Outer, OUTER)] {
        for section in view.ruffle.sections.iter().filter(|s| s.role == role) {
            canvas.polyline(&points(view, section), Stroke::new(Colour::INK, width * unit));
        }
    }
}

/// Returns the boxes that dots and numbers take up, and how high the numbers are.
fn draw_joints(canvas: &mut Canvas, view: &PartView, area: Rect, unit: f64) -> (Vec<Rect>, f64) {
    let dots: Vec<P2> = view.joints.iter().map(|j| j.0).collect();
    let lines: Vec<(P2, P2)> = view.ruffle.segments().map(|(i, j)| (view.positions[i], view.positions[j])).collect();
    // Where joints crowd, dots and numbers shrink with the room between them.
    let crowd = nearest_pair(&dots).unwrap_or(f64::INFINITY);
    let height = (0.45 * crowd).clamp(SMALLEST_TEXT * unit, JOINT_TEXT * unit);
    let dot_mm = DOT * unit * height / (JOINT_TEXT * unit);
    for dot in &dots {
        canvas.disc(*dot, dot_mm, Colour::RED, None);
    }
    let widths: Vec<f64> = view.joints.iter().map(|j| text_width(&j.1, height)).collect();
    let obstacles = Obstacles { lines: &lines, dots: &dots, dot_mm, area };
    let places = obstacles.place(&widths, height, 0.3 * height);
    for ((_, text), place) in view.joints.iter().zip(&places) {
        let (at, colour) = (place.min, Colour::INK);
        canvas.text(Text { at, align: Align::Left, height_mm: height, colour, text });
    }
    (dots.iter().map(|dot| Rect { min: *dot, max: *dot }.grown(dot_mm)).chain(places).collect(), height)
}

/// The point of a polyline so far from its start, mm.
fn along(points: &[P2], mut way_mm: f64) -> P2 {
    for w in points.windows(2) {
        let long = (w[1] - w[0]).norm();
        if way_mm <= long && long > 0.0 {
            return w[0] + (w[1] - w[0]) * (way_mm / long);
        }
        way_mm -= long;
    }
    points[points.len() - 1]
}

/// Where along a section its number may stand, the best place first, as shares of its length.
const NUMBER_SHARES: [f64; 7] = [0.5, 0.4, 0.6, 0.3, 0.7, 0.22, 0.78];

/// Puts every section's number on it, off what is `taken` where there is a place. A short section gets a small one.
fn draw_section_numbers(canvas: &mut Canvas, view: &PartView, mut taken: Vec<Rect>, highest_mm: f64) {
    for (number, section) in view.ruffle.sections.iter().enumerate() {
        let points = points(view, section);
        let text = number.to_string();
        let long: f64 = points.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
        let height = (0.12 * long).clamp(0.6 * highest_mm, highest_mm);
        let half = V2::new(0.5 * text_width(&text, height), 0.5 * height);
        let place = |share: f64| {
            let at = along(&points, share * long);
            Rect { min: at - half, max: at + half }.grown(0.3 * height)
        };
        let free = |rect: &Rect| !taken.iter().any(|t| t.overlaps(rect));
        let rect = NUMBER_SHARES.map(place).into_iter().find(free).unwrap_or_else(|| place(0.5));
        canvas.frame(&rect, Some(Colour::WHITE), Some(Stroke::new(Colour::GREY, 0.07 * highest_mm)));
        let at = rect.min + V2::repeat(0.3 * height);
        canvas.text(Text { at, align: Align::Left, height_mm: height, colour: Colour::BLUE, text: &text });
        taken.push(rect);
    }
}

fn nearest_pair(points: &[P2]) -> Option<f64> {
    let pairs = points.iter().enumerate().flat_map(|(i, a)| points[..i].iter().map(move |b| (a - b).norm()));
    pairs.min_by(f64::total_cmp)
}

/// What the numbers are.
const NUMBERS: &str = "numbers at dots: joints, in boxes: sections";
/// What the bands are.
const LEGEND: [&str; 3] = ["densified once", "densified twice", "densified three times or more"];
/// Room for a sample of a band before its line.
const SWATCH: f64 = 6.0;

/// What stands under the picture: the name and its figures on the left, the scale bar on the right.
struct Foot<'a> {
    lines: Vec<Text<'a>>,
    /// What the bands mean: one line of `lines` each, from the end; an index into [`Colour::DENSITY`].
    bands: Vec<usize>,
    bar: [P2; 2],
    bar_text: String,
    unit: f64,
}

impl<'a> Foot<'a> {
    fn new(view: &'a PartView, picture: &Rect, unit: f64) -> Foot<'a> {
        let bar_mm = round_length(0.3 * picture.width());
        let levels = (0..view.ruffle.sections.len()).map(|s| view.ruffle.densified.level(s));
        let deepest = levels.max().unwrap_or(0).min(LEGEND.len());
        let bands: Vec<usize> = (0..deepest).collect();
        let words = std::iter::once((view.name, TITLE, Colour::INK))
            .chain(view.caption.iter().map(|line| (line.as_str(), CAPTION, Colour::GREY)))
            .chain(std::iter::once((NUMBERS, CAPTION, Colour::GREY)))
            .chain(bands.iter().map(|band| (LEGEND[*band], CAPTION, Colour::GREY)));
        let words: Vec<_> = words.filter(|(text, ..)| !text.is_empty()).collect();
        let indent = |k: usize| if k + bands.len() >= words.len() { SWATCH * unit } else { 0.0 };
        // A narrow part gets a page wide enough for its caption and the bar side by side.
        let caption_mm =
            words.iter().map(|(text, size, _)| text_width(text, size * unit) + SWATCH * unit).fold(0.0, f64::max);
        let gap = if words.is_empty() { 0.0 } else { 6.0 * unit };
        let inside = (picture.width() - 2.0 * MARGIN * unit).max(caption_mm + gap + bar_mm);
        let [left, right] = [-0.5, 0.5].map(|side| picture.center().x + side * inside);

        let mut y = picture.min.y;
        let mut lines = Vec::new();
        for (k, (text, size, colour)) in words.iter().copied().enumerate() {
            y -= size * unit;
            lines.push(Text {
                at: P2::new(left + indent(k), y),
                align: Align::Left,
                height_mm: size * unit,
                colour,
                text,
            });
            y -= 0.95 * CAPTION * unit;
        }
        let at = P2::new(right, picture.min.y - TITLE * unit);
        Foot {
            lines,
            bar: [at - V2::new(bar_mm, 0.0), at],
            bar_text: format!("{} mm", svg_number(bar_mm)),
            bands,
            unit,
        }
    }

    /// The page: the picture and the foot with a margin around them.
    fn area(&self, picture: &Rect) -> Rect {
        let page = self.lines.iter().fold(*picture, |page, line| page.union(line.bounds()));
        let page = page.with(self.bar[0]).with(self.bar[1]);
        let side = MARGIN * self.unit;
        let foot = self.lines.last().map_or(self.bar[0].y, |line| line.at.y).min(self.bar[0].y);
        let (left, right) = (self.lines.first().map_or(self.bar[0].x, |l| l.at.x), self.bar[1].x);
        page.with(P2::new(left - side, foot - 0.6 * side)).with(P2::new(right + side, foot))
    }

    fn draw(self, canvas: &mut Canvas) {
        let unit = self.unit;
        for line in &self.lines {
            canvas.text(*line);
        }
        let first = self.lines.len() - self.bands.len();
        for (line, band) in self.lines[first..].iter().zip(&self.bands) {
            let y = line.at.y + 0.5 * line.height_mm;
            let swatch = [-SWATCH + 0.5 * BAND, -0.3 * SWATCH].map(|x| P2::new(line.at.x + x * unit, y));
            canvas.polyline(&swatch, Stroke::new(Colour::DENSITY[*band], BAND * unit));
            canvas.polyline(&swatch, Stroke::new(Colour::INK, INNER * unit));
        }
        let [a, b] = self.bar;
        let tick = V2::new(0.0, 0.8 * unit);
        canvas.polyline(&[a + tick, a, b, b + tick], Stroke::new(Colour::GREY, 1.5 * HAIR * unit));
        let at = nalgebra::center(&a, &b) + V2::new(0.0, 1.2 * unit);
        let (height_mm, colour) = (0.9 * CAPTION * unit, Colour::GREY);
        canvas.text(Text { at, align: Align::Middle, height_mm, colour, text: &self.bar_text });
    }
}

/// The largest of 1, 2, 5, 10, 20, 50, ... mm that is no longer than `limit_mm`.
fn round_length(limit_mm: f64) -> f64 {
    let decade = 10f64.powf(limit_mm.log10().floor());
    [5.0, 2.0, 1.0].map(|step| step * decade).into_iter().find(|length| *length <= limit_mm).unwrap_or(decade)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ruffle::{Densification, Densified, Node, uniform_stack};
    use tiny_skia::Pixmap;

    /// A 60 x 40 mm box with a strip that runs along the floor, up the right side, back, and down the left side onto its start; the way
    /// back is densified.
    fn walk_around_a_box() -> (Outline, Ruffle, Vec<P2>) {
        let p = |(x, y)| P2::new(x, y);
        let corners = [(0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (0.0, 40.0)].map(p).to_vec();
        let positions = [(2.0, 2.0), (58.0, 2.0), (58.0, 30.0), (2.0, 30.0)].map(p).to_vec();
        let section = |role, k| Section { role, first_segment: k, end_segment: k + 1, pinned: false };
        let ruffle = Ruffle {
            node_count: 4,
            walk: [0, 1, 2, 3, 0].map(Node).to_vec(),
            rest_lengths: vec![56.0, 28.0, 56.0, 28.0],
            sections: vec![
                section(Role::Inner, 0),
                section(Role::Outer, 1),
                section(Role::Densified, 2),
                section(Role::Outer, 3),
            ],
            foot: [Node(0), Node(1)],
            densified: Densified {
                made: vec![Densification { first_section: 2, end_section: 4, role: Role::Outer, length_mm: 84.0 }],
                midpoints: Vec::new(),
            },
        };
        (Outline { outer: corners, holes: Vec::new() }, ruffle, positions)
    }

    fn canvas(name: &str) -> Canvas {
        let (outline, ruffle, positions) = walk_around_a_box();
        let joints = vec![(positions[0], "1".to_owned())];
        let caption = vec!["168 mm of strip".to_owned()];
        part_canvas(&PartView { name, outline: &outline, ruffle: &ruffle, positions: &positions, joints, caption })
    }

    fn colour_at(canvas: &Canvas, pixmap: &Pixmap, at: (f64, f64)) -> Colour {
        let scale = f64::from(pixmap.width()) / canvas.area.width();
        let c = pixmap
            .pixel(((at.0 - canvas.area.min.x) * scale) as u32, ((canvas.area.max.y - at.1) * scale) as u32)
            .unwrap();
        Colour(c.red(), c.green(), c.blue())
    }

    #[test]
    fn the_png_shows_region_strip_densified_sections_and_joints_where_they_are() {
        let canvas = canvas("seat");
        let pixmap = Pixmap::decode_png(&canvas.to_png(2000).unwrap()).unwrap();
        assert_eq!(pixmap.width().max(pixmap.height()), 2000);
        let at = |x, y| colour_at(&canvas, &pixmap, (x, y));
        assert_eq!(at(30.0, 15.0), Colour::REGION);
        assert_eq!(at(15.0, 2.0), Colour::INK);
        assert_eq!(at(58.0, 10.0), Colour::INK);
        // Off the section's number, on the band and on the line.
        assert_eq!(at(15.0, 30.35), Colour::DENSITY[0]);
        assert_eq!(at(15.0, 30.0), Colour::INK);
        assert_eq!(at(2.0, 2.0), Colour::RED);
        assert_eq!(at(30.0, 42.0), Colour::WHITE);
    }

    #[test]
    fn outer_sections_are_heavier_than_inner_ones() {
        let canvas = canvas("");
        let widths = |colour: Colour| -> Vec<f64> {
            let drawn = canvas.shapes.iter().filter(|s| s.fill.is_none() && s.paths[0].vertices.len() == 2);
            drawn.filter_map(|s| s.stroke).filter(|s| s.colour == colour).map(|s| s.width_mm).collect()
        };
        let ink = widths(Colour::INK);
        let bands = widths(Colour::DENSITY[0]);
        assert!(ink[0] < ink[2] && bands.iter().filter(|w| **w > ink[2]).count() >= 2, "{ink:?} {bands:?}");
    }

    #[test]
    fn a_part_high_above_the_floor_fills_its_picture() {
        let high = |by: f64| {
            let ruffle = uniform_stack(2, 20.0, 40.0, 4.0);
            let up = V2::new(0.0, by);
            let positions: Vec<P2> = ruffle.positions.iter().map(|p| p + up).collect();
            let outline = Outline { outer: positions.clone(), holes: Vec::new() };
            let (name, joints, caption) = ("A", Vec::new(), Vec::new());
            let ruffle = &ruffle.ruffle;
            part_canvas(&PartView { name, outline: &outline, ruffle, positions: &positions, joints, caption }).area
        };
        assert!((high(300.0).height() - high(0.0).height()).abs() < 1e-6);
        assert!(high(300.0).min.y > 200.0 && high(5.0).min.y < 0.0);
    }

    #[test]
    fn nothing_is_clipped_however_long_the_name() {
        for name in ["a", "the left arm of a teddy bear that has a very long name indeed"] {
            let canvas = canvas(name);
            for shape in &canvas.shapes {
                let air = shape.stroke.map_or(0.0, |s| 0.5 * s.width_mm);
                let drawn = shape.paths.iter().fold(Rect::EMPTY, |r, p| r.union(p.bounds())).grown(air);
                assert!(canvas.area.holds(&drawn, 0.0), "{drawn:?} in {:?}", canvas.area);
            }
        }
    }

    #[test]
    fn the_scale_bar_is_a_round_length() {
        for (limit, expected) in [(64.0, 50.0), (49.9, 20.0), (10.0, 10.0), (9.0, 5.0), (0.3, 0.2), (720.0, 500.0)] {
            assert!((round_length(limit) - expected).abs() < 1e-9, "{limit}");
        }
    }
}
