//! What a user is told while a job is sent: JSON events, one line that is updated on a terminal, or a log.

use std::io::Write;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use super::super::{Failure, output};
use crate::job::minutes;
use crate::stream::{Ending, Outcome, Outlook, Progress, Status};

/// Steps of the progress bar.
const BAR_STEPS: f64 = 1000.0;

/// A log gets a line for every so many percent.
const LOG_PERCENT: u32 = 5;

/// Tells, in the form that suits whoever listens.
pub(super) struct Teller {
    form: Form,
    began: Instant,
    /// S word of full power.
    max_s: f64,
    /// The sheet on its way and how many there are, from 1.
    sheet: (usize, usize),
    status: Option<Status>,
    /// Feed override last reported, %.
    feed_percent: u16,
    progress: Progress,
    outlook: Option<Outlook>,
    ending: Option<Ending>,
}

enum Form {
    /// For scripts, on stdout.
    Json,
    /// On stderr, where that is a terminal.
    Bar(ProgressBar),
    /// On stdout; the last step of progress that was told.
    Log(Option<u32>),
}

impl Teller {
    /// Nothing told yet.
    pub(super) fn new(as_json: bool, max_s: f64) -> Teller {
        let bar = ProgressBar::new(BAR_STEPS as u64);
        // A literal template: it cannot fail to parse.
        if let Ok(style) = ProgressStyle::with_template("{prefix} {bar:16} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        let form = match as_json {
            true => Form::Json,
            false if bar.is_hidden() => Form::Log(None),
            false => Form::Bar(bar),
        };
        let (began, progress) = (Instant::now(), Progress::default());
        Teller {
            form,
            began,
            max_s,
            sheet: (0, 0),
            status: None,
            feed_percent: 100,
            progress,
            outlook: None,
            ending: None,
        }
    }

    /// Since it all began.
    pub(super) fn now(&self) -> Duration {
        self.began.elapsed()
    }

    /// For whoever sits there, never for scripts: questions, checklists, what is typed.
    pub(super) fn say(&self, text: &str) {
        match &self.form {
            Form::Bar(bar) if !bar.is_finished() && self.status.is_some() => bar.println(text),
            // Nobody is left to tell when stderr is gone; the machine comes first.
            _ => drop(writeln!(std::io::stderr(), "{text}")),
        }
    }

    /// What the user should know before it begins.
    pub(super) fn warn(&self, code: &str, message: &str) -> Result<(), Failure> {
        match &self.form {
            Form::Json => self.event("warning", json!({ "code": code, "message": message })),
            _ => {
                self.say(&format!("warning: {message}"));
                Ok(())
            }
        }
    }

    /// Something the board says, or that has happened.
    pub(super) fn note(&self, event: &str, message: &str) -> Result<(), Failure> {
        match &self.form {
            Form::Json => self.event(event, json!({ "message": message })),
            Form::Bar(_) => {
                self.say(message);
                Ok(())
            }
            Form::Log(_) => output::line(message),
        }
    }

    /// A sheet is about to be cut.
    pub(super) fn begins(
        &mut self,
        sheet: (usize, usize),
        file: &str,
        lines: usize,
        time_s: f64,
    ) -> Result<(), Failure> {
        (self.sheet, self.progress, self.outlook) = (sheet, Progress::default(), None);
        let (number, of) = sheet;
        match &mut self.form {
            Form::Json => return self.event("sheet", json!({ "file": file, "lines": lines, "time_s": time_s })),
            Form::Bar(bar) => {
                bar.set_prefix(format!("sheet {number}/{of}"));
                bar.set_message("");
                bar.reset();
            }
            Form::Log(told) => *told = None,
        }
        output::line(&format!("sheet {number} of {of}: {file}, {} planned", minutes(time_s)))
    }

