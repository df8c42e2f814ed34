//! What the material and the machine ask of a toolpath.

use super::Error;
use crate::drawing::Operation;
use crate::geom::{P2, Rect};

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

/// How one operation is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Process {
    /// Feed, mm/min, above 0.
    pub feed_mm_per_min: f64,
    /// Power as a fraction of the machine's full power, 0..=1.
    pub power: f64,
    /// Air assist.
    pub air: Air,
    /// Runs along each contour, at least 1. Open paths are run there and back.
    pub passes: u32,
}

/// Everything [`super::plan`] needs besides the drawings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Full width the tool removes, mm; paths move by half of it.
    pub kerf_mm: f64,
    /// Marks and lettering; `None` where the tool cannot mark the material, and then nothing may be engraved.
    pub engrave: Option<Process>,
    /// Flaps, slits and holes.
    pub cut_inner: Process,
    /// Outlines.
    pub cut_outline: Process,
    /// What the head may reach, mm in the sheet frame.
    pub work_area: Rect,
    /// Where the tool starts and ends, mm in the sheet frame; outlines are made from the far side toward it.
    pub park: P2,
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

    /// Refuses what no machine can do.
    pub(super) fn check(&self) -> Result<(), Error> {
        let require = |holds: bool, name: &str, value: f64, needed: &'static str| match holds {
            true => Ok(()),
            false => Err(Error::Setting { name: name.to_string(), value, needed }),
        };
        let kerf = self.kerf_mm;
        require(kerf.is_finite() && kerf >= 0.0, "kerf_mm", kerf, "a finite width of at least 0 mm")?;
        require(self.park.x.is_finite(), "park x", self.park.x, "a finite position")?;
        require(self.park.y.is_finite(), "park y", self.park.y, "a finite position")?;
        for operation in Operation::ALL {
            let Some(process) = self.process(operation) else { continue };
            let Process { feed_mm_per_min: feed, power, passes, .. } = *process;
            let named = |key: &str| format!("{} {key}", operation.id());
            require(feed.is_finite() && feed > 0.0, &named("feed_mm_per_min"), feed, "a feed above 0 mm/min")?;
            require((0.0..=1.0).contains(&power), &named("power"), power, "a fraction from 0 to 1")?;
            require(passes >= 1, &named("passes"), f64::from(passes), "at least 1 pass")?;
        }
        Ok(())
    }
}
