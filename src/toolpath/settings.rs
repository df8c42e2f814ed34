//! What the material and the machine ask of a toolpath.

use super::Error;
use crate::drawing::Operation;
use crate::geom::{Motion, P2, Rect, V2};
use std::borrow::Cow;
use std::f64::consts::FRAC_PI_2;

/// How hard air assist blows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Air {
    /// Not at all.
    Off,
    /// Enough to keep smoke off the lens.
    Low,
    /// Enough to clear a deep cut.
    High,
}

/// One run along a contour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pass {
    /// Power as a fraction of the machine's full power, 0..=1.
    pub power: f64,
    /// How far below the first pass the tool is set, mm, at least 0.
    pub depth_mm: f64,
}

/// A dashed cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dashes {
    /// Length cut, mm.
    pub cut_mm: f64,
    /// Length left between two cuts, mm.
    pub gap_mm: f64,
}

/// How one operation is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Process {
    /// Feed, mm/min, above 0.
    pub feed_mm_per_min: f64,
    /// Runs along each contour, at least one. Open paths are run there and back.
    pub passes: Vec<Pass>,
    /// Air assist.
    pub air: Air,
    /// Perforation: every path is cut in dashes; `None` for a whole line.
    pub dashes: Option<Dashes>,
}

/// What touches the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tool {
    /// A beam.
    Laser {
        /// The tube that goes out at low power, if it does.
        strike: Option<Strike>,
    },
    /// A blade that trails the axis it swivels about.
    Knife {
        /// How far it trails, mm.
        offset_mm: f64,
    },
    /// A pen: draws the lines and cuts nothing.
    Pen,
}

/// What a tube needs to burn at all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strike {
    /// Share of full power below which the beam goes out.
    pub floor: f64,
    /// Acceleration of the slower axis, mm/s².
    pub acceleration_mm_per_s2: f64,
}

/// What of the drawings is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// Everything.
    All,
    /// Only what is engraved: another tool cuts.
    Marks,
    /// Only what is cut: another tool marks.
    Cuts,
}

/// Uncut stretches that hold a piece in its sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bridges {
    /// Width of sheet left, mm.
    pub width_mm: f64,
    /// Wanted distance from bridge to bridge along the contour, mm.
    pub pitch_mm: f64,
    /// True for a tick cut: bridges at even steps all the way, instead of on straight runs away from joints and bends.
    pub everywhere: bool,
}

/// A point of a box: 0 is left or lower, 0.5 the middle, 1 right or upper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
}

/// Which point lies at work X0 Y0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Zero {
    /// A point of the sheet: the sheet lies in a stop corner and the machine knows where that is.
    Sheet(Anchor),
    /// A point of the box around everything made: the user has put the head where that is to be.
    Job(Anchor),
}

/// How the sheet lies on the machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The sheet's x axis (a roll's feed) runs along the machine's y: the sheet is turned by a quarter counter-clockwise, never mirrored.
    pub turned: bool,
    /// Which point lies at work X0 Y0.
    pub zero: Zero,
    /// Where this tool works, seen from the tool that the machine's zero and reach are meant for, mm in the work frame.
    pub tip: V2,
}

/// A piece that is made in another way than the rest, to find out how that comes out.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// Name of the piece.
    pub piece: String,
    /// Feed, mm/min, above 0.
    pub feed_mm_per_min: f64,
    /// Power of every pass as a fraction of the machine's full power, 0..=1.
    pub power: f64,
}

/// Everything [`super::plan`] needs besides the drawings.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// What cuts or draws.
    pub tool: Tool,
    /// What of the drawings it makes.
    pub share: Share,
    /// Full width the tool removes, mm; paths move by half of it.
    pub kerf_mm: f64,
    /// Marks and lettering; `None` where the tool cannot mark the material, and then nothing may be engraved.
    pub engrave: Option<Process>,
    /// Flaps, slits and holes.
    pub cut_inner: Process,
    /// Outlines.
    pub cut_outline: Process,
    /// How far lines and arcs may leave the compensated path, mm; 0 keeps every corner.
    pub curve_tolerance_mm: f64,
    /// Pieces made in another way; none but on test cards.
    pub trials: Vec<Trial>,
    /// What holds outlines in the sheet; `None` for nothing.
    pub bridges: Option<Bridges>,
    /// True when something else holds the sheet (a mat, a vacuum table, a carrier): outlines need not be made from the far side.
    pub held: bool,
    /// Lead-in, and lead-out where a contour ends at its start, of closed contours, on scrap only, mm.
    pub lead_mm: f64,
    /// How far a closed contour is run beyond its start, mm.
    pub overcut_mm: f64,
    /// Each cut begins at least this far from where the last one ended, where the order permits, mm.
    pub cool_mm: f64,
    /// Straight edges that two outlines share are cut once.
    pub common_edges: bool,
    /// Two small crosses on scrap, made first, by which a sheet is found again.
    pub crosses: bool,
    /// Length of feed made before the next is begun, mm; `None` on a bed.
    pub window_mm: Option<f64>,
    /// The sheet is cut off across, last of all.
    pub cross_cut: bool,
    /// How the sheet lies on the machine.
    pub frame: Frame,
    /// What the head may reach, mm in the work frame.
    pub work_area: Rect,
    /// Where the head may not go, mm in the work frame: what stands on the bed too high to pass over, grown by the head's radius.
    pub keep_outs: Vec<(String, Rect)>,
    /// Where the tool starts and ends, mm in the work frame.
    pub park: P2,
}

