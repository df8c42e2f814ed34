//! The border of a job as a program of its own: it shows where on the bed the job lies before anything is cut.

use std::f64::consts::TAU;

use crate::gcode::{Action, Move};
use crate::geom::{P2, Rect, Similarity, convex_hull, tolerance};

/// Points are replaced by their hull when there are so many, so that a long job needs no more memory than a short one.
const POINTS: usize = 4096;

/// Gathers what lies inside a border.
#[derive(Debug, Clone, Default)]
pub struct Extent {
    points: Vec<P2>,
}

/// A border to be traced, mm in work coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Its corners, counter-clockwise, from the one nearest to work zero; one or two where there is no more.
    pub corners: Vec<P2>,
}

/// How a border is traced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracing {
    /// mm/min.
    pub feed_mm_per_min: f64,
    /// S word of the beam while it moves; 0 for a dark one.
    pub beam_s: f64,
    /// Where a tool with a height is lifted to first, mm in work coordinates; `None` for one without.
    pub up_mm: Option<f64>,
}

impl Extent {
    /// Takes points in, mm.
    pub fn add(&mut self, points: impl IntoIterator<Item = P2>) {
        for point in points {
            self.points.push(point);
            if self.points.len() >= POINTS {
                self.points = convex_hull(&self.points);
                // A circle of so many corners is round enough.
                let every = self.points.len().div_ceil(POINTS / 2);
                self.points = self.points.iter().copied().step_by(every.max(1)).collect();
            }
        }
    }

    /// Takes in the way of a move, arcs as far as they bulge.
    pub fn add_move(&mut self, m: &Move) {
        let steps = match m.action {
            Action::Arc { radius_mm, sweep_rad, .. } => {
                // A chord of an angle a stays within r (1 - cos (a / 2)) of its arc.
                let angle = 2.0 * (1.0 - tolerance::FLATTEN_MM / radius_mm.max(tolerance::FLATTEN_MM)).acos();
                (sweep_rad.abs() / angle.clamp(TAU / 720.0, TAU / 8.0)).ceil() as usize
            }
            _ => 1,
        };
        self.add((0..=steps).map(|k| m.point_at(k as f64 / steps as f64).xy()));
    }

    /// The same, laid elsewhere.
    pub fn laid(&self, placing: &Similarity) -> Extent {
        Extent { points: self.points.iter().map(|p| placing * p).collect() }
    }

    /// The tightest border without dents; `None` around nothing.
    pub fn hull(&self) -> Option<Frame> {
        Frame::from_nearest(convex_hull(&self.points))
    }

    /// The upright box around everything; `None` around nothing.
    pub fn boxed(&self) -> Option<Frame> {
        let Rect { min, max } = Rect::around(&self.points);
        if min.x > max.x {
            return None;
        }
        let mut corners = vec![min, P2::new(max.x, min.y), max, P2::new(min.x, max.y)];
        corners.dedup();
        Frame::from_nearest(corners)
    }
}

impl Frame {
    fn from_nearest(mut corners: Vec<P2>) -> Option<Frame> {
        let distance = |p: &P2| p.coords.norm();
        let nearest = (0..corners.len()).min_by(|a, b| distance(&corners[*a]).total_cmp(&distance(&corners[*b])))?;
        corners.rotate_left(nearest);
        Some(Frame { corners })
    }

    /// The box around it, mm.
    pub fn bounds(&self) -> Rect {
        Rect::around(&self.corners)
    }

    /// Once around, from wherever the tool stands to the first corner and back to it. The way there is dark; on the border the beam is lit in M4 only,
    /// in which a board in laser mode ($32=1) keeps it off at rest.
    pub fn lines(&self, tracing: Tracing) -> Vec<String> {
        let Some(first) = self.corners.first() else { return Vec::new() };
        let mut lines = Frame::way_to([first.x, first.y], tracing.up_mm);
        if tracing.beam_s > 0.0 {
            lines.push(format!("M4S{}", tracing.beam_s));
        }
        for p in self.corners.iter().skip(1).chain([first]) {
            lines.push(format!("G1X{:.3}Y{:.3}F{:.0}", p.x, p.y, tracing.feed_mm_per_min));
        }
        lines.push("M5S0".to_owned());
        lines
    }

