//! `furbelow resume`: goes on with a job that was stopped, interrupted or cut short by a fault.
//!
//! What was sent is in the journal, and how far it surely came. The machine is brought to where it knows its place, or is told where the sheet lies; the
//! head goes to a cross with the beam off, so that somebody can see whether it still fits; and the rest of the program is sent as a job of its own.

use std::fs::File;
use std::io::{BufReader, IsTerminal};
use std::path::{Path, PathBuf};

use super::super::connection::{Where, refused};
use super::super::keyboard::Keyboard;
use super::super::placing::{Placing, anywhere, drive_to};
use super::super::talk::Talk;
use super::super::{Failure, jobs, output};
use super::program::Program;
use super::teller::Teller;
use super::{Sending, setup, tell_end};
use crate::config::Machine;
use crate::gcode::{self, Restart, restart};
use crate::geom::{P2, P3, Similarity, V2};
use crate::stream::{Head, Outcome, Progress, Reached, Record, Standing};

/// A head this near to where it was last seen has not been moved, mm: half a step of a coarse machine and three decimals.
const SAME_PLACE_MM: f64 = 0.05;

/// Arguments of `resume`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Number of the job (see `furbelow jobs`) [default: the last one that is not finished]
    job: Option<u32>,
    /// Machine, when it is another file than the job was sent with
    #[arg(short, long)]
    machine: Option<String>,
    /// Where its board hangs now, when that has changed
    #[arg(long)]
    port: Option<String>,
    /// Go on at the start of the path that was interrupted, or at the very point, with --overlap-mm
    #[arg(long, value_name = "WHERE", default_value = "path")]
    at: At,
    /// How much of what is cut already is cut again before the point
    #[arg(long, value_name = "MM", default_value_t = 0.5)]
    overlap_mm: f64,
    /// Home the machine first
    #[arg(long)]
    home: bool,
    /// The head stands where the job's X0 Y0 was: make it work zero
    #[arg(long)]
    zero: bool,
    /// Find the sheet by the job's two alignment crosses, at X1,Y1,X2,Y2 in work coordinates; without them the head is moved onto them
    #[arg(long, value_name = "X1,Y1,X2,Y2", num_args = 0..=1, require_equals = true)]
    align: Option<Option<String>>,
    /// Go on although something else may have been cut than was planned
    #[arg(long)]
    although_damaged: bool,
    /// The setup checklist is done, and the sheet has not moved: do not ask
    #[arg(short, long)]
    yes: bool,
    /// One JSON object a line on stdout instead of sentences
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum At {
    /// The start of the path.
    Path,
    /// The very point.
    Point,
}

pub(in crate::cli) fn run(args: &Args) -> Result<(), Failure> {
    let record = chosen(args.job)?;
    if !(args.overlap_mm >= 0.0 && args.overlap_mm.is_finite()) {
        return Err(Failure::config(format!("--overlap-mm {}: it must be 0 or more", args.overlap_mm)));
    }
    let at = Where {
        machine: args.machine.clone().unwrap_or_else(|| record.head.machine.clone()),
        port: args.port.clone().unwrap_or_else(|| record.head.port.clone()),
    };
    let machine = at.machine()?;
    let mut teller = Teller::new(args.json, machine.controller.max_s);
    let sending_args = super::Args {
        job: PathBuf::from(&record.head.name),
        at: None,
        machines: Vec::new(),
        material: None,
        from_sheet: record.head.sheet.0,
        placing: Placing::by_crosses(args.align.as_ref().map(Option::as_deref))?,
        home: args.home,
        zero: args.zero,
        fix: false,
        check_on_board: false,
        yes: args.yes,
        pause_s: None,
        anyway: record.head.anyway,
        json: args.json,
    };
    let done = match record.standing {
        Standing::Damaged => {
            "nothing is left to cut; what was cut before may be something else than was planned: look at the sheet"
        }
        _ => "all is cut",
    };
    let sent = resume(args, &sending_args, &at, machine, record, &mut teller);
    tell_end(sent, done, &teller)
}

/// The job that is asked for, if it can be gone on with.
fn chosen(number: Option<u32>) -> Result<Record, Failure> {
    let journal = jobs::journal()?;
    let record = match number {
        Some(number) => journal.record(number)?,
        None => journal
            .records()?
            .into_iter()
            .rfind(|record| record.standing.is_open())
            .ok_or_else(|| refused("no job was left unfinished; `furbelow jobs` lists them all"))?,
    };
    let number = record.number;
    match record.standing {
        Standing::Running => Err(refused(format!("job {number} is being sent at this moment"))),
        Standing::Done => Err(refused(format!("job {number} is done: send it again to cut it again"))),
        Standing::Resumed => Err(refused(match record.resumed_by() {
            Some(by) => format!("job {by} went on with job {number}: resume that one"),
            None => format!("another job went on with job {number}"),
        })),
        _ => Ok(record),
    }
}

