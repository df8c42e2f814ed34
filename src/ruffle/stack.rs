//! The default stack of loops (paper section 3.1, figures 6 and 10), drawn into an outline.
//!
//! A stack is a ladder of rungs, bottom to top. The strip runs along rung 0, and then for each layer: right loop up to the next rung, diagonal
//! back down to the left, left loop up, straight along the next rung.
//!
//! ```text
//!      L1 ______________ R1
//!       /          __---  \        rung 0: L0 -> R0
//!      (      __---        )       right loop R0 -> R1, diagonal R1 -> L0,
//!       \__---____________/        left loop L0 -> L1, rung 1: L1 -> R1
//!      L0                R0
//! ```

use super::{Node, Role, Ruffle, Section};
use crate::cut::Outline;
use crate::geom::{P2, V2};
use lyon::geom::{CubicBezierSegment, point};

/// How a stack is drawn into an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StackSettings {
    /// Number of layers; `None` chooses it from the outline.
    pub layers: Option<usize>,
    /// Layer height over the outline's width at that height. 0.35 is the ratio at which neither loops collapse nor corners stay empty
    /// (measured over ten outlines: square, circle, triangle, L, hourglass and the like).
    pub aspect: f64,
    /// Thinnest layer, mm.
    pub min_layer_mm: f64,
    /// Thickest layer, mm.
    pub max_layer_mm: f64,
    /// Longest segment, mm. Sections are divided evenly, into at least [`MIN_SEGMENTS`].
    pub segment_mm: f64,
}

impl Default for StackSettings {
    fn default() -> Self {
        StackSettings { layers: None, aspect: 0.35, min_layer_mm: 12.0, max_layer_mm: 45.0, segment_mm: 3.0 }
    }
}

/// A loop needs this many segments to bend smoothly through half a turn.
pub const MIN_SEGMENTS: usize = 10;

/// Shortest rung, mm: a flap's neck with room at both sides.
const MIN_RUNG_MM: f64 = 10.0;
/// How far a rung's ends draw back from the outline, in layer heights: the room its loops bulge into.
const LOOP_REACH: f64 = 0.4;
/// Narrower than this, in mm, an outline holds no layer.
const MIN_CHORD_MM: f64 = 2.0 * MIN_RUNG_MM;
/// Step of the scan over heights, mm.
const SCAN_MM: f64 = 0.5;

/// Why no stack could be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StackError {
    /// The outline is too small anywhere.
    #[error(
        "the outline, {width_mm:.1} x {height_mm:.1} mm, has no place for a layer {min_layer_mm:.0} mm high and {min_chord_mm:.0} mm wide; make the shape larger (--height-mm)"
    )]
    TooSmall {
        /// Width of the outline.
        width_mm: f64,
        /// Height of the outline.
        height_mm: f64,
        /// Least layer height.
        min_layer_mm: f64,
        /// Least width.
        min_chord_mm: f64,
    },
    /// More layers than fit.
    #[error(
        "{layers} layers in {height_mm:.1} mm would be {layer_mm:.1} mm thin; below {min_layer_mm:.0} mm a loop creases. At most {most} fit"
    )]
    TooManyLayers {
        /// Asked for.
        layers: usize,
        /// Usable height.
        height_mm: f64,
        /// Resulting layer height.
        layer_mm: f64,
        /// Least layer height.
        min_layer_mm: f64,
        /// Largest count that works.
        most: usize,
    },
}

/// A ruffle and the drawing of it that a solver may start from.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Topology and rest lengths.
    pub ruffle: Ruffle,
    /// Position of every node, plane frame, mm.
    pub positions: Vec<P2>,
}

/// One rung of the ladder, plane frame, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rung {
    left: P2,
    right: P2,
    /// How far the loops above this rung reach beyond its ends, mm: left, right.
    reach: [f64; 2],
}

/// Draws a stack of vertical layers into `outline`.
pub fn draw_stack(outline: &Outline, settings: &StackSettings) -> Result<Drawn, StackError> {
    let slabs = slabs(outline, settings)?;
    Ok(thread(&rungs(&slabs), settings.segment_mm))
}

/// The part of the outline that one layer fills.
#[derive(Debug, Clone, Copy)]
struct Slab {
    bottom: f64,
    top: f64,
    left: f64,
    right: f64,
}

