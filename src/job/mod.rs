//! Chains the stages: a design becomes parts, pieces, sheets, programs and files.
//!
//! ```text
//! Design --realise--> Parts --strips--> Pieces --sheets--> Layouts, Programs --artifacts--> files
//! ```
//!
//! [`realise()`] is the one meaning of a design. `settings` is the only place where machine and profile become the stages' settings. Files are staged in
//! their folder and renamed at the end, so a failure leaves what was there before.

mod artifacts;
mod assembly;
mod bodies;
mod border;
mod cards;
mod change;
mod dry_run;
mod edits;
mod error;
mod label;
mod machining;
mod nested;
mod offcuts;
mod order;
mod output;
mod pictures;
mod probe;
mod program;
mod proposal;
mod realise;
mod report;
mod ruffle_json;
mod settings;
mod shape;
mod sheets;
mod standing;
mod stock;
mod strips;
mod survey;
mod ties;

pub use crate::ruffle::Role as SectionRole;
pub use border::take_in;
pub use cards::{Learnt, TestCard, learnt, test_card};
pub use change::{Changed, Cut, Places, Request, change};
pub use dry_run::{Form, Look, Looked, look, look_back};
pub use error::Error;
pub use label::{Label, SheetLabel};
pub use nested::{Nestable, Nested, nestables, offcut_stock, write_nested};
pub use order::{Batch, Order, Overrides, Source, StartFrom};
pub use probe::{Difference, differences, machine_file, probed};
pub use realise::{Realised, realise};
pub use report::{Report, SheetReport};
pub use settings::{check_settings, expected, limits};
pub use sheets::minutes;
pub use survey::{PartSurvey, SectionSurvey, Survey, survey};

pub use crate::toolpath::Anchor;

use crate::config::Library;
use crate::progress::{Observer, Progress, Warning};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The last stage's name in its progress: from here on files are written.
pub const WRITING: &str = "writing";

/// What a finished job tells its caller.
#[derive(Debug, Clone)]
pub struct Made {
    /// Everything in report.json.
    pub report: Report,
    /// Files written, relative to the output folder, in writing order.
    pub files: Vec<PathBuf>,
}

/// Does everything up to files in `out_dir`.
pub fn make(order: &Order, library: &Library, out_dir: &Path, observer: &mut dyn Observer) -> Result<Made, Error> {
    let began = Instant::now();
    let mut observer = Watch { inner: observer, stopped: false };
    let setup = settings::Setup::new(&order.design, library)?;
    output::refuse_foreign_design(out_dir, order)?;
    let realised = realise(&order.design, &order.folder, &setup, &mut observer).map_err(|e| order.placed(e))?;
    let nesting = Instant::now();
    let mut strips = strips::strips(&realised, &setup)?;
    strips.keep_only(&order.batch.only)?;
    let sheets = sheets::sheets(&strips, &setup, order, &mut observer)?;
    let nest_ms = nesting.elapsed().as_secs_f64() * 1e3;

    let mut warnings: Vec<Warning> = setup.warnings.clone();
    warnings.extend(realised.warnings.iter().cloned());
    warnings.extend(strips.warnings.iter().cloned());
    warnings.extend(sheets.warnings.iter().cloned());
    warnings.extend(dry_run::warning(&sheets.sheets));
    if observer.stopped {
        warnings.push(Warning::new("stopped-early", "stopped by you: this is the best found until then"));
    }
    let timing = report::Timing { solve_ms: realised.solve_ms, fit_ms: realised.fit_ms, nest_ms, wall_s: 0.0 };
    let mut report = report::report(&setup, &realised, &strips, &sheets, warnings, timing);
    // Nothing can be left out from here on, so a stop is not asked for.
    let _ = observer.step(Progress { stage: WRITING, done: 0, total: 0, note: String::new() });
    let mut stage = output::Stage::new(out_dir)?;
    artifacts::write(&mut stage, order, &setup, &realised, &strips, &sheets, &mut observer)?;
    report.timing.wall_s = began.elapsed().as_secs_f64();
    stage.write("report.json", report.to_json().as_bytes())?;
    let files = stage.publish()?;
    Ok(Made { report, files })
}

/// Remembers that the user asked to stop.
struct Watch<'a> {
    inner: &'a mut dyn Observer,
    stopped: bool,
}

impl Observer for Watch<'_> {
    fn step(&mut self, progress: Progress) -> ControlFlow<()> {
        let answer = self.inner.step(progress);
        self.stopped |= answer.is_break();
        answer
    }
}
