//! From placed drawings to what the tool follows: kerf, curves, bridges, order, passes, leads, blade, travel, limits.
//!
//! [`plan`] takes drawings that lie in the sheet frame (origin bottom left, x right, y up, mm) and gives runs in the work frame of the machine:
//!
//! ```text
//! drawings --turned and shifted (settings)--> work frame
//!   --half a kerf to the waste (kerf)--> --lines and arcs (smooth)--> --shared edges (common), bridges--> cuts
//!   --tour: engrave, inner, outlines (order, tour)--> --stretches, dashes, passes, leads (runs, lead)--> runs
//!   --crosses, cross-cut--> --blade ahead of its tip (knife)--> --round what stands on the bed (travel)--> --inside everything (limits)--> Toolpath
//! ```

mod bridges;
mod common;
mod crosses;
mod curve;
mod cuts;
mod error;
mod kerf;
mod knife;
mod lead;
mod limits;
mod mitre;
mod order;
mod runs;
mod settings;
mod smooth;
mod tour;
mod travel;

pub use error::Error;
pub use settings::{Air, Anchor, Bridges, Dashes, Frame, Pass, Process, Settings, Share, Strike, Tool, Trial, Zero};

use crate::drawing::{Drawing, DrawnPath, KerfSide, Operation, Role};
use crate::geom::{Motion, P2, Path, Rect};
use crate::progress::Warning;
use lead::Scrap;

/// One run of the tool along a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    /// What the middle of the tool (of a knife, the axis it swivels about) follows, kerf included, mm in the work frame, from where the tool enters.
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
    /// True where power that follows speed would leave the ends uncut.
    pub constant_power: bool,
    /// How far below the first pass the tool is set, mm.
    pub depth_mm: f64,
    /// Air assist.
    pub air: Air,
    /// Corners of the way to its start, round what stands on the bed; mostly none.
    pub way: Vec<P2>,
}

