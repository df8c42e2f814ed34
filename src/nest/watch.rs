//! How long to go on: the effort, and the caller who may stop the search.

use super::scene::Scene;
use crate::progress::{Observer, Progress};

/// Knows when it is enough.
pub(super) struct Watch<'a> {
    observer: &'a mut dyn Observer,
    effort: u64,
    note: String,
    /// The caller has had enough.
    pub(super) stopped: bool,
}

impl<'a> Watch<'a> {
    pub(super) fn new(observer: &'a mut dyn Observer, effort: u64) -> Watch<'a> {
        Watch { observer, effort, note: String::new(), stopped: false }
    }

    /// The figure that people watch.
    pub(super) fn tell(&mut self, note: String) {
        self.note = note;
    }

    /// True when so many lines are looked along or the caller stops the search.
    pub(super) fn is_over(&mut self, scene: &Scene, until: u64) -> bool {
        if !self.stopped && scene.looked < until {
            let done = scene.looked.min(self.effort);
            let progress = Progress { stage: "nesting", done, total: self.effort, note: self.note.clone() };
            self.stopped = self.observer.step(progress).is_break();
        }
        self.stopped || scene.looked >= until
    }
}
