//! From placed drawings to what the tool follows: kerf, order, passes, limits.
//!
//! [`plan`] takes drawings that already lie in the sheet frame (origin bottom left, x right, y up, mm). It moves every path to the waste side
//! by half the kerf (`kerf`), makes the whole sheet's engraving first, then all inner cuts, then the outlines from the far side toward
//! the park point (`order`), and refuses whatever leaves the sheet or the machine's work area (`limits`).

mod curve;
mod error;
mod kerf;
mod limits;
mod mitre;
mod order;
mod settings;

pub use error::Error;
pub use settings::{Air, Process, Settings};

use crate::drawing::{Drawing, DrawnPath, KerfSide, Operation, Role};
use crate::geom::{P2, Path, Rect};

/// One run of the tool along a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    /// What the middle of the tool follows, kerf included, mm in the sheet frame, from where the tool enters.
    pub path: Path,
    /// When it is made.
    pub operation: Operation,
    /// What it is for.
    pub role: Role,
    /// Name of the piece it belongs to.
    pub piece: String,
    /// The joint it belongs to ("A7"), if any.
    pub joint: Option<String>,
    /// Feed, mm/min.
    pub feed_mm_per_min: f64,
    /// Power, 0..1.
    pub power: f64,
    /// Air assist.
    pub air: Air,
}

/// Everything the tool does on one sheet, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Toolpath {
    /// Extent of the sheet along x, mm.
    pub width_mm: f64,
    /// Extent of the sheet along y, mm.
    pub height_mm: f64,
    /// Where the tool starts and ends, mm in the sheet frame.
    pub park: P2,
    /// Runs in order; a contour made in several passes is there several times.
    pub contours: Vec<Contour>,
    /// Length of all moves between contours, from the park point and back to it, mm.
    pub travel_mm: f64,
    /// The same for the order of the drawings inside each operation, every path as drawn, mm.
    pub travel_unordered_mm: f64,
    /// Greatest difference found between a compensated path's distance to its nominal curve and half the kerf, mm.
    pub max_kerf_deviation_mm: f64,
}

impl Toolpath {
    /// Length of all runs of one operation, every pass counted, mm.
    pub fn length_mm(&self, operation: Operation) -> f64 {
        self.contours.iter().filter(|c| c.operation == operation).map(|c| c.path.length()).sum()
    }

    /// Length cut, every pass counted, mm.
    pub fn cut_mm(&self) -> f64 {
        self.length_mm(Operation::CutInner) + self.length_mm(Operation::CutOutline)
    }

    /// Length engraved, every pass counted, mm.
    pub fn engrave_mm(&self) -> f64 {
        self.length_mm(Operation::Engrave)
    }

    /// The smallest box around all runs, arcs as far as they bulge; travel is not counted. Empty without runs.
    pub fn bounds(&self) -> Rect {
        self.contours.iter().fold(Rect::EMPTY, |rect, c| rect.union(c.path.bounds()))
    }
}

/// A drawing with the kerf in it: every path moved to its waste side by half of `kerf_mm`, for programs that follow lines as they are. Kerf sides are all
/// [`KerfSide::On`] afterwards.
///
/// # Errors
/// A path that the kerf cannot be made up for, with its piece and role.
pub fn compensated(drawing: &Drawing, kerf_mm: f64) -> Result<Drawing, Error> {
    let moved = |drawn: &DrawnPath| {
        let path = kerf::compensate(drawn, &drawing.name, kerf_mm)?.path;
        Ok(DrawnPath { path, kerf: KerfSide::On, ..drawn.clone() })
    };
    let paths = drawing.paths.iter().map(moved).collect::<Result<Vec<DrawnPath>, Error>>()?;
    Ok(Drawing { name: drawing.name.clone(), paths })
}

