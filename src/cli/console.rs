//! `furbelow console`: talk to a board line by line, with what its answers mean.

use std::io::{BufRead, IsTerminal};
use std::sync::mpsc::{self, Receiver};
use std::time::Duration;

use serde_json::json;

use super::connection::{Where, failed, machine_failure};
use super::talk::{OnInterrupt, Talk};
use super::{Failure, output};
use crate::stream::{Command, Event, State, Trouble};

/// How long to wait for the board before looking for lines again.
const LINE_WAIT: Duration = Duration::from_millis(20);

/// Waits without an event after which a question for the state is given up: 2 s, in which a board reports a dozen times.
const QUIET_WAITS: u32 = 100;

/// Reports of rest after which a script may end.
const REST_REPORTS: u32 = 2;

const HELP: &str = "lines go to the board; ? tells where it stands, ! or hold brakes, ~ or resume goes on, ^X or reset resets, unlock is $X, home is $H, cancel ends a jog, quit leaves; Ctrl-C brakes and resets";

/// Arguments of `console`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    at: Where,
    /// One JSON object a line on stdout instead of sentences
    #[arg(long)]
    json: bool,
}

/// What a typed line asks for.
#[derive(Debug, PartialEq, Eq)]
enum Typed {
    /// A byte the board acts on at once, or one that needs no answer.
    AtOnce(AtOnce),
    /// A line to be answered.
    Line(String),
    /// Tell the state.
    Where,
    Help,
    Quit,
    Nothing,
}

#[derive(Debug, PartialEq, Eq)]
enum AtOnce {
    Hold,
    Resume,
    Reset,
    CancelJog,
}

/// How a console session stands.
struct Console {
    talk: Talk,
    json: bool,
    /// Lines that are not answered.
    open: usize,
    /// A reset is under way.
    resetting: bool,
    /// Reports of rest since the last line.
    rest_reports: u32,
    /// An alarm has sounded, and the board has not started anew since: nothing moves, and it may answer nothing.
    alarmed: bool,
    /// Waits in a row in which nothing came.
    quiet: u32,
    /// Lines that ended in an error, and alarms.
    errors: usize,
    /// The next report is told.
    asked: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let machine = args.at.machine()?;
    let by_hand = std::io::stdin().is_terminal();
    let talk = Talk::open(&args.at.port, &machine)?;
    talk.on_interrupt(OnInterrupt::Stop);
    let mut console = Console {
        talk,
        json: args.json,
        open: 0,
        resetting: false,
        rest_reports: 0,
        alarmed: false,
        quiet: 0,
        errors: 0,
        asked: false,
    };
    if !args.json {
        let board = &console.talk.board;
        output::line(&format!("{} {}, {}", board.firmware.title(), board.version, console.talk.place()))?;
    }
    if by_hand {
        output::line(HELP)?;
    }
    let lines = read_lines();
    let mut at_end = false;
    loop {
        match console.talk.next(LINE_WAIT) {
            Some(event) => console.hear(event)?,
            None => console.hear_nothing()?,
        }
        if console.talk.interrupted() {
            return console.stopped();
        }
        // A script's next line waits for the answer to its last; a person's goes at once and is sent in turn.
        if at_end || !(by_hand || console.is_answered()) {
            if at_end && console.may_end() {
                break;
            }
            continue;
        }
        match lines.try_recv() {
            Ok(line) => at_end = console.say(&line)?,
            Err(mpsc::TryRecvError::Empty) => {}
            Err(mpsc::TryRecvError::Disconnected) => at_end = true,
        }
    }
    console.darken()?;
    match console.errors {
        n if n > 0 && !by_hand => Err(failed(format!("{} of the script ended in an error", output::count(n, "line")))),
        _ => Ok(()),
    }
}

impl Console {
    fn is_answered(&self) -> bool {
        self.open == 0 && !self.resetting && !self.asked
    }

    /// True when all is answered and the machine rests.
    fn may_end(&self) -> bool {
        self.is_answered() && (self.alarmed || self.rest_reports >= REST_REPORTS)
    }

    fn hear_nothing(&mut self) -> Result<(), Failure> {
        self.quiet += 1;
        if self.quiet >= QUIET_WAITS && std::mem::take(&mut self.asked) {
            let message = "the board does not report where it stands: reset it";
            self.tell(message, json!({ "event": "trouble", "message": message }))?;
        }
        Ok(())
    }

    /// Acts on a line that was typed; true to leave.
    fn say(&mut self, line: &str) -> Result<bool, Failure> {
        let command = match read(line) {
            Typed::Nothing => return Ok(false),
            Typed::Quit => return Ok(true),
            Typed::Help => return output::line(HELP).map(|()| false),
            Typed::Where => {
                self.asked = true;
                return Ok(false);
            }
            Typed::AtOnce(AtOnce::Reset) => {
                self.resetting = true;
                // What was under way is never answered.
                self.open = 0;
                Command::Reset
            }
            Typed::AtOnce(AtOnce::Hold) => Command::Hold,
            Typed::AtOnce(AtOnce::Resume) => Command::Resume,
            Typed::AtOnce(AtOnce::CancelJog) => Command::JogCancel,
            Typed::Line(line) => {
                self.open += 1;
                Command::Line(line)
            }
        };
        self.rest_reports = 0;
        self.talk.command(command);
        Ok(false)
    }

