//! What comes in.

use super::{Phase, Session, modes};
use crate::stream::advice::is_critical;
use crate::stream::event::Event;
use crate::stream::reply::{Firmware, Reply};
use crate::stream::status::{State, Status};
use crate::stream::trouble::Trouble;
use crate::stream::window::Kind;

/// "Memory could not be read": `$#` and `$N` answer it and `ok` to the same line.
const MEMORY_READ_ERROR: u16 = 7;

impl Session {
    /// One line of the board's, without its line feed.
    pub(super) fn on_line(&mut self, line: &str) {
        let Some(reply) = Reply::parse(line, self.board.inches()) else { return };
        match reply {
            Reply::Ok => self.on_answer(None),
            Reply::Error(code) => self.on_answer(Some(code)),
            Reply::Alarm(code) => self.on_alarm(code),
            Reply::Banner { firmware, version } => self.on_banner(firmware, version),
            Reply::Status(status) => self.on_status(status),
            Reply::Setting(number, value) => {
                self.board.settings.insert(number, value);
                self.tell(Event::Text(line.trim().to_owned()));
            }
            Reply::Buffers { blocks, bytes } if blocks > 0 && bytes > 1 => {
                (self.board.blocks, self.board.rx_bytes, self.board.blocks_told) = (blocks, bytes, true);
                self.tell(Event::Text(line.trim().to_owned()));
            }
            Reply::Version(version) => {
                if version.contains("FluidNC") {
                    self.board.firmware = Firmware::FluidNc;
                }
                self.board.version = version;
                self.tell(Event::Text(line.trim().to_owned()));
            }
            Reply::Firmware(firmware) => {
                self.board.firmware = firmware;
                self.tell(Event::Text(line.trim().to_owned()));
            }
            Reply::Message(message) => self.tell(Event::Message(message)),
            Reply::Modes(words) => {
                self.modes = modes::told(&words);
                self.shift_modes();
                self.tell(Event::Text(line.trim().to_owned()));
            }
            Reply::Shift(shift_mm) => {
                self.board.shift_mm = Some(shift_mm);
                self.shift_modes();
                self.tell(Event::Text(line.trim().to_owned()));
            }
            Reply::ToolLength(length_mm) => {
                self.board.tool_length_mm = Some(length_mm);
                self.shift_modes();
                self.tell(Event::Text(line.trim().to_owned()));
            }
            Reply::Startup(startup) => {
                self.obeyed(&startup);
                self.tell(Event::Text(line.trim().to_owned()));
            }
            Reply::Buffers { .. } | Reply::Text(_) => self.tell(Event::Text(line.trim().to_owned())),
        }
    }

    fn on_answer(&mut self, error: Option<u16>) {
        self.idle_since = None;
        self.rest_reports = 0;
        match self.phase {
            Phase::Opening { probed: Some(_), .. } => return self.ask(),
            Phase::Opening { .. } | Phase::Lost => return,
            Phase::Stopping(_) if self.window.is_empty() => return,
            _ => {}
        }
        let asks_twice = |text: &str| matches!(text, "$#" | "$N");
        if error == Some(MEMORY_READ_ERROR) && self.window.first().is_some_and(|entry| asks_twice(&entry.text)) {
            return;
        }
        let Some(entry) = self.window.pop() else {
            return match self.job.is_some() {
                true => self.fail(Trouble::ExtraAnswer),
                false => self.tell(Event::Text("an answer to no line of ours".to_owned())),
            };
        };
        match (entry.kind, error) {
            (Kind::Order, error) => self.on_order_answered(entry.text, error),
            (Kind::Job(number), None) => {
                let most = self.board.open_blocks();
                if let Some(job) = &mut self.job {
                    job.ledger.accepted(number, entry.effect, most);
                }
            }
            (Kind::Job(line), Some(code)) => {
                let trouble = Trouble::Refused { line, text: entry.text, code, firmware: self.board.firmware };
                if matches!(self.phase, Phase::Stopping(_)) {
                    self.tell(Event::Trouble(trouble))
                } else if self.is_checking() {
                    self.refused_in_check(line, trouble);
                } else {
                    self.fail(trouble)
                }
            }
        }
    }

    fn on_order_answered(&mut self, line: String, error: Option<u16>) {
        if line == "$H" && error.is_none() {
            (self.board.homed, self.board.restarted) = (true, false);
        }
        if error.is_none() {
            self.obeyed(&line);
        }
        let check_refused = error.is_some() && self.is_checking();
        self.tell(Event::Answered { line, error });
        if check_refused {
            return self.fail(Trouble::NoCheckMode);
        }
        if matches!(self.phase, Phase::Asking) && self.alone.is_empty() && self.window.is_empty() {
            self.phase = Phase::Ready;
            let board = self.board.clone();
            self.tell(Event::Ready(board));
        }
    }