/// Widths of the outline over height: one chord per scan line, following the widest first and then whatever overlaps it most.
fn chords(outline: &Outline) -> Vec<(f64, f64, f64)> {
    let bounds = outline.bounds();
    let lines = ((bounds.height() / SCAN_MM) as usize).max(1);
    let mut chords: Vec<(f64, f64, f64)> = Vec::new();
    let overlap = |a: (f64, f64), b: (f64, f64)| a.1.min(b.1) - a.0.max(b.0);
    for i in 0..lines {
        let v = bounds.min.y + (i as f64 + 0.5) * bounds.height() / lines as f64;
        let previous = chords.last().map(|(_, l, r)| (*l, *r));
        let best = outline.chords(v).into_iter().max_by(|a, b| {
            let score = |c: (f64, f64)| previous.map_or(c.1 - c.0, |p| overlap(c, p));
            score(*a).total_cmp(&score(*b))
        });
        match best {
            Some((l, r)) if previous.is_none_or(|p| overlap(p, (l, r)) > 0.0) => chords.push((v, l, r)),
            _ => {}
        }
    }
    let wide_enough = |c: &(f64, f64, f64)| c.2 - c.1 >= MIN_CHORD_MM;
    let Some(from) = chords.iter().position(wide_enough) else { return Vec::new() };
    let to = chords.iter().rposition(wide_enough).map_or(from, |i| i + 1);
    // Below the first wide chord the foot still stands on the floor, so the lowest slab reaches down to it.
    chords[..from].iter_mut().for_each(|c| *c = (c.0, f64::NAN, f64::NAN));
    chords.truncate(to);
    chords
}

/// Cuts the outline into layers whose height follows its width.
fn slabs(outline: &Outline, settings: &StackSettings) -> Result<Vec<Slab>, StackError> {
    let chords = chords(outline);
    let too_small = || StackError::TooSmall {
        width_mm: outline.bounds().width(),
        height_mm: outline.bounds().height(),
        min_layer_mm: settings.min_layer_mm,
        min_chord_mm: MIN_CHORD_MM,
    };
    let (Some(first), Some(last)) = (chords.first(), chords.last()) else { return Err(too_small()) };
    let step = outline.bounds().height() / ((outline.bounds().height() / SCAN_MM) as usize).max(1) as f64;
    let (bottom, top) = (first.0 - step / 2.0, last.0 + step / 2.0);
    if top - bottom < settings.min_layer_mm {
        return Err(too_small());
    }
    let ideal = |c: &(f64, f64, f64)| {
        let width = if c.1.is_nan() { MIN_CHORD_MM } else { c.2 - c.1 };
        (settings.aspect * width).clamp(settings.min_layer_mm, settings.max_layer_mm)
    };
    let density: Vec<f64> = chords.iter().map(|c| step / ideal(c)).collect();
    let total: f64 = density.iter().sum();
    let most = (((top - bottom) / settings.min_layer_mm) as usize).max(1);
    let n = match settings.layers {
        None => (total.round() as usize).clamp(1, most),
        Some(layers) if layers >= 1 && layers <= most => layers,
        Some(layers) => {
            return Err(StackError::TooManyLayers {
                layers,
                height_mm: top - bottom,
                layer_mm: (top - bottom) / layers.max(1) as f64,
                min_layer_mm: settings.min_layer_mm,
                most,
            });
        }
    };

    let mut levels = vec![bottom];
    let mut sum = 0.0;
    for (chord, d) in chords.iter().zip(&density) {
        while levels.len() < n && sum + d >= total * levels.len() as f64 / n as f64 {
            let part = (total * levels.len() as f64 / n as f64 - sum) / d;
            levels.push(chord.0 - step / 2.0 + part * step);
        }
        sum += d;
    }
    levels.push(top);

    let slab = |(bottom, top): (f64, f64)| {
        let inside = || chords.iter().filter(|c| c.0 > bottom && c.0 < top && !c.1.is_nan());
        let quantile = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 4).copied()
        };
        // The conservative quarter of the chord ends: loops touch the outline where it is narrow and do not pierce it.
        let right = quantile(inside().map(|c| c.2).collect())?;
        let left = -quantile(inside().map(|c| -c.1).collect())?;
        Some(Slab { bottom, top, left, right })
    };
    levels.windows(2).map(|w| slab((w[0], w[1])).ok_or_else(too_small)).collect()
}

/// Rungs between slabs, drawn back from the outline so that the loops have room.
fn rungs(slabs: &[Slab]) -> Vec<Rung> {
    let draw_back = |s: &Slab| LOOP_REACH * (s.top - s.bottom).min(0.6 * (s.right - s.left));
    let n = slabs.len();
    let mut rungs: Vec<Rung> = (0..=n)
        .map(|i| {
            let below = &slabs[i.saturating_sub(1)];
            let above = &slabs[i.min(n - 1)];
            let left = (below.left + draw_back(below)).max(above.left + draw_back(above));
            let right = (below.right - draw_back(below)).min(above.right - draw_back(above));
            let middle = 0.5 * (below.left.max(above.left) + below.right.min(above.right));
            let level = if i == n { slabs[n - 1].top } else { slabs[i].bottom };
            let (left, right) = if right - left >= MIN_RUNG_MM {
                (left, right)
            } else {
                (middle - 0.5 * MIN_RUNG_MM, middle + 0.5 * MIN_RUNG_MM)
            };
            Rung { left: P2::new(left, level), right: P2::new(right, level), reach: [0.0; 2] }
        })
        .collect();
    for (i, slab) in slabs.iter().enumerate() {
        let least = 0.25 * (slab.top - slab.bottom);
        let (low, high) = (rungs[i], rungs[i + 1]);
        rungs[i].reach = [
            (0.5 * (low.left.x + high.left.x) - slab.left).max(least),
            (slab.right - 0.5 * (low.right.x + high.right.x)).max(least),
        ];
    }
    rungs
}

