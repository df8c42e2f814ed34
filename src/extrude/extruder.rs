//! Spans for every node of a strip.

use super::silhouette::Silhouette;
use super::{Error, Span};
use crate::cut::PlaneFrame;
use crate::geom::P2;
use crate::mesh::TriMesh;
use crate::ruffle::Ruffle;

/// What decides how wide the strip is.
#[derive(Debug, Clone, PartialEq)]
pub enum Extruder {
    /// The same everywhere: designs without a mesh.
    Constant(Span),
    /// The mesh's thickness.
    Mesh(Solid),
}

/// A mesh seen along a plane's normal, and the smallest width a strip may have.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    silhouette: Silhouette,
    min_width_mm: f64,
}

impl Extruder {
    /// Spans as thick as `mesh` along the normal of `frame`, nowhere narrower than `min_width_mm` (what a joint needs).
    ///
    /// # Errors
    /// A smallest width that is not above 0.
    pub fn from_mesh(mesh: &TriMesh, frame: &PlaneFrame, min_width_mm: f64) -> Result<Extruder, Error> {
        if !(min_width_mm > 0.0 && min_width_mm.is_finite()) {
            return Err(Error::MinWidth { min_width_mm });
        }
        Ok(Extruder::Mesh(Solid { silhouette: Silhouette::new(mesh, frame), min_width_mm }))
    }

    /// The same span everywhere, mm along the normal.
    ///
    /// # Errors
    /// Ends that are not finite or not in order.
    pub fn constant(lo: f64, hi: f64) -> Result<Extruder, Error> {
        if lo < hi && lo.is_finite() && hi.is_finite() {
            Ok(Extruder::Constant(Span { lo, hi }))
        } else {
            Err(Error::Empty { lo, hi })
        }
    }

    /// A span for each node; `positions` are the nodes' plane coordinates, mm.
    ///
    /// A node outside the mesh gets what lies between the nearest nodes along the strip that are inside, by distance along the strip, and
    /// past the last such node what that one has. A round body gets thin toward its silhouette, just where outer sections lie: there the
    /// smallest width takes over, about the middle of what is left. A strip that meets the mesh nowhere has the smallest width about the
    /// plane. Nodes beyond the end of `positions` count as outside.
    pub fn spans(&self, ruffle: &Ruffle, positions: &[P2]) -> Vec<Span> {
        match self {
            Extruder::Constant(span) => vec![*span; ruffle.node_count],
            Extruder::Mesh(solid) => solid.spans(ruffle, positions),
        }
    }
}

/// What of a shape lies before or behind the strip, beyond a gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beyond {
    /// Share of the shape's thickness over the nodes that the strip does not fill.
    pub share: f64,
    /// Where most of it is, plane frame, mm.
    pub at: P2,
}

impl Extruder {
    /// Where the shape goes on beyond a gap, along the normal from the nodes at `positions`, and the strip does not follow; none where it does not go on. A strip has
    /// one width: it takes the stretch that holds the plane.
    pub fn beyond(&self, positions: &[P2]) -> Option<Beyond> {
        let Extruder::Mesh(solid) = self else { return None };
        let (mut most, mut left, mut whole) = ((0.0, P2::origin()), 0.0, 0.0);
        for p in positions {
            // Where the line misses the strip's stretch there is no gap: the outline ends before.
            let Some(filled) = solid.silhouette.span_at(*p) else { continue };
            let beyond = solid.silhouette.beyond_at(*p);
            left += beyond;
            whole += beyond + filled.width();
            if beyond > most.0 {
                most = (beyond, *p);
            }
        }
        (left > 0.0).then(|| Beyond { share: left / whole, at: most.1 })
    }
}

impl Solid {
    fn spans(&self, ruffle: &Ruffle, positions: &[P2]) -> Vec<Span> {
        let mut seen: Vec<Option<Span>> =
            (0..ruffle.node_count).map(|node| self.silhouette.span_at(*positions.get(node)?)).collect();
        for (node, span) in bridged(ruffle, &seen) {
            seen[node] = Some(span);
        }
        let whole = |span: Option<Span>| span.unwrap_or(Span { lo: 0.0, hi: 0.0 }).at_least(self.min_width_mm);
        eased(ruffle, seen.into_iter().map(whole).collect())
    }
}

/// Steepest rise of an edge, mm across per mm along the strip. A loop that grazes the silhouette would else cut a notch into the strip as sharp as a knife's:
/// a tear waiting to run, and narrower at its bottom than the tool.
const MAX_SLOPE: f64 = 2.0;

