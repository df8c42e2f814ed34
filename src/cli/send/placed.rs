//! Programs that lie elsewhere than at work zero: written anew where they are to lie, and checked there.

use super::super::Failure;
use super::super::placing::{corner, knows_place};
use super::Sending;
use crate::gcode::{CheckSettings, Restart, Rewriter};
use crate::geom::{P2, P3, Similarity, V2};
use crate::job;

impl Sending<'_> {
    /// Lays every program where the arguments say. False when the user has broken it off.
    ///
    /// # Errors
    /// It cannot lie there.
    pub(super) fn place_programs(&mut self) -> Result<bool, Failure> {
        if !self.args.placing.is_asked_for() {
            return Ok(true);
        }
        for k in 0..self.programs.len() {
            let crosses_mm = self.programs[k].crosses_mm;
            let keyboard = self.keyboard.as_ref();
            let placing = self.args.placing.solve(crosses_mm, &mut self.talk, &self.machine, keyboard)?;
            let Some(placing) = placing else { return Ok(false) };
            self.lay(k, P3::origin(), placing, None)?;
        }
        Ok(true)
    }

    /// Writes a program anew: each of its places carried by `placing`, from `from` on, its head standing at `start_mm` of its own coordinates first.
    ///
    /// # Errors
    /// It cannot be written anew, or must not lie there.
    pub(super) fn lay(
        &mut self,
        k: usize,
        start_mm: P3,
        placing: Similarity,
        from: Option<Restart>,
    ) -> Result<(), Failure> {
        let rewriter = Rewriter::new(start_mm, placing, self.machine.tool.class.is_laser(), from);
        let path = self.scratch.path().join(format!("{k}.nc"));
        self.programs[k] = self.programs[k].rewritten(rewriter, &placing, &path, &self.settings_here()?)?;
        Ok(())
    }

    /// What the machine permits, in work coordinates as they are now where the machine knows its place; else with work zero in its corner.
    fn settings_here(&self) -> Result<CheckSettings, Failure> {
        let mut settings = job::check_settings(&self.machine, None);
        if knows_place(&self.talk) {
            let by: V2 = corner(&self.talk, &self.machine)? - P2::origin();
            for area in settings.keep_outs.iter_mut().map(|(_, area)| area).chain([&mut settings.work_area]) {
                (area.min, area.max) = (area.min + by, area.max + by);
            }
        }
        Ok(settings)
    }
}
