//! One run of the campaign: a job is sent, a fault strikes, and where a machine can be homed the job is taken up again and finished.

use furbelow::emulator::{Board, BoardSettings, Fault, Memory, Settings, State, When};
use furbelow::gcode::{Restart, Rewriter, restart};
use furbelow::geom::{P3, Similarity, V3};
use furbelow::stream::{Command, Outcome, Progress, Trouble};
use std::fmt::Write as _;

use super::path::{Plan, burnt_mm, light_s, way_mm};
use super::rig::Rig;

/// What strikes, and what it does to the job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    ToHostDropped,
    ToHostCorrupted,
    OkStuck,
    Chatter,
    UnpluggedOwnPower,
    UnpluggedNoPower,
    Reset,
    SenderKilled,
    Stop,
    StopTwice,
    LineTorn,
    ToBoardDropped,
    ToBoardCorrupted,
}

impl Kind {
    pub const ALL: [Kind; 13] = [
        Kind::ToHostDropped,
        Kind::ToHostCorrupted,
        Kind::OkStuck,
        Kind::Chatter,
        Kind::UnpluggedOwnPower,
        Kind::UnpluggedNoPower,
        Kind::Reset,
        Kind::SenderKilled,
        Kind::Stop,
        Kind::StopTwice,
        Kind::LineTorn,
        Kind::ToBoardDropped,
        Kind::ToBoardCorrupted,
    ];

    pub fn title(self) -> &'static str {
        match self {
            Kind::ToHostDropped => "1 to 8 bytes to the computer lost",
            Kind::ToHostCorrupted => "1 to 8 bytes to the computer garbled",
            Kind::OkStuck => "1 or 2 `ok` never sent",
            Kind::Chatter => "the board talks of its own accord",
            Kind::UnpluggedOwnPower => "unplugged, board with its own power",
            Kind::UnpluggedNoPower => "unplugged, board without",
            Kind::Reset => "the board restarts",
            Kind::SenderKilled => "the sender is killed",
            Kind::Stop => "stop",
            Kind::StopTwice => "stop, twice",
            Kind::LineTorn => "a line to the board lost",
            Kind::ToBoardDropped => "1 to 4 bytes to the board lost",
            Kind::ToBoardCorrupted => "1 to 4 bytes to the board garbled",
        }
    }

    /// What the board reads is no longer what was sent.
    pub fn alters(self) -> bool {
        matches!(self, Kind::LineTorn | Kind::ToBoardDropped | Kind::ToBoardCorrupted)
    }
}

/// The machine a run is made on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kin {
    Grbl,
    GrblHal,
}

impl Kin {
    pub const ALL: [Kin; 2] = [Kin::Grbl, Kin::GrblHal];

    pub fn title(self) -> &'static str {
        match self {
            Kin::Grbl => "GRBL, 15 blocks",
            Kin::GrblHal => "grblHAL, 100 blocks",
        }
    }

    pub fn blocks(self) -> usize {
        self.hardware(1).planner_blocks
    }

    fn hardware(self, seed: u64) -> BoardSettings {
        let changes = [(20, 1.0), (22, 1.0), (23, 0.0), (24, 600.0), (25, 6000.0), (132, 5.0)];
        let settings = changes.into_iter().fold(Settings::default(), |s, (number, value)| s.with(number, value));
        let mut memory = Memory::default();
        memory.offsets_mm[0] = ZERO;
        let base = match self {
            Kin::Grbl => BoardSettings::default(),
            Kin::GrblHal => BoardSettings::grbl_hal(),
        };
        BoardSettings { settings, memory, seed, boot_s: base.boot_s.min(0.3), ..base }
    }
}

/// Where work zero lies in machine coordinates, mm.
const ZERO: V3 = V3::new(-90.0, -90.0, 0.0);

/// Burnt paths may stray from the plan so far, mm.
pub const STRAY_MM: f64 = 0.1;

/// The beam is off so long after the machine stands, at the latest, s.
pub const DARK_S: f64 = 0.05;

/// Blocks beyond the planner's that the account may be behind.
pub const BEHIND_LINES: usize = 5;

