//! `$` commands (system.c).

use std::collections::VecDeque;

use super::board::{Board, State};
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
            "I" => {
                let options = format!("[OPT:V,{},{}]", self.hardware.planner_blocks, self.hardware.rx_bytes);
                lines(vec!["[VER:1.1h.20190830:]".into(), options])
            }
            "N" => lines(vec!["$N0=".into(), "$N1=".into()]),
            "H" if !self.settings.is_on(22) => Err(5),
            "H" => {
                self.state = State::Home;
                Ok([Step::Home, Step::Homed, Step::Answer(None)].into())
            }
            "SLP" => Ok([Step::Answer(None), Step::Sleep].into()),
            "RST=$" | "RST=#" | "RST=*" => {
                if command != "RST=#" {
                    self.settings = self.hardware.settings.clone();
                    self.apply_settings();
                }
                if command != "RST=$" {
                    self.stored_mm = Default::default();
                }
                let said = Step::Say("[MSG:Restoring defaults]".into());
                Ok([Step::Eeprom(ALL_SETTINGS_BYTES), said, Step::Answer(None), Step::Reset].into())
            }
            _ => self.store(command),
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
