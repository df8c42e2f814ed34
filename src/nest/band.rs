//! A region taken apart into y-monotone bands: vertical lines meet each band in one stretch.
//!
//! A strip lying along x is one band, whatever its waves; other shapes take a few.

use super::NARROW_MM;
use super::chain::{self, Piece};
use crate::geom::P2;

/// Everything between a lower and an upper border over the same stretch of x.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Band {
    pub(super) x0: f64,
    pub(super) x1: f64,
    pub(super) lower: Vec<Piece>,
    pub(super) upper: Vec<Piece>,
}

impl Band {
    fn new(lower: Vec<Piece>, upper: Vec<Piece>) -> Band {
        Band { x0: upper[0].x0, x1: upper[upper.len() - 1].x1, lower, upper }
    }

    /// Both borders with fewer pieces, at most `within` outside of these.
    pub(super) fn simplified(&self, within: f64) -> Band {
        let below = chain::simplified(&chain::flipped(&self.lower), within);
        Band::new(chain::flipped(&below), chain::simplified(&self.upper, within))
    }

    /// Everything within `by` of the band.
    pub(super) fn grown(&self, by: f64) -> Band {
        let below = chain::grown(&chain::flipped(&self.lower), by);
        Band::new(chain::flipped(&below), chain::grown(&self.upper, by))
    }

    pub(super) fn shifted(&self, dx: f64, dy: f64) -> Band {
        let moved = |chain: &[Piece]| chain.iter().map(|p| p.shifted(dx, dy)).collect();
        Band::new(moved(&self.lower), moved(&self.upper))
    }
}

/// A stretch of a band between two neighbouring corners.
#[derive(Clone, Copy)]
struct Trapezoid {
    lower: Piece,
    upper: Piece,
}

impl Trapezoid {
    fn continues(&self, before: &Trapezoid) -> bool {
        let x = self.lower.x0;
        let low = self.lower.y(x).max(before.lower.y(x));
        low < self.upper.y(x).min(before.upper.y(x))
    }
}

/// The bands of what the loops enclose (even-odd). Loops must not cross.
pub(super) fn bands(loops: &[Vec<P2>]) -> Vec<Band> {
    let edges: Vec<Piece> = loops
        .iter()
        .flat_map(|points| (0..points.len()).map(|i| (points[i], points[(i + 1) % points.len()])))
        .filter(|(a, b)| (a.x - b.x).abs() > NARROW_MM)
        .map(|(a, b)| if a.x < b.x { Piece::between(a, b) } else { Piece::between(b, a) })
        .collect();
    let mut xs: Vec<f64> = edges.iter().flat_map(|e| [e.x0, e.x1]).collect();
    xs.sort_by(f64::total_cmp);
    xs.dedup_by(|a, b| (*a - *b).abs() <= NARROW_MM);

    let mut done: Vec<Vec<Trapezoid>> = Vec::new();
    let mut open: Vec<Vec<Trapezoid>> = Vec::new();
    for w in xs.windows(2) {
        let column = column(&edges, w[0], w[1]);
        let last = |band: &Vec<Trapezoid>| band[band.len() - 1];
        let partners = |t: &Trapezoid| open.iter().filter(|band| t.continues(&last(band))).count();
        let alone: Vec<bool> = column.iter().map(|t| partners(t) == 1).collect();
        let mut next: Vec<Vec<Trapezoid>> = Vec::new();
        let mut taken = vec![false; column.len()];
        for mut band in std::mem::take(&mut open) {
            let end = last(&band);
            let mut into = column.iter().enumerate().filter(|(_, t)| t.continues(&end));
            match (into.next(), into.next()) {
                (Some((k, t)), None) if alone[k] => {
                    band.push(*t);
                    taken[k] = true;
                    next.push(band);
                }
                _ => done.push(band),
            }
        }
        next.extend(column.iter().zip(&taken).filter(|(_, taken)| !**taken).map(|(t, _)| vec![*t]));
        open = next;
    }
    done.extend(open);
    done.iter()
        .map(|band| Band::new(band.iter().map(|t| t.lower).collect(), band.iter().map(|t| t.upper).collect()))
        .collect()
}

/// What lies between two neighbouring corners, from below.
fn column(edges: &[Piece], x0: f64, x1: f64) -> Vec<Trapezoid> {
    let middle = 0.5 * (x0 + x1);
    let mut across: Vec<Piece> =
        edges.iter().filter(|e| e.x0 < middle && middle < e.x1).map(|e| e.over(x0, x1)).collect();
    across.sort_by(|a, b| a.y(middle).total_cmp(&b.y(middle)));
    across.chunks_exact(2).map(|pair| Trapezoid { lower: pair[0], upper: pair[1] }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::signed_area;
    use proptest::prelude::*;

    fn polygon(points: &[(f64, f64)]) -> Vec<P2> {
        points.iter().map(|&(x, y)| P2::new(x, y)).collect()
    }

    fn area(band: &Band) -> f64 {
        let under = |chain: &[Piece]| chain.iter().map(|p| 0.5 * (p.y(p.x0) + p.y(p.x1)) * (p.x1 - p.x0)).sum::<f64>();
        under(&band.upper) - under(&band.lower)
    }

    #[test]
    fn a_wave_is_one_band_and_a_fork_three() {
        let wave = polygon(&[(0.0, 0.0), (5.0, 8.0), (10.0, 0.0), (10.0, 2.0), (5.0, 10.0), (0.0, 2.0)]);
        assert_eq!(bands(&[wave]).len(), 1);
        let fork =
            polygon(&[(0.0, 0.0), (9.0, 0.0), (9.0, 2.0), (4.0, 2.0), (4.0, 4.0), (9.0, 4.0), (9.0, 6.0), (0.0, 6.0)]);
        let bands = bands(&[fork]);
        assert_eq!(bands.len(), 3);
        assert!((bands.iter().map(area).sum::<f64>() - 44.0).abs() < 1e-12);
    }

    #[test]
    fn a_hole_is_left_out() {
        let square = polygon(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]);
        let hole = polygon(&[(4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0)]);
        let bands = bands(&[square, hole]);
        assert_eq!(bands.len(), 4);
        assert!((bands.iter().map(area).sum::<f64>() - 96.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn bands_have_the_area_of_the_shape_whichever_way_it_is_turned(
            radii in prop::collection::vec(1.0..9.0f64, 3..20), angle in 0.0..6.3f64,
        ) {
            let n = radii.len() as f64;
            let corner = |(k, r): (usize, &f64)| {
                let a = angle + k as f64 / n * std::f64::consts::TAU;
                P2::new(r * a.cos(), r * a.sin())
            };
            let star: Vec<P2> = radii.iter().enumerate().map(corner).collect();
            let bands = bands(std::slice::from_ref(&star));
            prop_assert!((bands.iter().map(area).sum::<f64>() - signed_area(&star)).abs() < 1e-5);
            let grown: Vec<Band> = bands.iter().map(|b| b.simplified(0.1).grown(0.5)).collect();
            prop_assert!(grown.iter().all(|b| b.lower.len() > 1 && area(b) > 0.0));
        }
    }
}
