//! The upper or lower border of a y-monotone band: straight pieces side by side along x, which may jump from one to the next.
//!
//! Everything here errs outward: a chain that was simplified or grown never lies inside the border it stands for.

use crate::geom::P2;

/// Directions of the tangents that stand in for a round corner, degrees from straight up. They stand off the circle by 2 % of its radius at most.
const TANGENTS_DEG: [f64; 7] = [-67.5, -45.0, -22.5, 0.0, 22.5, 45.0, 67.5];

/// A straight piece from `x0` to `x1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    pub(super) x0: f64,
    pub(super) x1: f64,
    /// Height at `x0`.
    y0: f64,
    slope: f64,
}

impl Piece {
    /// From `a` to `b`, with `a.x < b.x`.
    pub(super) fn between(a: P2, b: P2) -> Piece {
        Piece { x0: a.x, x1: b.x, y0: a.y, slope: (b.y - a.y) / (b.x - a.x) }
    }

    pub(super) fn y(&self, x: f64) -> f64 {
        self.y0 + self.slope * (x - self.x0)
    }

    fn start(&self) -> P2 {
        P2::new(self.x0, self.y0)
    }

    fn end(&self) -> P2 {
        P2::new(self.x1, self.y(self.x1))
    }

    /// The same piece of line over another stretch.
    pub(super) fn over(&self, x0: f64, x1: f64) -> Piece {
        Piece { x0, x1, y0: self.y(x0), slope: self.slope }
    }

    pub(super) fn shifted(&self, dx: f64, dy: f64) -> Piece {
        Piece { x0: self.x0 + dx, x1: self.x1 + dx, y0: self.y0 + dy, slope: self.slope }
    }
}

/// Upside down: a lower border becomes an upper one.
pub(super) fn flipped(chain: &[Piece]) -> Vec<Piece> {
    chain.iter().map(|p| Piece { y0: -p.y0, slope: -p.slope, ..*p }).collect()
}

/// Lowest and highest point.
pub(super) fn range(chain: &[Piece]) -> (f64, f64) {
    chain
        .iter()
        .flat_map(|p| [p.y0, p.y(p.x1)])
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), y| (lo.min(y), hi.max(y)))
}

/// An upper border with fewer pieces that lies at most `within` above this one and nowhere below. Straight runs stay exactly as they are,
/// and so does the highest point.
pub(super) fn simplified(chain: &[Piece], within: f64) -> Vec<Piece> {
    let (_, top) = range(chain);
    let mut made = Vec::new();
    let mut first = 0;
    while first < chain.len() {
        let mut best = chain[first];
        let mut next = first + 1;
        while next < chain.len() {
            let Some(piece) = chord(&chain[first..=next], within).filter(|p| p.y0.max(p.y(p.x1)) <= top) else { break };
            best = piece;
            next += 1;
        }
        made.push(best);
        first = next;
    }
    made
}

/// The chord over a run, lifted until no corner stands out above it; `None` when that takes it too far from one.
fn chord(run: &[Piece], within: f64) -> Option<Piece> {
    let chord = Piece::between(run[0].start(), run[run.len() - 1].end());
    let above = |p: P2| p.y - chord.y(p.x);
    let (mut least, mut most) = (0.0_f64, 0.0_f64);
    for piece in run {
        for off in [above(piece.start()), above(piece.end())] {
            least = least.min(off);
            most = most.max(off);
        }
        if most - least > within {
            return None;
        }
    }
    Some(chord.shifted(0.0, most))
}

/// The upper border of everything within `by` of the region below this upper border.
pub(super) fn grown(chain: &[Piece], by: f64) -> Vec<Piece> {
    let capsules: Vec<Capsule> = chain.iter().map(|p| Capsule::around(p, by)).collect();
    let mut xs: Vec<f64> = capsules.iter().flat_map(|c| c.breaks.iter().copied()).collect();
    xs.sort_by(f64::total_cmp);
    xs.dedup_by(|a, b| (*a - *b).abs() < super::NARROW_MM);
    let mut made = Vec::with_capacity(xs.len());
    for w in xs.windows(2) {
        let middle = 0.5 * (w[0] + w[1]);
        let over = || capsules.iter().filter(|c| c.x0 <= middle && middle <= c.x1);
        // Between two breaks every capsule is straight, so their maximum bends upward only: the chord lies above it.
        let top = |x: f64| over().map(|c| c.top(x)).fold(f64::NEG_INFINITY, f64::max);
        if over().next().is_some() {
            made.push(Piece::between(P2::new(w[0], top(w[0])), P2::new(w[1], top(w[1]))));
        }
    }
    made
}

/// The upper border of all points near a piece: the lowest of some tangents to it.
struct Capsule {
    x0: f64,
    x1: f64,
    /// Height at x = 0 and slope.
    tangents: Vec<(f64, f64)>,
    /// Where it bends, and both ends.
    breaks: Vec<f64>,
}

