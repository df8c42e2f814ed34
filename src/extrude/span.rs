//! The stretch of a line that the strip covers.

use serde::{Deserialize, Serialize};

/// From `lo` to `hi` along the plane's normal, mm, the plane at 0. Written as `[lo, hi]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct Span {
    /// The end behind the plane.
    pub lo: f64,
    /// The end before the plane.
    pub hi: f64,
}

impl Span {
    /// Length, mm.
    pub fn width(&self) -> f64 {
        self.hi - self.lo
    }

    /// Middle, mm.
    pub fn middle(&self) -> f64 {
        0.5 * (self.lo + self.hi)
    }

    /// True when the plane lies in it.
    pub fn holds_plane(&self) -> bool {
        self.lo <= 0.0 && 0.0 <= self.hi
    }

    /// The span itself, or one of `min_width_mm` about its middle if it is narrower.
    pub fn at_least(self, min_width_mm: f64) -> Span {
        if self.width() >= min_width_mm {
            return self;
        }
        let middle = self.middle();
        Span { lo: middle - 0.5 * min_width_mm, hi: middle + 0.5 * min_width_mm }
    }

    /// The span a fraction `t` of the way to `other`.
    pub fn toward(self, other: Span, t: f64) -> Span {
        Span { lo: self.lo + (other.lo - self.lo) * t, hi: self.hi + (other.hi - self.hi) * t }
    }
}

impl From<[f64; 2]> for Span {
    fn from([lo, hi]: [f64; 2]) -> Span {
        Span { lo, hi }
    }
}

impl From<Span> for [f64; 2] {
    fn from(span: Span) -> [f64; 2] {
        [span.lo, span.hi]
    }
}

/// A width that cannot be.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Error {
    /// The ends are the wrong way round, equal, or not finite.
    #[error(
        "an extrusion from {lo} to {hi} mm has no width; the first number must be smaller than the second, both finite"
    )]
    Empty {
        /// First end, mm.
        lo: f64,
        /// Second end, mm.
        hi: f64,
    },
    /// The smallest width is not a width.
    #[error("a smallest strip width of {min_width_mm} mm is not usable; give a finite number above 0")]
    MinWidth {
        /// What was given, mm.
        min_width_mm: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_span_widens_about_its_middle_and_a_wide_one_stays() {
        assert_eq!(Span { lo: 4.0, hi: 6.0 }.at_least(10.0), Span { lo: 0.0, hi: 10.0 });
        assert_eq!(Span { lo: -4.0, hi: 6.0 }.at_least(10.0), Span { lo: -4.0, hi: 6.0 });
    }

    #[test]
    fn spans_are_written_as_pairs() {
        let text = serde_json::to_string(&[Span { lo: -1.5, hi: 2.0 }]).unwrap();
        assert_eq!(text, "[[-1.5,2.0]]");
        assert_eq!(serde_json::from_str::<Vec<Span>>(&text).unwrap(), [Span { lo: -1.5, hi: 2.0 }]);
    }
}