/// Everything the tool does on one sheet, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Toolpath {
    /// Extent of the sheet along x of the sheet frame, mm.
    pub width_mm: f64,
    /// Extent of the sheet along y of the sheet frame, mm.
    pub height_mm: f64,
    /// From the sheet frame to the work frame.
    pub motion: Motion,
    /// Where the tool starts and ends, mm in the work frame.
    pub park: P2,
    /// Runs in order; a contour made in several passes, or with bridges, is there several times.
    pub contours: Vec<Contour>,
    /// Corners of the way home, round what stands on the bed; mostly none.
    pub home: Vec<P2>,
    /// Middles of the alignment crosses, mm in the work frame; none or two.
    pub crosses: Vec<P2>,
    /// Length of all moves between contours, from the park point and back to it, mm.
    pub travel_mm: f64,
    /// The same for the order of the drawings inside each operation, every path as drawn, mm.
    pub travel_unordered_mm: f64,
    /// Greatest difference found between a compensated path's distance to its nominal curve and half the kerf, mm.
    pub max_kerf_deviation_mm: f64,
    /// Greatest distance of the lines and arcs made from the compensated path they stand for, mm.
    pub max_curve_deviation_mm: f64,
    /// What the user should know.
    pub warnings: Vec<Warning>,
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
/// Settings out of range; a path that is no curve; a kerf that a path cannot be compensated for; a run outside the sheet or the work area, or
/// where something stands on the bed. Errors about a path name its piece and role.
pub fn plan(drawings: &[Drawing], width_mm: f64, height_mm: f64, settings: &Settings) -> Result<Toolpath, Error> {
    settings.check()?;
    let sheet = Rect::from_size(width_mm, height_mm);
    let job = drawings.iter().fold(Rect::EMPTY, |rect, d| rect.union(d.bounds())).grown(0.5 * settings.kerf_mm);
    let motion = settings.frame.motion(&sheet, if job.is_empty() { &sheet } else { &job });
    let placed: Vec<Drawing> = drawings.iter().map(|drawing| drawing.moved(&motion)).collect();
    let corners = |rect: &Rect| [rect.min, rect.max];
    let feed_of = |rect: &Rect| corners(rect).iter().map(|p| (motion.inverse() * p).x).fold(0.0, f64::max);
    let made = cuts::cuts(&placed, settings, &feed_of)?;
    let mut warnings = made.warnings;

    let scrap = Scrap::of(&placed, settings);
    let on_machine = Rect::EMPTY.with(motion * sheet.min).with(motion * sheet.max);
    // A roll is not fed far forward and back again for a mark.
    let begun = P2::new(settings.window_mm.unwrap_or(width_mm).min(width_mm), height_mm);
    let begun = Rect::EMPTY.with(motion * sheet.min).with(motion * begun);
    let marked = settings.crosses && matches!(settings.frame.zero, Zero::Sheet(_)) && !made.cuts.is_empty();
    let field = Rect { min: begun.min.sup(&settings.work_area.min), max: begun.max.inf(&settings.work_area.max) };
    let crosses = if marked { crosses::places(&field, scrap.pieces(), &settings.keep_outs) } else { None };
    if marked && crosses.is_none() {
        let message = "no room on the scrap for two alignment crosses: a stopped job cannot be found again by them; use a wider margin";
        warnings.push(Warning::new("no-crosses", message));
    }
    let marks: Vec<Contour> = crosses.iter().flat_map(|places| crosses::strokes(places, settings)).collect();
    let from = marks.last().and_then(|mark| mark.path.end()).unwrap_or(settings.park);
    let whole = |runs: Vec<Contour>| {
        let last = settings.cross_cut.then(|| cross_cut(&job, &sheet, &motion, settings));
        let mut runs: Vec<Contour> = marks.iter().cloned().chain(runs).chain(last).collect();
        if settings.blade_mm() > 0.0 {
            knife::drag(&mut runs, settings.blade_mm());
        }
        runs
    };
    let as_drawn = whole(order::as_drawn(&made.cuts, settings, &scrap));
    let mut contours = whole(order::arranged(&made.cuts, from, settings, &scrap));
    limits::check(&contours, &on_machine, settings)?;
    let home = travel::route(&mut contours, &settings.keep_outs, &settings.work_area, settings.park)?;
    Ok(Toolpath {
        width_mm,
        height_mm,
        motion,
        park: settings.park,
        travel_mm: travel::length_mm(&contours, &home, settings.park),
        travel_unordered_mm: travel::length_mm(&as_drawn, &[], settings.park),
        contours,
        home,
        crosses: crosses.map_or_else(Vec::new, |places| places.to_vec()),
        max_kerf_deviation_mm: made.max_kerf_deviation_mm,
        max_curve_deviation_mm: made.max_curve_deviation_mm,
        warnings,
    })
}

/// Room between the last piece and the cut across, mm.
const CROSS_CUT_CLEAR_MM: f64 = 5.0;

/// Cuts the sheet off behind what was made, from rim to rim of what the tool reaches: a blade's axis needs its trail of that.
fn cross_cut(job: &Rect, sheet: &Rect, motion: &Motion, settings: &Settings) -> Contour {
    let x = (job.max.x + CROSS_CUT_CLEAR_MM).min(sheet.max.x);
    let process = &settings.cut_outline;
    let (from, to) = (sheet.min.y + settings.blade_mm(), sheet.max.y - settings.blade_mm());
    Contour {
        path: Path::open([P2::new(x, from), P2::new(x, to)]).moved(motion),
        operation: Operation::CutOutline,
        role: Role::Outline,
        piece: "cross-cut".into(),
        joint: None,
        feed_mm_per_min: process.feed_mm_per_min,
        power: process.power(),
        constant_power: settings.constant_power(process),
        depth_mm: 0.0,
        air: process.air,
        way: Vec::new(),
    }
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