    fn hear(&mut self, event: Event) -> Result<(), Failure> {
        self.quiet = 0;
        match event {
            Event::Status(status, _) => {
                self.rest_reports = if status.state.at_rest() { self.rest_reports + 1 } else { 0 };
                if std::mem::take(&mut self.asked) {
                    let mut object = self.talk.place_json();
                    object["event"] = json!("status");
                    self.tell(&self.talk.place(), object)?;
                }
            }
            Event::Text(text) => self.tell(&text, json!({ "event": "text", "text": text }))?,
            Event::Message(text) => self.tell(&format!("[{text}]"), json!({ "event": "message", "text": text }))?,
            Event::Answered { line, error } => self.answered(&line, error)?,
            Event::Denied(reason) => {
                self.open = self.open.saturating_sub(1);
                self.errors += 1;
                self.tell(reason, json!({ "event": "denied", "message": reason }))?;
            }
            Event::Restarted => {
                (self.resetting, self.alarmed) = (false, false);
                self.open = 0;
                self.tell("the board has started anew", json!({ "event": "restarted" }))?;
            }
            Event::Trouble(trouble) => self.trouble(trouble)?,
            Event::Ready(_) | Event::Ended(_) => {}
        }
        Ok(())
    }

    fn answered(&mut self, line: &str, error: Option<u16>) -> Result<(), Failure> {
        self.open = self.open.saturating_sub(1);
        let object = json!({ "event": "answer", "line": line, "error": error });
        match error {
            None => self.tell("ok", object),
            Some(code) => {
                self.errors += 1;
                let explained = format!("{line}: {}", self.talk.explained(code));
                self.tell(&explained, object)
            }
        }
    }

    fn trouble(&mut self, trouble: Trouble) -> Result<(), Failure> {
        let message = trouble.to_string();
        match trouble {
            Trouble::Unsendable { .. } | Trouble::TooLong { .. } => self.open = self.open.saturating_sub(1),
            // The line that raised it is answered by the reset that must follow, or never.
            Trouble::Alarm { .. } => (self.open, self.alarmed) = (0, true),
            Trouble::Link(_) | Trouble::Silent(_) => return Err(machine_failure(trouble)),
            _ => {}
        }
        // An alarm that a reset of the user's brings is no surprise.
        self.errors += usize::from(!self.resetting);
        self.tell(&message, json!({ "event": "trouble", "message": message }))
    }

    fn tell(&self, text: &str, object: serde_json::Value) -> Result<(), Failure> {
        if self.json { output::line(&object.to_string()) } else { output::line(text) }
    }

    /// Nobody is there any more to look after a beam that was left on.
    fn darken(&mut self) -> Result<(), Failure> {
        if self.talk.status.power_s > 0.0 && self.talk.status.state == State::Idle {
            self.talk.insist(Command::Line("M5S0".to_owned()))?;
            eprintln!("the beam was left on: it is switched off");
        }
        Ok(())
    }

    /// Ctrl-C: the session brakes and resets by itself.
    fn stopped(mut self) -> Result<(), Failure> {
        let ending = self.talk.wait_for_end(&mut |_| Ok(()))?;
        eprintln!("stopped: {}", ending.account());
        self.talk.leave_stopped()
    }
}

fn read(line: &str) -> Typed {
    let line = line.trim();
    match line.to_ascii_lowercase().as_str() {
        "" => Typed::Nothing,
        "?" => Typed::Where,
        "help" => Typed::Help,
        "q" | "quit" | "exit" => Typed::Quit,
        "!" | "hold" => Typed::AtOnce(AtOnce::Hold),
        "~" | "resume" => Typed::AtOnce(AtOnce::Resume),
        "^x" | "\u{18}" | "reset" => Typed::AtOnce(AtOnce::Reset),
        "cancel" => Typed::AtOnce(AtOnce::CancelJog),
        "unlock" => Typed::Line("$X".to_owned()),
        "home" => Typed::Line("$H".to_owned()),
        _ => Typed::Line(line.to_owned()),
    }
}

/// Lines of stdin, until its end.
fn read_lines() -> Receiver<String> {
    let (typed, lines) = mpsc::channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            if typed.send(line).is_err() {
                break;
            }
        }
    });
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_orders_and_all_else_goes_to_the_board() {
        assert_eq!(read(" Hold "), Typed::AtOnce(AtOnce::Hold));
        assert_eq!(read("^X"), Typed::AtOnce(AtOnce::Reset));
        assert_eq!(read("unlock"), Typed::Line("$X".into()));
        assert_eq!(read("G1 X10 F100"), Typed::Line("G1 X10 F100".into()));
        assert_eq!((read(""), read("?"), read("q")), (Typed::Nothing, Typed::Where, Typed::Quit));
    }
}
