//! Programs that lie elsewhere than at work zero: written anew where they are to lie, and checked there.

use super::super::Failure;
use super::super::placing::settings_here;
use super::Sending;
use crate::gcode::{Restart, Rewriter};
use crate::geom::{P3, Similarity};

impl Sending<'_> {
    /// Lays the programs where the arguments say: all of them, or the first where each sheet is aligned when it lies on the bed. False when the user
    /// has broken it off.
    ///
    /// # Errors
    /// They cannot lie there.
    pub(super) fn place_programs(&mut self) -> Result<bool, Failure> {
        let placing = &self.args.placing;
        let sheets = if placing.is_aligned() { 1 } else { self.programs.len() };
        if !placing.is_asked_for() {
            self.placed = sheets;
            return Ok(true);
        }
        for _ in 0..sheets {
            if !self.place_next()? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Lays the next program where the arguments say. False when the user has broken it off.
    ///
    /// # Errors
    /// It cannot lie there.
    pub(super) fn place_next(&mut self) -> Result<bool, Failure> {
        let k = self.placed;
        let (crosses_mm, keyboard) = (self.programs[k].crosses_mm, self.keyboard.as_ref());
        let placing = self.args.placing.solve(crosses_mm, &mut self.talk, &self.machine, keyboard)?;
        let Some(placing) = placing else { return Ok(false) };
        self.lay(k, P3::origin(), placing, None)?;
        self.placed = k + 1;
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
        let settings = settings_here(&self.talk, &self.machine)?;
        self.programs[k] = self.programs[k].rewritten(rewriter, &placing, &path, &settings)?;
        Ok(())
    }
}