impl Share {
    pub(super) fn holds(self, operation: Operation) -> bool {
        match self {
            Share::All => true,
            Share::Marks => operation == Operation::Engrave,
            Share::Cuts => operation != Operation::Engrave,
        }
    }
}

impl Anchor {
    /// Lower left.
    pub const LOWER_LEFT: Anchor = Anchor { x: 0.0, y: 0.0 };

    /// That point of a box.
    pub fn of(self, rect: &Rect) -> P2 {
        rect.min + V2::new(self.x * rect.width(), self.y * rect.height())
    }
}

impl Frame {
    /// Lower left corner of the sheet at work zero, sheet and machine the same way round.
    pub const PLAIN: Frame = Frame { turned: false, zero: Zero::Sheet(Anchor::LOWER_LEFT), tip: V2::new(0.0, 0.0) };

    /// From the sheet frame to the work frame, for a sheet of this size on which `job` is the box around everything made.
    pub fn motion(&self, sheet: &Rect, job: &Rect) -> Motion {
        let turn = Motion::new(V2::zeros(), if self.turned { FRAC_PI_2 } else { 0.0 });
        let turned = |rect: &Rect| {
            let round = |p: P2| (turn * p).map(snapped);
            Rect::EMPTY.with(round(rect.min)).with(round(rect.max))
        };
        let zero = match self.zero {
            Zero::Sheet(anchor) => anchor.of(&turned(sheet)),
            Zero::Job(anchor) => anchor.of(&turned(job)),
        };
        Motion::new(-zero.coords - self.tip, turn.rotation.angle())
    }
}

