//! What a machine, its tool and its material would object to in a program, ours or foreign.
//!
//! Streams: holds one line, the planner's blocks and the findings, however long the file. Goes on after what the machine would refuse, as
//! GRBL does: a refused line changes nothing.

use std::collections::VecDeque;
use std::io::BufRead;

use super::burn::Burn;
use super::finding::{Finding, Findings};
use super::held_feed::HeldFeed;
use super::line_rules::LineRules;
use super::lines::{MAX_LINE_BYTES, read_line, real_time};
use super::move_rules::MoveRules;
use super::parse::{column_of_word, parse_line};
use super::timing::LitTime;
use super::trace::{Tracer, sent_bytes};
use super::{Limits, Move, Planner, Program, Stretch};
use crate::geom::Rect;

/// How many lines go by between two steps.
const LINES_PER_STEP: usize = 4096;

/// What the machine permits and what its tool and material bear.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckSettings {
    /// What the head may reach, mm in work coordinates.
    pub work_area: Rect,
    /// Travel of z, mm (GRBL $132).
    pub travel_z_mm: f64,
    /// What stands on the bed: its name and where, mm in work coordinates.
    pub keep_outs: Vec<(String, Rect)>,
    /// The S word of full power (GRBL $30).
    pub max_s: f64,
    /// How fast it moves, and how fast lines get there.
    pub limits: Limits,
    /// True when the tool burns.
    pub laser: bool,
    /// GRBL $32: the beam is off in G0 and power can follow speed.
    pub laser_mode: bool,
    /// The controller knows M7, which GRBL does only when built with it.
    pub mist: bool,
    /// Share of full power below which the beam goes out: a CO2 tube's strike floor; 0 when there is none.
    pub strike_floor: f64,
    /// What the material bears, when it is known.
    pub energy: Option<Energy>,
}

/// Energy per length, to tell cutting from scorching.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy {
    /// Light at full power, W.
    pub full_power_w: f64,
    /// What cuts the material, J/mm.
    pub cut_j_per_mm: f64,
}

/// Everything found, and what the program amounts to.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// What must not be sent, by line.
    pub errors: Vec<Finding>,
    /// What the user should know, by line.
    pub warnings: Vec<Finding>,
    /// Box around everything burnt or cut, mm in work coordinates; empty when nothing is.
    pub bounds: Rect,
    /// Length burnt or cut, mm.
    pub cut_mm: f64,
    /// Length moved without, mm.
    pub travel_mm: f64,
    /// Planned time, s, from the first step to the last.
    pub time_s: f64,
    /// How long the laser is lit, s.
    pub laser_on_s: f64,
    /// Lines of the file.
    pub lines: usize,
}

/// Checks a program held in memory, as a file of its written lines.
pub fn check(program: &Program, settings: &CheckSettings) -> Report {
    let mut checker = Checker::new(settings);
    for line in &program.lines {
        checker.line(&line.to_string());
    }
    checker.finish()
}

/// Checks moves that are known already, those of a plot: where they go, how fast and how long, and not how they are written.
pub fn check_moves(moves: &[Move], lines: usize, settings: &CheckSettings) -> Report {
    let mut checker = Checker::new(settings);
    checker.lines = lines;
    for m in moves {
        checker.take(m);
    }
    checker.finish()
}

/// Where findings go.
#[derive(Debug, Default)]
pub(super) struct Notes {
    pub(super) errors: Findings,
    pub(super) warnings: Findings,
}

/// Looks on while a file is checked, for who needs more than the report and must not hold the file either.
pub trait Witness: std::fmt::Debug {
    /// The program asks for this next.
    fn asked(&mut self, m: &Move);
    /// A move asked for before takes so many seconds more; moves come in order, and some of them several times.
    fn took(&mut self, m: &Move, seconds: f64);
}

/// Checks a file line by line.
#[derive(Debug)]
pub struct Checker<'a> {
    settings: &'a CheckSettings,
    witness: Option<&'a mut dyn Witness>,
    notes: Notes,
    tracer: Tracer,
    planner: Planner,
    line_rules: LineRules,
    move_rules: MoveRules,
    sums: Sums,
    lines: usize,
    /// Moves pushed to the planner.
    pushed: usize,
    /// What one line does.
    moves: Vec<Move>,
}

/// What comes out of the planner, move by move.
#[derive(Debug, Default)]
struct Sums {
    /// Moves the planner has not done with, with their index.
    pending: VecDeque<(usize, Move)>,
    /// The move the last stretch belonged to, and what it did so far.
    burn: Burn,
    held: HeldFeed,
    lit: LitTime,
    time_s: f64,
    cut_mm: f64,
    travel_mm: f64,
    bounds: Option<Rect>,
}

impl<'a> Checker<'a> {
    /// Nothing read yet.
    pub fn new(settings: &'a CheckSettings) -> Checker<'a> {
        Checker {
            settings,
            witness: None,
            notes: Notes::default(),
            tracer: Tracer::new(),
            planner: Planner::new(&settings.limits),
            line_rules: LineRules::default(),
            move_rules: MoveRules::default(),
            sums: Sums::default(),
            lines: 0,
            pushed: 0,
            moves: Vec::new(),
        }
    }

    /// Nothing read yet; `witness` is shown every move.
    pub fn watched(settings: &'a CheckSettings, witness: &'a mut dyn Witness) -> Checker<'a> {
        Checker { witness: Some(witness), ..Checker::new(settings) }
    }