    fn on_alarm(&mut self, code: u16) {
        let firmware = self.board.firmware;
        // A soft limit stops before it is passed and the position is kept; after all others it is in doubt.
        if code != 2 {
            self.board.homed = false;
        }
        if let Phase::Stopping(stopping) = &mut self.phase {
            stopping.clean = false;
            return;
        }
        self.deaf = is_critical(firmware, code);
        let trouble = Trouble::Alarm { code, firmware };
        self.tell(Event::Trouble(trouble.clone()));
        if self.job.is_some() {
            self.reset_for(Some(trouble));
        }
    }

    fn on_banner(&mut self, firmware: Firmware, version: String) {
        self.board.firmware = firmware;
        if self.board.version.is_empty() {
            self.board.version = version;
        }
        self.window.clear();
        self.alone.clear();
        self.overrides.restarted();
        self.deaf = false;
        self.idle_since = None;
        self.rest_reports = 0;
        self.status = None;
        self.modes = Some(modes::at_start());
        // GRBL forgets both with a reset (gc_init); others may keep them.
        let forgets = firmware == Firmware::Grbl;
        (self.board.shift_mm, self.board.tool_length_mm) = (forgets.then_some([0.0; 3]), forgets.then_some(0.0));
        match self.phase {
            Phase::Opening { .. } | Phase::Asking | Phase::Lost => {
                self.board.restarted = true;
                self.ask();
            }
            Phase::Stopping(_) => self.finish_stop(true),
            Phase::Ready if self.leaves_check() => self.finish_check(),
            Phase::Ready if self.job.is_some() => {
                self.tell(Event::Trouble(Trouble::Restarted));
                (self.board.homed, self.board.restarted) = (false, true);
                // Lines that were on the wire when it started anew are carried out by a board that knows nothing of what came before them.
                self.reset_for(Some(Trouble::Restarted));
            }
            Phase::Ready => self.tell(Event::Restarted),
        }
    }

    fn on_status(&mut self, mut status: Status) {
        if status.offset_mm.is_some() {
            self.board.offset_mm = status.offset_mm;
        }
        if let Some(offset) = self.board.offset_mm {
            let place =
                |from: Option<[f64; 3]>, sign: f64| from.map(|p| std::array::from_fn(|k| p[k] + sign * offset[k]));
            status.work_mm = status.work_mm.or_else(|| place(status.machine_mm, -1.0));
            status.machine_mm = status.machine_mm.or_else(|| place(status.work_mm, 1.0));
        }
        if let Some(told) = status.overrides {
            self.overrides.reported(told);
        }
        self.count_rest(&status);
        let departure = self.locate(&status);
        let progress = self.progress();
        let state = status.state;
        self.status = Some(status.clone());
        self.tell(Event::Status(status, progress));
        match self.phase {
            Phase::Stopping(_) => self.on_status_while_stopping(state),
            Phase::Ready if self.job.is_some() => match state {
                _ if departure.is_some() => departure.into_iter().for_each(|trouble| self.fail(trouble)),
                State::Alarm => {
                    self.tell(Event::Trouble(Trouble::Locked));
                    self.reset_for(Some(Trouble::Locked));
                }
                State::Sleep => {
                    self.tell(Event::Trouble(Trouble::Asleep));
                    self.reset_for(Some(Trouble::Asleep));
                }
                _ if self.is_checking() => self.on_status_while_checking(state),
                _ => self.end_when_done(),
            },
            _ => {}
        }
    }

    /// What a report says about lines carried out, and about rest.
    fn count_rest(&mut self, status: &Status) {
        if let Some((free, _)) = status.free.filter(|_| !self.board.blocks_told) {
            // A board that does not tell its planner's size has at least as many places as are free.
            self.board.blocks = self.board.blocks.max(free);
        }
        let used = status.free.map(|(blocks, _)| self.board.blocks.saturating_sub(blocks));
        let idle = matches!(status.state, State::Idle | State::Check);
        self.rest_reports = if idle && used.unwrap_or(0) == 0 { self.rest_reports + 1 } else { 0 };
        if !idle || self.window.is_empty() {
            self.idle_since = None;
        } else {
            self.idle_since.get_or_insert(self.now);
        }
        let (rested, segments) = (self.rested(), self.board.firmware.segments());
        if let Some(job) = &mut self.job {
            match used {
                _ if rested => job.ledger.agreed(),
                Some(used) if status.state == State::Hold(0) => job.ledger.reported(used),
                // An alarm empties the planner.
                Some(used) if status.state != State::Alarm => job.ledger.reported(used + segments),
                _ => {}
            }
        }
    }
}
