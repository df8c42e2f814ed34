//! Long work on the screen: a bar on stderr, and what Ctrl-C means.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use indicatif::{ProgressBar, ProgressStyle};

use super::{Exit, Failure};
use crate::job;
use crate::progress::{Observer, Progress};

/// How often the user pressed Ctrl-C.
static INTERRUPTS: AtomicU32 = AtomicU32::new(0);

/// True once files are being written.
static WRITING: AtomicBool = AtomicBool::new(false);

/// First Ctrl-C: go on with the best so far. Second: end at once; nothing is written before everything is.
fn listen_for_interrupts() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        // What is being written takes a moment and is put in place as one: that is finished.
        if INTERRUPTS.fetch_add(1, Ordering::SeqCst) > 0 && !WRITING.load(Ordering::SeqCst) {
            eprintln!("furbelow: stopped, nothing was written");
            std::process::exit(Exit::STOPPED);
        }
    })
    .map_err(Failure::config)
}

/// Shows progress on stderr when that is a terminal, and passes a Ctrl-C on.
pub(super) struct Screen {
    bar: ProgressBar,
    stage: &'static str,
}

impl Screen {
    /// Starts showing, and listening for Ctrl-C.
    pub fn open() -> Result<Screen, Failure> {
        listen_for_interrupts()?;
        let bar = ProgressBar::new(0);
        // Literal templates: they cannot fail to parse.
        if let Ok(style) = ProgressStyle::with_template("{prefix:<9} {bar:30} {msg}") {
            bar.set_style(style);
        }
        Ok(Screen { bar, stage: "" })
    }

    /// Takes the bar away.
    pub fn close(&self) {
        self.bar.finish_and_clear();
    }
}

impl Observer for Screen {
    fn step(&mut self, progress: Progress) -> ControlFlow<()> {
        if progress.stage != self.stage {
            self.stage = progress.stage;
            self.bar.set_prefix(progress.stage);
            WRITING.store(progress.stage == job::WRITING, Ordering::SeqCst);
        }
        self.bar.set_length(progress.total.max(1));
        self.bar.set_position(progress.done);
        self.bar.set_message(progress.note);
        if INTERRUPTS.load(Ordering::SeqCst) > 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