    /// Takes a whole file; `step` is told now and then how many bytes are done.
    ///
    /// # Errors
    /// Those of `input`.
    pub fn read(&mut self, mut input: impl BufRead, mut step: impl FnMut(u64)) -> std::io::Result<()> {
        let mut bytes = Vec::new();
        let mut done = 0;
        for count in 1_usize.. {
            let taken = read_line(&mut input, &mut bytes, MAX_LINE_BYTES)?;
            if taken == 0 {
                break;
            }
            done += taken;
            if count % LINES_PER_STEP == 0 {
                step(done);
            }
            self.raw_line(&bytes);
        }
        Ok(())
    }

    /// Takes the next line, without its line feed.
    pub fn line(&mut self, text: &str) {
        self.raw_line(text.as_bytes());
    }

    fn raw_line(&mut self, raw: &[u8]) {
        self.lines += 1;
        let number = self.lines;
        let Checker { settings, notes, .. } = self;
        // The start of a line that is not known whole may mean something else than the line.
        if raw.len() > MAX_LINE_BYTES {
            notes.errors.add(number, 1, "line-too-long", || {
                "line longer than 65,536 bytes was not read; split it, or have the file written with line ends".into()
            });
            return;
        }
        if !real_time(number, raw, notes) {
            return;
        }
        let text = String::from_utf8_lossy(raw);
        let bytes = sent_bytes(&text);
        if !self.line_rules.text(number, &text, bytes, notes) {
            return;
        }
        let line = match parse_line(&text, number) {
            Ok(line) => line,
            Err(error) => {
                let code = format!("error:{}", error.grbl_error);
                notes.errors.add(number, error.column, &code, || {
                    format!("{} (GRBL error:{}), found {:?}", error.problem, error.grbl_error, error.found)
                });
                return;
            }
        };
        if line.words.is_empty() || !LineRules::takes(number, &text, &line, settings, notes) {
            return;
        }
        self.moves.clear();
        if let Err(refusal) = self.tracer.line(&line, number, bytes, &mut self.moves) {
            let code = format!("error:{}", refusal.problem.grbl_error());
            let column = column_of_word(&text, refusal.word);
            notes.errors.add(number, column, &code, || refusal.problem.to_string());
            return;
        }
        self.line_rules.words(number, &text, &line, &self.moves, notes);
        let moves = std::mem::take(&mut self.moves);
        for m in &moves {
            self.take(m);
        }
        self.moves = moves;
    }

    fn take(&mut self, m: &Move) {
        let Checker { settings, notes, .. } = self;
        self.move_rules.judge(m, settings, notes);
        if let Some(witness) = &mut self.witness {
            witness.asked(m);
        }
        self.sums.measure(m, settings);
        let index = self.pushed;
        self.pushed += 1;
        if m.length_mm() > 0.0 || !m.goes() {
            self.sums.pending.push_back((index, *m));
        }
        self.planner.push(m, &mut |stretch| self.sums.take(&stretch, settings, &mut self.witness));
    }

    /// The end of the file.
    pub fn finish(mut self) -> Report {
        let Checker { settings, mut notes, mut sums, mut witness, .. } = self;
        self.planner.finish(&mut |stretch| sums.take(&stretch, settings, &mut witness));
        sums.burn.end(settings);
        sums.burn.tell(settings, &mut notes);
        sums.held.tell(&mut notes);
        self.move_rules.end(self.lines, self.tracer.beam_left(), settings, &mut notes);
        Report {
            errors: notes.errors.finish(),
            warnings: notes.warnings.finish(),
            bounds: sums.bounds.unwrap_or(Rect::EMPTY),
            cut_mm: sums.cut_mm,
            travel_mm: sums.travel_mm,
            time_s: sums.time_s,
            laser_on_s: sums.lit.seconds,
            lines: self.lines,
        }
    }
}

impl Sums {
    fn measure(&mut self, m: &Move, settings: &CheckSettings) {
        if !m.goes() {
            return;
        }
        let cuts = m.works(settings.laser);
        if cuts {
            self.cut_mm += m.length_mm();
            self.bounds = Some(self.bounds.unwrap_or(Rect::EMPTY).union(m.bounds()));
        } else {
            self.travel_mm += m.length_mm();
        }
    }

    fn take<'w>(
        &mut self,
        stretch: &Stretch,
        settings: &CheckSettings,
        witness: &mut Option<&'w mut (dyn Witness + 'w)>,
    ) {
        self.time_s += stretch.seconds;
        while self.pending.front().is_some_and(|(index, _)| *index < stretch.index) {
            self.pending.pop_front();
        }
        let Some((_, m)) = self.pending.front() else { return };
        if let Some(witness) = witness {
            witness.took(m, stretch.seconds);
        }
        self.lit.add(m, stretch.seconds);
        self.burn.add(m, stretch, settings);
        self.held.add(m, stretch);
    }
}

#[cfg(test)]
#[path = "check_tests.rs"]
pub(super) mod tests;