    /// A report.
    pub(super) fn reports(&mut self, status: &Status, progress: Progress, outlook: Outlook) -> Result<(), Failure> {
        (self.status, self.progress, self.outlook) = (Some(status.clone()), progress, Some(outlook));
        if let Some([feed_percent, ..]) = status.overrides {
            self.feed_percent = feed_percent;
        }
        let line = describe(status, self.feed_percent, outlook);
        match &mut self.form {
            Form::Json => self.event("status", json!({})),
            Form::Bar(bar) => {
                bar.set_position((outlook.done * BAR_STEPS) as u64);
                bar.set_message(line);
                Ok(())
            }
            Form::Log(told) => {
                let percent = (100.0 * outlook.done) as u32;
                if told.replace(percent / LOG_PERCENT) == Some(percent / LOG_PERCENT) {
                    return Ok(());
                }
                output::line(&format!("{percent:3} %  {line}"))
            }
        }
    }

    /// A sheet has come to its end, good or bad.
    pub(super) fn ends(&mut self, ending: &Ending) -> Result<(), Failure> {
        (self.progress, self.ending) = (ending.progress, Some(ending.clone()));
        if ending.outcome == Outcome::Done {
            self.outlook = Some(Outlook { done: 1.0, left_s: 0.0 });
        }
        match &self.form {
            Form::Json => {
                return self.event("sheet-end", ended(word(&ending.outcome), &ending.account(), Some(ending)));
            }
            Form::Bar(bar) => bar.finish_and_clear(),
            Form::Log(_) => {}
        }
        output::line(&ending.account())
    }

    /// It is all over: the last event. `outcome` is one of done, stopped, failed and refused.
    pub(super) fn over(&self, outcome: &str, message: &str) -> Result<(), Failure> {
        match &self.form {
            Form::Json => self.event("end", ended(outcome, message, self.ending.as_ref())),
            Form::Bar(bar) => {
                bar.finish_and_clear();
                Ok(())
            }
            Form::Log(_) => Ok(()),
        }
    }

    /// One JSON object on a line: what is known anyway, and what `more` says.
    fn event(&self, event: &str, more: Value) -> Result<(), Failure> {
        let status = self.status.as_ref();
        let place = |axis: usize| Some(status?.work_mm?[axis]);
        let Progress { sent, acked, executed } = self.progress;
        let mut object = json!({
            "t_s": thousandths(self.now().as_secs_f64()), "event": event,
            "sheet": self.sheet.0, "sheets": self.sheet.1,
            "line": sent, "acked": acked, "executed": executed,
            "state": status.map(|s| s.state.word()), "x_mm": place(0), "y_mm": place(1),
            "feed_mm_per_min": status.map(|s| s.feed_mm_per_min), "power": status.map(|s| thousandths(s.power_s / self.max_s)),
            "progress": self.outlook.map(|o| thousandths(o.done)), "eta_s": self.outlook.map(|o| thousandths(o.left_s)),
        });
        if let (Value::Object(object), Value::Object(more)) = (&mut object, more) {
            object.extend(more);
        }
        output::line(&object.to_string())
    }
}

/// More digits are noise.
fn thousandths(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

/// The word scripts read.
fn word(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Done => "done",
        Outcome::Stopped => "stopped",
        Outcome::Failed(_) => "failed",
    }
}

fn ended(outcome: &str, message: &str, ending: Option<&Ending>) -> Value {
    let mut object = json!({ "outcome": outcome, "message": message });
    if let Some(Ending { maybe, position_kept, beam_off, .. }) = ending {
        object["maybe"] = json!(maybe);
        object["position_kept"] = json!(position_kept);
        object["beam_off"] = json!(beam_off);
    }
    object
}

/// "12 min 05 s left  run  X12.3 Y4.5  F1320 (110 %)": no longer than what a terminal of 80 columns has room for beside the bar.
fn describe(status: &Status, feed_percent: u16, outlook: Outlook) -> String {
    let mut line = format!("{} left  {}", minutes(outlook.left_s), status.state.word());
    if let Some([x, y, _]) = status.work_mm {
        line += &format!("  X{x:.1} Y{y:.1}");
    }
    line += &format!("  F{:.0}", status.feed_mm_per_min);
    if feed_percent != 100 {
        line += &format!(" ({feed_percent} %)");
    }
    line
}