impl Capsule {
    fn around(piece: &Piece, by: f64) -> Capsule {
        let (p, q) = (piece.start(), piece.end());
        let own = -piece.slope.atan();
        let mut angles: Vec<f64> = TANGENTS_DEG.iter().map(|a| a.to_radians()).chain([own]).collect();
        angles.sort_by(f64::total_cmp);
        let tangents: Vec<(f64, f64)> = angles
            .iter()
            .map(|angle| {
                // The line that touches the circle around the farther end.
                let end = if *angle > own { q } else { p };
                let slope = -angle.tan();
                (end.y - slope * end.x + by / angle.cos(), slope)
            })
            .collect();
        let (x0, x1) = (piece.x0 - by, piece.x1 + by);
        let meet = |w: &[(f64, f64)]| (w[1].0 - w[0].0) / (w[0].1 - w[1].1);
        let inner = tangents.windows(2).map(meet).filter(|x| x.is_finite() && *x > x0 && *x < x1);
        let breaks = [x0, x1].into_iter().chain(inner).collect();
        Capsule { x0, x1, tangents, breaks }
    }

    fn top(&self, x: f64) -> f64 {
        self.tangents.iter().map(|(y, slope)| y + slope * x).fold(f64::INFINITY, f64::min)
    }
}

/// The most by which `top` rises above `bottom`, moved along x by `dx`, between `a` and `b`. Both must cover that stretch.
pub(super) fn rise(top: &[Piece], bottom: &[Piece], dx: f64, a: f64, b: f64) -> f64 {
    let mut t = top.partition_point(|p| p.x1 <= a);
    let mut u = bottom.partition_point(|p| p.x1 + dx <= a);
    let mut from = a;
    let mut most = f64::NEG_INFINITY;
    while let (Some(p), Some(q)) = (top.get(t), bottom.get(u)) {
        let q1 = q.x1 + dx;
        let to = p.x1.min(q1).min(b);
        let slope = p.slope - q.slope;
        let at_from = p.y(from) - q.y(from - dx);
        most = most.max(at_from).max(at_from + slope * (to - from));
        if to >= b {
            break;
        }
        from = to;
        t += usize::from(p.x1 <= to);
        u += usize::from(q1 <= to);
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::distance_to_segment;
    use proptest::prelude::*;

    fn chain(points: &[(f64, f64)]) -> Vec<Piece> {
        points.windows(2).map(|w| Piece::between(P2::new(w[0].0, w[0].1), P2::new(w[1].0, w[1].1))).collect()
    }

    fn at(chain: &[Piece], x: f64) -> f64 {
        let over = chain.iter().filter(|p| p.x0 - 1e-9 <= x && x <= p.x1 + 1e-9);
        over.map(|p| p.y(x)).fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn straight_runs_are_simplified_exactly_and_a_top_is_never_passed() {
        let straight = chain(&[(0.0, 1.0), (1.0, 1.0), (4.0, 1.0)]);
        assert_eq!(simplified(&straight, 0.1), chain(&[(0.0, 1.0), (4.0, 1.0)]));
        let bent = chain(&[(0.0, 0.0), (1.0, 0.05), (2.0, 0.05), (3.0, 0.0)]);
        assert!(range(&simplified(&bent, 1.0)).1 <= 0.05);
    }

    prop_compose! {
        fn wavy()(heights in prop::collection::vec(-5.0..5.0f64, 2..30)) -> Vec<Piece> {
            chain(&heights.iter().enumerate().map(|(k, y)| (k as f64, *y)).collect::<Vec<_>>())
        }
    }

    proptest! {
        #[test]
        fn what_is_simplified_lies_above_but_not_far(wavy in wavy(), within in 0.01..3.0f64) {
            let rough = simplified(&wavy, within);
            prop_assert!(rough.len() <= wavy.len());
            for k in 0..10 * (wavy.len() - 1) {
                let x = 0.1 * k as f64 + 0.05;
                let above = at(&rough, x) - at(&wavy, x);
                prop_assert!((-1e-9..=within + 1e-9).contains(&above), "{above} at {x}");
            }
        }

        #[test]
        fn what_is_grown_keeps_the_distance_and_little_more(wavy in wavy(), by in 0.1..3.0f64) {
            let grown = grown(&wavy, by);
            prop_assert!((grown[0].x0 + by).abs() < 1e-9);
            for k in 0..=40 {
                let x = -by + (wavy.len() as f64 + 2.0 * by) * (0.0125 + 0.025 * f64::from(k));
                if x >= wavy.len() as f64 + by - 1e-6 {
                    continue;
                }
                let p = P2::new(x, at(&grown, x));
                let distance = wavy.iter().map(|w| distance_to_segment(p, w.start(), w.end())).fold(f64::INFINITY, f64::min);
                prop_assert!(distance >= by - 1e-9, "{distance} < {by} at {x}");
            }
        }

        #[test]
        fn a_rise_is_the_most_of_many_samples(top in wavy(), bottom in wavy(), dx in -5.0..5.0f64) {
            let (from, to) = (dx.max(0.0), ((top.len()) as f64).min(bottom.len() as f64 + dx));
            if to - from > 0.1 {
                let most = rise(&top, &bottom, dx, from, to);
                let sampled = (0..=500)
                    .map(|k| from + (to - from) * f64::from(k) / 500.0)
                    .map(|x| at(&top, x) - at(&bottom, x - dx))
                    .fold(f64::NEG_INFINITY, f64::max);
                prop_assert!(most >= sampled - 1e-6 && most <= sampled + 1.0, "{most} {sampled}");
            }
        }
    }
}