/// Plans one sheet of `width_mm` x `height_mm` from drawings placed on it.
///
/// # Errors
/// Settings out of range; a path that is no curve; a kerf that a path cannot be compensated for; a run outside the sheet or the work area.
/// Errors about a path name its piece and role.
pub fn plan(drawings: &[Drawing], width_mm: f64, height_mm: f64, settings: &Settings) -> Result<Toolpath, Error> {
    settings.check()?;
    let sheet = Rect::from_size(width_mm, height_mm);
    let mut contours = Vec::new();
    let mut max_kerf_deviation_mm = 0.0_f64;
    for drawing in drawings {
        for drawn in &drawing.paths {
            let compensated = kerf::compensate(drawn, &drawing.name, settings.kerf_mm)?;
            max_kerf_deviation_mm = max_kerf_deviation_mm.max(compensated.deviation_mm);
            limits::check(&compensated.path, &drawing.name, drawn.role, &sheet, &settings.work_area)?;
            let operation = drawn.role.operation();
            let process = settings
                .process(operation)
                .ok_or_else(|| Error::NoProcess { piece: drawing.name.clone(), role: drawn.role.class() })?;
            contours.push(Contour {
                path: compensated.path,
                operation,
                role: drawn.role,
                piece: drawing.name.clone(),
                joint: drawn.joint.clone(),
                feed_mm_per_min: process.feed_mm_per_min,
                power: process.power,
                air: process.air,
            });
        }
    }

    let passes = |contour: &Contour| settings.process(contour.operation).map_or(1, |process| process.passes);
    let as_drawn = order::by_operation(contours);
    let travel_unordered_mm = order::travel_mm(&as_drawn, &passes, settings.park);
    let ordered = order::arrange(as_drawn, &passes, settings.park);
    let travel_mm = order::travel_mm(&ordered, &passes, settings.park);
    let contours = order::repeat(ordered, &passes);
    let park = settings.park;
    Ok(Toolpath { width_mm, height_mm, park, contours, travel_mm, travel_unordered_mm, max_kerf_deviation_mm })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn settings() -> Settings {
        let process = |feed_mm_per_min, power| Process { feed_mm_per_min, power, air: Air::Off, passes: 1 };
        Settings {
            kerf_mm: 0.15,
            engrave: Some(process(3000.0, 0.1)),
            cut_inner: process(900.0, 0.8),
            cut_outline: process(900.0, 0.8),
            work_area: Rect::from_size(400.0, 400.0),
            park: P2::origin(),
        }
    }

    fn drawn(path: Path, role: Role, kerf: KerfSide) -> DrawnPath {
        DrawnPath { path, role, kerf, joint: None }
    }

    fn piece(name: &str, x: f64, y: f64) -> Drawing {
        let p = |dx: f64, dy: f64| P2::new(x + dx, y + dy);
        let outline = Path::closed([p(0.0, 0.0), p(60.0, 0.0), p(60.0, 20.0), p(0.0, 20.0)]);
        let slit = Path::open([p(30.0, 5.0), p(30.0, 15.0)]);
        let mark = Path::open([p(10.0, 5.0), p(10.0, 15.0)]);
        let paths = vec![
            drawn(outline, Role::Outline, KerfSide::Outside),
            drawn(slit, Role::Slit, KerfSide::On),
            drawn(mark, Role::Mark, KerfSide::On),
            drawn(Path::circle(p(45.0, 10.0), 3.0), Role::Hole, KerfSide::Inside),
        ];
        Drawing { name: name.into(), paths }
    }

    fn sheet() -> Vec<Drawing> {
        vec![piece("A1", 10.0, 10.0), piece("A2", 200.0, 300.0), piece("A3", 10.0, 100.0), piece("A4", 100.0, 10.0)]
    }

    #[test]
    fn the_whole_sheet_is_engraved_then_cut_inside_then_freed_from_the_far_side() {
        let toolpath = plan(&sheet(), 400.0, 400.0, &settings()).unwrap();
        let operations: Vec<Operation> = toolpath.contours.iter().map(|c| c.operation).collect();
        assert!(operations.is_sorted());
        assert_eq!(operations.len(), 16);
        let outlines = toolpath.contours.iter().filter(|c| c.role == Role::Outline);
        assert_eq!(outlines.map(|c| c.piece.as_str()).collect::<Vec<_>>(), ["A2", "A4", "A3", "A1"]);
    }

    #[test]
    fn lengths_are_those_of_the_compensated_paths() {
        let toolpath = plan(&[piece("A1", 10.0, 10.0)], 400.0, 400.0, &settings()).unwrap();
        assert!((toolpath.engrave_mm() - 10.0).abs() < 1e-9);
        let rounded_outline = 160.0 + std::f64::consts::TAU * 0.075;
        let hole = std::f64::consts::TAU * (3.0 - 0.075);
        assert!((toolpath.cut_mm() - (rounded_outline + hole + 10.0)).abs() < 1e-6);
        assert!((toolpath.bounds().min - P2::new(9.925, 9.925)).norm() < 1e-6);
        assert!(toolpath.max_kerf_deviation_mm < 1e-6);
    }

    #[test]
    fn a_second_pass_runs_an_open_cut_back_without_travel() {
        let mut settings = settings();
        settings.cut_inner.passes = 2;
        let once = plan(&sheet(), 400.0, 400.0, &self::settings()).unwrap();
        let twice = plan(&sheet(), 400.0, 400.0, &settings).unwrap();
        let inner = |t: &Toolpath| t.length_mm(Operation::CutInner);
        assert!((inner(&twice) - 2.0 * inner(&once)).abs() < 1e-9);
        let slits: Vec<&Contour> = twice.contours.iter().filter(|c| c.role == Role::Slit).collect();
        assert_eq!(slits.len(), 8);
        for passes in slits.chunks(2) {
            assert_eq!(passes[0].piece, passes[1].piece);
            assert_eq!(passes[0].path.end(), passes[1].path.start());
        }
    }

    #[test]
    fn whatever_leaves_the_sheet_or_the_reach_is_refused_with_the_distance() {
        let far = plan(&[piece("A9", 345.0, 10.0)], 500.0, 400.0, &settings()).unwrap_err();
        assert!(matches!(&far, Error::Outside { limit: "work area", by_mm, .. } if (by_mm - 5.075).abs() < 1e-6));
        assert!(far.to_string().contains("A9"), "{far}");
        let off = plan(&[piece("A9", 10.0, 0.0)], 400.0, 400.0, &settings()).unwrap_err();
        assert!(matches!(&off, Error::Outside { limit: "sheet", by_mm, .. } if (by_mm - 0.075).abs() < 1e-6));
    }

    #[test]
    fn a_mark_is_never_cut_for_want_of_an_engraving() {
        let settings = Settings { engrave: None, ..settings() };
        let refused = plan(&sheet(), 400.0, 400.0, &settings).unwrap_err();
        assert!(matches!(refused, Error::NoProcess { role: "mark", .. }), "{refused}");
    }

    #[test]
    fn settings_out_of_range_are_refused() {
        let with = |change: &dyn Fn(&mut Settings)| {
            let mut settings = settings();
            change(&mut settings);
            plan(&[], 10.0, 10.0, &settings)
        };
        assert!(with(&|_| ()).is_ok());
        assert!(matches!(with(&|s| s.kerf_mm = -0.1), Err(Error::Setting { .. })));
        assert!(matches!(with(&|s| s.cut_inner.power = 1.1), Err(Error::Setting { .. })));
        assert!(matches!(with(&|s| s.cut_inner.feed_mm_per_min = 0.0), Err(Error::Setting { .. })));
        assert!(matches!(with(&|s| s.cut_outline.passes = 0), Err(Error::Setting { .. })));
        assert!(matches!(with(&|s| s.park.x = f64::NAN), Err(Error::Setting { .. })));
    }

    proptest! {
        #[test]
        fn ordering_keeps_every_contour_and_walks_what_it_reports(
            corners in prop::collection::vec((1.0..330.0f64, 1.0..370.0f64), 1..12),
        ) {
            let drawings: Vec<Drawing> =
                corners.iter().enumerate().map(|(i, (x, y))| piece(&format!("P{i}"), *x, *y)).collect();
            let toolpath = plan(&drawings, 400.0, 400.0, &settings()).unwrap();
            prop_assert_eq!(toolpath.contours.len(), 4 * drawings.len());
            for drawing in &drawings {
                for role in [Role::Outline, Role::Slit, Role::Mark, Role::Hole] {
                    let same = |c: &&Contour| c.piece == drawing.name && c.role == role;
                    prop_assert_eq!(toolpath.contours.iter().filter(same).count(), 1);
                }
            }
            let mut at = toolpath.park;
            let mut travel = 0.0;
            for contour in &toolpath.contours {
                travel += (contour.path.start().unwrap() - at).norm();
                at = contour.path.end().unwrap();
            }
            travel += (toolpath.park - at).norm();
            prop_assert!((travel - toolpath.travel_mm).abs() < 1e-6);
        }
    }
}
