//! Several machines at once: the sheets are dealt out, each machine takes the next when it has done its own, and one that fails holds no other up.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::super::connection::{
    self, EVENT_WAIT, failed, machine_failure, open_at, refused, require_board, wait_until_asked,
};
use super::super::{Exit, Failure, output};
use super::keeping::Keeping;
use super::program::Program;
use super::{Args, check, files, setup};
use crate::config::{Library, Machine};
use crate::job;
use crate::stream::{
    self, Address, Board, Command, Ending, Event, Head, Link, Outcome, State, Status, Trouble, Weight, lasting_name,
};

/// Reports that are waited for before a sheet is cut: the first may have been under way before.
const FRESH_REPORTS: usize = 2;

/// One machine of several.
struct Member {
    /// "diode-400@/dev/ttyUSB0".
    name: String,
    /// As it was given.
    machine_name: String,
    machine: Machine,
    port: String,
    /// All sheets, checked for this machine.
    programs: Vec<Program>,
}

/// Where a signal goes.
struct Ear {
    commands: Sender<Command>,
    /// It seeks its switches, and hears nothing but a reset.
    homes: Arc<AtomicBool>,
}

/// A machine that is being served: its board, and what was last heard of it.
struct Served {
    link: Link,
    board: Board,
    status: Status,
}

/// What all machines share.
struct Fleet<'a> {
    args: &'a Args,
    /// Sheets nobody has taken, by their place in the folder.
    waiting: Mutex<VecDeque<usize>>,
    done: Mutex<Vec<usize>>,
    began: Instant,
    interrupted: Arc<AtomicBool>,
    ears: Arc<Mutex<Vec<Ear>>>,
}

/// Sends all sheets to all machines.
///
/// # Errors
/// A machine or program that is not in order, before anything moves; at the end, any machine that failed.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let files = files(args)?;
    let members = members(args, &files)?;
    if !args.yes {
        return Err(Failure::config(
            "several machines at once are not asked one by one: give --yes when all checklists are done",
        ));
    }
    if files.len() > members.len() && args.pause_s.is_none() {
        return Err(Failure::config(format!(
            "{} for {}: say with --pause-s how many seconds loading the next sheet takes",
            output::count(files.len(), "sheet"),
            output::count(members.len(), "machine")
        )));
    }
    let fleet = Fleet {
        args,
        waiting: Mutex::new((0..files.len()).collect()),
        done: Mutex::new(Vec::new()),
        began: Instant::now(),
        interrupted: Arc::default(),
        ears: Arc::default(),
    };
    for member in &members {
        let mut warn = |_: &str, message: &str| fleet.tell(member, None, "warning", message);
        // What is to be done before was done: --yes says so.
        setup(args, &member.machine, &member.programs, &mut warn)?;
    }
    let (interrupted, ears) = (Arc::clone(&fleet.interrupted), Arc::clone(&fleet.ears));
    let on_interrupt = move || {
        interrupted.store(true, Ordering::SeqCst);
        for ear in locked(&ears).iter() {
            let command = if ear.homes.load(Ordering::SeqCst) { Command::Reset } else { Command::Stop };
            // A session that has ended has told why.
            let _ = ear.commands.send(command);
        }
    };
    ctrlc::set_handler(on_interrupt).map_err(Failure::config)?;
    let failures: Vec<String> = std::thread::scope(|scope| {
        let work = |member: Member| {
            let fleet = &fleet;
            scope.spawn(move || {
                let ended = fleet.serve(&member);
                ended.err().map(|failure| {
                    let why = failure.chain().map(ToString::to_string).collect::<Vec<_>>().join(": ");
                    // The others go on, whoever listens.
                    let _ = fleet.tell(&member, None, "failed", &why);
                    format!("{}: {why}", member.name)
                })
            })
        };
        let workers: Vec<_> = members.into_iter().map(work).collect();
        let ended = workers.into_iter().map(|worker| worker.join());
        ended
            .filter_map(|ended| ended.unwrap_or_else(|_| Some("a bug ended the work for one machine".to_owned())))
            .collect()
    });
    fleet.over(files.len(), &failures)
}

/// Reads "NAME@PORT" for each machine, and checks every sheet for it.
fn members(args: &Args, files: &[PathBuf]) -> Result<Vec<Member>, Failure> {
    let library = Library::open();
    let mut members: Vec<Member> = Vec::new();
    for text in &args.machines {
        let (machine_name, port) = text.split_once('@').ok_or_else(|| {
            Failure::config(format!("--machines {text}: each is NAME@PORT, such as diode-400@/dev/ttyUSB0"))
        })?;
        if let Some(twin) =
            members.iter().find(|member| member.port == port && !matches!(Address::parse(port), Address::Emulator(_)))
        {
            return Err(Failure::config(format!("--machines: {} and {text} hang on the same port", twin.name)));
        }
        let machine = library.machine(machine_name)?;
        require_board(&machine)?;
        let programs = check(files, &machine)?;
        let (name, port, machine_name) = (text.clone(), port.to_owned(), machine_name.to_owned());
        members.push(Member { name, machine_name, machine, port, programs });
    }
    Ok(members)
}