/// What is cut again before the point at which a job is taken up, mm.
const OVERLAP_MM: f64 = 0.5;

/// Rounding of lengths: arcs are burnt in chords, positions come with three decimals and a step's width, and half a dozen lines are written anew, mm.
const LENGTH_MM: f64 = 0.1;

/// Bytes a board says in a job, about.
const TO_HOST_BYTES: u64 = 5000;

/// Light of the same path on boards that plan by other numbers of blocks may differ by its corners' share.
const LIGHT_SHARE: f64 = 1e-3;

/// A job with all that jobs have, within seconds: travels, corners, an arc, short segments, changes of power, dwells.
pub fn job() -> String {
    let mut text = String::from(
        "G21G90G94G17\nM4S0\nG0X5Y5\nG1X25F3000S400\nY15\nX5S300\nY5\nG0X40Y5\nG3X40Y25J10F2400\nM5\nG4P0.1\nM4\nG0X60Y5\nG1F2000S500\n",
    );
    for k in 1..=240 {
        let t = f64::from(k) * 0.1;
        let _ = writeln!(text, "X{:.3}Y{:.3}", 60.0 + t, 5.0 + 4.0 * (2.0 * t).sin());
    }
    text + "G0X10Y40\nG1X30F2400S600\nY60S200\nX10\nG0X0Y0\nM5S0\n"
}

/// What came of a run.
#[derive(Debug, Clone)]
pub struct Run {
    pub kin: Kin,
    pub kind: Kind,
    pub outcome: String,
    /// It says that it is done, and something else was burnt.
    pub escaped: bool,
    /// Its trouble marks the job as one in which something else may have been cut.
    pub damaged: bool,
    /// The account against what the board had done, at its worst: lines behind.
    pub behind: usize,
    /// How far what was burnt strays from the plan, mm.
    pub stray_mm: f64,
    /// How long the beam was lit after the machine could stand, s.
    pub lit_late_s: f64,
    /// What was left of it was cut, or nothing was left.
    pub finished: bool,
    /// What was burnt twice when the job was taken up with an overlap; `None` when it was not, mm.
    pub twice_mm: Option<f64>,
    /// Reports beside the way before the job was ended.
    pub departed: usize,
    /// What must not be and was.
    pub broken: Vec<String>,
}

/// Chances from a seed (xorshift64, Marsaglia 2003).
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Random {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        (0..8).for_each(|_| _ = random.below(2));
        random
    }

    fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % n
    }
}

/// The job without faults: its plan and how long it takes.
pub struct Sound {
    pub text: String,
    plan: Plan,
    seconds: [f64; 2],
    start_mm: P3,
    /// Light it takes, share of full power times s.
    light_s: f64,
}

impl Sound {
    /// Runs it once on each kind of board.
    pub fn new() -> Sound {
        let text = job();
        let (mut start_mm, mut light) = (P3::origin(), 0.0);
        let seconds = Kin::ALL.map(|kin| {
            let mut rig = Rig::homed(Board::new(kin.hardware(1)));
            start_mm = rig.status.as_ref().and_then(|s| s.work_mm).map_or(start_mm, P3::from);
            let began_s = rig.now_s;
            rig.send(&text);
            assert!(rig.until(60.0, |rig| rig.ending.is_some()), "{:?}", rig.status);
            assert_eq!(rig.ending.as_ref().map(|e| &e.outcome), Some(&Outcome::Done), "{:?}", rig.ending);
            light = light_s(rig.board.trace());
            rig.now_s - began_s
        });
        Sound { plan: Plan::new(&text, start_mm, ZERO), text, seconds, start_mm, light_s: light }
    }
}