fn resume(
    args: &Args,
    sending_args: &super::Args,
    at: &Where,
    machine: Machine,
    record: Record,
    teller: &mut Teller,
) -> Result<Outcome, Failure> {
    tell(&record, teller)?;
    if record.standing == Standing::Damaged && !args.although_damaged {
        return Err(refused(format!(
            "job {} may have cut something else than was planned: look at the sheet, and give --although-damaged if it is worth going on",
            record.number
        )));
    }
    let somebody = std::io::stdin().is_terminal();
    if !somebody && !args.yes {
        return Err(Failure::config(
            "nobody is there to say that the sheet has not moved; give --yes when all is prepared",
        ));
    }
    let path = record.program()?;
    // Where its rest is to lie it is checked again.
    let program = Program::read(&path, record.head.name.clone(), &anywhere(&machine), |_| ())?;
    let Some(from) = place_to_go_on(args, &record)? else {
        record.finished()?;
        let doubt = match record.standing {
            Standing::Damaged => {
                ", but something else may have been cut than was planned: look at the sheet before you take it off"
            }
            _ => ": all its cuts are surely carried out",
        };
        teller.note("nothing-left", &format!("nothing is left to cut of job {}{doubt}", record.number))?;
        tell_rest(&record.head, at, teller)?;
        return Ok(Outcome::Done);
    };
    let programs = vec![program];
    let setup = setup(sending_args, &machine, &programs, &mut |code, message| teller.warn(code, message))?;
    let talk = Talk::open(&at.port, &machine)?;
    let keyboard = somebody.then(Keyboard::open);
    let scratch = tempfile::tempdir()?;
    let mut sending = Sending {
        args: sending_args,
        at,
        machine,
        programs,
        setup,
        keyboard,
        talk,
        teller,
        scratch,
        resumes: Some(record),
        placed: 1,
    };
    if !sending.get_ready()? {
        return Ok(Outcome::Stopped);
    }
    let Some(placing) = sending.placing_again()? else { return Ok(Outcome::Stopped) };
    let start_mm = sending.resumes.as_ref().and_then(|r| r.head.start_mm).map_or(P3::origin(), P3::from);
    if let Some(Record { head, .. }) = &sending.resumes {
        (sending.programs[0].crosses_mm, sending.programs[0].own_zero_mm) = (head.crosses_mm, head.own_zero_mm);
    }
    sending.lay(0, start_mm, placing, Some(from))?;
    if !sending.sheet_is_there()? {
        return Ok(Outcome::Stopped);
    }
    let outcome = sending.go()?;
    if let Some(record) = sending.resumes.as_ref().filter(|_| outcome == Outcome::Done) {
        tell_rest(&record.head, at, sending.teller)?;
    }
    Ok(outcome)
}

/// Says how the sheets after this one are sent.
fn tell_rest(head: &Head, at: &Where, teller: &Teller) -> Result<(), Failure> {
    rest_of_set(head, at).map_or(Ok(()), |command| teller.note("rest", &format!("the sheets after it: {command}")))
}

/// The command for what comes after a sheet of a set; `None` after the last.
fn rest_of_set(head: &Head, at: &Where) -> Option<String> {
    let (number, of) = head.sheet;
    let folder = Path::new(&head.name).parent().filter(|_| number < of)?;
    // A folder that `make` wrote holds its programs in one of its own.
    let folder = if folder.ends_with("sheets") { folder.parent()? } else { folder };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Where { machine, port } = at;
    Some(format!("furbelow send {} --from-sheet {} -m {machine} --port {port}", folder.display(), number + 1))
}

/// Says what is known.
fn tell(record: &Record, teller: &Teller) -> Result<(), Failure> {
    let Progress { executed, reached, .. } = record.progress();
    let (number, head) = (record.number, &record.head);
    let mut text = format!(
        "job {number}: {}, {}; of {} lines {executed} are surely carried out",
        head.name,
        record.standing.word(),
        head.lines
    );
    if record.maybe() > executed {
        text += &format!(", up to {} may be", record.maybe());
    }
    if let Some(reached) = reached.filter(|reached| reached.line > executed) {
        text += &format!("; the head was last seen {} mm into line {}", output::number(reached.along_mm), reached.line);
    }
    teller.note("job", &text)
}