impl Fleet<'_> {
    /// Takes sheets for one machine until there are no more.
    fn serve(&self, member: &Member) -> Result<(), Failure> {
        let link = open_at(&member.port, member.machine.controller.baud)?;
        let homes = Arc::new(AtomicBool::new(self.args.home));
        locked(&self.ears).extend(link.commands().map(|commands| Ear { commands, homes: Arc::clone(&homes) }));
        let (board, status) = wait_until_asked(&link, &mut Vec::new(), false)?;
        let mut served = Served { link, board, status };
        if self.args.home && !self.home(&mut served)? {
            return Ok(());
        }
        homes.store(false, Ordering::SeqCst);
        connection::require_idle(&served.status)?;
        let mut first = true;
        while let Some(k) = self.next() {
            let cut = self.load(member, k, std::mem::take(&mut first), &mut served).and_then(|goes_on| match goes_on {
                true => self.cut(member, k, &mut served).map(Some),
                false => Ok(None),
            });
            match cut {
                Ok(Some(ending)) if ending.outcome == Outcome::Done => locked(&self.done).push(k),
                Ok(Some(ending)) => {
                    return match ending.outcome {
                        Outcome::Failed(trouble) => Err(machine_failure(trouble)),
                        Outcome::Done | Outcome::Stopped => Ok(()),
                    };
                }
                Ok(None) => {
                    self.put_back(k);
                    return Ok(());
                }
                Err(failure) => {
                    self.put_back(k);
                    return Err(failure);
                }
            }
        }
        Ok(())
    }

    fn next(&self) -> Option<usize> {
        if self.interrupted.load(Ordering::SeqCst) { None } else { locked(&self.waiting).pop_front() }
    }

    /// A sheet that was not begun is for another machine.
    fn put_back(&self, k: usize) {
        locked(&self.waiting).push_front(k);
    }

    /// Gives whoever loads the time for it. False when it was stopped meanwhile.
    ///
    /// # Errors
    /// The board fails or starts anew meanwhile, or is not idle afterwards.
    fn load(&self, member: &Member, k: usize, first: bool, served: &mut Served) -> Result<bool, Failure> {
        let program = &member.programs[k];
        let stock = program.stock().unwrap_or_else(|| program.name());
        self.tell(member, Some(k), "load", &format!("sheet {}: {stock}", k + self.args.from_sheet))?;
        let until = Instant::now() + Duration::from_secs(self.args.pause_s.filter(|_| !first).unwrap_or(0).into());
        // What had come before counts too; the reports after it say how the board stands now.
        let mut fresh = 0;
        while (Instant::now() < until || fresh < FRESH_REPORTS) && !self.interrupted.load(Ordering::SeqCst) {
            let left = until.saturating_duration_since(Instant::now());
            fresh += usize::from(served.heed(EVENT_WAIT)? && left.is_zero());
        }
        if self.interrupted.load(Ordering::SeqCst) {
            return Ok(false);
        }
        connection::require_idle(&served.status).map(|()| true)
    }

    /// Seeks the switches and asks everything again. False when it was stopped meanwhile.
    fn home(&self, served: &mut Served) -> Result<bool, Failure> {
        if self.interrupted.load(Ordering::SeqCst) {
            return Ok(false);
        }
        served.link.command(Command::Home);
        let mut homed = false;
        loop {
            let event = served.link.next(EVENT_WAIT).map(|(_, event)| event);
            // Then troubles and a new start are what was asked for.
            if self.interrupted.load(Ordering::SeqCst) {
                return Ok(false);
            }
            match event {
                Some(Event::Answered { error: None, .. }) => {
                    homed = true;
                    served.link.command(Command::Ask);
                }
                Some(Event::Answered { error: Some(code), .. }) => {
                    return Err(failed(format!("it cannot be homed: error:{code}")));
                }
                Some(Event::Ready(board)) if homed => {
                    served.board = board;
                    while served.status.state != State::Idle {
                        served.heed(EVENT_WAIT)?;
                    }
                    served.heed(EVENT_WAIT)?;
                    return Ok(true);
                }
                Some(Event::Trouble(trouble)) => return Err(machine_failure(trouble)),
                Some(Event::Denied(reason)) => return Err(failed(reason)),
                Some(Event::Restarted) => return Err(machine_failure(Trouble::Restarted)),
                Some(_) | None => {}
            }
        }
    }

    fn cut(&self, member: &Member, k: usize, served: &mut Served) -> Result<Ending, Failure> {
        let Served { link, board, status } = served;
        let program = &member.programs[k];
        let expected = job::expected(&member.machine);
        for finding in stream::preflight(&program.survey.demand, program.label.machine.as_deref(), board, &expected) {
            if finding.weight == Weight::Refusal && !(self.args.anyway && finding.code == "other-machine") {
                return Err(refused(finding.message));
            }
            self.tell(member, Some(k), "warning", &finding.message)?;
        }
        let mut head = Head::new(program.name(), &member.machine_name, lasting_name(&member.port), board);
        let place = k + self.args.from_sheet;
        head.sheet = program.place((place, self.args.from_sheet - 1 + member.programs.len()));
        head.laser = member.machine.tool.class.is_laser();
        head.start_mm = status.work_mm;
        head.anyway = self.args.anyway;
        let (mut keeping, lines) = Keeping::take_up(program, head, None)?;
        let number = keeping.number().map_or(String::new(), |number| format!(", job {number}"));
        self.tell(member, Some(k), "sheet", &format!("{}{number}", program.name()))?;
        link.command(Command::Run { lines });
        let ending = self.follow(member, k, link, &mut keeping, status)?;
        keeping.ends(&ending);
        self.tell(member, Some(k), "sheet-end", &ending.account())?;
        Ok(ending)
    }

    fn follow(
        &self,
        member: &Member,
        k: usize,
        link: &Link,
        keeping: &mut Keeping,
        status: &mut Status,
    ) -> Result<Ending, Failure> {
        let mut waited = Duration::ZERO;
        let mut restarted = false;
        loop {
            if let Some(complaint) = keeping.complaint() {
                self.tell(member, Some(k), "warning", &complaint)?;
            }
            let Some((_, event)) = link.next(EVENT_WAIT) else {
                waited += EVENT_WAIT;
                // A session says something every moment while its thread lives.
                if waited > Duration::from_secs(30) {
                    return Err(failed("nothing is heard from the session any more"));
                }
                continue;
            };
            waited = Duration::ZERO;
            match event {
                Event::Status(report, progress) => {
                    keeping.reports(&report, progress);
                    *status = report;
                }
                Event::Trouble(trouble) => {
                    keeping.troubled(&trouble);
                    self.tell(member, Some(k), "trouble", &trouble.to_string())?;
                }
                Event::Message(message) => self.tell(member, Some(k), "message", &message)?,
                Event::Denied(reason) if !self.interrupted.load(Ordering::SeqCst) => return Err(failed(reason)),
                // It lost its place before it was told the first line.
                Event::Restarted => {
                    restarted = true;
                    link.command(Command::Stop);
                }
                Event::Ended(ending) if restarted => return Ok(ending.after_restart()),
                Event::Ended(ending) => return Ok(ending),
                _ => {}
            }
        }
    }

    fn tell(&self, member: &Member, sheet: Option<usize>, event: &str, message: &str) -> Result<(), Failure> {
        if !self.args.json {
            return output::line(&format!("{}: {message}", member.name));
        }
        let object: Value = json!({
            "t_s": (self.began.elapsed().as_secs_f64() * 1e3).round() / 1e3, "event": event, "machine": member.name,
            "sheet": sheet.map(|k| k + self.args.from_sheet), "message": message,
        });
        output::line(&object.to_string())
    }

    /// Says how it all ended.
    fn over(&self, sheets: usize, failures: &[String]) -> Result<(), Failure> {
        let mut done: Vec<usize> = locked(&self.done).iter().map(|k| k + self.args.from_sheet).collect();
        done.sort_unstable();
        let left: Vec<usize> =
            (0..sheets).map(|k| k + self.args.from_sheet).filter(|sheet| !done.contains(sheet)).collect();
        let interrupted = self.interrupted.load(Ordering::SeqCst);
        let outcome = match () {
            () if left.is_empty() => "done",
            () if interrupted => "stopped",
            () => "failed",
        };
        if self.args.json {
            let object =
                json!({ "event": "end", "outcome": outcome, "done": done, "left": left, "failures": failures });
            output::line(&object.to_string())?;
        } else {
            let list = |sheets: &[usize]| sheets.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            let left = if left.is_empty() { String::new() } else { format!("; not done: {}", list(&left)) };
            output::line(&format!("sheets done: {}{left}", list(&done)))?;
        }
        match () {
            () if left.is_empty() => Ok(()),
            () if interrupted => std::process::exit(Exit::STOPPED),
            () => Err(failed(format!("not all sheets are cut: {}", failures.join("; ")))),
        }
    }
}

impl Served {
    /// Lets the board speak once. True when it reported.
    ///
    /// # Errors
    /// It fails, or starts anew.
    fn heed(&mut self, wait: Duration) -> Result<bool, Failure> {
        match self.link.next(wait) {
            Some((_, Event::Status(status, _))) => {
                self.board.seen(&status);
                self.status = status;
                Ok(true)
            }
            Some((_, Event::Trouble(trouble))) => Err(machine_failure(trouble)),
            Some((_, Event::Restarted)) => Err(machine_failure(Trouble::Restarted)),
            Some(_) | None => Ok(false),
        }
    }
}

fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic elsewhere leaves lists of whole things.
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
