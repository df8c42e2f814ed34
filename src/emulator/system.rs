//! `$` commands (system.c).

use std::collections::VecDeque;

use super::board::{Board, State};
use super::memory::{Memory, STARTUP_LINES};
use super::motion::Way;
use super::steps::{Step, answer};
use crate::gcode::{Word, parse};

/// Bytes of GRBL's settings in the EEPROM: what restoring all of them writes.
const ALL_SETTINGS_BYTES: usize = 87;

impl Board {
    /// Carries out what follows a `$`.
    pub(super) fn system(&mut self, command: &str) -> Result<VecDeque<Step>, u8> {
        let resting = matches!(self.state, State::Idle | State::Alarm);
        let lines = |lines: Vec<String>| Ok(lines.into_iter().map(Step::Say).chain([Step::Answer(None)]).collect());
        match command {
            "" => lines(vec!["[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]".into()]),
            "$" if matches!(self.state, State::Run | State::Hold) => Err(8),
            "$" => lines(self.settings.lines().collect()),
            "G" => lines(vec![self.modal_line()]),
            "C" => self.toggle_check(),
            "X" => self.unlock(),
            _ if command.starts_with('J') => self.jog(command.strip_prefix("J=").ok_or(3)?),
            _ if !resting => Err(8),
            "#" => lines(self.offset_lines()),
            "I" => lines(self.build_lines()),
            "N" => lines(self.memory.startup.iter().enumerate().map(|(n, line)| format!("$N{n}={line}")).collect()),
            "H" if !self.settings.is_on(22) => Err(5),
            "H" => {
                self.state = State::Home;
                let startup = (0..STARTUP_LINES).map(Step::Startup);
                Ok([Step::Home, Step::Homed].into_iter().chain(startup).chain([Step::Answer(None)]).collect())
            }
            "SLP" => Ok([Step::Answer(None), Step::Sleep].into()),
            "RST=$" | "RST=#" | "RST=*" => {
                if command != "RST=#" {
                    self.settings = self.hardware.settings.clone();
                    self.apply_settings();
                }
                let kept = match command {
                    "RST=$" => self.memory.clone(),
                    "RST=#" => {
                        let Memory { startup, build_info, .. } = self.memory.clone();
                        Memory { startup, build_info, ..Memory::default() }
                    }
                    _ => Memory::default(),
                };
                let said = Step::Say("[MSG:Restoring defaults]".into());
                let mut steps = VecDeque::from([Step::Eeprom(ALL_SETTINGS_BYTES)]);
                steps.extend(self.write(kept));
                steps.extend([said, Step::Answer(None), Step::Reset]);
                Ok(steps)
            }
            _ => match (command.strip_prefix("I="), command.strip_prefix('N')) {
                (Some(text), _) => {
                    let memory = Memory { build_info: text.into(), ..self.memory.clone() };
                    Ok(self.write(memory).into_iter().chain([Step::Answer(None)]).collect())
                }
                (None, Some(startup)) => self.store_startup(startup),
                (None, None) => self.store(command),
            },
        }
    }

    fn store(&mut self, command: &str) -> Result<VecDeque<Step>, u8> {
        let (number, value) = command.split_once('=').ok_or(3)?;
        let number = number.parse().map_err(|_| 3)?;
        // GRBL knows neither exponents nor names for numbers.
        let plain = value.bytes().all(|b| matches!(b, b'0'..=b'9' | b'.' | b'-' | b'+'));
        let value: f64 = value.parse().ok().filter(|_| plain).ok_or(2)?;
        let written = self.settings.store(number, value)?;
        self.apply_settings();
        Ok([Step::Eeprom(written), Step::Answer(None)].into())
    }