/// Where the program is taken up; `None` when nothing is left of it.
fn place_to_go_on(args: &Args, record: &Record) -> Result<Option<Restart>, Failure> {
    let Reached { line, along_mm } = record.progress().place();
    let done = Restart { line, along_mm };
    let laser = record.head.laser;
    if args.at == At::Point && !laser {
        return Err(refused("only a laser can go on in the middle of a path: leave --at point out"));
    }
    let overlap_mm = (args.at == At::Point).then_some(args.overlap_mm);
    let lines = gcode::read_lines(BufReader::new(File::open(record.program()?)?));
    let start_mm = record.head.start_mm.map_or(P3::origin(), P3::from);
    restart(lines, start_mm, done, laser, overlap_mm).map_err(|e| refused(e.to_string()))
}

impl Sending<'_> {
    /// From the job's coordinates to work coordinates as they are now. `None` when the user has stopped it.
    ///
    /// # Errors
    /// Nothing says where the job lies.
    fn placing_again(&mut self) -> Result<Option<Similarity>, Failure> {
        let Some(record) = &self.resumes else { return Ok(Some(Similarity::identity())) };
        if record.is_other_board(&self.talk.board) {
            self.teller.warn("other-board", "the board has other settings than the one this job was sent to")?;
        }
        let head = &record.head;
        if self.args.placing.is_aligned() {
            let keyboard = self.keyboard.as_ref();
            return self.args.placing.solve(head.crosses_mm, &mut self.talk, &self.machine, keyboard);
        }
        if self.args.zero {
            return Ok(Some(Similarity::new(-V2::from(head.own_zero_mm), 0.0, 1.0)));
        }
        let last_mm = record.notes.iter().rev().find_map(|note| note.machine_mm);
        let near = |a: [f64; 3], b: [f64; 3]| (0..2).all(|k| (a[k] - b[k]).abs() <= SAME_PLACE_MM);
        let unmoved = last_mm.zip(self.talk.status.machine_mm).is_some_and(|(a, b)| near(a, b));
        let board = &self.talk.board;
        // A board that has not started anew since, and stands where it stood, still counts from where it did.
        let counts_on = !board.restarted && !board.homed && record.position_kept() && unmoved;
        let homed_both = head.homed && board.homed;
        // Homing finds again what was lost in between, where the job's own coordinates were those of homing too.
        let knows_on = head.knew_place && board.knows_place() && (board.homed || !record.position_lost());
        match head.offset_mm.zip(board.offset_mm) {
            Some((was, is)) if counts_on || homed_both || knows_on && near(was, is) => {
                Ok(Some(Similarity::new(V2::new(was[0] - is[0], was[1] - is[1]), 0.0, 1.0)))
            }
            _ if self.talk.homes() => Err(refused(
                "the machine may have lost its place: --home homes it (which helps when it was homed before the job too); or --align finds the sheet by its crosses; or put the head where the job's X0 Y0 was and give --zero",
            )),
            _ => Err(refused(
                "the machine has no switches and its board has forgotten where the head is: put the head where the job's X0 Y0 was and give --zero, or find the sheet by its crosses with --align",
            )),
        }
    }

    /// Goes to a cross with the beam off, or to where the job goes on, and asks whether the sheet is still where it was. False when it is not.
    fn sheet_is_there(&mut self) -> Result<bool, Failure> {
        let program = &self.programs[0];
        let (place, what) = match program.crosses_mm {
            Some([first, _]) => (P2::from(first), "its first alignment cross"),
            None => match program.survey.first_cut_mm {
                Some(place) => (P2::from(place), "where it goes on"),
                None => return Ok(true),
            },
        };
        if drive_to(&mut self.talk, &self.machine, place)? != Outcome::Done {
            return Ok(false);
        }
        self.teller.say(&format!("the head stands over {what}, beam off: {}", self.talk.place()));
        if self.args.yes {
            return Ok(true);
        }
        let question = "is the sheet still where it was, and the head where it should be? Enter goes on; if not, Ctrl-C, and resume with --align";
        Ok(self.ask(question)?.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Board;

    #[test]
    fn the_rest_of_a_set_is_a_command() {
        let at = Where { machine: "diode-400".to_owned(), port: "/dev/ttyUSB0".to_owned() };
        let rest = |name: &str, sheet: (usize, usize)| {
            rest_of_set(&Head { sheet, ..Head::new(name, "diode-400", "", &Board::default()) }, &at)
        };
        let command = |folder: &str| format!("furbelow send {folder} --from-sheet 3 -m diode-400 --port /dev/ttyUSB0");
        assert_eq!(rest("out/stool/sheets/sheet-02.nc", (2, 5)), Some(command("out/stool")));
        assert_eq!(rest("sheets/2.nc", (2, 3)), Some(command(".")));
        assert_eq!(rest("mine/2.nc", (2, 3)), Some(command("mine")));
        assert_eq!(rest("2.nc", (2, 3)), Some(command(".")));
        assert_eq!(rest("out/stool/sheets/sheet-05.nc", (5, 5)), None);
    }
}
