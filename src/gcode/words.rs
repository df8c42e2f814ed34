//! What one line says, before it is carried out: its words sorted by meaning.

use super::trace::TraceProblem;
use super::{Line, Word};

/// How the tool moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    Rapid,
    Line,
    ArcClockwise,
    ArcCounterClockwise,
    /// G80: axis words are then an error.
    Cancelled,
}

/// A line's words by meaning; `None` where it says nothing.
#[derive(Debug, Default)]
pub(super) struct Said {
    pub(super) motion: Option<Motion>,
    pub(super) inches: Option<bool>,
    pub(super) incremental: Option<bool>,
    pub(super) dwell: bool,
    /// 3, 4 or 5.
    pub(super) spindle: Option<u8>,
    /// Coolant words in order: 7, 8 or 9.
    pub(super) coolant: Vec<u8>,
    pub(super) pause: bool,
    pub(super) end: bool,
    pub(super) x: Option<f64>,
    pub(super) y: Option<f64>,
    pub(super) z: Option<f64>,
    pub(super) i: Option<f64>,
    pub(super) j: Option<f64>,
    pub(super) f: Option<f64>,
    pub(super) s: Option<f64>,
    pub(super) p: Option<f64>,
}

impl Said {
    pub(super) fn of(line: &Line) -> Result<Said, TraceProblem> {
        let mut said = Said::default();
        for word in &line.words {
            match word.letter {
                'G' => said.g_word(word)?,
                'M' => said.m_word(word)?,
                'X' => once(&mut said.x, word)?,
                'Y' => once(&mut said.y, word)?,
                'Z' => once(&mut said.z, word)?,
                'I' => once(&mut said.i, word)?,
                'J' => once(&mut said.j, word)?,
                'F' => once(&mut said.f, word)?,
                'S' => once(&mut said.s, word)?,
                'P' => once(&mut said.p, word)?,
                // Line numbers and tool numbers change nothing here.
                'N' | 'T' => {}
                _ => return Err(TraceProblem::Unsupported(*word)),
            }
        }
        match [said.f, said.s, said.p].into_iter().flatten().find(|v| *v < 0.0) {
            Some(value) => Err(TraceProblem::Negative(value)),
            None => Ok(said),
        }
    }

    /// True when a position is given.
    pub(super) fn has_axes(&self) -> bool {
        self.x.is_some() || self.y.is_some() || self.z.is_some()
    }

    fn g_word(&mut self, word: &Word) -> Result<(), TraceProblem> {
        let clash = TraceProblem::Clash(*word);
        // Tenths tell G91 from G91.1.
        match (word.value * 10.0).round() as i64 {
            _ if (word.value * 10.0).fract() != 0.0 => Err(TraceProblem::Unsupported(*word)),
            0 => set(&mut self.motion, Motion::Rapid, clash),
            10 => set(&mut self.motion, Motion::Line, clash),
            20 => set(&mut self.motion, Motion::ArcClockwise, clash),
            30 => set(&mut self.motion, Motion::ArcCounterClockwise, clash),
            800 => set(&mut self.motion, Motion::Cancelled, clash),
            200 => set(&mut self.inches, true, clash),
            210 => set(&mut self.inches, false, clash),
            900 => set(&mut self.incremental, false, clash),
            910 => set(&mut self.incremental, true, clash),
            40 => {
                self.dwell = true;
                Ok(())
            }
            // The XY plane, no cutter compensation, no tool length, the first work offset, exact path, incremental arc centres, feed per
            // minute: the only states this house uses, and GRBL's states at start.
            170 | 400 | 490 | 540 | 610 | 911 | 940 => Ok(()),
            _ => Err(TraceProblem::Unsupported(*word)),
        }
    }

    fn m_word(&mut self, word: &Word) -> Result<(), TraceProblem> {
        match word.value {
            0.0 | 1.0 => self.pause = true,
            2.0 | 30.0 => self.end = true,
            3.0 | 4.0 | 5.0 => set(&mut self.spindle, word.value as u8, TraceProblem::Clash(*word))?,
            7.0 | 8.0 | 9.0 => self.coolant.push(word.value as u8),
            _ => return Err(TraceProblem::Unsupported(*word)),
        }
        Ok(())
    }
}

fn once(slot: &mut Option<f64>, word: &Word) -> Result<(), TraceProblem> {
    set(slot, word.value, TraceProblem::Repeated(*word))
}

fn set<T>(slot: &mut Option<T>, value: T, problem: TraceProblem) -> Result<(), TraceProblem> {
    match slot.replace(value) {
        None => Ok(()),
        Some(_) => Err(problem),
    }
}
