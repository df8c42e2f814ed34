//! How much of an outline a strip's border goes round, exactly, and how that changes with the place of every node.

use super::faces::{add_doubled_area_slope, doubled_area, sides};
use crate::cut::Outline;
use crate::geom::{P2, V2, cross};

/// The outline, ready to be compared with many borders.
#[derive(Debug, Clone)]
pub(super) struct Region {
    edges: Vec<(P2, P2)>,
    pub area_mm2: f64,
}

/// Areas of one border, mm².
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Filling {
    /// Of what the border goes round.
    pub enclosed_mm2: f64,
    /// Of that, what lies in the outline.
    pub covered_mm2: f64,
}

/// The outline is moved aside by this much, mm: a strip that lies exactly on its border would be neither inside nor outside.
const ASIDE_MM: V2 = V2::new(-1.3e-6, -1.7e-6);

impl Region {
    /// The region of an outline.
    pub fn new(outline: &Outline) -> Region {
        let loops = outline.loops();
        let edges = loops.flat_map(|l| (0..l.len()).map(|i| (l[i] + ASIDE_MM, l[(i + 1) % l.len()] + ASIDE_MM)));
        Region { edges: edges.collect(), area_mm2: outline.area() }
    }

    /// Compares the region with what `border`, a counter-clockwise walk over nodes at `x` that does not cross itself, goes round. `slope` is told the two ends of every stretch of
    /// a side (as shares of it) with whether it lies inside.
    fn compare(&self, border: &[usize], x: &[P2], mut stretch: impl FnMut(usize, usize, [f64; 2], bool)) -> Filling {
        let walls: Vec<(P2, P2)> = sides(border).map(|(i, j)| (x[i], x[j])).collect();
        let mut covered = 0.0;
        let mut cuts = Vec::new();
        for ((i, j), wall) in sides(border).zip(&walls) {
            for ([from, to], middle) in stretches(*wall, &self.edges, &mut cuts) {
                let inside = inside(&self.edges, middle);
                if inside {
                    covered += cross(at(*wall, from).coords, at(*wall, to).coords);
                }
                stretch(i, j, [from, to], inside);
            }
        }
        for edge in &self.edges {
            for ([from, to], middle) in stretches(*edge, &walls, &mut cuts) {
                if inside(&walls, middle) {
                    covered += cross(at(*edge, from).coords, at(*edge, to).coords);
                }
            }
        }
        Filling { enclosed_mm2: 0.5 * doubled_area(border, x), covered_mm2: 0.5 * covered }
    }

    /// Areas of what `border` goes round.
    pub fn filling(&self, border: &[usize], x: &[P2]) -> Filling {
        self.compare(border, x, |_, _, _, _| {})
    }

    /// Empty area plus `protrusion_weight` times protruding area (mm²), with the change of it per mm that each node moves added to `slopes`: where a border moves
    /// outward it wins area inside the outline, and loses it outside.
    pub fn shortfall(&self, border: &[usize], x: &[P2], protrusion_weight: f64, slopes: &mut [V2]) -> f64 {
        let filling = self.compare(border, x, |i, j, [from, to], inside| {
            if inside {
                // A node takes along what lies near it: the integral of its share 1 - t of the side, or t for the node at its end.
                let (whole, end) = (to - from, 0.5 * (to * to - from * from));
                let out = V2::new(x[j].y - x[i].y, x[i].x - x[j].x) * (1.0 + protrusion_weight);
                slopes[i] -= out * (whole - end);
                slopes[j] -= out * end;
            }
        });
        add_doubled_area_slope(border, x, 0.5 * protrusion_weight, slopes);
        self.area_mm2 - filling.covered_mm2 + protrusion_weight * (filling.enclosed_mm2 - filling.covered_mm2)
    }
}

fn at((a, b): (P2, P2), share: f64) -> P2 {
    a + (b - a) * share
}