/// Threads the strip through the ladder.
fn thread(rungs: &[Rung], segment_mm: f64) -> Drawn {
    let mut weaver = Weaver { segment_mm, ..Weaver::default() };
    let right = V2::new(1.0, 0.0);
    let rung = |r: &Rung| Curve::line(r.left, r.right);
    let mut left_node = weaver.start(rungs[0].left);
    let mut right_node = weaver.section(&rung(&rungs[0]), Role::Inner, None);
    let foot = [left_node, right_node];
    let last = rungs.len() - 2;
    for (i, pair) in rungs.windows(2).enumerate() {
        let (low, high) = (&pair[0], &pair[1]);
        let next_right = weaver.section(&Curve::arc(low.right, high.right, right, low.reach[1]), Role::Outer, None);
        weaver.section(&Curve::line(high.right, low.left), Role::Inner, Some(left_node));
        left_node = weaver.section(&Curve::arc(low.left, high.left, -right, low.reach[0]), Role::Outer, None);
        let role = if i == last { Role::Outer } else { Role::Inner };
        right_node = weaver.section(&rung(high), role, Some(next_right));
    }
    debug_assert_eq!(right_node, weaver.walk[weaver.walk.len() - 1]);
    let ruffle = Ruffle {
        node_count: weaver.positions.len(),
        walk: weaver.walk,
        rest_lengths: weaver.rest_lengths,
        sections: weaver.sections,
        foot,
    };
    Drawn { ruffle, positions: weaver.positions }
}

/// A section as drawn.
struct Curve(CubicBezierSegment<f64>);

impl Curve {
    fn new(from: P2, ctrl1: P2, ctrl2: P2, to: P2) -> Curve {
        let p = |q: P2| point(q.x, q.y);
        Curve(CubicBezierSegment { from: p(from), ctrl1: p(ctrl1), ctrl2: p(ctrl2), to: p(to) })
    }

    fn line(from: P2, to: P2) -> Curve {
        Curve::new(from, from + (to - from) / 3.0, to - (to - from) / 3.0, to)
    }

    /// A loop from `from` to `to` that leaves and arrives along `out` and reaches `reach` beyond the middle of its ends. A cubic reaches
    /// three quarters of its handles; unequal ends get handles that bring both to the same extent.
    fn arc(from: P2, to: P2, out: V2, reach: f64) -> Curve {
        let lead = (to - from).dot(&out);
        let least = reach / 4.0 + 1.0;
        let handle = |r: f64| 4.0 / 3.0 * r.max(least);
        Curve::new(from, from + out * handle(reach + lead / 2.0), to + out * handle(reach - lead / 2.0), to)
    }

    /// Points that divide the curve evenly by length, ends included, and its length.
    fn divide(&self, segment_mm: f64) -> (Vec<P2>, f64) {
        const FINE: usize = 512;
        let fine: Vec<P2> = (0..=FINE)
            .map(|i| {
                let p = self.0.sample(i as f64 / FINE as f64);
                P2::new(p.x, p.y)
            })
            .collect();
        let mut along = vec![0.0];
        for w in fine.windows(2) {
            along.push(along[along.len() - 1] + (w[1] - w[0]).norm());
        }
        let length = along[FINE];
        let n = ((length / segment_mm).ceil() as usize).max(MIN_SEGMENTS);
        let mut k = 0;
        let points = (0..=n)
            .map(|i| {
                let s = length * i as f64 / n as f64;
                while k + 1 < FINE && along[k + 1] < s {
                    k += 1;
                }
                let t = ((s - along[k]) / (along[k + 1] - along[k])).clamp(0.0, 1.0);
                fine[k] + (fine[k + 1] - fine[k]) * t
            })
            .collect();
        (points, length)
    }
}

/// Collects sections into a ruffle.
#[derive(Default)]
struct Weaver {
    segment_mm: f64,
    positions: Vec<P2>,
    walk: Vec<Node>,
    rest_lengths: Vec<f64>,
    sections: Vec<Section>,
}

impl Weaver {
    fn new_node(&mut self, at: P2) -> Node {
        self.positions.push(at);
        Node(self.positions.len() as u32 - 1)
    }