    /// The dark way to a place, mm in work coordinates; a tool with a height is lifted to where it travels first, mm in work coordinates.
    pub fn way_to(place_mm: [f64; 2], up_mm: Option<f64>) -> Vec<String> {
        let mut lines = ["G21G90G94G17G54", "M5S0"].map(str::to_owned).to_vec();
        lines.extend(up_mm.map(|up_mm| format!("G0Z{up_mm:.3}")));
        lines.push(format!("G0X{:.3}Y{:.3}", place_mm[0], place_mm[1]));
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::{parse, trace};

    fn extent(text: &str) -> Extent {
        let mut extent = Extent::default();
        for m in trace(&parse(text).unwrap()).unwrap().iter().filter(|m| m.burns()) {
            extent.add_move(m);
        }
        extent
    }

    #[test]
    fn the_border_is_around_what_burns_and_not_around_the_ways_between() {
        let job = extent("G21G90M4S500\nG0X200Y200\nG0X10Y10\nG1X40F1000\nX10Y30\nM5\nG0X0Y0\n");
        let hull = job.hull().unwrap();
        assert_eq!(hull.corners, [P2::new(10.0, 10.0), P2::new(40.0, 10.0), P2::new(10.0, 30.0)]);
        assert_eq!(job.boxed().unwrap().corners.len(), 4);
        assert_eq!(job.boxed().unwrap().bounds(), hull.bounds());
        assert_eq!(extent("G0X10Y10\n").hull(), None);
        assert_eq!(extent("G0X10Y10\n").boxed(), None);
    }

    #[test]
    fn an_arc_bulges_into_the_border() {
        let job = extent("G21G90G0X0Y0M4S500F1000\nG2X100Y0I50J0\n");
        let top = job.hull().unwrap().bounds().max.y;
        assert!((top - 50.0).abs() < tolerance::FLATTEN_MM, "{top}");
    }

    #[test]
    fn a_long_job_is_bounded_in_memory_and_keeps_its_border() {
        let mut extent = Extent::default();
        for k in 0..200_000 {
            let angle = f64::from(k) * 0.7;
            extent.add([P2::new(100.0 + 50.0 * angle.cos(), 80.0 + 50.0 * angle.sin())]);
            assert!(extent.points.len() <= POINTS);
        }
        let bounds = extent.hull().unwrap().bounds();
        let far = [bounds.min.x - 50.0, bounds.max.x - 150.0, bounds.min.y - 30.0, bounds.max.y - 130.0];
        assert!(far.iter().all(|d| d.abs() < 0.01), "{bounds:?}");
    }

    #[test]
    fn a_tool_with_a_height_is_lifted_before_it_goes_across() {
        let moves = trace(&parse(&Frame::way_to([5.0, 6.0], Some(3.0)).join("\n")).unwrap()).unwrap();
        let ends: Vec<[f64; 3]> = moves.iter().map(|m| m.to.into()).collect();
        assert_eq!(ends, [[0.0, 0.0, 3.0], [5.0, 6.0, 3.0]]);
        assert!(!Frame::way_to([5.0, 6.0], None).concat().contains('Z'));
        let frame = extent("G21G90M4S500F900\nG0X10Y10\nG1X40\nY30\n").hull().unwrap();
        let lines = frame.lines(Tracing { feed_mm_per_min: 3000.0, beam_s: 0.0, up_mm: Some(3.0) });
        assert_eq!(trace(&parse(&lines.join("\n")).unwrap()).unwrap()[0].to, crate::geom::P3::new(0.0, 0.0, 3.0));
    }

    #[test]
    fn without_power_no_line_lights_the_beam_and_with_power_only_m4_does() {
        let frame = extent("G21G90M4S500F900\nG0X10Y10\nG1X40\nY30\n").hull().unwrap();
        for (beam_s, lit) in [(0.0, 0), (10.0, 3)] {
            let text = frame.lines(Tracing { feed_mm_per_min: 3000.0, beam_s, up_mm: None }).join("\n");
            let moves = trace(&parse(&text).unwrap()).unwrap();
            assert_eq!(moves.iter().filter(|m| m.burns()).count(), lit);
            assert!(moves.iter().all(|m| m.power_s <= beam_s && m.beam != crate::gcode::Beam::Constant));
            assert_eq!(moves.last().unwrap().beam, crate::gcode::Beam::Off);
        }
    }
}