/// The stretches of a side between the edges that cut it: shares of it, and the middle.
fn stretches<'a>(
    side: (P2, P2),
    edges: &[(P2, P2)],
    cuts: &'a mut Vec<f64>,
) -> impl Iterator<Item = ([f64; 2], P2)> + 'a {
    cuts.clear();
    cuts.push(0.0);
    let (a, along) = (side.0, side.1 - side.0);
    for (p, q) in edges {
        let (from, to) = (cross(along, p - a), cross(along, q - a));
        if (from > 0.0) == (to > 0.0) {
            continue;
        }
        let edge = q - p;
        let share = cross(p - a, edge) / cross(along, edge);
        if share > 0.0 && share < 1.0 {
            cuts.push(share);
        }
    }
    cuts.push(1.0);
    cuts[1..].sort_by(f64::total_cmp);
    cuts.windows(2).map(move |w| ([w[0], w[1]], at(side, 0.5 * (w[0] + w[1]))))
}

/// Whether `p` lies inside closed loops given by all their edges: it does if a ray from it leaves them an odd number of times.
fn inside(edges: &[(P2, P2)], p: P2) -> bool {
    let crossed = edges.iter().filter(|(a, b)| (a.y > p.y) != (b.y > p.y)).filter(|(a, b)| {
        let left = cross(b - a, p - a) > 0.0;
        left == (b.y > a.y)
    });
    crossed.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::faces::Faces;
    use crate::geom::enclosed;
    use crate::ruffle::{Drawn, uniform_stack};

    fn outline() -> Outline {
        let loops = |points: &[(f64, f64)]| points.iter().map(|(x, y)| P2::new(*x, *y)).collect::<Vec<P2>>();
        Outline {
            outer: loops(&[(-9.0, 0.0), (61.0, 0.0), (57.0, 80.0), (30.0, 40.0), (-12.0, 75.0)]),
            holes: vec![loops(&[(20.0, 10.0), (20.0, 20.0), (35.0, 20.0), (35.0, 10.0)])],
        }
    }

    fn wobbly() -> (Drawn, Faces) {
        let mut drawn = uniform_stack(3, 24.0, 45.0, 4.0);
        for (i, p) in drawn.positions.iter_mut().enumerate() {
            *p += V2::new((0.7 * i as f64).sin(), (1.1 * i as f64).cos()) * 0.4;
        }
        let faces = Faces::of(&drawn.ruffle, &drawn.positions);
        (drawn, faces)
    }

    #[test]
    fn areas_agree_with_triangles_clipped_one_by_one() {
        let (drawn, faces) = wobbly();
        let x = &drawn.positions;
        let filling = Region::new(&outline()).filling(&faces.border, x);
        let segments: Vec<(P2, P2)> = drawn.ruffle.segments().map(|(i, j)| (x[i], x[j])).collect();
        let exact = enclosed(&segments).coverage(outline().loops());
        assert!((filling.enclosed_mm2 - exact.enclosed).abs() < 1e-3, "{filling:?} {exact:?}");
        assert!((filling.covered_mm2 - exact.covered).abs() < 1e-3, "{filling:?} {exact:?}");
    }

    #[test]
    fn a_strip_along_the_border_counts_once() {
        let square = [(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0)].map(|(x, y)| P2::new(x, y)).to_vec();
        let region = Region::new(&Outline { outer: square.clone(), holes: Vec::new() });
        let filling = region.filling(&[0, 1, 2, 3], &square);
        assert!((filling.covered_mm2 - 1600.0).abs() < 1e-3, "{filling:?}");
    }

    #[test]
    fn slopes_match_finite_differences() {
        let (drawn, faces) = wobbly();
        let region = Region::new(&outline());
        let value = |x: &[P2]| region.shortfall(&faces.border, x, 3.0, &mut vec![V2::zeros(); x.len()]);
        let mut slopes = vec![V2::zeros(); drawn.positions.len()];
        region.shortfall(&faces.border, &drawn.positions, 3.0, &mut slopes);
        for node in &faces.border {
            for axis in 0..2 {
                let moved = |by: f64| {
                    let mut x = drawn.positions.clone();
                    x[*node].coords[axis] += by;
                    value(&x)
                };
                let slope = (moved(1e-4) - moved(-1e-4)) / 2e-4;
                assert!((slope - slopes[*node][axis]).abs() < 1e-3, "node {node}: {slope} against {}", slopes[*node]);
            }
        }
    }
}