/// Spans widened until no edge rises more steeply than [`MAX_SLOPE`]: notches are filled, nothing is cut away.
fn eased(ruffle: &Ruffle, mut spans: Vec<Span>) -> Vec<Span> {
    // A wide place reaches its neighbours in one sweep each way; where the strip meets itself it reaches other passes, which takes another round.
    loop {
        let before = spans.clone();
        let forward: Vec<(usize, usize)> = ruffle.segments().collect();
        let steps = forward.iter().copied().zip(ruffle.rest_lengths.iter().copied());
        let backward = forward.iter().map(|(i, j)| (*j, *i)).zip(ruffle.rest_lengths.iter().copied()).rev();
        for ((from, to), length) in steps.chain(backward) {
            let wide = spans[from];
            spans[to].lo = spans[to].lo.min(wide.lo + MAX_SLOPE * length);
            spans[to].hi = spans[to].hi.max(wide.hi - MAX_SLOPE * length);
        }
        if spans == before {
            return spans;
        }
    }
}

/// For every node without a span, one interpolated along the strip; the mean over its passes where the strip meets itself.
fn bridged(ruffle: &Ruffle, seen: &[Option<Span>]) -> Vec<(usize, Span)> {
    let stations = ruffle.stations();
    let known: Vec<(f64, Span)> =
        stations.iter().enumerate().filter_map(|(k, s)| Some((*s, seen[ruffle.at(k)]?))).collect();
    let (Some(first), Some(last)) = (known.first(), known.last()) else { return Vec::new() };
    let mut sums: Vec<(Span, f64)> = vec![(Span { lo: 0.0, hi: 0.0 }, 0.0); ruffle.node_count];
    for (k, s) in stations.iter().enumerate() {
        let after = known.partition_point(|(station, _)| station <= s);
        let span = match (after.checked_sub(1).map(|i| known[i]), known.get(after)) {
            (Some((from, before)), Some((to, next))) => before.toward(*next, (s - from) / (to - from)),
            (None, _) => first.1,
            (_, None) => last.1,
        };
        let (sum, passes) = &mut sums[ruffle.at(k)];
        (sum.lo, sum.hi, *passes) = (sum.lo + span.lo, sum.hi + span.hi, *passes + 1.0);
    }
    let missing = sums.into_iter().enumerate().filter(|(node, (_, passes))| seen[*node].is_none() && *passes > 0.0);
    missing.map(|(node, (sum, passes))| (node, Span { lo: sum.lo / passes, hi: sum.hi / passes })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut::Plane;
    use crate::geom::{P3, V3};
    use crate::mesh::samples::{cuboid, sphere};
    use crate::ruffle::{Node, Role, Section};

    /// A strip over `walk` with one section; node ids up to the largest.
    fn strip(walk: &[u32], rest_lengths: &[f64]) -> Ruffle {
        let nodes = walk.iter().max().map_or(0, |n| n + 1);
        Ruffle {
            node_count: nodes as usize,
            walk: walk.iter().copied().map(Node).collect(),
            rest_lengths: rest_lengths.to_vec(),
            sections: vec![Section {
                role: Role::Inner,
                first_segment: 0,
                end_segment: rest_lengths.len(),
                pinned: false,
            }],
            foot: [Node(0), Node(nodes - 1)],
            densified: Default::default(),
        }
    }

    fn seen(mesh: &TriMesh, min_width_mm: f64) -> Extruder {
        let frame = PlaneFrame::new(&Plane { origin: P3::origin(), normal: V3::z() }, V3::y());
        Extruder::from_mesh(mesh, &frame, min_width_mm).unwrap()
    }

    fn line(us: &[f64]) -> Vec<P2> {
        us.iter().map(|u| P2::new(*u, 0.3)).collect()
    }

    #[test]
    fn a_constant_extruder_ignores_positions() {
        let ruffle = strip(&[0, 1, 2], &[1.0, 1.0]);
        let spans = Extruder::constant(-20.0, 20.0).unwrap().spans(&ruffle, &line(&[0.0, 1.0, 900.0]));
        assert_eq!(spans, [Span { lo: -20.0, hi: 20.0 }; 3]);
        assert!(matches!(Extruder::constant(2.0, 2.0), Err(Error::Empty { .. })));
        assert!(matches!(Extruder::constant(f64::NAN, 2.0), Err(Error::Empty { .. })));
    }

    #[test]
    fn nodes_outside_are_interpolated_by_length_along_the_strip() {
        // Two slabs side by side with a gap, 10 thick before and 30 thick after it.
        let thin = cuboid(P3::new(0.0, -5.0, -5.0), V3::new(10.0, 10.0, 10.0));
        let thick = cuboid(P3::new(20.0, -5.0, -5.0), V3::new(10.0, 10.0, 30.0));
        let extruder = seen(&crate::mesh::samples::together(&[thin, thick]), 2.0);
        let ruffle = strip(&[0, 1, 2, 3, 4], &[50.0, 10.0, 30.0, 80.0]);
        let spans = extruder.spans(&ruffle, &line(&[-3.0, 9.0, 15.0, 21.0, 40.0]));
        let his: Vec<f64> = spans.iter().map(|s| s.hi).collect();
        assert_eq!(his, [5.0, 5.0, 10.0, 25.0, 25.0]);
        assert!(spans.iter().all(|s| s.lo == -5.0));
    }

    #[test]
    fn a_connection_point_outside_takes_the_mean_of_its_passes() {
        let thin = cuboid(P3::new(0.0, -5.0, -5.0), V3::new(10.0, 10.0, 10.0));
        let thick = cuboid(P3::new(20.0, -5.0, -5.0), V3::new(10.0, 10.0, 30.0));
        let extruder = seen(&crate::mesh::samples::together(&[thin, thick]), 2.0);
        // First passed between the slabs half way (15), then again at the end, past the thick one (25).
        let ruffle = strip(&[0, 1, 2, 1], &[10.0, 10.0, 10.0]);
        let spans = extruder.spans(&ruffle, &line(&[5.0, 15.0, 25.0]));
        assert_eq!(spans[1], Span { lo: -5.0, hi: 20.0 });
    }

    #[test]
    fn a_ball_thins_to_the_smallest_width_at_its_silhouette_without_a_jump() {
        let extruder = seen(&sphere(P3::origin(), 50.0, 64), 12.0);
        let us: Vec<f64> = (0..=220).map(|i| f64::from(i) * 0.25).collect();
        let walk: Vec<u32> = (0..us.len() as u32).collect();
        let spans = extruder.spans(&strip(&walk, &vec![0.25; us.len() - 1]), &line(&us));
        assert!((spans[0].width() - 100.0).abs() < 0.2);
        for pair in spans.windows(2) {
            let step = pair[0].width() - pair[1].width();
            assert!((-1e-9..=0.5 * MAX_SLOPE + 1e-9).contains(&step), "{pair:?}");
        }
        assert!((spans[220].width() - 12.0).abs() < 1e-9 && spans[220].middle().abs() < 0.1);
    }

    #[test]
    fn a_notch_is_filled_to_the_steepest_slope_and_nothing_is_cut_away() {
        let ruffle = strip(&[0, 1, 2, 3, 1], &[10.0; 4]);
        let spans = [30.0, 5.0, 5.0, 40.0].map(|w| Span { lo: -w, hi: w }).to_vec();
        let his: Vec<f64> = eased(&ruffle, spans).iter().map(|s| s.hi).collect();
        assert_eq!(his, [30.0, 20.0, 20.0, 40.0]);
    }

    #[test]
    fn what_lies_beyond_a_gap_is_told_with_its_share_and_place() {
        let near = cuboid(P3::new(0.0, -5.0, -5.0), V3::new(40.0, 10.0, 10.0));
        let behind = cuboid(P3::new(20.0, -5.0, 15.0), V3::new(20.0, 10.0, 30.0));
        let extruder = seen(&crate::mesh::samples::together(&[near.clone(), behind]), 2.0);
        let beyond = extruder.beyond(&line(&[5.0, 15.0, 25.0, 35.0])).unwrap();
        assert_eq!((beyond.share, beyond.at.x), (0.6, 25.0));
        let aside = cuboid(P3::new(50.0, -5.0, 15.0), V3::repeat(10.0));
        assert_eq!(seen(&crate::mesh::samples::together(&[near, aside]), 2.0).beyond(&line(&[5.0, 55.0])), None);
        assert_eq!(Extruder::constant(-1.0, 1.0).unwrap().beyond(&line(&[5.0])), None);
    }

    #[test]
    fn a_strip_that_misses_has_the_smallest_width_about_the_plane() {
        let extruder = seen(&cuboid(P3::origin(), V3::repeat(10.0)), 8.0);
        let spans = extruder.spans(&strip(&[0, 1], &[1.0]), &line(&[-50.0, -40.0]));
        assert_eq!(spans, [Span { lo: -4.0, hi: 4.0 }; 2]);
        assert!(matches!(
            Extruder::from_mesh(
                &cuboid(P3::origin(), V3::repeat(1.0)),
                &PlaneFrame::new(&Plane { origin: P3::origin(), normal: V3::z() }, V3::y()),
                0.0
            ),
            Err(Error::MinWidth { .. })
        ));
    }
}