/// Plays a run.
pub fn play(seed: u64, sound: &Sound) -> Run {
    let kin = Kin::ALL[(seed % 2) as usize];
    let kind = Kind::ALL[(seed / 2 % Kind::ALL.len() as u64) as usize];
    let mut random = Random::new(seed);
    let job_s = sound.seconds[(seed % 2) as usize];
    let mut rig = Rig::homed(Board::new(kin.hardware(seed)));
    rig.board.take_trace();
    let mut strikes_s = rig.now_s + random.below((job_s * 1000.0) as u64) as f64 / 1000.0;
    let some = 1 + random.below(8) as u32;
    let fault = match kind {
        Kind::ToHostDropped => Some(Fault::DropOut(some)),
        Kind::ToHostCorrupted => Some(Fault::CorruptOut(some)),
        Kind::OkStuck => Some(Fault::StuckOk(1 + some / 5)),
        Kind::Chatter => Some(Fault::Chatter(some)),
        Kind::UnpluggedOwnPower => Some(Fault::Unplug { powered: true }),
        Kind::UnpluggedNoPower => Some(Fault::Unplug { powered: false }),
        Kind::Reset => Some(Fault::Reset),
        Kind::LineTorn => Some(Fault::TornLine),
        Kind::ToBoardDropped => Some(Fault::DropIn(some.min(4))),
        Kind::ToBoardCorrupted => Some(Fault::CorruptIn(some.min(4))),
        Kind::SenderKilled | Kind::Stop | Kind::StopTwice => None,
    };
    // Bytes come in bursts: half of the faults that strike them go by their count.
    let by_count = random.below(2) == 0;
    let ahead = |[to_board, to_host]: [u64; 2], random: &mut Random| match kind {
        Kind::LineTorn | Kind::ToBoardDropped | Kind::ToBoardCorrupted => {
            When::ByteIn(to_board + random.below(sound.text.len() as u64))
        }
        _ => When::ByteOut(to_host + random.below(TO_HOST_BYTES)),
    };
    let bytes = kind.alters() || matches!(kind, Kind::ToHostDropped | Kind::ToHostCorrupted);
    if let Some(fault) = fault {
        let when = if by_count && bytes { ahead(rig.bytes, &mut random) } else { When::At(strikes_s) };
        rig.board.schedule(when, fault);
        if by_count && bytes {
            // Nothing is altered before it strikes, and nobody knows when that is.
            strikes_s = rig.now_s;
        }
    }
    let mut run = Run {
        kin,
        kind,
        outcome: String::new(),
        escaped: false,
        damaged: false,
        behind: 0,
        stray_mm: 0.0,
        lit_late_s: 0.0,
        finished: false,
        twice_mm: None,
        departed: 0,
        broken: Vec::new(),
    };
    rig.send(&sound.text);
    follow(&mut rig, &mut run, sound, strikes_s, &mut random);
    let progress = rig.ending.as_ref().map_or(rig.progress, |ending| ending.progress);
    // What the board holds it carries out.
    rig.wait(0.1);
    if !rig.connected {
        rig.wait(job_s);
    }
    rig.wait(0.3);
    if rig.board.power() > 0.0 || rig.board.is_moving() {
        run.broken.push("it is lit or moves after its end".to_owned());
    }
    run.lit_late_s = rig.lit_late_s;
    let first = rig.board.take_trace();
    run.stray_mm = sound.plan.strays_mm(&first);
    let outcome = rig.ending.as_ref().map(|ending| ending.outcome.clone());
    run.outcome = match &outcome {
        None => "no word".to_owned(),
        Some(Outcome::Failed(trouble)) => name(trouble),
        Some(outcome) => format!("{outcome:?}").to_lowercase(),
    };
    run.damaged = matches!(&outcome, Some(Outcome::Failed(trouble)) if trouble.damages());
    let done = outcome == Some(Outcome::Done);
    run.escaped = done && (run.stray_mm > STRAY_MM || sound.plan.missed_mm(&first) > STRAY_MM);
    judge(&mut run, done);
    if done && !kind.alters() && (light_s(&first) / sound.light_s - 1.0).abs() > LIGHT_SHARE {
        run.broken.push(format!("{} of {} of light", light_s(&first), sound.light_s));
    }
    if !done && !kind.alters() {
        take_up(&mut rig, &mut run, sound, progress, &first, &mut random);
    }
    run
}