    /// `$N0=` and `$N1=`: carried out to see whether it can be, then stored.
    fn store_startup(&mut self, command: &str) -> Result<VecDeque<Step>, u8> {
        if self.state != State::Idle {
            return Err(8);
        }
        let (number, line) = command.split_once('=').ok_or(3)?;
        let number = number.parse::<usize>().ok().filter(|n| *n < STARTUP_LINES).ok_or(3)?;
        let mut steps = self.g_code(line)?;
        let answered = steps.pop_back();
        let mut memory = self.memory.clone();
        memory.startup[number] = line.to_owned();
        steps.extend(self.write(memory).into_iter().chain(answered));
        Ok(steps)
    }

    /// A startup line as steps: it is told with what became of it instead of answered.
    pub(super) fn startup_steps(&mut self, number: usize) -> VecDeque<Step> {
        let line = self.memory.startup[number].clone();
        if line.is_empty() {
            return VecDeque::new();
        }
        match self.g_code(&line) {
            Ok(mut steps) => {
                steps.retain(|step| !matches!(step, Step::Answer(_)));
                steps.push_back(Step::Say(format!(">{line}:ok")));
                steps
            }
            Err(code) => [Step::Say(format!(">{line}:error:{code}"))].into(),
        }
    }

    /// Stores what is to survive power; the writing takes its time when anything changes.
    pub(super) fn write(&mut self, memory: Memory) -> Option<Step> {
        let bytes = memory.bytes_changed(&self.memory);
        self.memory = memory;
        (bytes > 0).then_some(Step::Eeprom(bytes))
    }

    fn toggle_check(&mut self) -> Result<VecDeque<Step>, u8> {
        match self.state {
            State::Check => Ok([Step::Say("[MSG:Disabled]".into()), Step::Answer(None), Step::Reset].into()),
            State::Idle => {
                self.state = State::Check;
                Ok([Step::Say("[MSG:Enabled]".into()), Step::Answer(None)].into())
            }
            _ => Err(8),
        }
    }

    fn unlock(&mut self) -> Result<VecDeque<Step>, u8> {
        if self.state != State::Alarm {
            return Ok(answer(None));
        }
        self.state = State::Idle;
        Ok([Step::Say("[MSG:Caution: Unlocked]".into()), Step::Answer(None)].into())
    }

    /// `$J=` (gcode.c, jog.c): a line with units and distance of its own, at a feed of its own, with the beam as it is.
    fn jog(&mut self, text: &str) -> Result<VecDeque<Step>, u8> {
        if !matches!(self.state, State::Idle | State::Jog) {
            return Err(8);
        }
        let program = parse(text).map_err(|e| e.grbl_error)?;
        let mut line = program.lines.into_iter().next().ok_or(26)?;
        let takes = |w: &Word| match w.letter {
            'G' => [20.0, 21.0, 53.0, 90.0, 91.0].contains(&w.value),
            letter => matches!(letter, 'X' | 'Y' | 'Z' | 'F' | 'N'),
        };
        if !line.words.iter().all(takes) {
            return Err(16);
        }
        if line.value('F').is_none_or(|f| f <= 0.0) {
            return Err(22);
        }
        if !['X', 'Y', 'Z'].iter().any(|axis| line.value(*axis).is_some()) {
            return Err(26);
        }
        line.words.extend([Word::new('G', 1.0), Word::new('G', 94.0)]);
        // Modal state stays as it was; only the position goes on.
        let mut jogger = self.interpreter.clone();
        let moves = jogger.line(&line).map_err(|problem| problem.grbl_error())?;
        if self.settings.is_on(20) && !self.is_within(jogger.position()) {
            return Err(15);
        }
        self.interpreter.set_position(jogger.position());
        let mut steps = VecDeque::new();
        for m in moves.iter().filter(|m| m.goes()) {
            let (beam, power_s) = (m.beam, m.power_s);
            let way = Way { to: m.to, feed_mm_per_min: Some(m.feed_mm_per_min), overridable: false, beam, power_s };
            steps.push_back(Step::Way(way));
        }
        steps.push_back(Step::Jog);
        steps.push_back(Step::Answer(None));
        Ok(steps)
    }
}