/// A quarter turn's sine is exact and its cosine is not: nothing is left of what lies below a picometre.
fn snapped(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

impl Process {
    /// Power of the first pass, 0..=1.
    pub fn power(&self) -> f64 {
        self.passes.first().map_or(0.0, |pass| pass.power)
    }

    /// True when power that follows speed would leave more than half a kerf unlit at the ends of a cut: under M4 power is p v / F, so the tube
    /// is out below v = F floor / p, which at acceleration a is reached after v² / 2a.
    pub(super) fn starves(&self, strike: &Strike, kerf_mm: f64) -> bool {
        let starving = |pass: &Pass| {
            let slow_mm_per_s = self.feed_mm_per_min / 60.0 * strike.floor / pass.power;
            pass.power > 0.0 && slow_mm_per_s.powi(2) / (2.0 * strike.acceleration_mm_per_s2) > 0.5 * kerf_mm
        };
        self.passes.iter().any(starving)
    }
}

impl Settings {
    /// How an operation is made, if it is.
    pub fn process(&self, operation: Operation) -> Option<&Process> {
        match operation {
            Operation::Engrave => self.engrave.as_ref(),
            Operation::CutInner => Some(&self.cut_inner),
            Operation::CutOutline => Some(&self.cut_outline),
        }
    }

    /// How an operation is made on one piece, if it is.
    pub(super) fn process_on(&self, piece: &str, operation: Operation) -> Option<Cow<'_, Process>> {
        let usual = self.process(operation)?;
        let Some(trial) = self.trials.iter().find(|trial| trial.piece == piece) else {
            return Some(Cow::Borrowed(usual));
        };
        let tried = |pass: &Pass| Pass { power: trial.power, ..*pass };
        let passes = usual.passes.iter().map(tried).collect();
        Some(Cow::Owned(Process { feed_mm_per_min: trial.feed_mm_per_min, passes, ..usual.clone() }))
    }

    /// How far the blade trails its axis, mm; 0 for what is no knife.
    pub(super) fn blade_mm(&self) -> f64 {
        match self.tool {
            Tool::Knife { offset_mm } => offset_mm,
            Tool::Laser { .. } | Tool::Pen => 0.0,
        }
    }

    /// True when this process needs the same power at any speed.
    pub fn constant_power(&self, process: &Process) -> bool {
        match self.tool {
            Tool::Laser { strike: Some(strike) } => process.starves(&strike, self.kerf_mm),
            _ => false,
        }
    }

    /// Refuses what no machine can do.
    pub(super) fn check(&self) -> Result<(), Error> {
        let require = |holds: bool, name: &str, value: f64, needed: &'static str| match holds {
            true => Ok(()),
            false => Err(Error::Setting { name: name.to_string(), value, needed }),
        };
        let lengths = [
            ("kerf_mm", self.kerf_mm),
            ("curve_tolerance_mm", self.curve_tolerance_mm),
            ("lead_mm", self.lead_mm),
            ("overcut_mm", self.overcut_mm),
            ("cool_mm", self.cool_mm),
            ("blade offset_mm", self.blade_mm()),
        ];
        for (name, value) in lengths {
            require(value.is_finite() && value >= 0.0, name, value, "a finite length of at least 0 mm")?;
        }
        require(self.park.x.is_finite(), "park x", self.park.x, "a finite position")?;
        require(self.park.y.is_finite(), "park y", self.park.y, "a finite position")?;
        if let Some(window) = self.window_mm {
            require(window.is_finite() && window > 0.0, "window_mm", window, "a length above 0 mm")?;
        }
        if let Some(Bridges { width_mm, pitch_mm, .. }) = self.bridges {
            require(width_mm > 0.0 && width_mm.is_finite(), "bridge width_mm", width_mm, "a width above 0 mm")?;
            require(pitch_mm > width_mm && pitch_mm.is_finite(), "bridge pitch_mm", pitch_mm, "more than the width")?;
        }
        for Trial { piece, feed_mm_per_min: feed, power } in &self.trials {
            require(
                feed.is_finite() && *feed > 0.0,
                &format!("{piece} feed_mm_per_min"),
                *feed,
                "a feed above 0 mm/min",
            )?;
            require((0.0..=1.0).contains(power), &format!("{piece} power"), *power, "a fraction from 0 to 1")?;
        }
        for operation in Operation::ALL {
            let Some(process) = self.process(operation) else { continue };
            let named = |key: &str| format!("{} {key}", operation.id());
            let feed = process.feed_mm_per_min;
            require(feed.is_finite() && feed > 0.0, &named("feed_mm_per_min"), feed, "a feed above 0 mm/min")?;
            require(!process.passes.is_empty(), &named("passes"), 0.0, "at least 1 pass")?;
            for Pass { power, depth_mm } in &process.passes {
                require((0.0..=1.0).contains(power), &named("power"), *power, "a fraction from 0 to 1")?;
                require(*depth_mm >= 0.0 && depth_mm.is_finite(), &named("depth_mm"), *depth_mm, "at least 0 mm")?;
            }
            if let Some(Dashes { cut_mm, gap_mm }) = process.dashes {
                require(cut_mm > 0.0 && cut_mm.is_finite(), &named("dash cut_mm"), cut_mm, "a length above 0 mm")?;
                require(gap_mm > 0.0 && gap_mm.is_finite(), &named("dash gap_mm"), gap_mm, "a length above 0 mm")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_sheet_keeps_its_handedness_and_its_corner_at_zero() {
        let sheet = Rect::from_size(1000.0, 570.0);
        let frame = Frame { turned: true, ..Frame::PLAIN };
        let motion = frame.motion(&sheet, &sheet);
        // The feed runs along y; what lay lower now lies right.
        let at = |x: f64, y: f64| motion * P2::new(x, y);
        assert!((at(0.0, 570.0) - P2::origin()).norm() < 1e-9);
        assert!((at(0.0, 0.0) - P2::new(570.0, 0.0)).norm() < 1e-9);
        assert!((at(1000.0, 0.0) - P2::new(570.0, 1000.0)).norm() < 1e-9);
    }

    #[test]
    fn any_of_nine_points_of_sheet_or_job_comes_to_lie_at_zero() {
        let sheet = Rect::from_size(300.0, 200.0);
        let job = Rect { min: P2::new(20.0, 30.0), max: P2::new(120.0, 90.0) };
        for x in [0.0, 0.5, 1.0] {
            for y in [0.0, 0.5, 1.0] {
                let anchor = Anchor { x, y };
                let on_sheet = Frame { zero: Zero::Sheet(anchor), ..Frame::PLAIN }.motion(&sheet, &job);
                assert!((on_sheet * anchor.of(&sheet)).coords.norm() < 1e-9);
                let on_job = Frame { zero: Zero::Job(anchor), ..Frame::PLAIN }.motion(&sheet, &job);
                assert!((on_job * anchor.of(&job)).coords.norm() < 1e-9);
            }
        }
    }

    #[test]
    fn a_tube_starves_at_the_ends_of_weak_fast_cuts_and_a_diode_does_not() {
        let process = |power, feed_mm_per_min| Process {
            feed_mm_per_min,
            passes: vec![Pass { power, depth_mm: 0.0 }],
            air: Air::Low,
            dashes: None,
        };
        let tube = Strike { floor: 0.10, acceleration_mm_per_s2: 500.0 };
        assert!(process(0.13, 2700.0).starves(&tube, 0.17), "1.2 mm unlit");
        assert!(!process(0.60, 600.0).starves(&tube, 0.17));
        let diode = Strike { floor: 0.03, acceleration_mm_per_s2: 500.0 };
        assert!(!process(0.50, 1200.0).starves(&diode, 0.15));
    }
}