/// Until the job has ended or its sender is gone.
fn follow(rig: &mut Rig, run: &mut Run, sound: &Sound, strikes_s: f64, random: &mut Random) {
    let end_s = rig.now_s + 600.0;
    let mut asked = 0;
    let (mut reports, mut held_s) = (rig.reports, 0.0);
    while rig.ending.is_none() {
        rig.step();
        if rig.now_s > end_s {
            run.broken.push(format!("neither done nor given up: {:?}", rig.status));
            return;
        }
        if rig.reports > reports {
            reports = rig.reports;
            let sound_so_far = !run.kind.alters() || rig.now_s < strikes_s;
            if sound_so_far && rig.board.is_plugged() && rig.board.state() != State::Alarm {
                account(rig, run, sound);
            }
            depart(rig, run, sound);
        }
        match run.kind {
            Kind::SenderKilled if rig.now_s >= strikes_s => {
                rig.connected = false;
                return;
            }
            Kind::Stop | Kind::StopTwice if rig.now_s >= strikes_s && asked == 0 => {
                rig.command(Command::Stop);
                asked = 1;
                if run.kind == Kind::StopTwice {
                    rig.wait(0.001 * random.below(200) as f64);
                    rig.command(Command::Stop);
                }
            }
            _ => {}
        }
        if !rig.board.is_plugged() {
            rig.lose_link();
        }
        // A byte that became a hold: someone sees the machine stand and lets it go on.
        let held = rig.board.state() == State::Hold && rig.trouble.is_none() && asked == 0;
        held_s = if held { held_s + 0.004 } else { 0.0 };
        if held_s > 3.0 {
            rig.command(Command::Resume);
            held_s = 0.0;
        }
    }
}

/// The account of the lines against what the board has done.
fn account(rig: &Rig, run: &mut Run, sound: &Sound) {
    let done = sound.plan.line_at(way_mm(rig.board.trace()) + LENGTH_MM);
    let told = rig.progress.executed;
    if told > done {
        // Lines without a way may be done before the next one with a way begins.
        if sound.plan.lines_with_way(done, told) > 0 {
            run.broken.push(format!("line {told} is told as done, and {done} is"));
        }
    }
    // Where answers and lines do not agree the account goes back to where they did, and the place the head was seen at stands beside it.
    let disagree = matches!(rig.trouble, Some(Trouble::LostAnswer { .. } | Trouble::ExtraAnswer));
    if !disagree {
        run.behind = run.behind.max(sound.plan.lines_with_way(told, done.max(told)));
    }
    if let Some(reached) = rig.progress.reached {
        let told_mm = sound.plan.way_mm[reached.line - 1] + reached.along_mm;
        if told_mm > way_mm(rig.board.trace()) + LENGTH_MM {
            run.broken.push(format!("{reached:?} is told as reached, and it is not"));
        }
    }
}

/// Reports of a head beside its way.
fn depart(rig: &Rig, run: &mut Run, sound: &Sound) {
    let Some(place) = rig.status.as_ref().and_then(|status| status.machine_mm) else { return };
    let running = rig.board.state() == State::Run && rig.trouble.is_none();
    // What the board says may be garbled: where it is counts.
    let off = sound.plan.off_mm(rig.board.position_mm(), true).min(sound.plan.off_mm(P3::from(place), true)) > STRAY_MM;
    run.departed = if running && off {
        run.departed + 1
    } else if running {
        0
    } else {
        run.departed
    };
    if run.departed > 2 {
        run.broken.push("a third report beside the way, and it goes on".to_owned());
        run.departed = 0;
    }
}

/// What must hold in every run.
fn judge(run: &mut Run, done: bool) {
    if run.lit_late_s > DARK_S {
        run.broken.push(format!("lit {:.3} s after it could stand", run.lit_late_s));
    }
    if run.behind > run.kin.blocks() + BEHIND_LINES {
        run.broken.push(format!("the account is {} lines behind", run.behind));
    }
    if !run.kind.alters() && run.stray_mm > STRAY_MM {
        run.broken.push(format!("burnt {:.3} mm beside the plan", run.stray_mm));
    }
    if !run.kind.alters() && run.escaped {
        run.broken.push("done, and something is missing".to_owned());
    }
    if run.kind == Kind::Chatter && !done {
        run.broken.push("chatter ended the job".to_owned());
    }
}