    fn start(&mut self, at: P2) -> Node {
        let node = self.new_node(at);
        self.walk.push(node);
        node
    }

    /// Adds a section that ends on `end`, or on a new node; returns that node.
    fn section(&mut self, curve: &Curve, role: Role, end: Option<Node>) -> Node {
        let (points, length) = curve.divide(self.segment_mm);
        let n = points.len() - 1;
        for p in &points[1..n] {
            let node = self.new_node(*p);
            self.walk.push(node);
        }
        let end = end.unwrap_or_else(|| self.new_node(points[n]));
        self.walk.push(end);
        let first_segment = self.rest_lengths.len();
        self.rest_lengths.extend(std::iter::repeat_n(length / n as f64, n));
        self.sections.push(Section { role, first_segment, end_segment: self.rest_lengths.len() });
        end
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn polygon(points: &[(f64, f64)]) -> Outline {
        Outline { outer: points.iter().map(|(x, y)| P2::new(*x, *y)).collect(), holes: Vec::new() }
    }

    fn rectangle(width: f64, height: f64) -> Outline {
        polygon(&[(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)])
    }

    #[test]
    fn a_stack_of_n_layers_has_4n_plus_1_sections_and_2n_connection_points() {
        for layers in 1..=5 {
            let settings = StackSettings { layers: Some(layers), ..StackSettings::default() };
            let drawn = draw_stack(&rectangle(100.0, 100.0), &settings).unwrap();
            drawn.ruffle.check().unwrap();
            assert_eq!(drawn.ruffle.sections.len(), 4 * layers + 1);
            assert_eq!(drawn.ruffle.connection_points().len(), 2 * layers);
        }
    }

    #[test]
    fn the_drawing_has_the_rest_lengths_to_within_its_chords() {
        let drawn = draw_stack(&rectangle(100.0, 100.0), &StackSettings::default()).unwrap();
        for (k, (i, j)) in drawn.ruffle.segments().enumerate() {
            let length = (drawn.positions[j] - drawn.positions[i]).norm();
            let rest = drawn.ruffle.rest_lengths[k];
            assert!((length / rest - 1.0).abs() < 0.02, "segment {k}: {length} against {rest}");
        }
    }

    #[test]
    fn the_first_rung_lies_on_the_floor_and_loops_touch_the_sides() {
        let drawn = draw_stack(&rectangle(100.0, 100.0), &StackSettings::default()).unwrap();
        let bounds = crate::geom::Rect::around(&drawn.positions);
        assert!(bounds.min.y.abs() < 1e-9 && (bounds.max.y - 100.0).abs() < 1e-9);
        assert!(bounds.min.x.abs() < 1.5 && (bounds.max.x - 100.0).abs() < 1.5, "{bounds:?}");
    }

    #[test]
    fn layers_are_thinner_where_the_outline_is_narrower() {
        let drawn =
            draw_stack(&polygon(&[(0.0, 0.0), (111.0, 0.0), (55.5, 100.0)]), &StackSettings::default()).unwrap();
        let ends: Vec<f64> =
            drawn.ruffle.connection_points().iter().map(|c| drawn.positions[c.node.index()].y).collect();
        let bottom = ends[1] - ends[0];
        let top = ends[ends.len() - 1] - ends[ends.len() - 3];
        assert!(top < bottom, "{ends:?}");
    }

    #[test]
    fn an_outline_without_room_is_refused_with_its_size() {
        let error = draw_stack(&rectangle(15.0, 9.0), &StackSettings::default()).unwrap_err();
        assert!(error.to_string().contains("15.0 x 9.0"), "{error}");
        let settings = StackSettings { layers: Some(20), ..StackSettings::default() };
        let error = draw_stack(&rectangle(100.0, 100.0), &settings).unwrap_err();
        assert!(error.to_string().contains("At most 8"), "{error}");
    }

    proptest! {
        #[test]
        fn any_stack_passes_its_check_and_starts_without_crossings(
            bottom in 40.0..150.0f64, top in 40.0..150.0f64, height in 30.0..200.0f64, aspect in 0.2..0.6f64,
        ) {
            let outline = polygon(&[(-bottom / 2.0, 0.0), (bottom / 2.0, 0.0), (top / 2.0, height), (-top / 2.0, height)]);
            let drawn = draw_stack(&outline, &StackSettings { aspect, ..StackSettings::default() }).unwrap();
            prop_assert!(drawn.ruffle.check().is_ok());
            let segments: Vec<(P2, P2)> =
                drawn.ruffle.segments().map(|(i, j)| (drawn.positions[i], drawn.positions[j])).collect();
            for (a, s) in segments.iter().enumerate() {
                for t in &segments[a + 1..] {
                    prop_assert!(!crate::geom::segments_cross(s.0, s.1, t.0, t.1));
                }
            }
        }
    }
}