/// The job is taken up: homed, the rest sent, and both traces together are the plan.
fn take_up(
    rig: &mut Rig,
    run: &mut Run,
    sound: &Sound,
    progress: Progress,
    first: &[furbelow::emulator::Segment],
    random: &mut Random,
) {
    let done = progress.place();
    let overlap_mm = (random.below(2) == 0).then_some(OVERLAP_MM);
    let lines = || sound.text.lines().map(|line| Ok(line.to_owned()));
    let done = Restart { line: done.line, along_mm: done.along_mm };
    let from = restart(lines(), sound.start_mm, done, true, overlap_mm).expect("a program");
    let burnt_first = burnt_mm(first);
    let whole = sound.plan.burnt_mm[sound.plan.burnt_mm.len() - 1];
    let Some(from) = from else {
        run.finished = true;
        if burnt_first + LENGTH_MM < whole {
            run.broken.push(format!("nothing is left to cut, and {:.1} mm are", whole - burnt_first));
        }
        return;
    };
    let mut rewriter = Rewriter::new(sound.start_mm, Similarity::identity(), true, Some(from));
    let rest: Vec<String> = sound.text.lines().flat_map(|line| rewriter.line(line).expect("lines")).collect();
    if !rig.board.is_plugged() {
        rig.board.schedule(When::At(rig.now_s), Fault::Replug);
        rig.wait(0.02);
    }
    rig.reopen();
    rig.board.take_trace();
    rig.send(&(rest.join("\n") + "\n"));
    if !rig.until(120.0, |rig| rig.ending.is_some()) {
        run.broken.push("what was taken up does not end".to_owned());
        return;
    }
    let ending = rig.ending.as_ref().map(|ending| ending.outcome.clone());
    if ending != Some(Outcome::Done) {
        run.broken.push(format!("what was taken up ended with {ending:?}"));
    }
    run.finished = true;
    let second = rig.board.take_trace();
    let burnt_second = burnt_mm(&second);
    let both: Vec<_> = first.iter().chain(&second).copied().collect();
    let (missed, strays) = (sound.plan.missed_mm(&both), sound.plan.strays_mm(&both));
    if missed > STRAY_MM || strays > STRAY_MM {
        run.broken.push(format!("together {missed:.3} mm are missing and {strays:.3} mm astray"));
    }
    let twice_mm = burnt_first + burnt_second - whole;
    run.twice_mm = overlap_mm.map(|_| twice_mm);
    // What the board did after its last word to us is cut again: nobody could know.
    let begun_mm = whole - burnt_second;
    let planned_from_mm = begun_mm + overlap_mm.unwrap_or(0.0);
    if twice_mm < -LENGTH_MM || overlap_mm.is_some() && burnt_first + LENGTH_MM < begun_mm {
        run.broken.push(format!("{:.3} mm were left out", -twice_mm));
    }
    let in_doubt_mm = (burnt_first - planned_from_mm).max(0.0);
    if overlap_mm.is_some_and(|overlap| twice_mm > overlap + in_doubt_mm + LENGTH_MM) {
        run.broken.push(format!("{twice_mm:.3} mm were burnt twice"));
    }
    let at_rest = matches!(run.kind, Kind::Stop) && run.outcome == "stopped";
    if at_rest && overlap_mm.is_some_and(|overlap| twice_mm > overlap + LENGTH_MM) {
        run.broken.push(format!("after a stop at rest {twice_mm:.3} mm were burnt twice"));
    }
}

fn name(trouble: &Trouble) -> String {
    let words = match trouble {
        Trouble::Refused { .. } => "a line refused",
        Trouble::Alarm { .. } => "alarm",
        Trouble::Locked => "locked",
        Trouble::Restarted => "restart noticed",
        Trouble::Silent(_) => "silence noticed",
        Trouble::Link(_) => "port gone",
        Trouble::LostAnswer { .. } => "missing `ok` noticed",
        Trouble::ExtraAnswer => "extra `ok` noticed",
        Trouble::WrongPlace { .. } => "wrong end noticed",
        Trouble::OffPlan { .. } => "off its way noticed",
        Trouble::TooSlow { .. } => "too slow noticed",
        _ => "other trouble",
    };
    words.to_owned()
}
